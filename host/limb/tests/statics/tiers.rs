//! Limbs of scenes: what they carry, which tier is taken, what is refused.

use softlimb_limb::Limb;
use softlimb_limb::statics::{Bundle, Fidelity, Load, LoadedLimb, Tangent, by_fidelity, cheapest, cheapest_rod};
use softlimb_scene as scene;
use softlimb_scene::Scene;

fn scene(direction: &str, density: f64) -> (Scene, Limb) {
    let file = format!("{}/../../scenes/weightless-a.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(file).expect("a scene");
    let text = text
        .replace("base_direction = [1, 0, 0]        # forward", &format!("base_direction = {direction}"))
        .replace("base_up = [0, 0, 1]", "base_up = [0, 1, 0]")
        .replace("mass = \"300 g\"", &format!("mass = \"{} g\"", 300.0 * density))
        .replace("mass = \"400 g\"", &format!("mass = \"{} g\"", 400.0 * density))
        .replace("1080 kg/m3", &format!("{} kg/m3", 1080.0 * density.max(0.1)));
    let scene = scene::parse(&text, "scene.toml").unwrap_or_else(|error| panic!("{error}"));
    let limb = Limb::new(&scene).expect("a limb");
    (scene, limb)
}

pub(crate) fn loaded(
    direction: &str,
    density: f64,
    pressure_pa: f64,
    bays: usize,
    payload_kg: f64,
) -> Option<(LoadedLimb, f64)> {
    let (scene, limb) = scene(direction, density);
    let load = Load { payload_kg, ..Load::default() };
    let pressures = vec![pressure_pa; limb.channels()];
    let loaded = LoadedLimb::new(&scene, &limb, &pressures, &vec![bays; limb.modules().len()], &load)?;
    Some((loaded, scene.rest_length_m()))
}

#[test]
fn kinematic_tier_is_the_kinematics() {
    let (scene, limb) = scene("[1, 0, 0]", 1.0);
    let pressures: Vec<f64> = limb.modules().iter().flat_map(|module| vec![40e3; module.channels.len()]).collect();
    let loaded = LoadedLimb::new(&scene, &limb, &pressures, &[3, 3, 3], &Load::default()).expect("a limb");
    let states: Vec<_> = limb
        .modules()
        .iter()
        .map(|module| module.actuator.forward(40e3, &fra_model::Load::none()).expect("finite").state)
        .collect();
    let off = (loaded.free_tip().translation.vector - limb.tip_pose(&states).translation.vector).norm();
    assert!(off < 1e-12, "{off:e}");
}

/// Without load tubes of their own are where the kinematics have them; those of a twisting bundle lean, and the kinematics have them by a series.
#[test]
fn tubes_without_load_are_the_kinematics() {
    for letter in ["a", "b", "c"] {
        let file = format!("{}/../../scenes/weightless-{letter}.toml", env!("CARGO_MANIFEST_DIR"));
        let scene = scene::load(&file).unwrap_or_else(|error| panic!("{error}"));
        let limb = Limb::new(&scene).expect("a limb");
        let bays = vec![2; limb.modules().len()];
        let loaded =
            LoadedLimb::new(&scene, &limb, &vec![40e3; limb.channels()], &bays, &Load::default()).expect("a limb");
        let tubes = loaded.tubes_at_rest(4).expect("tubes of one length").tip();
        let off = (tubes.translation.vector - loaded.free_tip().translation.vector).norm();
        let rest: Vec<_> = limb.modules().iter().map(|module| module.actuator.rest()).collect();
        let motion = (tubes.translation.vector - limb.tip_pose(&rest).translation.vector).norm();
        let leans = limb.modules().iter().any(softlimb_limb::LimbModule::is_restrained);
        assert_eq!(leans, letter == "b");
        assert!(off < if leans { 5e-3 * motion } else { 1e-8 }, "{letter}: {off:e} of {motion}");
    }
}

#[test]
fn light_limb_needs_no_statics_and_a_heavy_one_does() {
    let (limb, length_m) = loaded("[0, 0, -1]", 1e-4, 0.0, 3, 0.0).expect("a limb");
    assert_eq!(cheapest(&limb, 0.01, length_m).expect("stable").tier, Fidelity::Kinematic);
    let (limb, length_m) = loaded("[0, 0, -1]", 1.0, 30e3, 3, 0.0).expect("a limb");
    let answer = cheapest_rod(&limb, 0.01, length_m).expect("a hanging limb is stable");
    assert!(answer.tier >= Fidelity::Constant, "{:?}", answer.tier);
    // The finest tier agrees within what the answer says of itself.
    let (_, shape) = by_fidelity(&limb.rod, Fidelity::Fourfold, None).expect("stable");
    let off = (shape.tip().translation.vector - answer.shape.tip().translation.vector).norm() / length_m;
    assert!(off <= 2.5 * answer.order_error + 1e-4, "{off} {}", answer.order_error);
}

/// The pull is along the axis and the strips of the elbow are beside it: they keep their length, and the limb bends to their side, in their plane.
#[test]
fn hanging_limb_stretches_and_bends_to_the_side_of_its_strips() {
    let (limb, length_m) = loaded("[0, 0, -1]", 1.0, 0.0, 3, 0.5).expect("a limb");
    let (_, shape) = by_fidelity(&limb.rod, Fidelity::Fourfold, None).expect("stable");
    let pressed = loaded("[0, 0, -1]", 1e-4, 20e3, 3, 0.0).expect("a limb").0.free_tip().translation.vector;
    let (tip, free) = (shape.tip().translation.vector, limb.free_tip().translation.vector);
    let (moved, bent) = ((tip - free).xy(), (pressed - free).xy());
    assert!(moved.dot(&bent) > 0.0 && moved.perp(&bent).abs() < 1e-9, "{moved} {bent}");
    assert!(tip.z < free.z - 1e-3 * length_m, "{tip}");
}

#[test]
fn hard_cases_are_answered_or_refused() {
    let pressures = [0.0, 97e3];
    let mut flagged = 0;
    for direction in ["[1, 0, 0]", "[0, 0, 1]", "[0, 0, -1]"] {
        for pressure_pa in pressures {
            for (bays, payload_kg) in [(1, 0.0), (3, 0.0), (3, 2.0), (6, 50.0)] {
                let (limb, length_m) = loaded(direction, 1.0, pressure_pa, bays, payload_kg).expect("a limb");
                match cheapest_rod(&limb, 0.01, length_m) {
                    Ok(rods) => {
                        let answer = cheapest(&limb, 0.01, length_m).expect("rods carry it");
                        // Tubes only where all of them stand.
                        let stands =
                            || answer.buckling.is_some_and(|tube| tube.ratio() < 1.0) && answer.load_factor() >= 1.0;
                        assert!(answer.tier != Fidelity::Tubes || stands());
                        let tip = answer.tip().translation.vector;
                        assert!(tip.iter().all(|x| x.is_finite()) && answer.error().is_finite());
                        flagged += usize::from(rods.error() > 0.01);
                    }
                    Err(_) => flagged += 1,
                }
            }
        }
    }
    assert!(flagged >= 6, "loads beyond what a limb of 2 kg carries are named: {flagged}");
    // An upright limb of 50 kg on slender bays falls.
    let (limb, length_m) = loaded("[0, 0, 1]", 1.0, 0.0, 1, 50.0).expect("a limb");
    assert!(cheapest(&limb, 0.01, length_m).is_err());
}

#[test]
fn wrong_counts_and_pressures_are_no_limb() {
    let (scene, limb) = scene("[1, 0, 0]", 1.0);
    let channels = limb.channels();
    let make = |pressures: &[f64], bays: &[usize]| LoadedLimb::new(&scene, &limb, pressures, bays, &Load::default());
    assert!(make(&vec![0.0; channels], &[1, 1, 1]).is_some());
    assert!(make(&vec![0.0; channels - 1], &[1, 1, 1]).is_none());
    assert!(make(&vec![0.0; channels], &[1, 1]).is_none());
    assert!(make(&vec![0.0; channels], &[1, 0, 1]).is_none());
    assert!(make(&vec![f64::NAN; channels], &[1, 1, 1]).is_none());
}

#[test]
fn plates_lie_in_the_plane_of_the_ends_of_unequal_tubes() {
    let (scene, limb) = scene("[0, 0, -1]", 1.0);
    let tube = Tangent::of(&limb.modules()[0].actuator, 30e3).expect("a tube");
    let places = [[0.03, 0.0], [-0.015, 0.026], [-0.015, -0.026]];
    let stretches = [1.10, 1.12, 1.07];
    let tubes = places.into_iter().zip(stretches).map(|(place, stretch)| (place, Tangent { stretch, ..tube }));
    let bundle = Bundle::of_tubes(*scene.modules()[0].motion, tubes.collect(), 0.08).expect("a bundle");
    // Without the tubes' own stiffness against bending, three ends and a plane through them.
    for ([x, y], stretch) in places.into_iter().zip(stretches) {
        let [ux, uy] = bundle.free.bend_rad_per_m.map(|bend| {
            let arms = places.iter().map(|[x, _]| x * x).sum::<f64>() * tube.axial_n;
            bend * (arms + 3.0 * tube.bending_nm2) / arms
        });
        assert!((bundle.free.stretch - ux * x - uy * y - stretch).abs() < 1e-4, "{:?}", bundle.free);
    }
}

/// Spacers count as many times as there are, in the scene and in the statics.
#[test]
fn statics_weigh_what_the_scene_weighs() {
    let path = format!("{}/../../scenes/loaded/carry-hanging.toml", env!("CARGO_MANIFEST_DIR"));
    let light = std::fs::read_to_string(path).expect("a scene");
    let heavy = light.replace("spacers = 3", "spacers = 3\nspacer_mass = \"40 g\"");
    let [light, heavy] = [light, heavy].map(|text| scene::parse(&text, "scene.toml").expect("a scene"));
    assert!((heavy.mass_kg() - light.mass_kg() - 6.0 * 0.04).abs() < 1e-12);
    let limb = Limb::new(&heavy).expect("a limb");
    let weighs = |bays: [usize; 3]| {
        let loaded = LoadedLimb::new(&heavy, &limb, &vec![20e3; limb.channels()], &bays, &Load::default());
        loaded.expect("a limb").rod.mass_kg()
    };
    assert!((weighs([2, 4, 4]) - heavy.mass_kg()).abs() < 1e-12);
    // Other plates than the scene's own weigh what they are.
    assert!((weighs([2, 6, 6]) - heavy.mass_kg() - 4.0 * 0.04).abs() < 1e-12);
}
