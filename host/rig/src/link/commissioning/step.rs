//! Steps of commissioning, their verdicts, and advice.

use std::fmt;

/// Kind of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepKind {
    /// The device answers, has started as it should, and is at rest.
    Link,
    /// It takes the configuration.
    Configuration,
    /// A sensor reads an empty chamber.
    Sensor,
    /// The device is ready.
    Ready,
    /// The supply is within its limits.
    Supply,
    /// A chamber keeps its pressure while all valves are closed.
    Closed,
    /// The fill valve raises the pressure of its chamber, and of no other, about as fast as modelled.
    Fill,
    /// The chamber holds the pressure.
    Leak,
    /// The vent valve lets it out, about as fast as modelled.
    Vent,
    /// All pressures are down.
    Down,
}

/// Outcome of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The step passed.
    Passed,
    /// The step failed.
    Failed,
    /// Not taken, because an earlier step failed.
    LeftOut,
}

/// A step with its outcome.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// Its kind.
    pub kind: StepKind,
    /// The channel, from 0; `None` for the system.
    pub channel: Option<u8>,
    /// Its outcome.
    pub verdict: Verdict,
    /// The measurement, or the error.
    pub finding: String,
}

/// Verdict and measurement of a step.
pub(super) type Finding = (Verdict, String);

pub(super) fn passed(text: String) -> Finding {
    (Verdict::Passed, text)
}

pub(super) fn failed(text: String) -> Finding {
    (Verdict::Failed, text)
}

/// Every step for a number of channels, in order.
pub(super) fn all(channels: usize) -> impl Iterator<Item = (StepKind, Option<u8>)> {
    use StepKind::{Closed, Configuration, Down, Fill, Leak, Link, Sensor, Supply, Vent};
    let each = move |kind| (0..channels as u8).map(move |channel| (kind, Some(channel)));
    let valves = (0..channels as u8).flat_map(|channel| [Fill, Leak, Vent].map(|kind| (kind, Some(channel))));
    [(Link, None), (Configuration, None)]
        .into_iter()
        .chain(each(Sensor))
        .chain([(Supply, None)])
        .chain(each(Closed))
        .chain(valves)
        .chain([(Down, None)])
}

impl Step {
    pub(super) fn new(kind: StepKind, channel: Option<u8>, (verdict, finding): Finding) -> Self {
        Self { kind, channel, verdict, finding }
    }

    pub(super) fn left_out(kind: StepKind, channel: Option<u8>) -> Self {
        Self::new(kind, channel, (Verdict::LeftOut, "left out: an earlier step failed".to_owned()))
    }

    /// Places to look at when the step fails.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        (self.verdict == Verdict::Failed).then(|| self.kind.advice())
    }
}

impl StepKind {
    fn advice(self) -> &'static str {
        match self {
            Self::Link => {
                "cable, power and baud; vent a device under pressure, clear a fault (`softlimb device vent`, `clear`); a start by watchdog, \
                 panic or brown-out has a cause in program or power supply"
            }
            Self::Configuration => "the scene's limits and the number of channels of the device",
            Self::Sensor => {
                "plug, wire and supply voltage of the sensor; the board's input; air left in the chamber; a fill valve that does not close"
            }
            Self::Ready => "the emergency stop and its wire",
            Self::Supply => "pump, regulator, supply valve and hoses; the sensor of the supply; `supply` of the scene",
            Self::Closed => {
                "a fill valve that does not close: dirt in its seat, exchanged ports, a driver that stays on"
            }
            Self::Fill => {
                "coil and driver of the fill valve; the hose to the chamber; a vent valve that stays open; exchanged hoses \
                 or plugs; `plant.valve`, `plant.line` and the actuators of the scene"
            }
            Self::Leak => "fittings, hose and actuator in soapy water; the seats of both valves",
            Self::Vent => {
                "coil and driver of the vent valve; a blocked outlet; a kinked hose to the chamber; `plant.valve` and `plant.line` of the scene"
            }
            Self::Down => "vent valves; disconnect the supply and open a hose before you touch the limb",
        }
    }
}

impl fmt::Display for StepKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Link => "link",
            Self::Configuration => "configuration",
            Self::Sensor => "sensor",
            Self::Ready => "ready",
            Self::Supply => "supply",
            Self::Closed => "valves closed",
            Self::Fill => "fill valve",
            Self::Leak => "leak",
            Self::Vent => "vent valve",
            Self::Down => "pressures down",
        })
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Passed => "passed",
            Self::Failed => "failed",
            Self::LeftOut => "left out",
        })
    }
}
