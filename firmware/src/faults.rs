//! Latched faults: their effect on the valves, and the reports that are still due.

use heapless::Deque;
use softlimb_protocol::{FaultCode, SYSTEM_CHANNEL};

/// Number of codes: as many as the fault bits have.
const CODES: usize = 16;

/// Faults that wait for their report.
const PENDING: usize = 32;

/// Which vents a fault opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VentScope {
    /// None: the pressure is kept until the hold time has passed.
    Nothing,
    /// That of the channel concerned.
    Channel,
    /// All.
    All,
}

/// Effect of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reaction {
    /// The device enters the faulted state.
    pub latches: bool,
    /// The supply valve closes and the pump stops.
    pub cuts_supply: bool,
    /// Vents that open at once.
    pub vents: VentScope,
}

/// The reaction to each fault. Dropping the pressure drops the payload: while the program runs, only danger of bursting and the emergency
/// stop do it.
pub const fn reaction(code: FaultCode) -> Reaction {
    let (latches, cuts_supply, vents) = match code {
        FaultCode::EmergencyStop => (true, true, VentScope::All),
        FaultCode::OverPressure => (true, true, VentScope::Channel),
        // A chamber whose valves or reading deceive must not be filled by any of them. Valves without voltage deceive, too.
        FaultCode::SupplyHigh
        | FaultCode::SensorFrozen
        | FaultCode::ReadingJumped
        | FaultCode::FillWithoutEffect
        | FaultCode::ExcessAir
        | FaultCode::MissingAir
        | FaultCode::ValveSupplyLow => (true, true, VentScope::Nothing),
        FaultCode::SensorImplausible | FaultCode::SupplyLow | FaultCode::InverseFailed | FaultCode::TickOverrun => {
            (true, false, VentScope::Nothing)
        }
        FaultCode::LinkLost | FaultCode::SetpointsExhausted => (false, false, VentScope::Nothing),
    };
    Reaction { latches, cuts_supply, vents }
}

/// One occurrence of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occurrence {
    /// Device time, us.
    pub time_us: u64,
    /// Code of the fault.
    pub code: FaultCode,
    /// Channel, or [`SYSTEM_CHANNEL`].
    pub channel: u8,
    /// The offending value: Pa, us or a count, by the code.
    pub value: i32,
}

/// The latched faults.
#[derive(Clone, Debug)]
pub struct Faults {
    bits: u16,
    cuts_supply: bool,
    /// One word a code; the codes begin at 1.
    seen: [u32; CODES + 1],
    pending: Deque<Occurrence, PENDING>,
}

impl Faults {
    /// No fault.
    pub const fn new() -> Self {
        Self { bits: 0, cuts_supply: false, seen: [0; CODES + 1], pending: Deque::new() }
    }

    /// Latches an occurrence; true if it is the first of its code and channel. Beyond 32 unreported ones an occurrence is latched but not reported.
    pub fn raise(&mut self, occurrence: Occurrence) -> bool {
        let channel_bit = 1 << occurrence.channel.min(31);
        let Some(seen) = self.seen.get_mut(usize::from(occurrence.code as u8)) else {
            return false;
        };
        if *seen & channel_bit != 0 {
            return false;
        }
        *seen |= channel_bit;
        self.bits |= occurrence.code.bit();
        self.cuts_supply |= reaction(occurrence.code).cuts_supply;
        // A full list loses only the message: the bit is latched.
        let _ = self.pending.push_back(occurrence);
        true
    }

    /// Bit `code - 1` for each latched fault, as in Telemetry.
    pub fn bits(&self) -> u16 {
        self.bits
    }

    /// Whether a fault is latched.
    pub fn contains(&self, code: FaultCode) -> bool {
        self.bits & code.bit() != 0
    }

    /// Whether a latched fault keeps the supply cut off.
    pub fn cuts_supply(&self) -> bool {
        self.cuts_supply
    }

    /// A latched fault that forbids starting, if any: all but an empty buffer.
    pub fn blocks_start(&self) -> Option<FaultCode> {
        BLOCKING.into_iter().find(|&code| self.contains(code))
    }

    /// The unreported occurrences of a time.
    pub(crate) fn untold_of(&self, time_us: u64) -> impl Iterator<Item = &Occurrence> {
        self.pending.iter().filter(move |occurrence| occurrence.time_us == time_us)
    }

    /// The oldest unreported occurrence.
    pub fn untold(&self) -> Option<&Occurrence> {
        self.pending.front()
    }

    /// Marks the oldest unreported occurrence as reported.
    pub fn mark_reported(&mut self) {
        self.pending.pop_front();
    }

    /// Clears all latched faults; unreported occurrences are still reported.
    pub fn clear(&mut self) {
        self.bits = 0;
        self.cuts_supply = false;
        self.seen = [0; CODES + 1];
    }

    /// Forgets one code.
    pub fn forget(&mut self, code: FaultCode) {
        self.bits &= !code.bit();
        if let Some(seen) = self.seen.get_mut(usize::from(code as u8)) {
            *seen = 0;
        }
    }
}

impl Default for Faults {
    fn default() -> Self {
        Self::new()
    }
}

const BLOCKING: [FaultCode; 14] = [
    FaultCode::EmergencyStop,
    FaultCode::OverPressure,
    FaultCode::SensorImplausible,
    FaultCode::SupplyHigh,
    FaultCode::SupplyLow,
    FaultCode::InverseFailed,
    FaultCode::TickOverrun,
    FaultCode::LinkLost,
    FaultCode::SensorFrozen,
    FaultCode::ReadingJumped,
    FaultCode::FillWithoutEffect,
    FaultCode::ExcessAir,
    FaultCode::MissingAir,
    FaultCode::ValveSupplyLow,
];

impl Occurrence {
    /// A fault of no single channel.
    pub fn system(time_us: u64, code: FaultCode, value: i32) -> Self {
        Self { time_us, code, channel: SYSTEM_CHANNEL, value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn occurrence_is_told_once_per_channel_and_latched_until_cleared() {
        let mut faults = Faults::new();
        let over = |channel| Occurrence { time_us: 5, code: FaultCode::OverPressure, channel, value: 151_000 };
        assert!(faults.raise(over(3)));
        assert!(!faults.raise(over(3)));
        assert!(faults.raise(over(4)));
        assert_eq!(faults.bits(), 0b10);
        assert!(faults.cuts_supply());
        assert_eq!(faults.untold(), Some(&over(3)));
        faults.mark_reported();
        faults.mark_reported();
        assert_eq!(faults.untold(), None);
        faults.clear();
        assert_eq!((faults.bits(), faults.cuts_supply()), (0, false));
        assert!(faults.raise(over(3)), "a new occurrence after clearing is told again");
    }

    #[test]
    fn empty_buffer_does_not_block_a_start_but_a_lost_link_does() {
        let mut faults = Faults::new();
        faults.raise(Occurrence::system(0, FaultCode::SetpointsExhausted, 0));
        assert_eq!(faults.blocks_start(), None);
        faults.raise(Occurrence::system(0, FaultCode::LinkLost, 0));
        assert_eq!(faults.blocks_start(), Some(FaultCode::LinkLost));
        faults.forget(FaultCode::LinkLost);
        assert_eq!(faults.blocks_start(), None);
        assert!(faults.contains(FaultCode::SetpointsExhausted));
    }

    #[test]
    fn more_occurrences_than_places_are_latched_all_the_same() {
        let mut faults = Faults::new();
        for channel in 0..27 {
            for code in [FaultCode::SensorImplausible, FaultCode::OverPressure] {
                faults.raise(Occurrence { time_us: 0, code, channel, value: 0 });
            }
        }
        assert_eq!(faults.bits(), 0b11);
        let mut told = 0;
        while faults.untold().is_some() {
            faults.mark_reported();
            told += 1;
        }
        assert_eq!(told, PENDING);
    }
}
