//! The log of a device: its starts, and the faults of each.

use std::fmt;

use softlimb_protocol::{BootCause, Code, HostMessage, LogCondition, LogKind, LogRecord, ReadLog, SYSTEM_CHANNEL};

use super::driver::Driver;
use super::error::LinkError;
use super::fault::DeviceFault;
use super::options::StreamOptions;
use super::transport::Transport;
use super::words::code_name;

/// Longest wait for a part of the log after its request was acknowledged, us: some turns of the device.
const PART_US: u64 = 100_000;

/// Requests of a part: its frame is long, and a bad line loses it often.
const ATTEMPTS: usize = 20;

/// The log of a device.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceLog {
    /// Whether the device stores records.
    pub condition: Code<LogCondition>,
    /// Records since the start that were not stored.
    pub unstored: u32,
    /// The stored records, oldest first.
    pub starts: Vec<LoggedStart>,
}

/// A start of the device, and its faults until the next one.
#[derive(Clone, Debug, PartialEq)]
pub struct LoggedStart {
    /// Number of the start, from 1.
    pub number: u32,
    /// Why the device started; `None` if that record is older than the log, or spoiled by a loss of power.
    pub cause: Option<StartCause>,
    /// Faults, oldest first.
    pub faults: Vec<DeviceFault>,
}

/// Why the device started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StartCause {
    /// The cause.
    pub cause: Code<BootCause>,
    /// Place at which the program stopped before, by the cause; 0 if that is unknown.
    pub detail: u32,
}

impl fmt::Display for StartCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&code_name(self.cause))?;
        match self.cause.known() {
            Some(BootCause::Panic) if self.detail > 0 => write!(f, " at line {}", self.detail),
            Some(BootCause::HardFault) if self.detail > 0 => write!(f, " at {:#010x}", self.detail),
            _ => Ok(()),
        }
    }
}

impl DeviceLog {
    const EMPTY: Self = Self { condition: Code::from_raw(LogCondition::Absent as u8), unstored: 0, starts: Vec::new() };

    /// Adds a record. A kind of a later version is passed over.
    fn add(&mut self, record: &LogRecord) {
        let Some(kind) = record.kind.known() else { return };
        let start = self.start(record.start);
        let LogRecord { code, channel, detail, time_us, .. } = *record;
        match kind {
            LogKind::Boot => start.cause = Some(StartCause { cause: Code::from_raw(code), detail }),
            LogKind::Fault => start.faults.push(DeviceFault {
                code: Code::from_raw(code),
                channel: (channel != SYSTEM_CHANNEL).then_some(channel),
                value: Some(detail as i32),
                time_us: Some(time_us),
            }),
        }
    }

    /// The start with this number: the last one, or a new one.
    fn start(&mut self, number: u32) -> &mut LoggedStart {
        if self.starts.last().is_none_or(|start| start.number != number) {
            self.starts.push(LoggedStart { number, cause: None, faults: Vec::new() });
        }
        let last = self.starts.len() - 1;
        &mut self.starts[last]
    }
}

/// Reads the log of a device; changes nothing on it.
///
/// # Errors
/// [`LinkError`]; [`LinkError::Occupied`] if another host commands the device, [`LinkError::Refused`] while the limb follows setpoints.
pub fn read_log<T: Transport>(transport: &mut T, options: &StreamOptions<'_>) -> Result<DeviceLog, LinkError> {
    let mut on_event = |_: &mut T, _| {};
    let mut driver = Driver::new(transport, options, &mut on_event);
    driver.hello()?;
    let (mut log, mut first, mut failed) = (DeviceLog::EMPTY, 0, 0);
    loop {
        driver.session.forget_log();
        driver.demand(&HostMessage::from(ReadLog { session: driver.session.id(), first }))?;
        driver.until(PART_US, |driver| driver.session.log_state().is_some())?;
        let records = driver.session.take_log_records();
        // A lost frame of records shows in their number.
        match driver.session.log_state().filter(|state| usize::from(state.records) == records.len()) {
            Some(state) if state.until == state.next || state.until > first => {
                records.iter().for_each(|record| log.add(record));
                (log.condition, log.unstored) = (state.condition, state.unstored);
                if state.until == state.next {
                    return Ok(log);
                }
                (first, failed) = (state.until, 0);
            }
            _ if failed < ATTEMPTS => failed += 1,
            _ => return Err(LinkError::NoAnswer { message: "ReadLog" }),
        }
    }
}

/// Whether records are stored, in words.
#[must_use]
pub fn condition_in_words(condition: Code<LogCondition>) -> String {
    match condition.known() {
        Some(LogCondition::Absent) => "the device has no memory for a log".to_owned(),
        Some(LogCondition::Kept) => "records are stored".to_owned(),
        Some(LogCondition::Full) => "the log is full until the next start".to_owned(),
        Some(LogCondition::Failed) => "records are not stored: the memory does not hold what is written".to_owned(),
        None => format!("unknown condition {}", condition.raw()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use softlimb_protocol::FaultCode;

    #[test]
    fn records_are_sorted_by_start() {
        let mut log = DeviceLog::EMPTY;
        let record = |number, start, kind, code, detail| LogRecord {
            number,
            start,
            kind: Code::from_raw(kind),
            code,
            channel: 3,
            detail,
            time_us: 2_000_000,
        };
        let over = FaultCode::OverPressure as u8;
        // A fault of a start whose record is gone; a hard fault; a kind of a later version; a fault; power; a fault of no known code.
        let all = [(4, 7, 2, over, 151_240), (5, 8, 1, 6, 0x0800_1234), (6, 9, 9, 0, 0), (7, 8, 2, over, 130_000)];
        for (number, start, kind, code, detail) in all {
            log.add(&record(number, start, kind, code, detail));
        }
        log.add(&record(9, 11, 1, 0, 0));
        log.add(&record(10, 11, 2, 200, u32::MAX));
        let starts: Vec<_> = log
            .starts
            .iter()
            .map(|start| (start.number, start.cause.map(|cause| cause.to_string()), start.faults.len()))
            .collect();
        let expected = [(7, None, 1), (8, Some("HardFault at 0x08001234".into()), 1), (11, Some("PowerOn".into()), 1)];
        assert_eq!(starts, expected);
        assert_eq!(log.starts[0].faults[0].to_string(), "over-pressure on channel 3 at 151.2 kPa");
        assert_eq!(log.starts[2].faults[0].value, Some(-1));
    }

    #[test]
    fn cause_names_its_place_if_that_is_known() {
        let text = |cause: BootCause, detail| StartCause { cause: cause.into(), detail }.to_string();
        assert_eq!(text(BootCause::Panic, 4711), "Panic at line 4711");
        assert_eq!(text(BootCause::Panic, 0), "Panic");
        assert_eq!(text(BootCause::PowerOn, 7), "PowerOn");
    }
}
