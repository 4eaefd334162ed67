//! The figures of merit against errors whose size is known in closed form.

use softlimb_rig::record::RunLog;
use softlimb_rig::report::{ErrorStats, summary};

/// The made-up run with an observer that saw exactly what was asked for.
fn perfect() -> RunLog {
    let mut run = crate::synthetic_run::run();
    for sample in &mut run.samples {
        for module in &mut sample.modules {
            module.modelled = module.setpoint;
            module.achieved = Some(module.setpoint);
        }
        for channel in &mut sample.channels {
            channel.pressure_pa = channel.reference_pa;
            channel.true_pressure_pa = Some(channel.reference_pa);
        }
        sample.tip_modelled_m = sample.tip_setpoint_m;
        sample.tip_achieved_m = Some(sample.tip_setpoint_m);
    }
    run
}

fn close(stats: Option<ErrorStats>, rmse: f64, max: f64) {
    let stats = stats.expect("was observed");
    assert!((stats.rmse - rmse).abs() <= 1e-9 * rmse.abs() + 1e-12, "RMSE {} is not {rmse}", stats.rmse);
    assert!((stats.max - max).abs() <= 1e-9 * max.abs() + 1e-12, "max {} is not {max}", stats.max);
}

#[test]
fn perfect_run_has_no_error() {
    let summary = summary(&perfect());
    let all = ErrorStats { rmse: 0.0, max: 0.0, samples: 2001 };
    assert_eq!(summary.tip.error_m, Some(all));
    assert_eq!(summary.tip.tracking_error_m, Some(all));
    assert_eq!(summary.tip.final_error_m, Some(0.0));
    assert!(summary.modules.iter().all(|module| module.error == Some(all) && module.tracking_error == Some(all)));
    assert_eq!(summary.pressure.measured_error_pa, Some(ErrorStats { samples: 9 * 2001, ..all }));
}

#[test]
fn sine_of_whole_periods_has_its_root_mean_square() {
    let mut run = perfect();
    run.samples.pop(); // 2000 samples: ten whole periods of 2 s
    for sample in &mut run.samples {
        let error = 0.2 * (std::f64::consts::PI * (sample.time_s + 0.005)).sin();
        let module = &mut sample.modules[1];
        module.achieved = Some(module.setpoint + error);
        module.modelled = module.setpoint - 0.5 * error;
    }
    let elbow = &summary(&run).modules[1];
    let largest = 0.2 * (0.495 * std::f64::consts::PI).sin(); // the sample next to the peak
    close(elbow.error, 0.2 / 2.0_f64.sqrt(), largest);
    close(elbow.tracking_error, 0.1 / 2.0_f64.sqrt(), largest / 2.0);
}

#[test]
fn module_that_stays_at_rest_misses_no_goal() {
    let mut run = perfect();
    // Half a travel off at the ends of all phases: a miss of each.
    let setpoints = run.samples.iter().map(|sample| sample.modules[1].setpoint);
    let travel = setpoints.clone().fold(f64::NEG_INFINITY, f64::max) - setpoints.fold(f64::INFINITY, f64::min);
    for sample in &mut run.samples {
        let module = &mut sample.modules[1];
        module.modelled = module.setpoint + 0.5 * travel;
        module.achieved = Some(module.modelled);
    }
    let misses = summary(&run).misses;
    assert_eq!(misses.len(), run.info.phases.len());
    assert!(misses.iter().all(|miss| (miss.share_of_travel - 0.5).abs() < 1e-9), "{misses:?}");
    for sample in &mut run.samples {
        let module = &mut sample.modules[1];
        module.setpoint = 1.0;
        module.modelled = 1.0 + 0.5 * travel;
        module.achieved = Some(module.modelled);
    }
    assert!(summary(&run).misses.is_empty());
}

#[test]
fn tip_errors_are_distances_and_split_by_cause() {
    let mut run = perfect();
    for sample in &mut run.samples {
        let [x, y, z] = sample.tip_setpoint_m;
        sample.tip_modelled_m = [x + 0.001, y + 0.002, z - 0.002];
        sample.tip_achieved_m = Some([x - 0.003, y, z + 0.004]);
    }
    let tip = summary(&run).tip;
    close(tip.error_m, 0.005, 0.005);
    close(tip.tracking_error_m, 0.003, 0.003);
    assert!((tip.final_error_m.unwrap() - 0.005).abs() < 1e-12);
    // The same everywhere, so also at the end of each hold.
    let phases = run.info.phases.iter().filter(|phase| phase.hold_s >= 0.5).count();
    assert!(phases > 0);
    close(tip.at_holds_m, 0.005, 0.005);
    assert_eq!(tip.at_holds_m.unwrap().samples, phases);
}

#[test]
fn pressure_errors_of_sensor_and_chamber_are_apart() {
    let mut run = perfect();
    for sample in &mut run.samples {
        for channel in &mut sample.channels[3..6] {
            channel.pressure_pa += 300.0;
            channel.true_pressure_pa = Some(channel.reference_pa - 600.0);
        }
    }
    let summary = summary(&run);
    close(summary.modules[1].pressure.measured_error_pa, 300.0, 300.0);
    close(summary.modules[1].pressure.true_error_pa, 600.0, 600.0);
    close(summary.modules[0].pressure.true_error_pa, 0.0, 0.0);
    // One channel in three is off.
    close(summary.pressure.measured_error_pa, 300.0 / 3.0_f64.sqrt(), 300.0);
    close(summary.pressure.true_error_pa, 600.0 / 3.0_f64.sqrt(), 600.0);
}

#[test]
fn scheduled_time_alone_counts() {
    let mut run = perfect();
    let mut before = run.samples[0].clone();
    before.time_s = -1.0;
    before.modules[0].achieved = Some(99.0);
    let mut after = before.clone();
    after.time_s = 21.0;
    run.samples.insert(0, before);
    run.samples.push(after);
    let scheduled = summary(&run);
    close(scheduled.modules[0].error, 0.0, 0.0);
    assert_eq!(scheduled.modules[0].achieved_final, Some(1.0));
    assert_eq!((scheduled.duration_s, scheduled.samples), (22.0, 2003));

    run.info.phases.clear();
    let whole = summary(&run);
    assert_eq!(whole.modules[0].error.unwrap().max, 98.0);
    assert_eq!(whole.modules[0].achieved_final, Some(99.0));
}

#[test]
fn unobserved_values_are_absent_and_not_zero() {
    let mut run = perfect();
    run.wall_s = None;
    for sample in &mut run.samples {
        sample.tip_achieved_m = None;
        sample.modules[2].achieved = None;
        sample.channels.iter_mut().for_each(|channel| channel.true_pressure_pa = None);
    }
    let summary = summary(&run);
    assert_eq!((summary.tip.error_m, summary.tip.final_error_m), (None, None));
    assert_eq!((summary.modules[2].error, summary.modules[2].achieved_final), (None, None));
    assert_eq!((summary.pressure.true_error_pa, summary.real_time_factor), (None, None));
    assert!(summary.modules[1].error.is_some());
    let table = summary.table();
    let distal = table.lines().find(|line| line.starts_with("distal")).unwrap();
    assert!(distal.split_whitespace().rev().take(3).all(|cell| cell == "-"), "{distal}");
}

#[test]
fn real_time_factor_is_run_time_over_wall_time() {
    let mut run = perfect();
    run.wall_s = Some(0.25);
    assert_eq!(summary(&run).real_time_factor, Some(80.0)); // 20 s in 0.25 s
    run.wall_s = Some(0.0);
    assert_eq!(summary(&run).real_time_factor, None);
}

#[test]
fn empty_run_has_a_summary() {
    let mut run = perfect();
    run.samples.clear();
    let summary = summary(&run);
    assert_eq!((summary.duration_s, summary.tip.error_m), (0.0, None));
    assert!(summary.table().contains("0 samples"));
}

#[test]
fn json_is_in_si_units_and_says_which() {
    let mut run = perfect();
    for sample in &mut run.samples {
        sample.modules[1].achieved = Some(sample.modules[1].setpoint + 0.5);
    }
    let json = serde_json::to_value(summary(&run)).unwrap();
    let elbow = &json["modules"][1];
    assert_eq!((elbow["quantity"].as_str(), elbow["unit"].as_str()), (Some("bend_angle"), Some("rad")));
    assert!((elbow["error"]["rmse"].as_f64().unwrap() - 0.5).abs() < 1e-12);
    assert_eq!(json["tip"]["error_m"]["samples"], 2001);
    assert_eq!(json["faults"][0]["code"], 1);
    assert_eq!(json["incomplete"], serde_json::Value::Null);
}

#[test]
fn table_shows_people_units() {
    let mut run = perfect();
    for sample in &mut run.samples {
        sample.modules[1].achieved = Some(sample.modules[1].setpoint + std::f64::consts::FRAC_PI_6);
        sample.tip_achieved_m = Some(sample.tip_setpoint_m.map(|value| value + 0.01));
        sample.channels.iter_mut().for_each(|channel| channel.pressure_pa += 1500.0);
    }
    let table = summary(&run).table();
    let cells = |start: &str| {
        let line = table.lines().find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("{start}\n{table}"));
        line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(cells("elbow"), ["elbow", "bending", "3-5", "bend angle, deg", "0.00", "30.00", "30.00", "30.00"]);
    assert_eq!(cells("tip position, mm")[1..], ["17.32", "17.32"]); // 10 mm times the root of 3
    assert_eq!(cells("pressure, sensor")[1..], ["1.50", "1.50"]);
    assert!(table.contains("12.340 s, channel 4: sensor of channel 4 implausible (code 1, value -7)"));
}

#[test]
fn table_is_aligned_and_at_most_100_columns_wide() {
    let mut run = perfect();
    run.info.scene_name = "a scene with a name that goes on and on, ".repeat(9);
    run.info.weightless = true;
    run.info.modules[0].name = "a module with a very long name\nand a second line".into();
    run.info.modules[1].motion = "bending and more than that".into();
    run.info.modules[2].quantity = fra_model::StateQuantity::Pressure;
    run.incomplete = Some("the disk was full ".repeat(20));
    run.samples[5].modules[2].achieved = Some(-1.234e300);
    run.link.bytes_received = u64::MAX;
    run.link.frames_sent = u64::MAX;
    let fault = softlimb_rig::record::FaultRecord { channel: 0xFF, text: "x".repeat(300), ..run.faults[0].clone() };
    run.faults = vec![fault; 13];
    let table = summary(&run).table();
    for line in table.lines() {
        assert!(line.chars().count() <= 100, "{} columns: {line}", line.chars().count());
    }
    let lines: Vec<_> = table.lines().skip_while(|line| !line.starts_with("module")).take(4).collect();
    let widths: Vec<_> = lines.iter().map(|line| line.chars().count()).collect();
    assert!(widths.iter().all(|width| *width == widths[0]), "{lines:#?}");
    assert!(table.contains("faults  13") && table.contains("and 3 more") && table.contains("system"));
}
