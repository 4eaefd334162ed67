//! What scenes may say about tasks and designs, and what they are told when it is wrong.

use fra_model::Motion;
use softlimb_scene as scene;
use softlimb_scene::Gripper;

use super::common::{repository, with_phases};

const PHASE: &str = "[[phase]]\nname = \"p\"\ntip = [0.7, 0, 0.9]\n";

fn wrong(tables: &str) -> String {
    let text = with_phases("weightless-a", tables);
    scene::parse(&text, "task.toml").map_or_else(|error| error.render(false), |_| panic!("accepted:\n{text}"))
}

#[test]
fn obstacles_and_phases_are_read() {
    let scene = repository("reach-past-post");
    let names: Vec<_> = scene.obstacles().iter().map(|obstacle| obstacle.name.value.as_str()).collect();
    assert_eq!(names, ["post", "table"]);
    let grippers: Vec<_> = scene.phases().iter().map(|phase| phase.gripper).collect();
    assert_eq!(grippers, [Some(Gripper::Close), None, Some(Gripper::Open), None]);
    assert_eq!(scene.limits().clearance_m, 0.005);
    assert!(scene.phases().iter().all(|phase| phase.move_us.is_none()));
    let aim = scene.phases()[1].aim.unwrap();
    assert!((aim.direction.value.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-12);
}

/// A box turned by a quarter about the third axis is as long along y as it was along x.
#[test]
fn box_is_turned() {
    let tables = format!(
        "[[obstacle]]\nname = \"bar\"\nshape = \"box\"\ncenter = [5, 0, 0]\nsize = [2, 0.1, 0.1]\nrotation = [0, 0, \"90 deg\"]\n{PHASE}"
    );
    let scene = scene::parse(&with_phases("weightless-a", &tables), "task.toml").unwrap();
    let distance = scene.obstacles()[0].shape.distance(&nalgebra::Vector3::new(5.0, 3.0, 0.0)).distance_m;
    assert!((distance - 2.0).abs() < 1e-12);
}

#[test]
fn mistakes_are_shown_at_their_line() {
    let obstacle = |keys: &str| format!("[[obstacle]]\nname = \"o\"\n{keys}\n{PHASE}");
    for (tables, expected) in [
        (obstacle("shape = \"sphere\"\ncenter = [0, 0, 0]"), "missing key `radius`"),
        (
            obstacle("shape = \"sphere\"\nradius = 1\ncenter = [0, 0, 0]\nsize = [1, 1, 1]"),
            "`size` has no meaning for a `sphere`",
        ),
        (obstacle("shape = \"cone\""), "unknown `shape`"),
        (
            obstacle("shape = \"box\"\ncenter = [0, 0, 0]\nsize = [1, 0, 1]"),
            "every edge of a box must be at least 0.1 mm",
        ),
        (
            "[[phase]]\nname = \"p\"\ninside = \"bni\"\n\n[[region]]\nname = \"bin\"\ncenter = [0, 0, 0]\nsize = [1, 1, 1]\n".to_owned(),
            "did you mean `bin`?",
        ),
        (
            "[[phase]]\nname = \"p\"\ntargets = { elbow = { bend_angle = 1 } }\ndirection = [1, 0, 0]\n".to_owned(),
            "`direction` has no meaning with `targets`",
        ),
        (format!("{PHASE}direction = [0, 0, 0]\n"), "`direction` has no direction"),
        (
            format!("{PHASE}direction_tolerance = \"3 deg\"\n"),
            "`direction_tolerance` has no meaning without `direction`",
        ),
        (format!("{PHASE}inside = \"bin\"\n"), "a phase has one of `targets`, `tip` and `inside`"),
        (format!("{PHASE}gripper = \"shut\"\n"), "unknown `gripper`"),
        ("[markers]\nfile = \"nowhere.csv\"\n".to_owned(), "cannot read the markers"),
        (format!("{PHASE}[markers]\nfile = \"nowhere.csv\"\n"), "a scene has phases or `[markers]`"),
        (String::new(), "the scene has no `[[phase]]`"),
        (format!("{PHASE}[design]\nwall = [\"5 mm\", \"3 mm\"]\n"), "needs the lower value first"),
        (format!("{PHASE}[design]\nwall = \"5 mm\"\n"), "must be an array of two values"),
        (format!("{PHASE}[design]\nmodules = [1, 2.5]\n"), "needs whole numbers"),
        (format!("{PHASE}[design]\nmotions = [\"bending\"]\n"), "`motions` has no meaning without `modules`"),
        (format!("{PHASE}[design]\nmodules = [1, 2]\nmotions = [\"bending\", \"bending\"]\n"), "is there twice"),
        (format!("{PHASE}[design]\nshared_supply_line = 1\n"), "must be `true` or `false`"),
    ] {
        let message = wrong(&tables);
        assert!(message.contains(expected), "{expected}:\n{message}");
    }
}

#[test]
fn design_is_read_and_a_module_overrides_it() {
    let design = "[design]\ninner_radius = [\"6 mm\", \"10 mm\"]\nwall = [\"3 mm\", \"5 mm\"]\nlimit_margin = 0.1\nshared_supply_line = true\n\
                  mount_angle = \"free\"\nmodules = [2, 3]\nmotions = [\"bending\", \"extension\"]\n";
    let text = with_phases("weightless-a", &format!("{PHASE}{design}"));
    let text = text.replacen(
        "motion = \"bending\"",
        "motion = \"bending\"\nbounds = { wall = [\"2 mm\", \"2 mm\"], length = [0.1, 0.2] }",
        1,
    );
    let scene = scene::parse(&text, "task.toml").unwrap_or_else(|error| panic!("{}", error.render(false)));
    let design = scene.design().unwrap();
    assert_eq!((design.limit_margin, design.shared_supply_line, design.mount_angle_free), (0.1, true, true));
    let near = |found: [f64; 2], expected: [f64; 2]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15);
    let [shoulder, elbow, wrist] = &design.modules[..] else { panic!("{design:?}") };
    assert!(near(*shoulder.wall_m.unwrap(), [0.003, 0.005]) && near(*wrist.inner_radius_m.unwrap(), [0.006, 0.010]));
    assert!(near(*elbow.wall_m.unwrap(), [0.002, 0.002]) && near(*elbow.length_m.unwrap(), [0.1, 0.2]));
    assert!(shoulder.length_m.is_none() && shoulder.fiber_angle_rad.is_none());
    let choice = design.choice.as_ref().unwrap();
    assert_eq!((choice.modules_min, choice.modules_max), (2, 3));
    assert_eq!(choice.motions, [Motion::Bending, Motion::Extension]);
    assert!(repository("weightless-a").design().is_none());
}
