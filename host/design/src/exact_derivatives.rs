//! Derivatives of loaded limbs beside differences of converged evaluations, for the scenes of the groups and seeded tasks.

#[path = "../../../tests/support/samples.rs"]
mod samples;

use crate::from_scene::{LoadedDesign, loaded_design};
use crate::loaded::{Compared, Margin, compare, seeded};

fn scene(group: &str) -> LoadedDesign {
    let text = match group {
        "a" => include_str!("../../../scenes/open/loaded-group-a.toml"),
        "b" => include_str!("../../../scenes/open/loaded-group-b.toml"),
        _ => include_str!("../../../scenes/open/loaded-group-c.toml"),
    };
    loaded_design(&softlimb_scene::parse(text, "open.toml").unwrap()).unwrap()
}

/// A Jacobian that leaves the springs of a varied limb at the strains of the unvaried one is off by 1 % in half of the columns.
#[test]
fn jacobian_is_that_of_converged_evaluations_where_residuals_are_smooth() {
    let mut all = Compared::default();
    for group in ["a", "b", "c"] {
        let design = scene(group);
        compare(&design.task, &design.space, 2, &mut all);
    }
    let design = scene("a");
    for seed in 1..=samples::samples(10) {
        let posed = seeded(&design.task, &design.space, seed.into()).expect("a task");
        compare(&posed.task, &design.space, 3, &mut all);
    }
    let Compared { mut columns, smooth, kinks, fallen } = all;
    columns.sort_by(f64::total_cmp);
    let (median, most) = (columns[columns.len() / 2], columns[columns.len() - 1]);
    assert!(median <= 1e-6 && most <= 1e-4, "{median:e} {most:e}");
    assert!(fallen * 10 < columns.len(), "{fallen}");
    // Nearest points, steepest points and higher pressures of two change places; nothing else has kinks.
    assert!(kinks.len() * 20 < smooth, "{} {smooth}", kinks.len());
    let known = [Margin::Clearance, Margin::Tilt, Margin::Pressure, Margin::LoadFactor];
    assert!(kinks.iter().all(|margin| known.contains(margin)), "{kinks:?}");
}

/// A pressure and two radii move all segments of an actuator at once.
#[test]
fn jacobian_of_a_series_is_that_of_converged_evaluations() {
    let bounds = "bounds = { length = [\"50 mm\", \"130 mm\"] }";
    let hanging = include_str!("../../../scenes/extend-and-bend.toml")
        .replace("base_direction = [1, 0, 0]", "base_direction = [0, 0, -1]")
        .replace("base_up = [0, 0, 1]", "base_up = [1, 0, 0]")
        .replace("length = \"60 mm\"", &format!("{bounds}\nlength = \"60 mm\""))
        .replace("length = \"100 mm\"", &format!("{bounds}\nlength = \"100 mm\""))
        .replace("simulated = false", "")
        .replace("targets = { finger = { bend_angle = \"60 deg\" } }", "tip = [0.05, 0, -0.15]")
        .replace("targets = { finger = { bend_angle = \"25 deg\" } }", "payload = \"20 g\"\ntip = [0.03, 0, -0.16]");
    let open = "\n[design]\ninner_radius = [\"5 mm\", \"9 mm\"]\nwall = [\"2 mm\", \"5 mm\"]\nmount_angle = \"free\"\n";
    let scene = softlimb_scene::parse(&(hanging + open), "series.toml").unwrap_or_else(|error| panic!("{error}"));
    let design = loaded_design(&scene).unwrap();
    assert_eq!(design.space.modules.iter().map(|module| module.joined).collect::<Vec<_>>(), [false, true]);
    let mut all = Compared::default();
    compare(&design.task, &design.space, 5, &mut all);
    // Two radii, two lengths, one turn, and one pressure of each pose.
    assert_eq!((all.columns.len(), all.fallen), (7, 0));
    let most = all.columns.iter().copied().fold(0.0, f64::max);
    assert!(most <= 5e-6, "{most:e}");
}
