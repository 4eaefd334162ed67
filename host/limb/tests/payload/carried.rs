//! The largest payload by the statics: a hanging tube in closed form, and the scenes, whose plans carry what they carry.

use std::path::Path;

use softlimb_limb::Limb;
use softlimb_limb::payload::{CarryLimit, CarryLimits, carried_load};
use softlimb_limb::statics::{Fidelity, GRAVITY_M_PER_S2, Load, LoadedLimb};
use softlimb_motion as motion;
use softlimb_scene as scene;

const LIMITS: CarryLimits =
    CarryLimits { error: 0.01, load_factor_min: 1.5, buckling_margin_min: 3.0, pressure_share_max: 0.85 };

/// Three tubes that hang straight down.
const HANGING: &str = r#"
format = 1
name = "hanging"
seed = 1

[materials.soft]
law = "neo-hookean"
shear_modulus = "0.223 MPa"
density = "1080 kg/m3"

[windings.hoop-like]
angle = "3 deg"
families = 2
modulus = "361 MPa"
thickness = "0.178 mm"

[limb]
base_direction = [0, 0, -1]
base_up = [1, 0, 0]
connector = { length = "15 mm", mass = "50 g" }

[[module]]
name = "muscle"
motion = "extension"
actuators = 3
circle_radius = "30 mm"
inner_radius = "10 mm"
outer_radius = "14 mm"
length = "120 mm"
material = "soft"
winding = "hoop-like"
spacers = 3

[weight]

[[phase]]
name = "on"
duration = "2 s"
hold = "1 s"
targets = { muscle = { pressure = "30 kPa" } }
"#;

/// A pulled tube keeps its length while its pressure falls, until there is none left: the wall alone then carries all that hangs from it.
#[test]
fn hanging_tubes_carry_what_their_walls_hold_at_no_pressure() {
    let scene = scene::parse(HANGING, "hanging.toml").unwrap_or_else(|error| panic!("{error}"));
    let limb = Limb::new(&scene).expect("a limb");
    let found = carried_load(&scene, &limb, (&[30e3], 0.0), &LIMITS).expect("it hangs");
    assert_eq!((found.limit, found.keeps), (Some(CarryLimit::Reach), true));
    let module = &limb.modules()[0];
    // Half of the walls hang from the middle of the tubes.
    let hangs_kg = 0.5 * scene.modules()[0].mass_kg() + 0.05;
    let force_n = hangs_kg * GRAVITY_M_PER_S2 / 3.0;
    let state = module.actuator.forward(30e3, &fra_model::Load { force_n, torque_nm: 0.0 }).expect("finite").state;
    let walls_n = 3.0 * module.actuator.blocked(0.0, state.axial_stretch, 0.0).expect("finite").force_n;
    let expected_kg = walls_n / GRAVITY_M_PER_S2 - hangs_kg;
    println!("{} kg, {expected_kg} kg by the walls", found.payload_kg);
    assert!((found.payload_kg - expected_kg).abs() < 0.01 * expected_kg, "{} {expected_kg}", found.payload_kg);
    assert!(found.pressures_pa[0] < 0.01 * 30e3, "{:?}", found.pressures_pa);
}

/// No scene whose plan keeps the margins is said to carry less than it does.
#[test]
fn scenes_carry_what_their_plans_carry() {
    for name in ["pick-and-place-a", "pick-and-place-c", "steering"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenes/{name}.toml"));
        let scene = scene::load(&path).unwrap_or_else(|error| panic!("{error}"));
        let limb = Limb::new(&scene).expect("a limb");
        let plan = motion::plan(&scene, &limb).unwrap_or_else(|error| panic!("{error}"));
        let error = scene.weight().expect("weight").error;
        for (phase, carried) in plan.phases.iter().zip(motion::carried(scene.phases())) {
            // What is put down is carried until the end of the move.
            let hold_us = if carried.moved.payload_kg > carried.held.payload_kg { 0 } else { phase.hold_us };
            let states = plan.states_at((phase.start_us + phase.move_us + hold_us) as f64);
            let pressures: Vec<f64> = states.iter().map(|state| state.pressure_pa.max(0.0)).collect();
            let planned_kg = carried.payload_kg();
            let found = carried_load(&scene, &limb, (&pressures, planned_kg), &CarryLimits { error, ..LIMITS })
                .unwrap_or_else(|limit| panic!("{name} {}: {limit:?}", phase.name));
            println!("{name} {}: {planned_kg} kg planned, {:.3} kg, {:?}", phase.name, found.payload_kg, found.limit);
            assert!(found.keeps && found.payload_kg >= planned_kg, "{name} {}: {found:?}", phase.name);
            // With it the tip is where it was, and the margins are the statics' own.
            let at = |pressures: &[f64], payload_kg: f64| {
                let all = limb.channel_values(pressures);
                let bays: Vec<usize> = limb.modules().iter().map(softlimb_limb::LimbModule::bays).collect();
                let load = Load { payload_kg, ..Load::default() };
                LoadedLimb::new(&scene, &limb, &all, &bays, &load).expect("in range")
            };
            let tip = |loaded: &LoadedLimb| {
                let settled = loaded.settle(Fidelity::Linear, None).expect("it stands");
                settled.shape.tip().translation.vector
            };
            let (before, with) = (at(&pressures, planned_kg), at(&found.pressures_pa, found.payload_kg));
            let moved = (tip(&before) - tip(&with)).norm();
            assert!(moved < 1e-4, "{name} {}: {moved}", phase.name);
            let mut shares = limb.drives().zip(&found.pressures_pa).map(|(drive, pa)| pa / drive.ceiling_pa());
            assert!(shares.all(|share| share < 0.85 + 1e-6), "{name} {}", phase.name);
            // Six pressures hold three coordinates: where one is at its margin, the others make up for it.
            assert!(name != "steering" || found.payload_kg > 1.0, "{}: {} kg", phase.name, found.payload_kg);
            let with = with.stand(error, scene.rest_length_m()).expect("it stands");
            assert!(with.load_factor >= 1.5 && with.buckling_margin >= 3.0);
        }
    }
}
