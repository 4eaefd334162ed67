//! Times that the plan chooses, and marker series.

use super::common::{planned, refused, with_phases};

const ELBOW: &str = "[[phase]]\nname = \"bend\"\ntargets = { elbow = { bend_angle = \"60 deg\" } }\n";

fn move_s(text: &str) -> f64 {
    let (_, _, plan) = planned(text).unwrap();
    plan.phases[0].move_us as f64 * 1e-6
}

/// The peak rate of a minimum-jerk move is 15/8 of the mean one.
#[test]
fn a_rate_limit_gives_its_closed_form() {
    let text = with_phases("weightless-a", ELBOW).replace("[limits]", "[limits]\nangle_rate_max = \"20 deg/s\"");
    assert!((move_s(&text) - 1.875 * 60.0 / 20.0).abs() <= 0.010_001);
}

/// With a constant supply, time scales exactly as the reciprocal of the conductance of valve and line in series.
#[test]
fn a_valve_limit_scales_with_the_conductance() {
    let scene = |conductance: f64| {
        let plant = format!(
            "[plant.supply]\nkind = \"regulated\"\npressure = \"200 kPa\"\n[plant.valve]\nconductance = \"{conductance} dm3/(s bar)\"\n"
        );
        with_phases("weightless-a", ELBOW) + "\n" + &plant
    };
    let line = {
        let (d, l): (f64, f64) = (2.5e-3, 1.0);
        0.029 * d * d / (l / d.powf(1.25) + 510.0).sqrt() * 1e8
    };
    let series = |valve: f64| valve * line / valve.hypot(line);
    let (wide, narrow) = (move_s(&scene(0.072)), move_s(&scene(0.018)));
    assert!(wide > 0.3, "{wide}");
    let (found, expected) = (narrow / wide, series(0.072) / series(0.018));
    assert!((found / expected - 1.0).abs() < 0.011 / wide, "{found} {expected}");
}

/// A duration far below what the valves can do is said to be, with one that is enough and is not warned of.
#[test]
fn given_time_that_valves_cannot_follow_is_warned_of() {
    let text = |seconds: &str| with_phases("weightless-a", &format!("{ELBOW}duration = \"{seconds} s\"\n"));
    let (_, _, plan) = planned(&text("0.05")).unwrap();
    let [warning] = &plan.warnings[..] else { panic!("{:?}", plan.warnings) };
    assert!(warning.starts_with("phase `bend` is faster than the valves of `elbow` can follow"), "{warning}");
    let enough = warning.split(": ").nth(1).unwrap().split(' ').next().unwrap();
    assert!(planned(&text(enough)).unwrap().2.warnings.is_empty());
    assert!((move_s(&with_phases("weightless-a", ELBOW)) - enough.parse::<f64>().unwrap()).abs() < 0.011);
}

/// A small reservoir with a weak pump cannot fill all modules: no duration helps once the pump stalls below the chambers.
#[test]
fn supply_that_never_suffices_is_refused() {
    let goal = "[[phase]]\nname = \"all\"\ntargets = { shoulder = { pressure = \"95 kPa\" } }\n";
    let text =
        with_phases("weightless-a", goal) + "\n[plant.supply]\npressure = \"101 kPa\"\nstall_pressure = \"102 kPa\"\n";
    assert!(refused(&text).contains("the supply does not suffice"), "{}", refused(&text));
}

/// Three quarters of an arc in the plane of the limb, followed in time: the tip is where the file says at the times it says.
#[test]
fn marker_series_is_followed_on_its_clock() {
    let folder = tempfile::tempdir().unwrap();
    let at = |time: f64| [0.78 + 0.03 * time.cos(), 0.0, 0.80 + 0.03 * time.sin()];
    let rows: Vec<String> = (0..=45)
        .map(|row| {
            let time = f64::from(row) * 0.1;
            let [x, y, z] = at(time);
            format!("{},{x},{y},{z}", 7.0 + time)
        })
        .collect();
    std::fs::write(folder.path().join("arc.csv"), format!("time_s,x_m,y_m,z_m\n{}\n", rows.join("\n"))).unwrap();
    let text = with_phases("weightless-a", "[markers]\nfile = \"arc.csv\"\n");
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let scene = softlimb_scene::load(&path).unwrap();
    let limb = softlimb_limb::Limb::new(&scene).unwrap();
    let plan = softlimb_motion::plan(&scene, &limb).unwrap();
    assert_eq!((plan.phases.len(), plan.phases[1].move_us), (2, 4_500_000));
    let start = plan.phases[1].start_us as f64;
    for step in 0..=90 {
        let time = f64::from(step) * 0.05;
        let tip = limb.tip(&plan.states_at(start + time * 1e6));
        let off = (nalgebra::Vector3::from(tip) - nalgebra::Vector3::from(at(time))).norm();
        // Between rows the way is smooth but not the arc; knots and wire units cost some micrometres.
        let allowed = if step % 2 == 0 { 3e-5 } else { 1.5e-3 };
        assert!(off < allowed, "{off} at {time} s");
    }
}
