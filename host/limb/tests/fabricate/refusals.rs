//! What cannot be made is refused where the scene says it.

use fra_model::{Actuator, Load};
use softlimb_limb::fabricate::{Settings, plan};
use softlimb_scene::parse;

use crate::fabricate::common::{TUBE, Tube, settings, words};

#[track_caller]
fn refused(tube: Tube, diameter_mm: f64, spacing_mm: f64, expected: &[&str]) {
    let error = words(&tube.piece(diameter_mm, spacing_mm).unwrap_err());
    for word in expected {
        assert!(error.contains(word), "`{word}` is missing:\n{error}");
    }
    assert!(error.contains("tube.toml:"), "no place:\n{error}");
}

#[test]
fn wall_too_thin_to_cast() {
    let thin = Tube { inner_mm: 13.3, winding_mm: 14.0, ..TUBE };
    refused(
        thin,
        0.18,
        3.0,
        &["the wall is too thin to be cast", "outer_radius = \"14 mm\"", "0.700 mm", "1.000 mm", "14.300 mm"],
    );
    let settings = Settings { wall_min_m: 5e-4, ..settings(0.18, 3.0) };
    assert!(plan(&thin.scene(), &settings).is_ok(), "another workshop can");
}

#[test]
fn groove_deeper_than_the_wall() {
    let deep = Tube { winding_mm: 10.2, ..TUBE };
    refused(deep, 0.5, 4.0, &["deeper than the wall", "winding = \"thread\"", "0.500 mm", "10.200 mm", "10.250 mm"]);
    assert!(deep.piece(0.3, 4.0).is_ok());
}

#[test]
fn threads_closer_than_their_grooves() {
    // The groove of a thread of 0.5 mm that lies flush is 1 mm wide.
    refused(TUBE, 0.5, 0.9, &["this winding cannot be wound", "0.9", "1.000 mm", "--spacing"]);
    assert!(TUBE.piece(0.5, 1.1).is_ok());
}

#[test]
fn fibers_that_fill_the_wall() {
    let text = TUBE.text().replace("thickness = \"0.2 mm\"", "placement = \"layer\"");
    let scene = parse(&text, "tube.toml").unwrap();
    let error = words(&plan(&scene, &settings(0.3, 4.0)).unwrap_err());
    assert!(error.contains("this winding cannot be wound") && error.contains("placement = \"sheet\""), "{error}");
}

#[test]
fn settings_out_of_range_are_named() {
    let good = settings(0.3, 4.0);
    let cases = [
        (
            "stiffness_n",
            Settings { thread: softlimb_limb::fabricate::Thread { stiffness_n: f64::NAN, ..good.thread }, ..good },
        ),
        (
            "diameter_m",
            Settings { thread: softlimb_limb::fabricate::Thread { diameter_m: 0.0, ..good.thread }, ..good },
        ),
        ("spacing_m", Settings { spacing_m: Some(-1e-3), ..good }),
        ("wall_min_m", Settings { wall_min_m: f64::INFINITY, ..good }),
        ("chord_m", Settings { chord_m: 0.0, ..good }),
        (
            "modulus",
            Settings { tolerances: softlimb_limb::fabricate::Tolerances { modulus: 0.6, ..good.tolerances }, ..good },
        ),
    ];
    for (field, settings) in cases {
        let error = words(&plan(&TUBE.scene(), &settings).unwrap_err());
        assert!(error.starts_with(&format!("{field} = ")) && error.contains("is not allowed"), "{error}");
    }
}

#[test]
fn distant_threads_and_thin_layers_are_remarked() {
    let piece = Tube { winding_mm: 13.8, ..TUBE }.piece(0.2, 3.5).unwrap();
    let all = piece.warnings.join("\n");
    assert!(all.contains("more than 0.75 of the wall of 4.00 mm"), "{all}");
    assert!(all.contains("the cover over the thread is 0.10 mm thin"), "{all}");
    let piece = Tube { winding_mm: 10.8, ..TUBE }.piece(0.2, 2.5).unwrap();
    let all = piece.warnings.join("\n");
    assert!(all.contains("the groove leaves 0.70 mm of wall"), "{all}");
    assert!(!all.contains("0.75 of the wall"), "{all}");
}

/// Hoops of a soft sheet hardly hold the wall: the model has a limit point below 150 kPa.
#[test]
fn pressure_beyond_the_limit_point_is_remarked() {
    let text = TUBE.text().replace("modulus = \"300 MPa\"", "modulus = \"0.01 MPa\"");
    let text = format!("{text}[limits]\npressure_max = \"150 kPa\"\n");
    let scene = parse(&text, "tube.toml").unwrap_or_else(|error| panic!("{}", error.render(false)));
    let limit_pa = Actuator::new(&scene.modules()[0].actuator())
        .expect("valid")
        .forward(150e3, &Load::none())
        .expect("finite")
        .limit_pressure_pa
        .expect("a limit point");
    let all = plan(&scene, &settings(0.3, 4.0)).unwrap()[0].warnings.join("\n");
    assert!(
        all.contains(&format!("limit point at {:.2} kPa, below `pressure_max` of 150.00 kPa", 1e-3 * limit_pa)),
        "{all}"
    );
    let below = TUBE.piece(0.3, 4.0).unwrap().warnings.join("\n");
    assert!(!below.contains("limit point"), "{below}");
}
