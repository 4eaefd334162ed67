//! Designs of limbs with segmented actuators. The tip of a hidden limb gives the way-points; the tip of the designed scene must reach them.

use softlimb_design::from_scene::{
    BriefError, design_to_run, loaded_design, loaded_text, redesigned_limb, redesigned_totals, task, totals,
};
use softlimb_design::loaded::{Effort, search};
use softlimb_design::synthesis::{Budget, design};
use softlimb_limb::Limb;
use softlimb_limb::statics::{Load, LoadedLimb};
use softlimb_motion as motion;
use softlimb_numerics::Random;
use softlimb_scene::{self as scene, Scene};

use crate::samples::samples;

/// An actuator that extends, twists and bends, and a bending wrist.
const SCENE: &str = r#"
format = 1
name = "series"
materials.silicone = { law = "neo-hookean", shear_modulus = "0.223 MPa" }

[windings.hoop]
angle = "3 deg"
families = 2
thread = { stiffness = "772 N", diameter = "0.178 mm" }

[windings.helix]
angle = "30 deg"
families = 1
thread = { stiffness = "772 N", diameter = "0.178 mm" }

[limb]
base_direction = [0, 0, -1]
base_up = [1, 0, 0]
connector = { length = "15 mm", mass = "20 g" }

[[module]]
name = "finger"
motion = "bending"
actuators = 1
inner_radius = "INNER"
outer_radius = "OUTER"
end_length = "4 mm"
material = "silicone"
bounds = { inner_radius = ["7 mm", "11 mm"], wall = ["3 mm", "5 mm"] }

[[module.segments]]
motion = "extension"
length = "EXTENDS"
winding = "hoop"
bounds = { length = ["50 mm", "120 mm"], fiber_angle = ["2 deg", "12 deg"] }

[[module.segments]]
motion = "twisting"
length = "80 mm"
winding = "helix"

[[module.segments]]
motion = "bending"
length = "BENDS"
bend_direction = "90 deg"
bounds = { length = ["80 mm", "180 mm"] }

[[module]]
name = "wrist"
motion = "bending"
actuators = 1
inner_radius = "10 mm"
outer_radius = "14 mm"
length = "150 mm"
material = "silicone"

[weight]
simulated = SIMULATED

[design]
mount_angle = "free"

[limits]
pressure_max = "80 kPa"
load_factor_min = 1
tip_stiffness_min = "1 N/m"
buckling_margin_min = 1
"#;

fn read(text: &str) -> Scene {
    scene::parse(text, "series.toml").unwrap_or_else(|error| panic!("{}\n{text}", error.render(false)))
}

/// The scene of sizes, m, with a phase for each tip.
fn text([inner, outer, extends, bends]: [f64; 4], tips_m: &[[f64; 3]], weight: bool) -> String {
    let mm = |value: f64| format!("{} mm", 1e3 * value);
    let sizes = [("INNER", inner), ("OUTER", outer), ("EXTENDS", extends), ("BENDS", bends)];
    let sized = sizes.iter().fold(SCENE.to_owned(), |text, (key, value)| text.replace(key, &mm(*value)));
    let phase =
        |(index, tip): (usize, &[f64; 3])| format!("[[phase]]\nname = \"p{index}\"\nhold = \"1 s\"\ntip = {tip:?}\n");
    let phases: String = tips_m.iter().enumerate().map(phase).collect();
    sized.replace("SIMULATED", &weight.to_string()) + &phases
}

const HIDDEN: [f64; 4] = [8.6e-3, 12.4e-3, 0.091, 0.142];
const STATED: [f64; 4] = [9e-3, 13e-3, 0.07, 0.12];
/// Pressures of finger and wrist, Pa.
const PRESSURES_PA: [[f64; 2]; 3] = [[25e3, 8e3], [40e3, 30e3], [52e3, 15e3]];

fn distance_m(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

fn tip_m(limb: &Limb, pressures_pa: &[f64]) -> [f64; 3] {
    let states: Vec<_> = limb.modules().iter().zip(pressures_pa).map(|(module, pa)| module.curve.at(*pa)).collect();
    limb.tip(&states)
}

#[test]
fn way_points_of_a_hidden_limb_are_reached_and_the_scene_can_be_run() {
    let hidden = Limb::new(&read(&text(HIDDEN, &[[0.0, 0.0, 0.1]], false))).unwrap();
    let tips_m = PRESSURES_PA.map(|pressures_pa| tip_m(&hidden, &pressures_pa));
    let wanted = read(&text(STATED, &tips_m, false));
    let tasked = task(&wanted).unwrap();
    assert_eq!(tasked.spaces.iter().map(|space| space.joined).collect::<Vec<_>>(), [false, true, true, false]);
    let designed =
        |limb: &_| read(&scene::redesigned(&wanted, &redesigned_limb(&wanted, &tasked, limb), None).unwrap());
    let plan = |limb: &_| {
        let scene = designed(limb);
        motion::plan(&scene, &Limb::new(&scene).unwrap()).ok().map(|_| 0)
    };
    let found = design_to_run(&tasked.task, &tasked.spaces, &Budget::default(), plan).unwrap();
    assert!(found.limb.does_it() && found.via_points.is_some(), "{:?}", found.limb.shortfall);
    let limb = Limb::new(&designed(&found.limb)).unwrap();
    for (answer, tip) in found.limb.way_points.iter().zip(tips_m) {
        let [finger @ .., wrist] = &answer.pressure_pa[..] else { panic!("{answer:?}") };
        assert!(finger.iter().all(|pressure| pressure == &finger[0]), "one chamber: {finger:?}");
        let off_m = distance_m(tip_m(&limb, &[finger[0], *wrist]), tip);
        assert!(off_m < 4e-8, "{off_m:e}");
    }
}

/// Hidden limbs have random sizes and pressures. A search with the default budget reaches all their tip positions.
#[test]
fn hidden_limbs_at_random_are_found() {
    let count = samples(60);
    let missed = (1..=u64::from(count)).filter(|seed| {
        let mut random = Random::new(*seed, 7);
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let inner_m = between(7.5e-3, 10.5e-3);
        let sizes = [inner_m, inner_m + between(3.2e-3, 4.8e-3), between(0.055, 0.115), between(0.085, 0.175)];
        let pressures_pa: Vec<[f64; 2]> = (0..3).map(|_| [between(5e3, 50e3), between(5e3, 40e3)]).collect();
        let hidden = Limb::new(&read(&text(sizes, &[[0.0, 0.0, 0.1]], false))).unwrap();
        let tips_m: Vec<[f64; 3]> = pressures_pa.iter().map(|pressures_pa| tip_m(&hidden, pressures_pa)).collect();
        let tasked = task(&read(&text(STATED, &tips_m, false))).unwrap();
        !design(&tasked.task, &tasked.spaces, &Budget::default()).unwrap().does_it()
    });
    let missed = missed.collect::<Vec<_>>();
    println!("{} of {count} missed: {missed:?}", missed.len());
    assert!(missed.is_empty(), "{missed:?}");
}

/// The tip under its own weight by the statics of a scene, m.
fn hanging_tip_m(scene: &Scene, limb: &Limb, pressures_pa: &[f64]) -> [f64; 3] {
    let bays = vec![1; limb.modules().len()];
    let loaded = LoadedLimb::new(scene, limb, pressures_pa, &bays, &Load::default()).unwrap();
    loaded.stand(1e-5, scene.rest_length_m()).unwrap().tip_m
}

#[test]
fn tips_of_a_hidden_limb_under_its_weight_are_reached() {
    let hidden = read(&text(HIDDEN, &[[0.0, 0.0, -0.3]], true));
    let limb = Limb::new(&hidden).unwrap();
    let tips_m = PRESSURES_PA.map(|pressures_pa| hanging_tip_m(&hidden, &limb, &pressures_pa));
    let wanted = read(&text(STATED, &tips_m, true));
    let limb_design = loaded_design(&wanted).unwrap();
    let (task, space) = (&limb_design.task, &limb_design.space);
    let effort = Effort { starts: 8, steps: 25, raises: 0, ..Effort::default() };
    let found = search(task, space, &space.first_guess(), &effort, &|| false).unwrap();
    assert!(found.reached, "{:?}", found.evaluation.lacks);
    let designed = read(&loaded_text(&wanted, &limb_design, &found.evaluation).unwrap());
    let limb = Limb::new(&designed).unwrap();
    for (pose, tip) in found.confirmed.iter().zip(tips_m) {
        assert_eq!(pose.pressures_pa.len(), 2, "one chamber for all segments");
        let off_m = distance_m(hanging_tip_m(&designed, &limb, &pose.pressures_pa), tip);
        assert!(off_m < 3e-5, "{off_m:e}");
    }
}

/// The targets are the total bend of the finger and the bend of the wrist. The designed scene reaches both at the stated pressures.
#[test]
fn totals_of_segments_are_reached_and_the_scene_can_be_run() {
    let targets = |finger: u8, wrist: u8| {
        format!(
            "targets = {{ finger = {{ bend_angle = \"{finger} deg\" }}, wrist = {{ bend_angle = \"{wrist} deg\" }} }}"
        )
    };
    let tips = [[0.0, 0.0, 0.1], [0.0, 0.0, 0.2]];
    let [first, second] = tips.map(|tip| format!("tip = {tip:?}"));
    let asked = text(STATED, &tips, false).replace(&first, &targets(70, 20)).replace(&second, &targets(35, 50));
    let wanted = read(&asked);
    let tasked = totals(&wanted).unwrap();
    let found = design(&tasked.task, &tasked.spaces, &Budget::default()).unwrap();
    assert!(found.does_it(), "{:?}", found.shortfall);
    let values = redesigned_totals(&wanted, &tasked, &found);
    let text = scene::redesigned(&wanted, &redesigned_limb(&wanted, &tasked, &found), Some(&values)).unwrap();
    let designed = read(&text);
    let limb = Limb::new(&designed).unwrap();
    motion::plan(&designed, &limb).unwrap_or_else(|error| panic!("{}", error.render(false)));
    for (answer, angles_deg) in found.way_points.iter().zip([[70.0_f64, 20.0], [35.0, 50.0]]) {
        let pressures_pa = [answer.pressure_pa[0], answer.pressure_pa[3]];
        for ((module, pressure_pa), angle_deg) in limb.modules().iter().zip(pressures_pa).zip(angles_deg) {
            let found_deg = module.curve.at(pressure_pa).bend_angle_rad.to_degrees();
            assert!((found_deg - angle_deg).abs() < 1e-4, "{found_deg} {angle_deg}");
        }
    }
    let line = asked.replace("[design]", "[design]\nshared_supply_line = true");
    let Err(BriefError::Scene(error)) = totals(&read(&line)) else { panic!("one line for a series and a module") };
    assert!(error.render(false).contains("one supply line of all modules takes modules of one"), "{error}");
}

#[test]
fn kinds_are_not_chosen_from_a_series() {
    let chosen = text(STATED, &[[0.0, 0.0, 0.1]], false).replace("[design]", "[design]\nmodules = [1, 2]");
    let Err(BriefError::Scene(error)) = task(&read(&chosen)) else { panic!("a series is no kind") };
    assert!(error.render(false).contains("`finger` has several segments, and a choice of motions"), "{error}");
}
