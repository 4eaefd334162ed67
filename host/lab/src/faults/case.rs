//! One case, from the plant of its seed to a verdict.

use softlimb_protocol::{FaultCode, SYSTEM_CHANNEL};
use softlimb_rig::link::{Event, StreamOptions, Transport, stream};

use super::bench::{CHANNELS, configuration, knots, settings};
use super::rows::Row;
use super::session::Session;
use super::{EXCESS_PA, LIMIT_PA, PHASES};

/// Time after the session in which the device acts by itself, us.
const AFTERMATH_US: u64 = 3_000_000;

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
    /// Highest true pressure of all chambers, Pa.
    pub peak_pa: f64,
}

impl Case {
    /// Name of the phase.
    #[must_use]
    pub fn phase_name(&self) -> &'static str {
        PHASES[self.phase].0
    }

    /// Runs the case.
    #[must_use]
    pub fn run(&self) -> Outcome {
        let mut session = Session::new(&settings(self.seed), self.row.faults, self.channel, PHASES[self.phase].1);
        let mut is_false = false;
        let (configuration, knots) = (configuration(), knots());
        // Most runs of the matrix do not end well: only what the device does is judged.
        let _ = stream(&mut session, &configuration, &knots, &StreamOptions::new(7), |session, event| match event {
            Event::Armed { start_us, .. } => session.start_us = Some(start_us),
            Event::Fault { message, .. } => is_false |= session.broken_us.is_none() || !self.concerns(message.channel),
            _ => {}
        });
        let end_us = session.now_us() + AFTERMATH_US;
        while session.now_us() < end_us {
            session.wait_until(end_us);
            // Bytes that nobody reads would end each wait.
            session.receive(&mut Vec::new()).expect("a simulated line");
        }
        let since_us = session.broken_us.max(session.start_us);
        let mut latched = session.latched.iter().filter(|(code, _)| *code != FaultCode::SetpointsExhausted);
        let told = latched.find_map(|(code, at_us)| Some((*code, (*at_us as f64 - since_us? as f64) * 1e-6)));
        let peak_pa = session.peak_pa();
        is_false |= session.broken_us.is_none();
        Outcome { verdict: self.verdict(told, peak_pa, is_false), told, peak_pa }
    }

    /// Whether a fault of a channel may come of this case.
    fn concerns(&self, channel: u8) -> bool {
        let (own, told) = (self.channel, usize::from(channel));
        // Exchanged sensors concern the next channel too, and what belongs to no channel concerns all.
        let is_near = told == own || told == (own + 1) % CHANNELS && self.row.name == "sensors-swapped";
        channel == SYSTEM_CHANNEL || is_near || self.row.channels().len() == 1
    }

    fn verdict(&self, told: Option<(FaultCode, f64)>, peak_pa: f64, is_false: bool) -> Verdict {
        let deadline_s = f64::from(self.row.deadline_ms) * 1e-3;
        match told {
            _ if peak_pa > LIMIT_PA + EXCESS_PA => Verdict::Peak,
            _ if is_false => Verdict::False,
            _ if self.row.codes.is_empty() => Verdict::Passed,
            None => Verdict::Unnoticed,
            Some((code, _)) if !self.row.codes.contains(&code) => Verdict::Misnamed,
            Some((_, after_s)) if after_s > deadline_s => Verdict::Late,
            Some(_) => Verdict::Passed,
        }
    }
}
