//! What puts the mass on the tip of a drawn limb off, one difference from the model at a time.
//!
//!     cargo run --release -p softlimb-lab --example weighing_limbs [LIMBS]
//!
//! Limbs that the plant draws hang by the statics at the setpoints, without noise, valves and creep. Each is taken with its mirror image, whose
//! parameters are off by as much to the other side: half the sum of both is what is no matter of chance.

use fra_model::{Actuator, ActuatorParameters, Load as NoLoad, Material};
use softlimb_limb::Limb;
use softlimb_limb::statics::{Bundle, Fidelity, GRAVITY_M_PER_S2, Load, LoadedLimb, Spring};
use softlimb_motion as motion;
use softlimb_motion::Plan;
use softlimb_rig::payload_estimation::{Observation, mass};
use softlimb_rig::simulate;
use softlimb_scene as scene;
use softlimb_scene::Scene;
use softlimb_sim::plant::Plant;

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/loaded/carry-hanging.toml");
const LOAD_N: f64 = 10.0;
const LIMBS: u64 = 200;

/// What of a limb differs from the model.
#[derive(Clone, Copy)]
struct Case {
    name: &'static str,
    /// Spreads as the scene says them; the defaults for `None`.
    spread: Option<&'static str>,
    module: Option<usize>,
    shape: bool,
    springs: bool,
}

const ALL: Case = Case { name: "all", spread: None, module: None, shape: true, springs: true };
const CASES: [Case; 10] = [
    Case { name: "nothing", shape: false, springs: false, ..ALL },
    ALL,
    Case { name: "moduli alone", spread: Some("wall = 0\nfiber_angle = 0"), ..ALL },
    Case { name: "walls alone", spread: Some("modulus = 0\nfiber_angle = 0"), ..ALL },
    Case { name: "angles alone", spread: Some("modulus = 0\nwall = 0"), ..ALL },
    Case { name: "the shape without load alone", springs: false, ..ALL },
    Case { name: "the springs alone", shape: false, ..ALL },
    Case { name: "the shoulder alone", module: Some(0), ..ALL },
    Case { name: "the elbow alone", module: Some(1), ..ALL },
    Case { name: "the wrist alone", module: Some(2), ..ALL },
];

/// Off to the other side by as much.
fn mirrored(truth: &ActuatorParameters<f64>, nominal: &ActuatorParameters<f64>) -> ActuatorParameters<f64> {
    let other = |truth: f64, nominal: f64| 2.0 * nominal - truth;
    let mut mirrored = *truth;
    mirrored.outer_radius_m = other(truth.outer_radius_m, nominal.outer_radius_m);
    if let (Material::NeoHookean { shear_modulus_pa: truth }, Material::NeoHookean { shear_modulus_pa: nominal }) =
        (truth.material, nominal.material)
    {
        mirrored.material = Material::NeoHookean { shear_modulus_pa: other(truth, nominal) };
    }
    if let (Some(mirrored), Some(nominal)) = (&mut mirrored.fiber, nominal.fiber) {
        mirrored.angle_rad = other(mirrored.angle_rad, nominal.angle_rad);
        mirrored.radius_m = other(mirrored.radius_m, nominal.radius_m);
    }
    mirrored
}

/// The tip of a limb of these actuators, one a channel, at the ends of all phases without and with the load.
fn seen(scene: &Scene, limb: &Limb, plan: &Plan, actuators: &[Actuator<f64>], case: &Case) -> Vec<Observation> {
    let mut seen = Vec::new();
    for (phase, planned) in plan.phases.iter().enumerate() {
        let end_us = (planned.start_us + planned.move_us + planned.hold_us) as f64;
        let pressures_pa: Vec<f64> = plan.states_at(end_us).iter().map(|state| state.pressure_pa).collect();
        let bundle = |index: usize| {
            let (module, pressure_pa) = (&limb.modules()[index], pressures_pa[index]);
            let positions_m = module.positions_m();
            let tubes = module.channels.clone().enumerate().map(|(place, channel)| {
                let own = case.module.is_none_or(|only| only == index);
                let pick = |own| if own { &actuators[channel] } else { &module.actuator };
                let spring = Spring::new(pick(own && case.springs), pressure_pa)?;
                let shape = pick(own && case.shape).forward(pressure_pa, &NoLoad::none()).ok()?.state;
                Some((positions_m[place], spring.about(&shape)))
            });
            let bays = f64::from(scene.modules()[index].spacers + 1);
            Bundle::of_springs(module.motion, tubes.collect::<Option<_>>()?, module.length_m() / bays)
        };
        let bundles: Vec<Bundle> =
            (0..limb.modules().len()).map(|index| bundle(index).expect("an equilibrium")).collect();
        let walls_kg: Vec<f64> = scene.modules().iter().map(scene::Module::mass_kg).collect();
        for loaded in [false, true] {
            let load = Load { payload_kg: if loaded { LOAD_N / GRAVITY_M_PER_S2 } else { 0.0 }, ..Load::default() };
            let hung = LoadedLimb::of_bundles(scene, limb, bundles.clone(), &walls_kg, &load);
            let tip_m = hung.settle(Fidelity::Fourfold, None).expect("stands").shape.tip().translation.vector;
            let pressures_pa = pressures_pa.clone();
            seen.push(Observation { line: 0, phase, loaded, tip_m, accuracy_m: 1e-3, pressures_pa });
        }
    }
    seen
}

/// How far the mass is off, percent: of a drawn limb, and the mean with its mirror image.
fn off(scene: &Scene, limb: &Limb, plan: &Plan, seed: u64, case: &Case) -> [f64; 2] {
    let plant = Plant::new(&simulate::settings(scene, limb, seed).plant).expect("a plant");
    let truth: Vec<_> = plant.truth().channels.iter().map(|channel| channel.parameters.actuator).collect();
    let nominal: Vec<_> =
        limb.modules().iter().flat_map(|one| one.channels.clone().map(|_| *one.actuator.parameters())).collect();
    let other: Vec<_> = truth.iter().zip(&nominal).map(|(truth, nominal)| mirrored(truth, nominal)).collect();
    let [own, other] = [truth, other].map(|parameters| {
        let actuators: Vec<_> = parameters.iter().map(|one| Actuator::new(one).expect("an actuator")).collect();
        let found = mass(scene, limb, plan, &seen(scene, limb, plan, &actuators, case), 0.0).expect("a mass");
        100.0 * (found.kg * GRAVITY_M_PER_S2 / LOAD_N - 1.0)
    });
    [own, 0.5 * (own + other)]
}

/// Mean, its standard error and the standard deviation.
fn statistics(values: &[f64]) -> [f64; 3] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    [mean, deviation / count.sqrt(), deviation]
}

fn main() {
    let limbs = std::env::args().nth(1).map_or(LIMBS, |count| count.parse().expect("a number of limbs"));
    let text = std::fs::read_to_string(SCENE).expect("the scene");
    println!("{limbs} limbs; mass off, %      standard deviation            mean           mean with mirror images");
    for case in CASES {
        let spread = case.spread.unwrap_or_default();
        let scene = format!("{text}\n[plant.chamber]\ncreep_share = 0\n[plant.spread]\n{spread}\n");
        let scene = scene::parse(&scene, SCENE).unwrap_or_else(|error| panic!("{error}")).carrying(0.0, true);
        let limb = Limb::new(&scene).expect("a limb");
        let plan = motion::plan(&scene, &limb).expect("a plan");
        let (own, even): (Vec<f64>, Vec<f64>) =
            (1..=limbs).map(|seed| off(&scene, &limb, &plan, seed, &case)).map(|[own, even]| (own, even)).unzip();
        let ([mean, error, deviation], [even, even_error, _]) = (statistics(&own), statistics(&even));
        println!(
            "{:28} {deviation:10.2}       {mean:+10.2} +- {error:.2}       {even:+10.3} +- {even_error:.3}",
            case.name
        );
    }
}
