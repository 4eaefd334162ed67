//! A log reads back exactly, survives being cut off, and refuses what it is not.

use softlimb_rig::record;
use softlimb_rig::record::{
    Capture, CoilPulse, DeviceTick, Direction, RecordError, Recorder, Recovered, RunEnd, RunLog, WireBytes,
};
use std::path::Path;

/// Writes a run the way a live one is written: everything in order of time.
fn write(run: &RunLog, path: &Path) {
    let mut recorder = Recorder::create(path, &run.info).unwrap();
    stream(run, &mut recorder);
    recorder.finish(&end(run)).unwrap();
}

fn end(run: &RunLog) -> RunEnd {
    RunEnd {
        link: run.link,
        peak_chamber_pa: run.peak_chamber_pa.clone(),
        contacts: run.contacts.clone(),
        wall_s: run.wall_s,
        targets: run.targets.clone(),
    }
}

fn stream(run: &RunLog, recorder: &mut Recorder) {
    let mut shapes = run.shapes.iter().peekable();
    let mut bodies = run.bodies.iter().peekable();
    let mut faults = run.faults.iter().peekable();
    for sample in &run.samples {
        recorder.sample(sample).unwrap();
        while let Some(shape) = shapes.next_if(|shape| shape.time_s <= sample.time_s) {
            recorder.shape(shape).unwrap();
        }
        while let Some(body) = bodies.next_if(|body| body.time_s <= sample.time_s) {
            recorder.body(body).unwrap();
        }
        while let Some(fault) = faults.next_if(|fault| fault.time_s <= sample.time_s) {
            recorder.fault(fault).unwrap();
        }
    }
}

#[test]
fn run_reads_back_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut run = crate::synthetic_run::run();
    // Values that a text format or an f32 would lose.
    run.samples[7].channels[2].pressure_pa = 0.1 + 0.2;
    run.samples[7].channels[3].true_pressure_pa = None;
    run.samples[8].modules[1].achieved = None;
    run.samples[9].tip_achieved_m = None;
    run.samples[10].tip_setpoint_m = [f64::MIN_POSITIVE, -0.0, f64::MAX];
    run.shapes[1].achieved = None;
    run.bodies[1].nearest = None;
    run.bodies[2].tip_unloaded_m = None;
    (run.info.feedback, run.info.corrections) = (Some(record::Observer::Imus), true);
    run.contacts = vec![record::ContactRecord {
        obstacle: "rim".into(),
        force_n: 0.1 + 0.2,
        time_s: 1.0,
        first_s: 0.5,
        carried: true,
    }];
    run.info.scene_name = "größe \"x\"".into();
    write(&run, &path);
    let read = record::read(&path).unwrap();
    // Piece by piece, so that a failure names the piece and not 2000 samples.
    assert_eq!(read.info, run.info);
    assert_eq!(read.samples.len(), run.samples.len());
    for (read, written) in read.samples.iter().zip(&run.samples) {
        assert_eq!(read, written);
    }
    assert_eq!(read.samples[10].tip_setpoint_m[1].to_bits(), (-0.0_f64).to_bits());
    assert_eq!(read.shapes, run.shapes);
    assert_eq!(read.bodies, run.bodies);
    assert_eq!((read.faults, read.link, read.wall_s), (run.faults, run.link, run.wall_s));
    assert_eq!(read.contacts, run.contacts);
    assert_eq!(read.incomplete, None);
}

#[test]
fn run_that_nobody_observed_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut run = crate::synthetic_run::run();
    run.samples.truncate(3);
    for sample in &mut run.samples {
        sample.tip_achieved_m = None;
        sample.channels.iter_mut().for_each(|channel| channel.true_pressure_pa = None);
        sample.modules.iter_mut().for_each(|module| module.achieved = None);
    }
    run.shapes.clear();
    run.bodies.clear();
    run.faults.clear();
    run.wall_s = None;
    write(&run, &path);
    assert_eq!(record::read(&path).unwrap(), run);
}

#[test]
fn equal_runs_give_equal_files() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = (folder.path().join("one.mcap"), folder.path().join("two.mcap"));
    let run = crate::synthetic_run::run();
    write(&run, &one);
    write(&run, &two);
    assert_eq!(std::fs::read(one).unwrap(), std::fs::read(two).unwrap());
}

#[test]
fn name_is_given_only_to_a_finished_log() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, "the log before").unwrap();
    let run = crate::synthetic_run::run();
    let mut recorder = Recorder::create(&path, &run.info).unwrap();
    stream(&run, &mut recorder);
    drop(recorder);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "the log before");

    let left = record::read(folder.path().join("run.mcap.partial")).unwrap();
    assert_eq!(left.samples, run.samples);
    assert_eq!(left.incomplete.as_deref(), Some("the run was not finished"));

    write(&run, &path);
    assert_eq!(record::read(&path).unwrap().incomplete, None);
    assert!(!folder.path().join("run.mcap.partial").exists());
}

#[test]
fn disk_is_at_most_half_a_second_behind_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let run = crate::synthetic_run::run();
    let mut recorder = Recorder::create(&path, &run.info).unwrap();
    for sample in &run.samples[..777] {
        recorder.sample(sample).unwrap();
    }
    // What another process would see now, as after a kill.
    let seen = record::read(folder.path().join("run.mcap.partial")).unwrap();
    let behind_s = run.samples[776].time_s - seen.samples.last().unwrap().time_s;
    assert!(behind_s <= 0.5, "{behind_s} s behind");
    assert_eq!(seen.samples, run.samples[..seen.samples.len()]);
    assert!(seen.incomplete.is_some());
}

/// Bytes of the link at 10 Hz for `count` tenths of a second, and a row of two ticks beside each.
fn link(count: u64) -> (Vec<WireBytes>, Vec<DeviceTick>) {
    let direction = |index| if index % 3 == 0 { Direction::ToDevice } else { Direction::ToHost };
    let wire = |index| WireBytes {
        host_us: 100_000 * index,
        direction: direction(index),
        bytes: (0..=255).take(index as usize % 257 + 1).collect(),
    };
    let tick = |index| DeviceTick {
        device_us: 100_000 * (index / 2) + 1_000 * (index % 2),
        codes: vec![410, index as u16, 3_000],
        valve_supply_code: 2_700 + index as u16,
        stop_pressed: false,
        supply_open: index % 5 > 0,
        pump_duty: index as u8,
        outputs: 1,
        pulses: (0..index as u8 % 3).map(|channel| CoilPulse { channel, fill_us: 0, vent_us: 300 }).collect(),
    };
    ((0..count).map(wire).collect(), (0..2 * count).map(tick).collect())
}

#[test]
fn bytes_of_the_link_and_ticks_come_back_and_are_on_the_disk_without_a_sample() {
    let folder = tempfile::tempdir().unwrap();
    let (path, partial) = (folder.path().join("run.mcap"), folder.path().join("run.mcap.partial"));
    let (wire, ticks) = link(30);
    let mut recorder = Recorder::create(&path, &crate::synthetic_run::info()).unwrap();
    for (index, wire) in wire.iter().enumerate() {
        recorder.wire(wire).unwrap();
        recorder.ticks(&ticks[2 * index..2 * index + 2], true).unwrap();
    }
    let seen = record::read_capture(&partial).unwrap();
    let behind_us = 2_900_000 - seen.wire.last().unwrap().host_us;
    assert!(behind_us <= 500_000, "{behind_us} us behind");
    recorder.finish(&RunEnd::default()).unwrap();
    assert_eq!(record::read_capture(&path).unwrap(), Capture { wire, ticks, at_pins: true, samples: Vec::new() });
    assert_eq!(record::read(&path).unwrap().samples, []);
}

/// What `recover` makes of a file.
fn recovered(bytes: &[u8]) -> (Recovered, RunLog) {
    let folder = tempfile::tempdir().unwrap();
    let (log, out) = (folder.path().join("cut.mcap"), folder.path().join("out.mcap"));
    std::fs::write(&log, bytes).unwrap();
    let recovered = record::recover(&log, &out).unwrap();
    (recovered, record::read(&out).unwrap())
}

#[test]
fn recovery_keeps_all_samples_but_the_last_of_a_log_cut_off_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let run = crate::synthetic_run::run();
    write(&run, &path);
    let whole = std::fs::read(&path).unwrap();
    let (_, finished) = recovered(&whole);
    assert_eq!((finished.samples == run.samples, finished.incomplete), (true, None));
    for cut in (whole.len() / 20..whole.len()).step_by(whole.len() / 37) {
        let (found, log) = recovered(&whole[..cut]);
        assert_eq!(log.samples, run.samples[..log.samples.len()], "cut at {cut}");
        // In the index behind the last record nothing of the run is lost.
        assert_eq!(log.incomplete.is_none(), found.was_finished, "cut at {cut}: {:?}", log.incomplete);
        assert!(found.chunks_damaged == 0 && (!found.was_finished || log.samples == run.samples), "{found:?}");
        // The reader without recovery has the closed chunks. All in the open one but its last sample is there too.
        std::fs::write(&path, &whole[..cut]).unwrap();
        let closed = record::read(&path).unwrap().samples.len();
        assert!(
            log.samples.len() >= closed && (found.unchecked > 0) == (log.samples.len() > closed),
            "cut at {cut}: {found:?}"
        );
        let share = log.samples.len() as f64 / run.samples.len() as f64;
        assert!((share - cut as f64 / whole.len() as f64).abs() < 0.02, "cut at {cut}: {share}");
    }
}

#[test]
fn recovery_leaves_a_damaged_chunk_out_and_keeps_those_behind_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let run = crate::synthetic_run::run();
    write(&run, &path);
    let mut bytes = std::fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    let (found, log) = recovered(&bytes);
    assert_eq!((found.chunks_damaged, found.was_finished), (1, true));
    let lost = run.samples.len() - log.samples.len();
    assert!((1..=50).contains(&lost), "{lost} samples lost");
    assert_eq!(log.samples.last(), run.samples.last());
    let kept = run.samples.iter().filter(|sample| log.samples.contains(sample)).count();
    assert_eq!(kept, log.samples.len());
    // Shapes and solids number their own messages: those of the whole chunks stay.
    for (found, all) in [(log.shapes.len(), run.shapes.len()), (log.bodies.len(), run.bodies.len())] {
        assert!(found < all && all - found <= 7, "{found} of {all}");
    }
}

#[test]
fn recovery_keeps_images_and_readings() {
    let folder = tempfile::tempdir().unwrap();
    let (path, out) = (folder.path().join("run.mcap"), folder.path().join("recovered.mcap"));
    let mut run = crate::synthetic_run::run();
    let base = record::Pose { position_m: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0] };
    run.info.limb = Some(record::DrawnLimb { base, links: Vec::new(), modules: vec!["elbow".into()] });
    let mut recorder = Recorder::create(&path, &run.info).unwrap();
    for sample in &run.samples[..200] {
        recorder.sample(sample).unwrap();
        recorder.image(sample.time_s, [1.0; 3]).unwrap();
        recorder.imu(sample.time_s, 0, base.rotation, [0.0; 3]).unwrap();
    }
    drop(recorder);
    record::recover(folder.path().join("run.mcap.partial"), &out).unwrap();
    let bytes = std::fs::read(out).unwrap();
    for topic in ["/softlimb/telemetry", "/softlimb/camera", "/softlimb/imu"] {
        let messages = mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap);
        assert_eq!(messages.filter(|message| message.channel.topic == topic).count(), 200, "{topic}");
    }
}

#[test]
fn recovery_refuses_what_is_no_log() {
    let folder = tempfile::tempdir().unwrap();
    let (log, out) = (folder.path().join("x"), folder.path().join("out.mcap"));
    assert!(matches!(record::recover(&log, &out), Err(RecordError::File { .. })));
    std::fs::write(&log, b"text").unwrap();
    assert!(matches!(record::recover(&log, &out), Err(RecordError::NotMcap { .. })));
    std::fs::write(&log, b"\x89MCAP0\r\n").unwrap();
    assert!(matches!(record::recover(&log, &out), Err(RecordError::NotARun { .. })));
    assert!(!out.exists());
}

#[test]
fn log_cut_off_anywhere_gives_its_beginning() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let run = crate::synthetic_run::run();
    write(&run, &path);
    let whole = std::fs::read(&path).unwrap();
    let mut longest = 0;
    for percent in (1..100).step_by(7) {
        std::fs::write(&path, &whole[..whole.len() * percent / 100]).unwrap();
        let read = record::read(&path).unwrap();
        assert!(read.incomplete.is_some(), "{percent} %");
        assert_eq!(read.samples, run.samples[..read.samples.len()], "{percent} %");
        assert!(read.samples.len() >= longest, "{percent} %");
        longest = read.samples.len();
    }
    assert!(longest > 1800, "only {longest} samples at 99 %");
}

#[test]
fn flipped_bits_are_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut run = crate::synthetic_run::run();
    run.samples.truncate(60);
    run.shapes.truncate(2);
    write(&run, &path);
    let whole = std::fs::read(&path).unwrap();
    for (place, bit) in (0..whole.len()).step_by(131).zip((0..8).cycle()) {
        let mut bytes = whole.clone();
        bytes[place] ^= 1 << bit;
        std::fs::write(&path, bytes).unwrap();
        if let Ok(read) = record::read(&path) {
            assert!(read.incomplete.is_some(), "bit {bit} of byte {place} of {}", whole.len());
            assert!(run.samples.starts_with(&read.samples), "bit {bit} of byte {place}");
        }
    }
}

#[test]
fn channels_that_no_device_has_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut info = crate::synthetic_run::info();
    info.modules[1].channels = 0..usize::MAX;
    let error = Recorder::create(folder.path().join("run.mcap"), &info).unwrap_err();
    assert!(error.to_string().contains("\"elbow\""), "{error}");
}

#[test]
fn flipped_bit_ends_the_log_there_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let run = crate::synthetic_run::run();
    write(&run, &path);
    let mut bytes = std::fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x10;
    std::fs::write(&path, bytes).unwrap();
    let read = record::read(&path).unwrap();
    assert!(read.incomplete.is_some());
    assert!((500..1500).contains(&read.samples.len()), "{} samples", read.samples.len());
    assert_eq!(read.samples, run.samples[..read.samples.len()]);
}

#[test]
fn malformed_logs_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.mcap");
    let missing = record::read(&path).unwrap_err();
    assert!(matches!(missing, RecordError::File { action: "read", .. }));
    assert!(missing.to_string().contains("x.mcap"));

    for content in [&b""[..], b"text", b"\x89MCAP1\r\n"] {
        std::fs::write(&path, content).unwrap();
        assert!(matches!(record::read(&path), Err(RecordError::NotMcap { .. })), "{content:?}");
    }

    // Magic and a header with empty profile and library: how any MCAP file begins.
    let foreign = [&b"\x89MCAP0\r\n"[..], &[1, 8, 0, 0, 0, 0, 0, 0, 0], &[0; 8]].concat();
    std::fs::write(&path, foreign).unwrap();
    assert!(matches!(record::read(&path), Err(RecordError::NotARun { .. })));
}

#[test]
fn folder_that_is_not_there_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("no/run.mcap");
    let error = Recorder::create(&path, &crate::synthetic_run::info()).unwrap_err().to_string();
    assert!(error.contains("cannot create") && error.contains("run.mcap.partial"), "{error}");
}

#[test]
fn sample_that_does_not_fit_the_run_is_refused_and_the_log_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let run = crate::synthetic_run::run();
    let mut recorder = Recorder::create(&path, &run.info).unwrap();
    let good = &run.samples[0];

    let mut bad = good.clone();
    bad.channels.pop();
    assert!(recorder.sample(&bad).unwrap_err().to_string().contains("8 channels, the run has 9"));
    let mut bad = good.clone();
    bad.modules.clear();
    assert!(recorder.sample(&bad).unwrap_err().to_string().contains("0 modules, the run has 3"));
    let bad = record::Sample { time_s: f64::NAN, ..good.clone() };
    assert!(recorder.sample(&bad).unwrap_err().to_string().contains("not finite"));

    recorder.sample(good).unwrap();
    recorder.finish(&RunEnd { wall_s: None, ..end(&run) }).unwrap();
    assert_eq!(record::read(&path).unwrap().samples, run.samples[..1]);
}
