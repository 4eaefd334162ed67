//! Steps of valves against the flow of ISO 6358 by hand, and warnings about coarse ones.

use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_scene as scene;

fn finger(conductance: &str) -> scene::Scene {
    let path = format!("{}/../../scenes/finger.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains("\"0.008 dm3/(s bar)\""));
    scene::parse(&text.replace("\"0.008 dm3/(s bar)\"", &format!("\"{conductance} dm3/(s bar)\"")), "finger.toml")
        .unwrap()
}

#[test]
fn coarse_valves_are_named_with_a_conductance_that_would_do() {
    let warnings = |conductance: &str| {
        let scene = finger(conductance);
        let limb = Limb::new(&scene).unwrap();
        motion::valve_warnings(&scene, &limb)
    };
    assert_eq!(warnings("0.008"), Vec::<String>::new());
    let coarse = warnings("0.144");
    assert_eq!(coarse.len(), 1);
    assert!(coarse[0].starts_with("the valves are coarse for `finger`: open for 2.5 ms at least"), "{coarse:?}");
    let (_, enough) = coarse[0].split_once("a conductance of ").unwrap();
    let (enough, _) = enough.split_once(' ').unwrap();
    assert_eq!(warnings(enough), Vec::<String>::new(), "{enough}");
}

#[test]
fn first_step_is_that_of_the_flow_into_the_chamber() {
    // Subsonic flow from 161.325 kPa into 101.325 kPa with b = 0.3, for 2.5 ms; the line passes so much more that it takes 1e-3 at most.
    let subsonic = (1.0 - ((101.325_f64 / 161.325 - 0.3) / 0.7).powi(2)).sqrt();
    let mass_kg = 0.008e-8 * 1.185 * 161_325.0 * subsonic * 2.5e-3;
    // 1 mL of fittings, pi/4 2^2 500 mm3 of line.
    let dead_m3 = 1e-6 + 1.570_796e-6;
    let scene = finger("0.008");
    let limb = Limb::new(&scene).unwrap();
    let module = &limb.modules()[0];
    let air = |pressure_pa: f64| (pressure_pa + 101_325.0) * (module.curve.at(pressure_pa).volume_m3 + dead_m3);
    // Without heat that stays in the air, its mass follows pressure times volume.
    let first_pa = module.curve.states()[1].pressure_pa;
    let low = 287.05 * 293.15 * mass_kg * first_pa / (air(first_pa) - air(0.0));
    let found_pa = motion::valve_step_pa(&scene, &limb, module, first_pa);
    println!("{found_pa:.1} Pa by the check, {low:.1} Pa isothermally");
    // With heat, at most the polytropic exponent of 1.2 more.
    assert!((0.99 * low..1.21 * low).contains(&found_pa), "{found_pa} {low}");
}
