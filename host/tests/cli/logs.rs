//! `replay`, `export` and `recover` on the log of a run.

use softlimb::rig::record::{Recorder, RunEnd, read, read_capture};

use crate::cli::desk::Desk;

/// A desk with a run in `results`.
fn desk() -> Desk {
    let desk = Desk::with_scene("small", "small");
    desk.softlimb("run scene.toml --out results").done();
    desk
}

#[test]
fn run_is_run_again_bit_for_bit() {
    let desk = desk();
    let told = desk.softlimb("replay results/run.mcap").done().out;
    assert!(told.ends_with("\nno difference\n"), "{told}");
    let json = desk.softlimb("replay results/run.mcap --json").done().json();
    assert_eq!((&json["identical"], &json["converter_codes"]), (&true.into(), &true.into()), "{json}");
    assert!(json["ticks"] == json["ticks_compared"] && json["ticks"].as_u64() > Some(2_000), "{json}");
    assert!(json["messages_compared"].as_u64() > Some(200) && json["messages_missing"] == 0, "{json}");
    // Re-running leaves nothing behind.
    assert_eq!(desk.content(), ["results", "results/run.html", "results/run.mcap", "scene.toml"]);
}

#[test]
fn first_difference_is_told_and_ends_with_exit_code_3() {
    let desk = desk();
    let run = read(desk.path("results/run.mcap")).unwrap();
    let mut capture = read_capture(desk.path("results/run.mcap")).unwrap();
    let pulsed = capture.ticks.iter_mut().rfind(|tick| tick.pulses.iter().any(|pulse| pulse.fill_us > 0)).unwrap();
    let device_s = pulsed.device_us as f64 * 1e-6;
    let filled = pulsed.pulses.iter_mut().find(|pulse| pulse.fill_us > 0).unwrap();
    filled.fill_us -= 1;
    let fill_us = filled.fill_us;
    let mut recorder = Recorder::create(desk.path("forged.mcap"), &run.info).unwrap();
    capture.wire.iter().for_each(|wire| recorder.wire(wire).unwrap());
    recorder.ticks(&capture.ticks, false).unwrap();
    recorder.finish(&RunEnd::default()).unwrap();

    let answer = desk.softlimb("replay forged.mcap");
    assert_eq!(answer.code, Some(3), "{answer:?}");
    let (expected, got) = (format!("log     fill {fill_us} us"), format!("re-run  fill {} us", fill_us + 1));
    for words in ["s into the run", &format!("device time {device_s:.3} s, channel 0, coils"), &expected, &got] {
        assert!(answer.out.contains(words), "{words}: {}", answer.out);
    }
    let json = desk.softlimb("replay forged.mcap --json");
    assert_eq!((json.code, &json.json()["difference"]["device_s"]), (Some(3), &device_s.into()));
}

#[test]
fn log_is_exported_to_tables_and_json() {
    let desk = desk();
    let answer = desk.softlimb("export results/run.mcap --csv tables --json run.json").done();
    assert!(answer.out.is_empty() && answer.err.contains("tables/telemetry.csv"), "{answer:?}");
    let run = read(desk.path("results/run.mcap")).unwrap();
    let rows = |name: &str| -> Vec<Vec<String>> {
        let text = std::fs::read_to_string(desk.path(&format!("tables/{name}.csv"))).unwrap();
        text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let telemetry = rows("telemetry");
    assert_eq!(
        telemetry[0][..7].join(","),
        "time_s,state,fault_bits,supply_pa,valve_supply_v,output_bits,channel_0_pressure_pa"
    );
    assert_eq!(telemetry.len(), run.samples.len() + 1);
    let truth = rows("truth");
    let place = truth[0].iter().position(|name| name == "finger_bend_angle_rad").unwrap();
    for (row, sample) in truth[1..].iter().zip(&run.samples) {
        assert_eq!(row[place].parse(), Ok(sample.modules[0].achieved.unwrap()), "a number reads back exactly");
    }
    let ticks = rows("ticks");
    assert_eq!(ticks[2][0], "1000");
    assert_eq!(rows("wire")[1][..2], ["0", "to_device"]);
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(desk.path("run.json")).unwrap()).unwrap();
    assert_eq!(json["samples"].as_array().map(Vec::len), Some(run.samples.len()));
    assert_eq!(json["ticks"].as_array().map(Vec::len), Some(ticks.len() - 1));
    desk.softlimb("export results/run.mcap").failed(2, &["--csv", "--json"]);
    desk.softlimb("export scene.toml --json run.json").failed(1, &["scene.toml", "not an MCAP file"]);
}

#[test]
fn log_that_was_cut_off_is_recovered() {
    let desk = desk();
    let whole = std::fs::read(desk.path("results/run.mcap")).unwrap();
    desk.put("run.mcap.partial", &whole[..2 * whole.len() / 3]);
    let answer = desk.softlimb("recover run.mcap.partial");
    assert_eq!(answer.code, Some(3), "{answer:?}");
    assert!(answer.err.contains("wrote run.recovered.mcap") && answer.err.contains("not finished"), "{}", answer.err);
    let (run, cut) = (read(desk.path("results/run.mcap")).unwrap(), read(desk.path("run.recovered.mcap")).unwrap());
    assert!(cut.samples.len() > run.samples.len() / 2, "{}", cut.samples.len());
    assert_eq!(cut.samples, run.samples[..cut.samples.len()]);
    assert_eq!(desk.softlimb("report run.recovered.mcap").code, Some(3));
    // What is left can be run again as far as it goes.
    assert!(desk.softlimb("replay run.recovered.mcap").done().out.contains("no difference"));
    desk.softlimb("recover run.mcap.partial").failed(1, &["run.recovered.mcap", "--out"]);
    desk.softlimb("recover results/run.mcap -o again.mcap").done();
    assert_eq!(read(desk.path("again.mcap")).unwrap().samples, run.samples);
    desk.softlimb("recover no-such-file").failed(1, &["no-such-file"]);
}
