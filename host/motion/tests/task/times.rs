//! Times that the plan chooses, and marker series.

use super::common::{planned, refused, repository, with_phases};

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

/// A load that is put down in a pause needs air out of the chambers that carried it: a warning below the conductance that their masses of air
/// give by hand, and none above it.
#[test]
fn load_that_changes_hands_faster_than_valves_can_follow_is_warned_of() {
    let bare = repository("loaded/carry-hanging").source_text().to_owned();
    let told = |text: &str| {
        let (_, _, plan) = planned(text).unwrap_or_else(|error| panic!("{error}"));
        plan.warnings.into_iter().find(|warning| warning.contains("pause of phase `place`"))
    };
    let (scene, limb, plan) = planned(&bare).unwrap();
    let phase = plan.phases.iter().find(|phase| phase.name == "place").unwrap();
    let [before, after] =
        [0, phase.hold_us].map(|time_us| plan.states_at((phase.start_us + phase.move_us + time_us) as f64));
    // 1 mL of fittings, pi/4 2.5^2 1000 mm3 of line; a critical pressure ratio of 0.3; ISO 8778 has 1.185 kg/m3.
    let dead_m3 = scene.plant().chamber.dead_volume_m3 + 4.908_739e-6;
    let mass_kg = |state: &fra_model::State<f64>| {
        (state.pressure_pa + 101_325.0) * (state.volume_m3 + dead_m3) / (287.05 * 293.15)
    };
    let per_pressure = |low_pa: f64, high_pa: f64| {
        let (p1, p2) = (high_pa + 101_325.0, low_pa + 101_325.0);
        1.185 * p1 * (1.0 - ((p2 / p1 - 0.3) / 0.7).max(0.0).powi(2)).sqrt()
    };
    let needed = limb.drives().zip(before.iter().zip(&after)).map(|(_, (a, b))| {
        let change_kg = mass_kg(b) - mass_kg(a);
        let middle_pa = 0.5 * (a.pressure_pa + b.pressure_pa);
        let flow = if change_kg > 0.0 { per_pressure(middle_pa, 250e3) } else { per_pressure(0.0, middle_pa) };
        1.875 * change_kg.abs() / (phase.hold_us as f64 * 1e-6) / flow
    });
    let whole = needed.fold(0.0, f64::max) * 1e8;
    let line = softlimb_motion::line_conductance_m3_per_s_pa(&scene.plant().line) * 1e8;
    let valve = whole * line / (line * line - whole * whole).sqrt();
    let with = |share: f64| format!("{bare}\n[plant.valve]\nconductance = \"{:.4} dm3/(s bar)\"\n", share * valve);
    println!("{valve:.4} dm3/(s bar) by hand");
    assert_eq!(told(&with(1.25)), None);
    let warning = told(&with(0.8)).expect("a warning");
    let (_, enough) = warning.split_once("a `hold` of ").unwrap();
    let hold = format!("hold = \"{} s\"", enough.split(' ').next().unwrap());
    let (head, place) = bare.split_once("name = \"place\"").unwrap();
    let longer = format!("{head}name = \"place\"{}", place.replacen("hold = \"1 s\"", &hold, 1));
    assert_eq!(told(&with(0.8).replace(&bare, &longer)), None, "{hold}");
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
