//! Warnings about windings, beside lengths and distances by hand.

use softlimb_limb::fabricate::{Settings, advice, plan};
use softlimb_scene::{Scene, parse};

/// A tube of 20 and 32 mm, 160 mm long.
fn tube(winding: &str) -> Scene {
    let text = format!(
        "format = 1\nname = \"tube\"\n[materials.rubber]\nlaw = \"neo-hookean\"\nshear_modulus = \"0.3 MPa\"\n[windings.w]\n{winding}\n\
         [limb]\nconnector = {{ length = \"15 mm\", mass = \"50 g\" }}\n[[module]]\nname = \"tube\"\nmotion = \"extension\"\nactuators = 1\n\
         inner_radius = \"20 mm\"\nouter_radius = \"32 mm\"\nlength = \"160 mm\"\nmaterial = \"rubber\"\nwinding = \"w\"\n\
         [[phase]]\nname = \"rest\"\nduration = \"1 s\"\ntargets = {{ tube = {{ axial_stretch = 1.0 }} }}\n"
    );
    parse(&text, "tube.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
}

fn warnings(winding: &str) -> Vec<String> {
    advice(&tube(winding), &Settings::default())
}

fn thread(angle_deg: f64, starts: u32) -> String {
    format!(
        "angle = \"{angle_deg} deg\"\nfamilies = 2\nthread = {{ stiffness = \"772 N\", diameter = \"0.178 mm\", starts = {starts} }}"
    )
}

#[test]
fn warnings_name_a_winding_that_can_be_made() {
    assert_eq!(warnings(&thread(3.0, 3)), Vec::<String>::new());
    // 2 families x 6 x 160 mm/sin 3 deg = 36.7 m; three of six are 18.3 m.
    let long = warnings(&thread(3.0, 6));
    assert_eq!(long.len(), 1, "{long:?}");
    assert!(long[0].starts_with("tube.toml:20: winding of `tube`: 36.7 m of thread on each actuator, 6 side by side"));
    assert!(long[0].contains("starts = 3 }` takes 18.3 m"), "{long:?}");
    // 2 pi 32 mm sin 8 deg/2 families = 13.99 mm on a wall of 12 mm: two starts are 7 mm apart, within 9 mm.
    let far = warnings(&thread(8.0, 1));
    assert!(
        far[0].contains("threads 13.99 mm apart on a wall of 12.00 mm") && far[0].contains("`starts = 2`"),
        "{far:?}"
    );
    let loss = far.iter().any(|text| text.contains("of the motion, which the plan includes"));
    assert!(loss, "{far:?}");
    // The stiff sheet of a winding that nobody winds.
    let sheet = warnings("angle = \"3 deg\"\nfamilies = 2\nmodulus = \"361 MPa\"\nthickness = \"0.178 mm\"");
    assert!(sheet[0].contains("more than 20 m; `thread = {"), "{sheet:?}");
    let layer = warnings("angle = \"3 deg\"\nfamilies = 2\nmodulus = \"1 MPa\"\nplacement = \"smeared\"");
    assert!(layer[0].contains("`placement = \"sheet\"` can be wound"), "{layer:?}");
}

/// `check` and `fabricate` choose the number of threads for a sheet by the same rule.
#[test]
fn length_of_thread_is_that_of_the_workshop() {
    for angle_deg in [3.0, 12.0, 25.0, 40.0] {
        let winding =
            format!("angle = \"{angle_deg} deg\"\nfamilies = 2\nmodulus = \"361 MPa\"\nthickness = \"0.178 mm\"");
        let wound = &plan(&tube(&winding), &Settings::default()).expect("it can be wound")[0].winding;
        let stated =
            format!("{:.1} m of thread on each actuator, {} side by side", wound.all_threads_m(), wound.starts);
        let found = warnings(&winding);
        assert_eq!(
            found.iter().any(|text| text.contains(&stated)),
            wound.all_threads_m() > 20.0,
            "{stated}: {found:?}"
        );
    }
}
