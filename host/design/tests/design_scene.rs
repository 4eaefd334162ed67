//! Designs of scenes: what is found is a scene again, which can be planned and does what was asked.

use softlimb_design::actuators as fit;
use softlimb_design::from_scene::{design_to_run, leads_the_tip, redesigned_limb, redesigned_targets, targets, task};
use softlimb_design::synthesis as path;
use softlimb_limb::Limb;
use softlimb_motion as motion;
use softlimb_scene as scene;
use softlimb_scene::{Goal, Scene};

fn read(text: &str) -> Scene {
    scene::parse(text, "designed.toml").unwrap_or_else(|error| panic!("{}\n{text}", error.render(false)))
}

/// Bounds that leave everything open that a workshop can change.
const OPEN: &str = "
[design]
inner_radius = [\"8 mm\", \"12 mm\"]
wall = [\"3.5 mm\", \"5 mm\"]
length = [\"150 mm\", \"320 mm\"]
fiber_angle = [\"2 deg\", \"10 deg\"]
";

/// A scene whose modules all have ends of this length.
fn with_ends_of(text: &str, millimetres: u8) -> String {
    let text = text.replace("\nactuators = ", &format!("\nend_length = \"{millimetres} mm\"\nactuators = "));
    assert_eq!(read(&text).modules()[0].end_length_m, 1e-3 * f64::from(millimetres));
    text
}

#[test]
fn targets_are_reached_by_other_sizes_and_the_scene_can_be_run() {
    targets_are_reached(&format!("{}{OPEN}", include_str!("../../../scenes/weightless-a.toml")));
}

#[test]
fn targets_are_reached_by_the_part_between_the_ends() {
    let text = with_ends_of(include_str!("../../../scenes/weightless-a.toml"), 4);
    targets_are_reached(&format!("{text}{OPEN}"));
}

fn targets_are_reached(text: &str) {
    let wanted = read(text);
    assert!(!leads_the_tip(&wanted));
    let problem = targets(&wanted).unwrap_or_else(|error| panic!("{}", error.render(false)));
    let answer = fit::solve(&problem, &fit::Budget::default()).unwrap();
    assert!(answer.objective < 1e-12, "{}", answer.objective);
    let (modules, values) = redesigned_targets(&wanted, &answer);
    let designed = read(&scene::redesigned(&wanted, &modules, Some(&values)).unwrap());
    let limb = Limb::new(&designed).unwrap();
    motion::plan(&designed, &limb).unwrap_or_else(|error| panic!("{}", error.render(false)));
    // Lengths and angles of the first phase: those that the author's scene has.
    let [before, after] = [&wanted, &designed].map(|scene| {
        let Goal::Targets(targets) = &scene.phases()[0].goal else { panic!("targets") };
        let in_space = |target: &scene::Target| match *scene.modules()[target.module].motion {
            fra_model::Motion::Extension => target.value.value * scene.modules()[target.module].moving_length_m(),
            _ => target.value.value,
        };
        targets.iter().map(in_space).collect::<Vec<_>>()
    });
    for (before, after) in before.iter().zip(&after) {
        assert!((before - after).abs() < 1e-8, "{before:?} {after:?}");
    }
    assert_ne!(*wanted.modules()[0].length_m, *designed.modules()[0].length_m);
}

/// Designs a group's limb and checks the plan of its scene by dense samples of what is streamed, with the thickness of the body about
/// each: bundles, then the tool about the tip.
fn designed_keeps_clear(text: &str) {
    let wanted = read(text);
    assert!(leads_the_tip(&wanted));
    let tasked = task(&wanted).unwrap();
    let found = path::design(&tasked.task, &tasked.spaces, &path::Budget::default()).unwrap();
    assert!(found.does_it(), "{:?}", found.shortfall);
    let designed = read(&scene::redesigned(&wanted, &redesigned_limb(&wanted, &tasked, &found), None).unwrap());
    let limb = Limb::new(&designed).unwrap();
    // The written scene has its tip where the design says, at the pressures that it states.
    for answer in &found.way_points {
        let modules = limb.modules().iter().zip(&answer.pressure_pa);
        let states: Vec<_> = modules.map(|(module, pressure_pa)| module.curve.at(*pressure_pa)).collect();
        let off_m = (nalgebra::Vector3::from(limb.tip(&states)) - nalgebra::Vector3::from(answer.tip_m)).norm();
        assert!(off_m < 1e-6, "{off_m} {answer:?}");
    }
    let plan = motion::plan(&designed, &limb).unwrap_or_else(|error| panic!("{}", error.render(false)));
    let mut nearest_m = vec![f64::INFINITY; designed.phases().len()];
    for step in 0..=2000 {
        let states = plan.states_at(plan.duration_us() as f64 * f64::from(step) / 2000.0);
        let points = limb.backbone(&states);
        let per_module = (points.len() - 1) / states.len();
        for (index, point) in points.iter().enumerate() {
            let module = (index.saturating_sub(1) / per_module).min(states.len() - 1);
            let last = index + 1 == points.len();
            let thick_m =
                if last { 0.035 } else { designed.modules()[module].reach_m() + states[module].outer_radius_m };
            for obstacle in designed.obstacles() {
                let spare = obstacle.shape.distance(&(*point).into()).distance_m - thick_m;
                // What is asked is 5 mm.
                assert!(spare >= 5e-3 - 1e-6, "{} at {point:?}: {spare}", *obstacle.name);
            }
        }
        let tip = (*points.last().unwrap()).into();
        for (phase, nearest_m) in designed.phases().iter().zip(&mut nearest_m) {
            *nearest_m = nearest_m.min(off_goal(&designed, &phase.goal, tip));
        }
    }
    // The holds are long enough for samples to fall into each of them.
    assert!(nearest_m.iter().all(|m| *m < 1e-4), "{nearest_m:?}");
}

/// Two way-points on both sides of two posts: no limb of these sizes goes straight from rest to the one and on to the other.
#[test]
fn moves_that_cannot_be_straight_are_left_to_the_planner() {
    let text = include_str!("../../../scenes/reach-past-post.toml");
    let post = |name: &str, y: f64| {
        format!(
            "[[obstacle]]\nname = \"{name}\"\nshape = \"capsule\"\nfrom = [0.72, {y}, 0.4]\nto = [0.72, {y}, 1.6]\nradius = \"15 mm\"\n"
        )
    };
    let phase = |name: &str, tip: &str| format!("[[phase]]\nname = \"{name}\"\nhold = \"0.2 s\"\ntip = {tip}\n");
    let wanted = read(&format!(
        "{}{}{}{}{}{}\n[design]\ninner_radius = [\"9 mm\", \"11 mm\"]\nwall = [\"3.5 mm\", \"4.5 mm\"]\nlength = [\"220 mm\", \"260 mm\"]\n",
        &text[..text.find("[[obstacle]]").unwrap()],
        post("left", 0.075),
        post("right", -0.075),
        phase("between", "[0.8, 0.0, 1.02]"),
        phase("aside", "[0.66, -0.25, 0.9]"),
        &text[text.find("[limits]").unwrap()..],
    ));
    let tasked = task(&wanted).unwrap();
    let designed = |found: &path::Candidate| {
        read(&scene::redesigned(&wanted, &redesigned_limb(&wanted, &tasked, found), None).unwrap())
    };
    let planned = |found: &path::Candidate| {
        let scene = designed(found);
        motion::plan(&scene, &Limb::new(&scene).unwrap()).ok()
    };
    let via_points = |found: &path::Candidate| Some(planned(found)?.phases.iter().map(|phase| phase.via_points).sum());
    let found = design_to_run(&tasked.task, &tasked.spaces, &path::Budget::default(), via_points).unwrap();
    assert!(found.limb.does_it() && found.via_points.is_some_and(|count| count > 0), "{found:?}");
    let (scene, plan) = (designed(&found.limb), planned(&found.limb).unwrap());
    let limb = Limb::new(&scene).unwrap();
    for step in 0..=2000 {
        let states = plan.states_at(plan.duration_us() as f64 * f64::from(step) / 2000.0);
        for point in limb.backbone(&states) {
            let nearest = scene.obstacles().iter().map(|post| post.shape.distance(&point.into()).distance_m);
            // The tool is a ball of 20 mm, all else is thicker; 5 mm are asked for.
            assert!(nearest.fold(f64::INFINITY, f64::min) >= 25e-3 - 1e-6, "{point:?}");
        }
    }
    // A planner that refuses everything leaves the answer of the search for straight moves.
    let refused = design_to_run(&tasked.task, &tasked.spaces, &path::Budget::default(), |_| None).unwrap();
    assert!(!refused.limb.does_it() && refused.via_points.is_none() && refused.refused > 0);
}

/// How far a tip is from what a phase asks of it, m.
fn off_goal(scene: &Scene, goal: &Goal, tip: nalgebra::Vector3<f64>) -> f64 {
    match goal {
        Goal::Tip(target) => (tip - nalgebra::Vector3::from(target.value)).norm(),
        Goal::Inside(region) => scene.regions()[region.value].shape.distance(&tip).distance_m.max(0.0),
        _ => panic!("a group leads the tip"),
    }
}

#[test]
fn group_a_is_designed_and_keeps_clear() {
    designed_keeps_clear(include_str!("../../../scenes/open/group-a.toml"));
}

#[test]
fn limb_with_ends_is_designed_and_keeps_clear() {
    designed_keeps_clear(&with_ends_of(include_str!("../../../scenes/open/group-a.toml"), 8));
}

#[test]
fn group_b_is_designed_and_keeps_clear() {
    designed_keeps_clear(include_str!("../../../scenes/open/group-b.toml"));
}

#[test]
fn group_c_is_designed_and_keeps_clear() {
    designed_keeps_clear(include_str!("../../../scenes/open/group-c.toml"));
}

#[test]
fn entries_beyond_a_design_are_shown_at_their_line() {
    let text = include_str!("../../../scenes/weightless-a.toml")
        .replace("circle_radius = \"30 mm\"", "circle_radius = \"17 mm\"");
    let wide = read(&format!("{text}{OPEN}"));
    let error = targets(&wide).unwrap_err().render(false);
    assert!(error.contains("may overlap") && error.contains("wall = "), "{error}");
    let mixed = include_str!("../../../scenes/open/group-a.toml")
        .replace("tip = [0.74, 0, 0.83]", "targets = { elbow = { bend_angle = \"30 deg\" } }");
    let error = task(&read(&mixed)).unwrap_err().to_string();
    assert!(error.contains("either for the tip or for targets"), "{error}");
    let steering = include_str!("../../../scenes/weightless-a.toml").replacen(
        "motion = \"extension\"",
        "motion = \"extension\"\nsteering = true",
        1,
    );
    let error = targets(&read(&format!("{steering}{OPEN}"))).unwrap_err().render(false);
    assert!(error.contains("a steering module is designed under weight") && error.contains("[[module]]"), "{error}");
}

/// A module with two windings, its motion and target, and open sizes.
fn wound_twice(motion: &str, windings: [&str; 2], target: &str) -> Scene {
    let [first, second] = windings;
    read(&format!(
        r#"
format = 1
name = "wound"
weight = {{ simulated = false, compensated = false }}
materials.silicone = {{ law = "neo-hookean", shear_modulus = "0.2 MPa" }}
limb.connector = {{ length = 0, mass = 0 }}

[windings.first]
{first}
thickness = "0.1 mm"
[windings.second]
{second}
thickness = "0.1 mm"

[[module]]
name = "rod"
motion = "{motion}"
actuators = 1
inner_radius = "6 mm"
outer_radius = "9 mm"
length = "150 mm"
material = "silicone"
winding = ["first", "second"]
pressure_max = "80 kPa"

[[phase]]
name = "move"
targets = {{ rod = {{ {target} }} }}

[design]
inner_radius = ["6 mm", "10 mm"]
wall = ["2 mm", "4 mm"]
length = ["100 mm", "250 mm"]
fiber_angle = ["15 deg", "40 deg"]
"#
    ))
}

/// Straight and bending modules with a second winding that keeps its angle: finite elements of the designed module have what was asked at the
/// pressure found, and the planner takes that pressure.
#[test]
fn modules_with_two_windings_are_designed() {
    use fra_model::{ActuatorParameters, Fiber, Motion};
    use softlimb_fea::cross_section::{EndLoad, Options, Section};
    let soft = "angle = \"3 deg\"\nfamilies = 2\nmodulus = \"10 MPa\"";
    let helix = "angle = \"40 deg\"\nfamilies = 1\nmodulus = \"2 MPa\"";
    let steep = "angle = \"30 deg\"\nfamilies = 1\nmodulus = \"200 MPa\"";
    let axial = "angle = \"90 deg\"\nfamilies = 1\nmodulus = \"200 MPa\"";
    for (motion, windings, target, wanted) in [
        ("bending", [soft, helix], "bend_angle = \"75 deg\"", 75f64.to_radians()),
        ("twisting", [steep, axial], "twist = -1.9", -1.9),
    ] {
        let scene = wound_twice(motion, windings, target);
        let problem = targets(&scene).unwrap_or_else(|error| panic!("{}", error.render(false)));
        let answer = fit::solve(&problem, &fit::Budget::default()).unwrap();
        assert_eq!(answer.status, "reached", "{answer:?}");
        let (modules, values) = redesigned_targets(&scene, &answer);
        let designed = read(&scene::redesigned(&scene, &modules, Some(&values)).unwrap());
        let module = &designed.modules()[0];
        let second = module.second_fiber.expect("kept");
        let own = scene.modules()[0].second_fiber.expect("stated");
        assert_eq!((second.angle_rad, second.modulus_pa), (own.angle_rad, own.modulus_pa));
        assert_eq!(second.radius_m, *module.outer_radius_m);
        let pressure_pa = answer.segments[0].phases[0].pressure_pa;
        let section = Section::with_two_windings(&module.actuator(), &second, &Options::default()).unwrap();
        let curve = section.curve(&[pressure_pa], &EndLoad::default()).unwrap();
        let state = curve.answers[0].equilibrium().unwrap().state.over(*module.length_m);
        let found = if *module.motion == Motion::Bending { state.bend_angle_rad } else { state.twist_rad };
        assert!((found / wanted - 1.0).abs() < 1e-4, "{motion}: {found} {wanted}");
        let (first, bend) = (module.fiber.expect("wound"), answer.segments[0].bend);
        let angles_deg = [first.angle_rad, second.angle_rad].map(f64::to_degrees);
        let differ = answer.segments[0].windings_deg.iter().zip(angles_deg).map(|(found, own)| (found - own).abs());
        assert!(differ.fold(0.0, f64::max) < 1e-9 && answer.segments[0].windings_deg.len() == 2, "{angles_deg:?}");
        let stated = bend.and_then(|bend| bend.winding_2deg);
        assert_eq!(stated.is_some(), motion == "bending");
        if let Some(stated) = stated {
            let changes = [-2f64, 2.0].map(|off_deg| {
                let turned = |fiber: Fiber<f64>| Fiber { angle_rad: fiber.angle_rad + off_deg.to_radians(), ..fiber };
                let wound = ActuatorParameters { fiber: Some(turned(*first)), ..module.actuator() };
                let section = Section::with_two_windings(&wound, &turned(*second), &Options::default()).unwrap();
                let curve = section.curve(&[pressure_pa], &EndLoad::default()).unwrap();
                let rates = curve.answers[0].equilibrium().unwrap().state.bend_rates_rad_per_m;
                (rates[0] * *module.length_m / wanted - 1.0).abs()
            });
            let most = changes[0].max(changes[1]);
            assert!((stated / most - 1.0).abs() < 1e-2, "{stated} {changes:?}");
        }
        let limb = Limb::new(&designed).unwrap();
        let plan = motion::plan(&designed, &limb).unwrap_or_else(|error| panic!("{}", error.render(false)));
        let states = plan.states_at(plan.duration_us() as f64);
        assert!((states[0].pressure_pa / pressure_pa - 1.0).abs() < 1e-5, "{motion}: {states:?} {pressure_pa}");
    }
}
