//! A simulated device in real time behind a port, for programs that only know the protocol.

use std::io;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use softlimb_protocol::{Code, Decoder, DeviceMessage, DeviceState};
use softlimb_sim::{EmulatorError, Processor, SimulatedMcu};

use super::client::ClientPort;
use crate::link::DeviceFault;

/// Time that a slow computer may lag behind before the device's clock stands still for the rest.
const LAG_MAX_US: u64 = 250_000;
/// Longest pause between two looks at the port, us; as long as the device's tick.
const PAUSE_US: u64 = 1_000;
/// Longest time that a device that has fallen behind makes up between two looks at the port, us.
const STRIDE_US: u64 = 5_000;
/// Time between two reports of a computer that is too slow.
const REPORT: Duration = Duration::from_secs(10);

/// News of a served device.
#[derive(Clone, Debug, PartialEq)]
pub enum Served {
    /// A client has connected.
    Connected(SocketAddr),
    /// The device has accepted the session of a client, which commands it from now on.
    Commands(SocketAddr),
    /// A client was disconnected.
    Left {
        /// The client.
        client: SocketAddr,
        /// Why.
        why: Leave,
    },
    /// The device says that it is in another state.
    State(Code<DeviceState>),
    /// The device reports a fault.
    Fault(DeviceFault),
    /// This computer is too slow for real time: the device's clock has stood still for so long since the last report, us.
    Lag(u64),
}

/// End of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leave {
    /// The client has closed it, or it has failed.
    Closed,
    /// The client has taken no bytes for so long: it died without closing.
    TookNothing(Duration),
    /// All places were taken, and this client had been silent the longest.
    MadeRoom,
}

/// Why a device is not served any more.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The port failed.
    #[error("the port of the served device failed: {0}")]
    Port(#[from] io::Error),
    /// The emulated processor does not run any more.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
}

/// Runs a device in real time behind a port until `stop`. At a TCP address one client commands and the others look; a
/// terminal has one client. The device stays as the last one left it, as a board does. `on_news` is given the device's time of an event, us.
///
/// # Errors
/// [`ServeError`]. A client that leaves is none.
pub fn serve<P: Processor>(
    device: &mut SimulatedMcu<P>,
    port: &mut ClientPort,
    stop: &AtomicBool,
    mut on_news: impl FnMut(u64, Served),
) -> Result<(), ServeError> {
    let mut pace = Pace::new(device.now_us());
    let mut listener = Listener::default();
    let mut bytes = Vec::new();
    while !stop.load(Ordering::Relaxed) {
        let (now_us, lag_us) = pace.now_us(device.now_us());
        device.advance_to(now_us.min(device.now_us() + STRIDE_US));
        if let Some(failure) = device.take_failure() {
            return Err(failure.into());
        }
        let at_us = device.device_time_us();
        lag_us.into_iter().for_each(|lag_us| on_news(at_us, Served::Lag(lag_us)));
        bytes.clear();
        device.read(&mut bytes);
        port.send(&bytes, &mut |news| on_news(at_us, news))?;
        listener.hear(&bytes, |news| on_news(at_us, news));
        bytes.clear();
        port.receive(at_us, &mut bytes, &mut |news| on_news(at_us, news))?;
        device.write(&bytes);
        pace.rest(device.next_tick_us());
    }
    Ok(())
}

/// The device's pace: the time of this computer, without that in which it could not keep up.
struct Pace {
    began: Instant,
    start_us: u64,
    lost_us: u64,
    reported: Option<Instant>,
}

impl Pace {
    fn new(start_us: u64) -> Self {
        Self { began: Instant::now(), start_us, lost_us: 0, reported: None }
    }

    /// The time to go to from `at_us`; now and then the time that was given up since the last report, us.
    fn now_us(&mut self, at_us: u64) -> (u64, Option<u64>) {
        let lag_us = self.clock_us().saturating_sub(at_us);
        if lag_us > LAG_MAX_US {
            (self.began, self.start_us) = (Instant::now(), at_us + PAUSE_US);
            self.lost_us += lag_us - PAUSE_US;
        }
        let is_due = self.lost_us > 0 && self.reported.is_none_or(|reported| reported.elapsed() >= REPORT);
        let report = is_due.then(|| {
            self.reported = Some(Instant::now());
            std::mem::take(&mut self.lost_us)
        });
        (self.clock_us(), report)
    }

    fn clock_us(&self) -> u64 {
        self.start_us + self.began.elapsed().as_micros() as u64
    }

    /// Sleeps until a time of the device.
    fn rest(&self, until_us: u64) {
        thread::sleep(Duration::from_micros(until_us.saturating_sub(self.clock_us()).min(PAUSE_US)));
    }
}

/// Reads along what the device says.
#[derive(Default)]
struct Listener {
    decoder: Decoder<DeviceMessage>,
    state: Option<Code<DeviceState>>,
}

impl Listener {
    fn hear(&mut self, bytes: &[u8], mut on_news: impl FnMut(Served)) {
        for &byte in bytes {
            let state = match self.decoder.push(byte) {
                Some(Ok(frame)) => match frame.message {
                    DeviceMessage::HelloReply(reply) => reply.state,
                    DeviceMessage::HeartbeatReply(reply) => reply.state,
                    DeviceMessage::Telemetry(telemetry) => telemetry.state,
                    DeviceMessage::Fault(fault) => {
                        on_news(Served::Fault(DeviceFault::from(&fault)));
                        continue;
                    }
                    DeviceMessage::Ack(_)
                    | DeviceMessage::Samples(_)
                    | DeviceMessage::Ticks(_)
                    | DeviceMessage::LinkErrors(_)
                    | DeviceMessage::LogRecords(_)
                    | DeviceMessage::LogState(_) => continue,
                },
                _ => continue,
            };
            if self.state.replace(state) != Some(state) {
                on_news(Served::State(state));
            }
        }
    }
}
