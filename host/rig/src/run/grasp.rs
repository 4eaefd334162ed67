//! The load of the simulated gripper: the tip carries the planned payload while the true jaws hold it.
//!
//! While the gripper takes or releases a payload, the payload stands on a support, and partly closed jaws carry it as planned. At all other
//! times only closed jaws hold it.

use crate::record::FaultRecord;
use softlimb_scene::{Gripper, Scene};

/// Channel number of faults of the whole system.
const SYSTEM: u8 = 0xFF;
/// Largest delay of the jaws behind the plan, in knots: the device switches at a knot, and a movement by hand starts between two knots.
const KNOTS_LATE: u64 = 2;

/// Hold of the jaws on a payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hold {
    Nothing,
    /// They close on it.
    Closing,
    Closed,
    /// The payload is lost, until the plan carries none.
    Lost,
}

/// A gripper and its load.
#[derive(Debug)]
pub(super) struct Grasp {
    late_us: u64,
    /// Time until which jaws may still close that the plan has closed from the start, us: a hand holds the payload until then.
    begun_us: u64,
    /// Planned mass at the last sample, kg, and time of its last change, us.
    planned_kg: f64,
    changed_us: u64,
    hold: Hold,
}

impl Grasp {
    /// The gripper of a scene before a run; `None` where no phase has a command for it, and payloads are fixed to the tip.
    pub(super) fn new(scene: &Scene) -> Option<Self> {
        let first = scene.phases().iter().find_map(|phase| phase.gripper)?;
        let late_us = KNOTS_LATE * u64::from(scene.controller().knot_period_us);
        let dwell_us = (1e6 * scene.gripper_time_s()).round() as u64;
        let (begun_us, hold) = match first {
            Gripper::Close => (0, Hold::Nothing),
            Gripper::Open => (dwell_us + late_us, Hold::Closing),
        };
        Some(Self { late_us, begun_us, planned_kg: 0.0, changed_us: 0, hold })
    }

    /// Mass at the tip, kg, and the loss of a payload, reported once. Arguments: time of the run, planned mass, position of the jaws (1 closed).
    pub(super) fn carried_kg(&mut self, time_us: u64, planned_kg: f64, closure: f64) -> (f64, Option<FaultRecord>) {
        if planned_kg != self.planned_kg {
            (self.planned_kg, self.changed_us) = (planned_kg, time_us);
        }
        if planned_kg == 0.0 {
            self.hold = Hold::Nothing;
            return (0.0, None);
        }
        let stands = time_us <= self.changed_us + self.late_us;
        let (hold, lost) = match self.hold {
            Hold::Closing if closure < 1.0 && time_us < self.begun_us => (Hold::Closing, None),
            Hold::Nothing | Hold::Closing | Hold::Closed if stands => (shared(closure), None),
            Hold::Closed | Hold::Closing if closure == 1.0 => (Hold::Closed, None),
            Hold::Closed => (Hold::Lost, Some((FaultRecord::DROPPED, "the gripper opens on the way and drops"))),
            Hold::Nothing | Hold::Closing => (
                Hold::Lost,
                Some((FaultRecord::LEFT_BEHIND, "the gripper is not closed as the limb goes on, and leaves behind")),
            ),
            Hold::Lost => (Hold::Lost, None),
        };
        self.hold = hold;
        let record = |(code, words)| FaultRecord {
            time_s: time_us as f64 * 1e-6,
            channel: SYSTEM,
            code,
            value: (1e3 * planned_kg).round() as i32,
            text: format!("{words} its payload of {planned_kg:.3} kg"),
        };
        let holds = matches!(hold, Hold::Closing | Hold::Closed);
        (if holds { planned_kg } else { 0.0 }, lost.map(record))
    }
}

/// Hold of the jaws on a supported payload.
fn shared(closure: f64) -> Hold {
    match closure {
        0.0 => Hold::Nothing,
        1.0 => Hold::Closed,
        _ => Hold::Closing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: [u8; 0] = [];

    /// A sample each 10 ms: planned mass, kg, closure, mass at the tip, kg.
    type Sample = (f64, f64, f64);

    fn codes(mut grasp: Grasp, samples: &[Sample]) -> Vec<u8> {
        let mut codes = Vec::new();
        for (index, (planned_kg, closure, known_kg)) in (0..).zip(samples) {
            let (kg, fault) = grasp.carried_kg(10_000 * index, *planned_kg, *closure);
            assert_eq!(kg, *known_kg, "sample {index}");
            codes.extend(fault.map(|fault| fault.code));
        }
        codes
    }

    fn opened() -> Grasp {
        Grasp { late_us: 20_000, begun_us: 0, planned_kg: 0.0, changed_us: 0, hold: Hold::Nothing }
    }

    #[test]
    fn load_is_taken_and_put_down_as_planned() {
        let samples = [
            (0.0, 0.0, 0.0),
            (0.0, 0.0, 0.0),
            (0.1, 0.5, 0.1),
            (0.2, 1.0, 0.2),
            (0.2, 1.0, 0.2),
            (0.2, 1.0, 0.2),
            (0.2, 1.0, 0.2),
            (0.2, 1.0, 0.2),
            (0.1, 0.5, 0.1),
            (0.0, 0.0, 0.0),
            (0.0, 0.0, 0.0),
        ];
        assert_eq!(codes(opened(), &samples), NONE);
    }

    #[test]
    fn load_stays_where_jaws_close_late_or_never() {
        let never = [(0.1, 0.0, 0.0), (0.2, 0.0, 0.0), (0.2, 0.0, 0.0), (0.2, 0.0, 0.0), (0.2, 0.0, 0.0)];
        assert_eq!(codes(opened(), &never), [FaultRecord::LEFT_BEHIND]);
        // They close after the limb has left, which brings nothing back.
        let late = [(0.2, 0.1, 0.2), (0.2, 0.4, 0.2), (0.2, 0.7, 0.2), (0.2, 0.9, 0.0), (0.2, 1.0, 0.0)];
        assert_eq!(codes(opened(), &late), [FaultRecord::LEFT_BEHIND]);
        // A delay within that of the knots is none.
        let soon = [(0.2, 0.1, 0.2), (0.2, 0.4, 0.2), (0.2, 0.7, 0.2), (0.2, 1.0, 0.2), (0.2, 1.0, 0.2)];
        assert_eq!(codes(opened(), &soon), NONE);
    }

    #[test]
    fn load_falls_where_jaws_open_on_the_way() {
        let taken = [(0.2, 1.0, 0.2), (0.2, 1.0, 0.2), (0.2, 1.0, 0.2), (0.2, 1.0, 0.2)];
        let falls = [(0.2, 0.9, 0.0), (0.2, 0.0, 0.0), (0.2, 1.0, 0.0), (0.0, 1.0, 0.0), (0.3, 1.0, 0.3)];
        assert_eq!(codes(opened(), &[taken.as_slice(), &falls].concat()), [FaultRecord::DROPPED]);
    }

    #[test]
    fn load_of_the_start_is_held_until_the_jaws_have_closed() {
        let start = || Grasp { begun_us: 30_000, hold: Hold::Closing, ..opened() };
        let closes = [(0.2, 0.0, 0.2), (0.2, 0.5, 0.2), (0.2, 0.9, 0.2), (0.2, 1.0, 0.2), (0.2, 1.0, 0.2)];
        assert_eq!(codes(start(), &closes), NONE);
        let fails = [(0.2, 0.0, 0.2), (0.2, 0.0, 0.2), (0.2, 0.0, 0.2), (0.2, 0.0, 0.0), (0.2, 0.0, 0.0)];
        assert_eq!(codes(start(), &fails), [FaultRecord::LEFT_BEHIND]);
    }
}
