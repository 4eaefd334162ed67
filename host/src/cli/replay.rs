//! `softlimb replay`: the controller run again on the inputs of a log.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::shared::{about, show};
use super::{Failure, Outcome};
use softlimb_rig::record::read_capture;
use softlimb_rig::replay;

/// Run the controller again on the inputs of a log, and compare its outputs bit for bit
#[derive(Args)]
#[command(
    after_help = "The log of a simulated or emulated device has the converter codes of each control tick: all coils and all messages are compared.\n\
                  So has that of a board or of `device serve` by `run --record-codes`, if the device was reset before. Without codes, answers,\n\
                  states, setpoint buffer, digital outputs and references are compared up to the end of the run. Exit code 3 tells of a\n\
                  difference, or of a log with missing ticks.\n\n\
                  Example: softlimb replay out/pick-and-place-a/run.mcap"
)]
pub(super) struct Replay {
    /// The recorded run (MCAP)
    log: PathBuf,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed {
    identical: bool,
    converter_codes: bool,
    from_start_of_run: bool,
    ticks: u64,
    ticks_compared: u64,
    messages_compared: u64,
    messages_missing: u64,
    frames_unanswered: u64,
    /// Of the device's clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    gap_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    difference: Option<Difference>,
}

#[derive(Serialize)]
struct Difference {
    /// After the start of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    time_s: Option<f64>,
    /// Of the device's clock.
    device_s: f64,
    at: String,
    expected: String,
    got: String,
}

impl Replay {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let capture = read_capture(&self.log).map_err(Failure::new)?;
        let result = replay::replay(&capture).map_err(|error| about(&self.log)(&error))?;
        let printed = Printed::of(&result);
        show(self.json, &printed, || printed.text())?;
        Ok(if printed.identical { Outcome::Done } else { Outcome::DoneWithWarnings })
    }
}

impl Printed {
    fn of(result: &replay::Replay) -> Self {
        let seconds = |us: u64| us as f64 * 1e-6;
        let difference = result.difference.as_ref().map(|difference| Difference {
            time_s: result.start_us.map(|start_us| seconds(difference.device_us) - seconds(start_us)),
            device_s: seconds(difference.device_us),
            at: difference.at.clone(),
            expected: difference.expected.clone(),
            got: difference.got.clone(),
        });
        Self {
            identical: difference.is_none() && result.gap_us.is_none(),
            converter_codes: result.is_exact,
            from_start_of_run: result.has_history,
            ticks: result.ticks,
            ticks_compared: result.ticks_compared,
            messages_compared: result.messages,
            messages_missing: result.messages_missing,
            frames_unanswered: result.frames_unanswered,
            gap_s: result.gap_us.map(seconds),
            difference,
        }
    }

    fn text(&self) -> String {
        let mut lines = vec![match self.converter_codes {
            true => format!(
                "{} ticks run again: coils of {} ticks and {} messages compared",
                self.ticks, self.ticks_compared, self.messages_compared
            ),
            false => format!(
                "{} ticks run again: {} messages compared, without what depends on converter codes, which the log does not have",
                self.ticks, self.messages_compared
            ),
        }];
        if self.from_start_of_run {
            lines
                .push("the device had a configuration before: the run alone is compared, from its start on; reset a device before a run to compare all of it".to_owned());
        }
        if self.messages_missing > 0 {
            lines.push(format!(
                "{} messages of the re-run are not in the log: lost, or left out",
                self.messages_missing
            ));
        }
        if let Some(gap_s) = self.gap_s {
            lines.push(format!("the log has no inputs of the tick at device time {gap_s:.3} s: compared until then"));
        }
        lines.push(match &self.difference {
            None => "no difference".to_owned(),
            Some(Difference { time_s, device_s, at, expected, got }) => {
                let of_run = time_s.map_or_else(String::new, |time_s| format!("{time_s:.3} s into the run, "));
                format!(
                    "first difference: {of_run}device time {device_s:.3} s, {at}\n  log     {expected}\n  re-run  {got}"
                )
            }
        });
        lines.join("\n")
    }
}
