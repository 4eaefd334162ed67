//! One case, from the plant of its seed to a verdict.

use softlimb_protocol::{DeviceState, FaultCode, SYSTEM_CHANNEL};
use softlimb_rig::link::{Event, StreamOptions, Transport, stream};

use super::bench::{CHANNELS, configuration, knots, settings};
use super::rows::{Deadline, Row};
use super::session::Session;
use super::trace::Trace;
use super::{EXCESS_PA, LIMIT_PA, PHASES};

/// Longest time after the session, us: of a device with a fault, and of one that vents and compares its zeros.
const FAULTED_US: u64 = 3_000_000;
const VENTED_US: u64 = 15_000_000;

/// Portion of it, us.
const PORTION_US: u64 = 100_000;

/// A row in one phase, on one channel, with one plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// The row.
    pub row: Row,
    /// Index into [`PHASES`].
    pub phase: usize,
    /// The channel.
    pub channel: usize,
    /// Seed of the plant.
    pub seed: u64,
}

/// Verdict on a case, the worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// A chamber got more than its limit and 12 kPa.
    Peak,
    /// A fault before there was one, or on another channel.
    False,
    /// A fault with another name.
    Misnamed,
    /// No report.
    Unnoticed,
    /// A report after the deadline.
    Late,
    /// All as it should be.
    Passed,
}

/// Outcome of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The verdict.
    pub verdict: Verdict,
    /// The first report: code, and time after the fault or after the start where that is later, s.
    pub told: Option<(FaultCode, f64)>,
    /// Time of the first effect on a true pressure, counted as that of the report, s.
    pub effect_s: Option<f64>,
    /// Whether a report was due. Without one, only a peak, a false or a wrong name fails the case.
    pub due: bool,
    /// Whether the report is in time where the deadline counts from the fault itself.
    pub prompt: bool,
    /// Highest true pressure of all chambers, Pa.
    pub peak_pa: f64,
}

impl Case {
    /// Name of the phase.
    #[must_use]
    pub fn phase_name(&self) -> &'static str {
        PHASES[self.phase].0
    }

    /// Runs the case beside the pressures of the sound plant of its seed.
    #[must_use]
    pub fn run(&self, sound: &Trace) -> Outcome {
        let mut session = Session::new(&settings(self.seed), self.row.faults, self.channel, PHASES[self.phase].1);
        let mut is_false = false;
        run(&mut session, |is_broken, channel| is_false |= !is_broken || !self.concerns(channel));
        let since_us = session.broken_us.max(session.start_us);
        let mut latched = session.latched.iter().filter(|(code, _)| *code != FaultCode::SetpointsExhausted);
        let told = latched.find_map(|(code, at_us)| Some((*code, (*at_us as f64 - since_us? as f64) * 1e-6)));
        let effect_us = since_us.and_then(|since_us| session.trace.departs_us(sound, since_us));
        let since_s = |time_us: Option<u64>| Some((time_us? as f64 - since_us? as f64) * 1e-6);
        let (effect_s, vented_s) = (since_s(effect_us), since_s(session.vented_us));
        let peak_pa = session.peak_pa();
        is_false |= session.broken_us.is_none();
        let verdict = |deadline_s: Option<f64>| self.verdict(told, deadline_s, peak_pa, is_false);
        // Once the device has vented, a report comes too late to help.
        let is_due = |deadline_s: &f64| told.is_some() || vented_s.is_none_or(|vented_s| *deadline_s < vented_s);
        let (deadline_s, prompt_s) = match self.row.deadline {
            Deadline::Fault(ms) => (Some(seconds(ms)), Some(seconds(ms))),
            Deadline::Effect(ms) => (effect_s.map(|effect_s| effect_s + seconds(ms)).filter(is_due), Some(seconds(ms))),
            Deadline::Zero => ((session.deviation_pa().abs() > ZERO_PA).then_some(f64::INFINITY), Some(DRIFT_S)),
            Deadline::Never => (None, None),
        };
        let prompt = verdict(prompt_s) == Verdict::Passed;
        Outcome { verdict: verdict(deadline_s), told, effect_s, due: deadline_s.is_some(), prompt, peak_pa }
    }

    /// Whether a fault of a channel may come of this case.
    fn concerns(&self, channel: u8) -> bool {
        let (own, told) = (self.channel, usize::from(channel));
        // Exchanged sensors concern the next channel too, and what belongs to no channel concerns all.
        let is_near = told == own || told == (own + 1) % CHANNELS && self.row.name == "sensors-swapped";
        channel == SYSTEM_CHANNEL || is_near || self.row.channels().len() == 1
    }

    /// Verdict with a deadline, s; without one no report is needed.
    fn verdict(
        &self,
        told: Option<(FaultCode, f64)>,
        deadline_s: Option<f64>,
        peak_pa: f64,
        is_false: bool,
    ) -> Verdict {
        match told {
            _ if peak_pa > LIMIT_PA + EXCESS_PA => Verdict::Peak,
            _ if is_false => Verdict::False,
            _ if self.row.deadline == Deadline::Never => Verdict::Passed,
            None if deadline_s.is_none() => Verdict::Passed,
            None => Verdict::Unnoticed,
            Some((code, _)) if !self.row.codes.contains(&code) => Verdict::Misnamed,
            Some((_, after_s)) if deadline_s.is_some_and(|deadline_s| after_s > deadline_s) => Verdict::Late,
            Some(_) => Verdict::Passed,
        }
    }
}

/// Deviation of a reading that the comparison with its zero has to find, Pa: 3 % of the sensors' range and their noise.
const ZERO_PA: f64 = 0.03 * 206_843.0 + 200.0;

/// Deadline of a drift where it counts from the fault itself, s.
const DRIFT_S: f64 = 5.0;

fn seconds(ms: u32) -> f64 {
    f64::from(ms) * 1e-3
}

/// Pressures of the sound plant of a seed.
#[must_use]
pub(super) fn sound(seed: u64) -> Trace {
    let mut session = Session::new(&settings(seed), &[], 0, 0.0);
    run(&mut session, |_, _| {});
    session.trace
}

/// A whole session. Each fault that the host hears of is handed on: whether a part was broken by then, and the channel.
fn run(session: &mut Session, mut fault: impl FnMut(bool, u8)) {
    // Most runs of the matrix do not end well: only what the device does is judged.
    let _ = stream(session, &configuration(), &knots(), &StreamOptions::new(7), |session, event| match event {
        Event::Armed { start_us, .. } => session.start_us = Some(start_us),
        Event::Fault { message, .. } => fault(session.broken_us.is_some(), message.channel),
        _ => {}
    });
    let from_us = session.now_us();
    let is_over = |session: &Session| match session.state() {
        DeviceState::Ready => true,
        DeviceState::Faulted => session.now_us() >= from_us + FAULTED_US,
        _ => session.now_us() >= from_us + VENTED_US,
    };
    while !is_over(session) {
        let portion_us = session.now_us() + PORTION_US;
        while session.now_us() < portion_us {
            session.wait_until(portion_us);
            // Bytes that nobody reads would end each wait.
            session.receive(&mut Vec::new()).expect("a simulated line");
        }
    }
}
