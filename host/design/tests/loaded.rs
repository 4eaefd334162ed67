//! Limbs designed under load: small tasks, judged by the statics of the product on the scene that is written.

use nalgebra::Vector3;
use softlimb_design::from_scene::{BriefError, loaded_design, loaded_text};
use softlimb_design::loaded::{
    Effort, Evaluation, Found, Judgement, Margin, REACHED_M, Refusal, active_bounds, evaluate, search, search_to_run,
    seeded,
};
use softlimb_limb::Limb;
use softlimb_limb::statics::{Fidelity, Load, LoadedLimb};
use softlimb_motion as motion;
use softlimb_scene::{self as scene, Scene};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Two modules that hang and lift a flask to one side.
const TASK: &str = r#"
format = 1
name = "hanging"
materials.silicone = { law = "neo-hookean", shear_modulus = "0.223 MPa" }
windings.hoops = { angle = "3 deg", families = 2, modulus = "361 MPa", thickness = "0.178 mm" }

[limb]
base_position = [0, 0, 1]
base_direction = [0, 0, -1]
base_up = [1, 0, 0]
connector = { length = "15 mm", mass = "100 g" }
end_effector = { length = "50 mm", mass = "100 g" }

[[module]]
name = "shoulder"
motion = "bending"
arrangement = "row"
spacing = "46 mm"
inner_radius = "14 mm"
outer_radius = "22 mm"
length = "190 mm"
material = "silicone"
bounds = { length = ["120 mm", "220 mm"] }

[[module]]
name = "wrist"
motion = "extension"
circle_radius = "50 mm"
inner_radius = "10 mm"
outer_radius = "15 mm"
length = "150 mm"
material = "silicone"
winding = "hoops"

[[object]]
name = "flask"
radius = "30 mm"
height = "100 mm"
grasp = "90 mm"
mass = "0.2 kg"

[[phase]]
name = "pick"
hold = "1 s"
gripper = "close"
object = "flask"
tip = [0.12, 0, 0.56]

[[phase]]
name = "lift"
hold = "1 s"
object = "flask"
tip = [0.16, 0, 0.58]

[limits]
pressure_max = "150 kPa"
clearance = "5 mm"

[weight]

[design]
inner_radius = ["8 mm", "18 mm"]
wall = ["4 mm", "10 mm"]
length = ["100 mm", "220 mm"]
circle_radius = ["30 mm", "60 mm"]
"#;

fn read(text: &str) -> Scene {
    scene::parse(text, "loaded.toml").unwrap_or_else(|error| panic!("{}\n{text}", error.render(false)))
}

fn effort() -> Effort {
    Effort { starts: 8, steps: 25, raises: 1, ..Effort::default() }
}

fn found(scene: &Scene) -> Found {
    let design = loaded_design(scene).unwrap();
    search(&design.task, &design.space, &design.space.first_guess(), &effort(), &|| false).unwrap()
}

#[test]
fn limits_are_those_of_the_scene() {
    let scene = read(&TASK.replace("[limits]", "[limits]\ntip_stiffness_min = \"55 N/m\"\nsag_max = \"30 %\""));
    let limits = loaded_design(&scene).unwrap().task.limits;
    assert_eq!((limits.load_factor, limits.stiffness_n_per_m, limits.sag_share), (1.5, 55.0, 0.3));
    assert_eq!((limits.buckling_margin, limits.pressure_share), (3.0, 0.85));
}

#[test]
fn a_limb_is_found_whose_scene_stands_where_the_task_wants_it() {
    stands_where_wanted(&read(TASK), [[0.12, 0.0, 0.56], [0.16, 0.0, 0.58]]);
}

/// Ends of 6 mm in each module, which the statics of the written scene know from its text.
#[test]
fn limb_with_ends_is_found_that_stands_where_the_task_wants_it() {
    let ends = "material = \"silicone\"\nend_length = \"6 mm\"";
    let wanted = read(&TASK.replace("material = \"silicone\"", ends));
    let designed = stands_where_wanted(&wanted, [[0.12, 0.0, 0.56], [0.16, 0.0, 0.58]]);
    for module in designed.modules() {
        assert!(module.end_length_m == 6e-3 && (0.1..=0.22).contains(&*module.length_m), "{:?}", *module.length_m);
    }
    let limb = Limb::new(&designed).unwrap();
    let plan = motion::plan(&designed, &limb).unwrap_or_else(|error| panic!("{}", error.render(false)));
    let margins = motion::margins(&designed, &limb, &plan, &motion::Sent::uncorrected(&limb, &plan)).unwrap();
    // One pressure a module in a plane: the planner's pressures are those of the design, and so are its margins.
    let stated = found(&wanted).confirmed;
    for (stated, planned) in stated.iter().zip(&margins) {
        for (a, b) in [(stated.sag_m, planned.sag_m), (stated.stiffness_n_per_m, planned.stiffness_n_per_m)] {
            assert!((a / b - 1.0).abs() < 0.02, "{stated:?} {planned:?}");
        }
    }
}

/// The search interpolates the laws of wound benders; the statics of the written scene have the law of its radii. Tubes with two windings are designed, too.
#[test]
fn limb_with_wound_benders_is_found_that_stands_where_the_task_wants_it() {
    let windings =
        "windings.steep = { angle = \"15 deg\", families = 2, modulus = \"361 MPa\", thickness = \"0.178 mm\" }
windings.soft = { angle = \"60 deg\", families = 2, modulus = \"0.5 MPa\", thickness = \"0.178 mm\" }
windings.hoops";
    let text = TASK.replace("windings.hoops", windings);
    let goals = [[0.12, 0.0, 0.56], [0.16, 0.0, 0.58]];
    let bender = "material = \"silicone\"\nbounds";
    for winding in ["\"steep\"", "[\"hoops\", \"soft\"]"] {
        let bender_wound = format!("material = \"silicone\"\nwinding = {winding}\nbounds");
        let designed = stands_where_wanted(&read(&text.replace(bender, &bender_wound)), goals);
        assert!(Limb::new(&designed).unwrap().modules()[0].bend().unwrap().is_by_section(), "{winding}");
    }
    let wound_twice = text.replace("winding = \"hoops\"", "winding = [\"hoops\", \"soft\"]");
    let designed = stands_where_wanted(&read(&wound_twice), goals);
    assert!(designed.modules()[1].second_fiber.is_some());
}

#[test]
fn lengths_that_ends_use_up_are_refused_at_their_bounds() {
    let ends = "material = \"silicone\"\nend_length = \"60 mm\"";
    let wanted = read(&TASK.replace("material = \"silicone\"", ends));
    let Err(BriefError::Scene(error)) = loaded_design(&wanted) else { panic!("no length is left") };
    let error = error.render(false);
    assert!(error.contains("the least `length` of `shoulder` must be more than `end_length` at both ends"), "{error}");
    assert!(error.contains("a length of 120.000 mm is allowed") && error.contains("take 120.000 mm of it"), "{error}");
}

/// A pressure for each actuator of the shoulder, one for the wrist: out of the plane, and the tip still has one way more than coordinates.
#[test]
fn a_limb_with_a_steering_module_is_found_that_stands_where_the_task_wants_it() {
    let bending = "motion = \"bending\"\narrangement = \"row\"\nspacing = \"46 mm\"";
    let steering = "motion = \"extension\"\nsteering = true\ncircle_radius = \"45 mm\"\nwinding = \"hoops\"";
    let text = TASK.replace(bending, steering);
    let text = text.replace("[0.12, 0, 0.56]", "[0.05, 0.03, 0.44]").replace("[0.16, 0, 0.58]", "[0.0, 0.07, 0.45]");
    assert!(text.contains("steering = true") && text.contains("0.07, 0.45"));
    let designed = stands_where_wanted(&read(&text), [[0.05, 0.03, 0.44], [0.0, 0.07, 0.45]]);
    assert!(designed.modules()[0].steering && !designed.modules()[1].steering);
}

/// Searches for the limb of a task and judges it by the statics of the scene that is written, which is given back.
fn stands_where_wanted(wanted: &Scene, goals: [[f64; 3]; 2]) -> Scene {
    let design = loaded_design(wanted).unwrap();
    let found = found(wanted);
    assert!(found.reached, "{:?}", found.evaluation.lacks);
    let poses = &found.confirmed;
    let designed = read(&loaded_text(wanted, &design, &found.evaluation).unwrap());
    let limb = Limb::new(&designed).unwrap();
    let bays: Vec<usize> = designed.modules().iter().map(|module| usize::from(module.spacers) + 1).collect();
    let payloads_kg = [0.0, 0.2];
    for (index, ((pose, goal), payload_kg)) in poses.iter().zip(goals).zip(payloads_kg).enumerate() {
        assert!(pose.lacks.is_empty() && pose.tip_error_m <= REACHED_M, "{pose:?}");
        // The statics of the written scene, built from its text, at the pressures that the design states.
        let channels = limb.channel_values(&pose.pressures_pa);
        let load = Load { payload_kg, ..Load::default() };
        let loaded = LoadedLimb::new(&designed, &limb, &channels, &bays, &load).unwrap();
        // Fine enough for tubes between plates: rods of a tolerance of 0.1 % are off by 0.2 mm.
        let standing = loaded.stand(1e-5, designed.rest_length_m()).unwrap();
        let off = standing.tip_m.iter().zip(goal).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        assert!(off <= 1.5e-4, "{off} {:?} {goal:?}", standing.tip_m);
        // The phase that takes an object states how the end effector points, and no other one does.
        let aims = designed.phases().iter().filter(|phase| phase.aim.is_some()).count();
        assert_eq!(aims, usize::from(!designed.objects().is_empty()));
        if let Some(aim) = &designed.phases()[index].aim {
            let rods = loaded.settle(Fidelity::Fourfold, None).unwrap();
            let axis = rods.shape.tip().rotation * Vector3::z();
            let off_rad = axis.angle(&Vector3::from(*aim.direction));
            // Four digits of the direction, and finer rods.
            assert!(off_rad < 0.01_f64.to_radians(), "{axis} {aim:?}");
        }
        assert!(standing.load_factor >= 1.5 && standing.buckling_margin >= 3.0);
        assert!(standing.sag_m <= 0.4 * designed.rest_length_m());
        assert!(standing.stiffness_n_per_m.unwrap()[2] >= 40.0);
        for (drive, pressure) in limb.drives().zip(&pose.pressures_pa) {
            assert!(*pressure <= (0.85 + 1e-6) * drive.ceiling_pa());
        }
    }
    designed
}

/// The planner chooses the place in a region, and pressures that need not be those of the design.
#[test]
fn limb_found_keeps_its_margins_as_the_planner_has_it() {
    let region = "[[region]]\nname = \"shelf\"\ncenter = [0.16, 0, 0.58]\nsize = [0.04, 0.04, 0.04]\n\n[limits]";
    let text = TASK.replace("tip = [0.16, 0, 0.58]", "inside = \"shelf\"").replace("[limits]", region);
    let wanted = read(&text);
    let design = loaded_design(&wanted).unwrap();
    let planned = |limb: &Evaluation| {
        let designed = read(&loaded_text(&wanted, &design, limb).unwrap());
        let limb = Limb::new(&designed).unwrap();
        let plan = motion::plan(&designed, &limb).unwrap_or_else(|error| panic!("{}", error.render(false)));
        (designed.rest_length_m(), motion::margins(&designed, &limb, &plan, &motion::Sent::uncorrected(&limb, &plan)))
    };
    let refused = |limb: &Evaluation| {
        let (length_m, margins) = planned(limb);
        let kept = margins.unwrap().iter().all(|margins| {
            margins.load_factor >= 1.5
                && margins.stiffness_n_per_m >= 40.0
                && margins.sag_m <= 0.4 * length_m
                && margins.buckling_margin >= 3.0
                && margins.pressure_share <= 0.85
        });
        (!kept).then(|| "a margin".to_owned())
    };
    let (task, space) = (&design.task, &design.space);
    let found = search_to_run(task, space, &space.first_guess(), &effort(), &refused, &|| false).unwrap();
    assert!(found.reached && found.refused.is_none(), "{:?}", planned(&found.evaluation).1);
}

/// The limb for a stiffer tip is as stiff as the scene demands by the statics of the scene that is written; that of the free scene is not.
#[test]
fn stiffness_of_the_tip_is_a_goal_of_the_scene() {
    let least = |text: &str| {
        let wanted = read(text);
        let design = loaded_design(&wanted).unwrap();
        let (task, space) = (&design.task, &design.space);
        let effort = Effort { raises: 0, ..effort() };
        let found = search(task, space, &space.first_guess(), &effort, &|| false).unwrap();
        assert!(found.reached, "{:?}", found.evaluation.lacks);
        let designed = read(&loaded_text(&wanted, &design, &found.evaluation).unwrap());
        let limb = Limb::new(&designed).unwrap();
        let plan = motion::plan(&designed, &limb).unwrap_or_else(|error| panic!("{}", error.render(false)));
        let margins = motion::margins(&designed, &limb, &plan, &motion::Sent::uncorrected(&limb, &plan)).unwrap();
        margins.iter().map(|margins| margins.stiffness_n_per_m).fold(f64::INFINITY, f64::min)
    };
    let free = least(TASK);
    let goal = (1.3 * free).ceil();
    let stiff = least(&TASK.replace("[limits]", &format!("[limits]\ntip_stiffness_min = \"{goal} N/m\"")));
    assert!(free >= 40.0 && stiff >= goal, "{free} {stiff} {goal}");
}

/// The mass by hand from the sizes of the written scene: walls at 1080 kg/m3, and 0.1 kg for each connector and the gripper.
#[test]
fn limb_is_no_heavier_than_the_scene_allows() {
    let found = |text: &str| {
        let wanted = read(text);
        let design = loaded_design(&wanted).unwrap();
        let effort = Effort { raises: 0, ..effort() };
        let found = search(&design.task, &design.space, &design.space.first_guess(), &effort, &|| false).unwrap();
        let designed = read(&loaded_text(&wanted, &design, &found.evaluation).unwrap());
        let walls_m3 = designed.modules().iter().map(|module| {
            let [inner, outer] = [*module.inner_radius_m, *module.outer_radius_m];
            3.0 * std::f64::consts::PI * (outer * outer - inner * inner) * *module.length_m
        });
        (
            found.reached,
            1080.0 * walls_m3.sum::<f64>() + 0.3 + designed.modules().iter().map(|m| m.spacers_mass_kg()).sum::<f64>(),
            found,
        )
    };
    let (reached, free_kg, _) = found(TASK);
    assert!(reached);
    let most_kg = 0.9 * free_kg;
    let with = |kg: f64| TASK.replace("[design]", &format!("[design]\nmass_max = \"{kg} kg\""));
    let (reached, light_kg, _) = found(&with(most_kg));
    assert!(reached && light_kg <= most_kg * (1.0 + 1e-9), "{free_kg} {light_kg} {most_kg}");
    // Connectors and gripper alone weigh 0.3 kg.
    let (reached, _, limb) = found(&with(0.31));
    assert!(!reached && limb.confirmed[0].lacks.contains(&Margin::Mass), "{:?}", limb.confirmed);
}

#[test]
fn answer_depends_on_the_seed_but_not_on_the_threads() {
    let design = loaded_design(&read(TASK)).unwrap();
    let of = |abreast| {
        let effort = Effort { abreast, raises: 0, ..effort() };
        search(&design.task, &design.space, &design.space.first_guess(), &effort, &|| false).unwrap()
    };
    assert_eq!(of(1).evaluation.sizes, of(3).evaluation.sizes);
}

/// The planner's refusals lead on to further starts, in their order for any number of threads, and end the search with the sixth.
#[test]
fn refused_limbs_lead_to_further_starts_up_to_the_sixth() {
    let design = loaded_design(&read(TASK)).unwrap();
    let (task, space) = (&design.task, &design.space);
    let of = |abreast, refusal: &Refusal<'_>| {
        let effort = Effort { abreast, raises: 0, starts: 40, ..effort() };
        search_to_run(task, space, &space.first_guess(), &effort, refusal, &|| false).unwrap()
    };
    let free = of(2, &|_| None);
    assert_eq!((free.reached, free.refused_before, &free.refused), (true, 0, &None));
    let first = free.evaluation.sizes;
    let but_first = |limb: &Evaluation| (limb.sizes == first).then(|| "not this one".to_owned());
    let (one, three) = (of(1, &but_first), of(3, &but_first));
    assert!(one.reached && one.refused.is_none() && one.evaluation.sizes != first);
    assert_eq!((one.refused_before, one.evaluation.sizes), (1, three.evaluation.sizes));
    let count = AtomicUsize::new(0);
    let none = |_: &Evaluation| {
        count.fetch_add(1, Ordering::Relaxed);
        Some("none".to_owned())
    };
    let refused = of(1, &none);
    assert_eq!((refused.reached, refused.refused.as_deref()), (true, Some("none")));
    assert_eq!((refused.evaluation.sizes, count.into_inner()), (first.clone(), 6));
    assert_eq!(of(3, &|_| Some("none".to_owned())).evaluation.sizes, first);
}

#[test]
fn carried_object_stays_upright_within_its_tilt() {
    let mut design = loaded_design(&read(TASK)).unwrap();
    assert_eq!(design.task.poses[1].carried.unwrap().tilt_max_rad, 35_f64.to_radians());
    let of = |design: &softlimb_design::from_scene::LoadedDesign| {
        search(&design.task, &design.space, &design.space.first_guess(), &effort(), &|| false).unwrap()
    };
    let free = of(&design);
    assert!(free.reached);
    // Half of the tilt that the free search takes: another limb, or the margin is named.
    let most_rad = 0.5 * free.confirmed[1].tilt_rad;
    assert!(most_rad > 0.0);
    design.task.poses[1].carried.as_mut().unwrap().tilt_max_rad = most_rad;
    let upright = of(&design);
    let tilts = upright.confirmed[1].tilt_rad > most_rad;
    assert_eq!(tilts, upright.confirmed[1].lacks.contains(&Margin::Tilt));
    assert!(!upright.reached || !tilts);
    assert!(upright.confirmed[1].tilt_rad < free.confirmed[1].tilt_rad);
}

#[test]
fn pressures_of_the_search_are_those_of_inverse_kinematics() {
    // One bender and one extension in a plane have one pair of pressures for a place: the search's are those that Newton's method on the tip finds.
    let design = loaded_design(&read(TASK)).unwrap();
    let found = found(&read(TASK));
    let by = Judgement { moves: false, ..found.by.clone() };
    let other = evaluate(&design.task, &design.space, &found.evaluation.sizes, &by).unwrap();
    for (own, other) in found.evaluation.poses.iter().zip(&other.poses) {
        for (a, b) in own.pressures_pa.iter().zip(&other.pressures_pa) {
            // The search leaves up to 0.03 mm of the way, which is some 0.1 % of a pressure.
            assert!((a - b).abs() < 150.0, "{:?} {:?}", own.pressures_pa, other.pressures_pa);
        }
    }
}

#[test]
fn a_task_out_of_reach_names_the_bound_that_forbids_it() {
    // The longest limb, with both modules straight, ends 0.22 + 0.22 + 0.03 + 0.05 m below its base, stretched by no more than a third of
    // the wrist: 0.35 m under the base are within reach, 0.7 m are not.
    let text = TASK.replace("tip = [0.16, 0, 0.58]", "tip = [0.05, 0, 0.30]");
    let wanted = read(&text);
    let design = loaded_design(&wanted).unwrap();
    let found = found(&wanted);
    assert!(!found.reached);
    assert!(found.evaluation.lacks.iter().any(|lack| lack.margin == Margin::Reach && lack.value.abs() > 0.1));
    let bounds = active_bounds(&design.task, &design.space, &found, &|| false);
    let length = bounds.iter().find(|bound| bound.name == "length").unwrap_or_else(|| panic!("{bounds:?}"));
    assert!(length.moved_to > length.bound && length.left < 0.9, "{length:?}");
}

#[test]
fn the_carried_object_keeps_clear_too() {
    // A post beside the way: the gripper passes it, the flask of 30 mm does not where it is held at 90 mm.
    let post = "\n[[obstacle]]\nname = \"post\"\nshape = \"sphere\"\ncenter = [0.205, 0, 0.52]\nradius = \"20 mm\"\n";
    let near = format!("{TASK}{post}");
    let with = loaded_design(&read(&near)).unwrap();
    let carried = with.task.poses[1].carried.unwrap();
    assert_eq!((carried.radius_m, carried.below_m), (0.03, 0.09));
    assert!(with.task.poses[0].carried.is_none(), "the flask is taken up at the end of the move");
    // The flask's axis is 45 mm from the post's centre at its height, which is less than 30 + 20 mm: no limb can have its tip there.
    let found = search(&with.task, &with.space, &with.space.first_guess(), &effort(), &|| false).unwrap();
    assert!(!found.reached);
    let spare_m = found.evaluation.poses[1].spare_m().unwrap().0;
    // As it hangs 10.2 mm are lacking; as it turns with the tip, it may be nearer.
    assert!(spare_m < 0.045 - 0.05 - 0.0052 + 2e-3, "{spare_m}");
    let gripper = near.replace("object = \"flask\"", "payload = \"0.2 kg\"");
    let without = loaded_design(&read(&gripper)).unwrap();
    assert!(without.task.poses.iter().all(|pose| pose.carried.is_none()));
}

#[test]
fn tasks_that_a_hidden_limb_does_are_solved_or_name_a_bound() {
    let design = loaded_design(&read(TASK)).unwrap();
    let mut solved = 0;
    for seed in 1..=3 {
        let task = seeded(&design.task, &design.space, seed).expect("a task").task;
        let effort = Effort { seed, starts: 16, raises: 0, ..effort() };
        let found = search(&task, &design.space, &design.space.first_guess(), &effort, &|| false).unwrap();
        if found.reached {
            let poses = &found.confirmed;
            assert!(poses.iter().all(|pose| pose.lacks.is_empty() && pose.tip_error_m <= REACHED_M), "{poses:?}");
            solved += 1;
        } else {
            let bounds = active_bounds(&task, &design.space, &found, &|| false);
            assert!(!bounds.is_empty(), "task {seed}: {:?}", found.evaluation.lacks);
        }
    }
    assert!(solved >= 2, "{solved} of 3");
}
