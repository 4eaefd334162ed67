//! The states of the device and every way from one to another, as one table.

use softlimb_protocol::DeviceState;
use softlimb_protocol::DeviceState::{Faulted, Holding, Idle, Ready, Running, Venting};

/// Events that can change the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// Configured, all sensors plausible, zeros taken.
    SensorsReady,
    /// A new configuration is in force.
    Reconfigured,
    /// The start time of an accepted start has come.
    Start,
    /// Commanded, or the setpoints ran out.
    Hold,
    /// Commanded, or the reaction to a lost link.
    Vent,
    /// Venting has emptied the chambers.
    Vented,
    /// A fault that latches.
    Fault,
    /// The latched faults were cleared.
    Clear,
    /// The zeros are taken anew.
    Zero,
    /// A chamber is filled by hand.
    Fill,
}

/// Every transition; there are no others.
pub const TRANSITIONS: &[(DeviceState, Event, DeviceState)] = &[
    (Idle, Event::SensorsReady, Ready),
    (Idle, Event::Vent, Venting),
    (Idle, Event::Fault, Faulted),
    (Ready, Event::Reconfigured, Idle),
    (Ready, Event::Zero, Idle),
    (Ready, Event::Start, Running),
    (Ready, Event::Fill, Holding),
    (Ready, Event::Vent, Venting),
    (Ready, Event::Fault, Faulted),
    (Running, Event::Hold, Holding),
    (Running, Event::Vent, Venting),
    (Running, Event::Fault, Faulted),
    (Holding, Event::Start, Running),
    (Holding, Event::Vent, Venting),
    (Holding, Event::Fault, Faulted),
    (Venting, Event::Hold, Holding),
    (Venting, Event::Vented, Idle),
    (Venting, Event::Fault, Faulted),
    (Faulted, Event::Clear, Idle),
];

/// The state after `event`, or `None` where the event means nothing.
pub fn next(state: DeviceState, event: Event) -> Option<DeviceState> {
    TRANSITIONS.iter().find(|&&(from, by, _)| from == state && by == event).map(|&(_, _, to)| to)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATES: [DeviceState; 6] = [Idle, Ready, Running, Holding, Venting, Faulted];

    #[test]
    fn only_start_sets_the_limb_in_motion() {
        for state in STATES {
            for &(from, event, to) in TRANSITIONS.iter().filter(|&&(_, _, to)| to == Running) {
                assert_eq!((event, to), (Event::Start, Running));
                assert!(from == Ready || from == Holding);
            }
            assert!(state == Ready || state == Holding || next(state, Event::Start).is_none());
        }
    }

    #[test]
    fn every_state_but_faulted_can_fault_and_only_clearing_leaves_it() {
        for state in STATES {
            assert_eq!(next(state, Event::Fault).is_some(), state != Faulted);
        }
        let ways_out: Vec<_> = TRANSITIONS.iter().filter(|t| t.0 == Faulted).collect();
        assert_eq!(ways_out, [&(Faulted, Event::Clear, Idle)]);
    }

    #[test]
    fn events_have_one_outcome() {
        for (i, a) in TRANSITIONS.iter().enumerate() {
            assert!(TRANSITIONS.iter().skip(i + 1).all(|b| (a.0, a.1) != (b.0, b.1)), "{a:?}");
        }
    }
}
