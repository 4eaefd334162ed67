//! The same scene and seed give the same run, to the byte, but for the time it took.

mod support;

use softlimb_rig::record;
use softlimb_rig::record::RunLog;
use softlimb_rig::run::{RunError, RunOptions, write_report};

use support::{Ran, options, rerun, run, run_with, scene_with};

const SCENE: &str = "single-bending";

/// Name of the record that only a finished log has; it holds the time that the run took.
const END: &[u8] = b"softlimb.end";
/// What a metadata record has before its name: opcode, length of the record, length of the name.
const BEFORE_NAME: usize = 1 + 8 + 4;

fn ran(seed: u64) -> Ran {
    run(&scene_with(SCENE, ""), seed)
}

fn bytes(ran: &Ran) -> Vec<u8> {
    std::fs::read(&ran.files.log).unwrap()
}

/// The log up to its last word: everything that was said, without the time it took and the index behind it.
fn said(log: &[u8]) -> &[u8] {
    let at = log.windows(END.len()).position(|window| window == END).expect("a finished log");
    &log[..at - BEFORE_NAME]
}

fn timeless(run: &RunLog) -> RunLog {
    assert!(run.wall_s.is_some_and(|wall_s| wall_s > 0.0));
    RunLog { wall_s: None, ..run.clone() }
}

#[test]
fn same_seed_writes_the_same_bytes() {
    let (first, second) = (ran(4), ran(4));
    assert_eq!(timeless(&first.files.run), timeless(&second.files.run));
    let (first, second) = (bytes(&first), bytes(&second));
    // All but the index, a few kilobytes of a megabyte.
    assert!(said(&first).len() > first.len() * 9 / 10, "{} of {}", said(&first).len(), first.len());
    assert!(said(&first) == said(&second), "the logs differ");
}

#[test]
fn seeds_give_other_plants_under_the_same_plan() {
    let (first, other) = (ran(4), ran(5));
    assert!(said(&bytes(&first)) != said(&bytes(&other)));
    let (first, other) = (&first.files.run, &other.files.run);
    assert_eq!((first.info.seed, other.info.seed), (Some(4), Some(5)));
    assert_eq!(first.info.config_hash, other.info.config_hash, "the device is told the same");
    let setpoints = |run: &RunLog| -> Vec<f64> {
        let scheduled = run.samples.iter().filter(|sample| sample.time_s <= 7.5);
        scheduled.map(|sample| sample.modules[0].setpoint).collect()
    };
    let achieved = |run: &RunLog| run.samples.last().map(|sample| sample.modules[0].achieved);
    assert_eq!(setpoints(first), setpoints(other));
    assert_ne!(achieved(first), achieved(other));
}

#[test]
fn report_made_again_from_the_log_is_the_same_page() {
    let ran = ran(4);
    let again = ran.files.report.with_file_name("again.html");
    write_report(&again, &record::read(&ran.files.log).unwrap()).unwrap();
    let (first, second) = (std::fs::read(&ran.files.report).unwrap(), std::fs::read(&again).unwrap());
    assert!(!first.is_empty() && first == second, "the pages differ");
    assert_eq!(ran.left_behind(), ["again.html", "run.html", "run.mcap"]);
}

#[test]
fn log_that_was_cut_off_agrees_with_the_whole_one_as_far_as_it_goes() {
    let ran = ran(4);
    let whole = &ran.files.run;
    let log = bytes(&ran);
    let mut longest = 0;
    for share in [3, 5, 7, 9] {
        let path = ran.files.log.with_file_name(format!("cut-{share}.mcap"));
        std::fs::write(&path, &log[..log.len() * share / 10]).unwrap();
        let cut = record::read(&path).unwrap();
        assert!(cut.incomplete.is_some() && cut.wall_s.is_none());
        assert_eq!(cut.info, whole.info);
        assert_eq!(cut.samples, whole.samples[..cut.samples.len()]);
        assert!(cut.samples.len() >= longest, "a longer log holds no less");
        longest = cut.samples.len();
    }
    assert!(longest > whole.samples.len() / 2, "{longest} of {}", whole.samples.len());
}

#[test]
fn controller_run_again_on_the_log_of_a_run_gives_its_outputs() {
    let ran = ran(4);
    let again = rerun(&ran.files.log);
    assert!(again.is_exact && again.ticks > 9_000 && again.ticks_compared == again.ticks, "{again:?}");
}

#[test]
fn fault_decisions_of_a_log_are_made_again() {
    for (fault, told) in [
        ("sensor-frozen@0.7,0", "frozen pressure sensor"),
        ("sensor-zero@1,0", "fall of a reading without venting"),
        ("supply-stuck-closed@0.5", "less air than the valves explain"),
        ("fill-stuck-open@1,0", "more air than the valves explain"),
        ("valve-supply-sag@1", "voltage of the valves' supply too low at 4.8 V"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let faults = vec![fault.parse().unwrap()];
        let options = RunOptions { faults, ..options(folder.path(), 4) };
        let watched = "[limits]\nvalve_voltage_min = \"20 V\"\n";
        let Err(RunError::Stopped { files, .. }) = run_with(&scene_with(SCENE, watched), &options) else {
            panic!("{fault} stops no run");
        };
        let heard = &files.run.faults;
        assert_eq!(files.run.samples[0].valve_supply_v, Some(23.996));
        assert!(heard.first().is_some_and(|heard| heard.text.starts_with(told)), "{fault}: {heard:?}");
        let again = rerun(&files.log);
        assert!(again.is_exact && again.ticks_compared == again.ticks, "{fault}: {again:?}");
    }
}
