//! A device step by step, healthy and with every fault that the simulated plant can have.

use softlimb_rig::link::{Step, StepKind, StreamOptions, Verdict, commission};
use softlimb_sim::SimSettings;
use softlimb_sim::plant::{PartFault, Spread, Supply};

use crate::link_common::{SESSION, configuration, device, settings};

/// Commissions two channels, of which the second may be broken. Asserts that each step was reported when it ended.
fn commissioned(settings: &SimSettings, fault: Option<PartFault>) -> Vec<Step> {
    let mut mcu = device(settings);
    fault.into_iter().for_each(|fault| mcu.inject(1, fault).unwrap());
    let mut told = Vec::new();
    let steps =
        commission(&mut mcu, &configuration(2), &StreamOptions::new(SESSION), &mut |step| told.push(step.clone()));
    assert_eq!(told, steps);
    for step in &steps {
        println!("{} {:?}: {}, {}", step.kind, step.channel, step.verdict, step.finding);
        assert_eq!(step.advice().is_some(), step.verdict == Verdict::Failed);
    }
    steps
}

/// The steps that failed, and whether every step of channel 0 passed.
fn failures(steps: &[Step]) -> (Vec<(StepKind, Option<u8>)>, bool) {
    let failed = steps.iter().filter(|step| step.verdict == Verdict::Failed).map(|step| (step.kind, step.channel));
    let of_first = |step: &&Step| step.channel == Some(0);
    (failed.collect(), steps.iter().filter(of_first).all(|step| step.verdict == Verdict::Passed))
}

#[track_caller]
fn finds(fault: PartFault, step: StepKind, words: &str) -> (Vec<(StepKind, Option<u8>)>, bool) {
    let steps = commissioned(&settings(2), Some(fault));
    let found = steps.iter().find(|found| (found.kind, found.channel) == (step, Some(1))).unwrap();
    assert!(found.verdict == Verdict::Failed && found.finding.contains(words), "{found:?}");
    failures(&steps)
}

#[test]
fn healthy_device_passes_every_step() {
    let steps = commissioned(&settings(2), None);
    // Link, configuration, two sensors, supply, two closed channels, three steps for each, and the end.
    assert_eq!(steps.len(), 14);
    assert!(steps.iter().all(|step| step.verdict == Verdict::Passed), "{steps:?}");
}

#[test]
fn channel_takes_ten_seconds_and_two_hundred_millilitres_of_air() {
    let spent = |channels| {
        let mut mcu = device(&settings(channels));
        let options = StreamOptions::new(SESSION);
        let steps = commission(&mut mcu, &configuration(channels), &options, &mut |_| ());
        assert!(steps.iter().all(|step| step.verdict == Verdict::Passed), "{steps:?}");
        // At the density of ISO 8778.
        let air_ml = mcu.truth().channels.iter().map(|channel| channel.air_used_kg / 1.185 * 1e6).fold(0.0, f64::max);
        (mcu.now_us() as f64 * 1e-6, air_ml)
    };
    let ((one_s, _), (two_s, air_ml)) = (spent(1), spent(2));
    println!("{:.1} s and at most {air_ml:.0} mL for each channel", two_s - one_s);
    assert!(two_s - one_s <= 10.0 && air_ml <= 200.0, "{one_s} s, {two_s} s, {air_ml} mL");
}

#[test]
fn dead_sensor_is_named_and_nothing_is_filled() {
    let (failed, _) = finds(PartFault::SensorOpen, StepKind::Sensor, "implausible");
    assert_eq!(failed, [(StepKind::Sensor, Some(1))]);
}

#[test]
fn fill_valve_that_stays_open_is_found_before_anything_is_filled() {
    let (failed, _) = finds(PartFault::FillStuckOpen, StepKind::Closed, "over-pressure");
    assert!(!failed.iter().any(|(kind, _)| *kind == StepKind::Fill), "{failed:?}");
}

#[test]
fn vent_valve_that_stays_open_lets_the_air_escape() {
    let (failed, first_passed) = finds(PartFault::VentStuckOpen, StepKind::Fill, "the air escapes");
    assert_eq!((failed, first_passed), (vec![(StepKind::Fill, Some(1))], true));
}

#[test]
fn valves_that_stay_closed_and_exchanged_plugs_are_found() {
    let (failed, first_passed) = finds(PartFault::FillStuckClosed, StepKind::Fill, "");
    assert_eq!((failed, first_passed), (vec![(StepKind::Fill, Some(1))], true));
    let (failed, first_passed) = finds(PartFault::VentStuckClosed, StepKind::Vent, "");
    assert_eq!((failed, first_passed), (vec![(StepKind::Vent, Some(1)), (StepKind::Down, None)], true));
    let (failed, first_passed) = finds(PartFault::CoilsSwapped, StepKind::Fill, "the coils are exchanged");
    assert_eq!((failed, first_passed), (vec![(StepKind::Fill, Some(1))], true));
    let (failed, _) = finds(PartFault::SensorsSwapped, StepKind::Fill, "channel 0 rises");
    assert_eq!(failed, [(StepKind::Fill, Some(0)), (StepKind::Fill, Some(1))], "and no chamber bursts meanwhile");
}

/// Flow beside the modelled one and its uncertainty in percent, from the finding of a step.
fn flow(steps: &[Step], kind: StepKind) -> (f64, f64) {
    let finding = &steps.iter().find(|step| (step.kind, step.channel) == (kind, Some(0))).unwrap().finding;
    let told = finding.strip_suffix(" % of the modelled flow").and_then(|text| text.rsplit_once(": ")).unwrap().1;
    let (share, uncertainty) = told.split_once(" +- ").unwrap();
    (share.parse().unwrap(), uncertainty.parse().unwrap())
}

#[test]
fn flow_of_either_valve_is_told_beside_the_modelled_one() {
    // Valve and line in series, as ISO 6358 has it.
    let path = |valve: f64| valve * 3.78 / valve.hypot(3.78);
    for (valve, delay_us) in [(1.44, 0.0), (0.9, 0.0), (2.2, 0.0), (1.44, 700.0)] {
        let mut settings = settings(2);
        settings.plant.spread = Spread::NONE;
        for channel in &mut settings.plant.channels {
            channel.valve.conductance_m3_per_s_pa = valve * 1e-9;
            channel.valve.on_delay_us += delay_us;
        }
        let steps = commissioned(&settings, None);
        let expected = 100.0 * path(valve) / path(1.44);
        for kind in [StepKind::Fill, StepKind::Vent] {
            let (share, uncertainty) = flow(&steps, kind);
            // The air is still a little colder than the wall when the pressure is read.
            let allowed = uncertainty + 0.03 * expected;
            assert!((share - expected).abs() <= allowed, "{kind}: {share} +- {uncertainty}, {expected}");
            assert!(uncertainty <= 40.0, "{kind}: {uncertainty}");
        }
    }
}

#[test]
fn kinked_hose_is_found_by_the_flow_of_the_vent() {
    // Short pulses fill the hose up to the kink, and the air passes it afterwards: the fill valve shows nothing of it.
    for share in [0.1, 0.02] {
        let (failed, first_passed) = finds(PartFault::HoseKinked { share }, StepKind::Vent, "of the modelled flow");
        assert_eq!((failed, first_passed), (vec![(StepKind::Vent, Some(1))], true));
    }
}

#[test]
fn leak_is_found_by_its_rate_or_by_a_fill_that_does_not_last() {
    let leak = |conductance_m3_per_s_pa| PartFault::Leak { conductance_m3_per_s_pa };
    let (failed, first_passed) = finds(leak(2e-11), StepKind::Leak, "kPa/s");
    assert_eq!((failed, first_passed), (vec![(StepKind::Leak, Some(1))], true));
    let (failed, first_passed) = finds(leak(1e-8), StepKind::Fill, "");
    assert_eq!((failed, first_passed), (vec![(StepKind::Fill, Some(1))], true));
}

#[test]
fn missing_supply_is_found_and_nothing_is_filled() {
    let mut low = settings(2);
    low.plant.supply = Supply::Regulated { pressure_pa: 50e3 };
    let steps = commissioned(&low, None);
    assert_eq!(failures(&steps).0, [(StepKind::Supply, None)]);
    let left_out = steps.iter().filter(|step| step.verdict == Verdict::LeftOut).count();
    assert_eq!(left_out, 8, "closed, fill, leak and vent of two channels");
}

#[test]
fn device_that_does_not_answer_fails_the_first_step() {
    let cut = SimSettings { line_faults: softlimb_sim::LineFaults::CUT, ..settings(2) };
    let steps = commissioned(&cut, None);
    assert_eq!(failures(&steps).0, [(StepKind::Link, None)]);
    assert!(steps[0].finding.contains("no answer to Hello"), "{:?}", steps[0]);
}
