//! A device without a run: who it is, what it measures, which faults it forgets.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use softlimb_protocol::{CommandCode, Decoder, DeviceMessage, HostMessage, ReadLinkErrors, SetSampling};

use super::device::DeviceInfo;
use super::driver::Driver;
use super::error::LinkError;
use super::event::Event;
use super::options::StreamOptions;
use super::sampling::Sampling;
use super::statistics::PortErrors;
use super::transport::Transport;

/// Longest wait for the HelloReply after a refusal, us.
const REFUSED_REPLY_US: u64 = 100_000;

/// Attempts to get LinkErrors: it can be lost although its Ack arrives.
const ATTEMPTS: usize = 5;

/// Identity of a device and the errors of its serial port.
#[derive(Clone, Debug, PartialEq)]
pub struct Examined {
    /// The device.
    pub device: DeviceInfo,
    /// Serial-port errors since the device started. `None` if another host commands the device, which answers that host alone.
    pub port_errors: Option<PortErrors>,
}

/// Reads identity and serial-port errors of a device; changes nothing on it.
///
/// # Errors
/// [`LinkError`]: no answer, another interface.
pub fn examine<T: Transport>(transport: &mut T, options: &StreamOptions<'_>) -> Result<Examined, LinkError> {
    let mut on_event = |_: &mut T, _| {};
    let mut driver = Driver::new(transport, options, &mut on_event);
    let device = who(&mut driver)?;
    let port_errors = if device.is_occupied { None } else { Some(port_errors(&mut driver)?) };
    Ok(Examined { device, port_errors })
}

fn port_errors<T: Transport>(driver: &mut Driver<'_, T>) -> Result<PortErrors, LinkError> {
    let message = HostMessage::from(ReadLinkErrors { session: driver.session.id() });
    for _ in 0..ATTEMPTS {
        driver.demand(&message)?;
        if let Some(errors) = driver.session.statistics().port_errors {
            return Ok(errors);
        }
    }
    Err(LinkError::NoAnswer { message: "ReadLinkErrors" })
}

/// Identifies a device by one Hello. A device that another host commands answers too.
///
/// # Errors
/// [`LinkError`]: no answer, another interface.
pub fn identify<T: Transport>(transport: &mut T, options: &StreamOptions<'_>) -> Result<DeviceInfo, LinkError> {
    let mut on_event = |_: &mut T, _| {};
    who(&mut Driver::new(transport, options, &mut on_event))
}

fn who<T: Transport>(driver: &mut Driver<'_, T>) -> Result<DeviceInfo, LinkError> {
    match driver.hello() {
        Err(LinkError::Occupied) => {
            driver.until(REFUSED_REPLY_US, |driver| driver.session.refused_reply().is_some())?;
            let reply = driver.session.refused_reply().ok_or(LinkError::Occupied)?;
            Ok(DeviceInfo { is_occupied: true, ..reply.into() })
        }
        answer => Ok(DeviceInfo::from(&answer?)),
    }
}

/// Clears the latched faults of a device. Nothing moves until the next run.
///
/// # Errors
/// [`LinkError`]; [`LinkError::Refused`] names a fault whose cause is still there.
pub fn clear_faults<T: Transport>(transport: &mut T, options: &StreamOptions<'_>) -> Result<(), LinkError> {
    let mut on_event = |_: &mut T, _| {};
    let mut driver = Driver::new(transport, options, &mut on_event);
    driver.hello()?;
    driver.command(CommandCode::ClearFaults)
}

/// Requests samples from a device that has a configuration. They go on when the session is silent, until another session begins.
///
/// # Errors
/// [`LinkError`]; [`LinkError::Occupied`] where another host commands.
pub fn request_samples<T: Transport>(
    transport: &mut T,
    options: &StreamOptions<'_>,
    sampling: Sampling,
) -> Result<(), LinkError> {
    let mut on_event = |_: &mut T, _| {};
    let mut driver = Driver::new(transport, options, &mut on_event);
    driver.hello()?;
    let Sampling { period_us, samples, content } = sampling;
    driver.demand(&SetSampling { session: options.session, period_us, samples, content: content.into() }.into())
}

/// Gives all measurements and faults that a device sends to `on_event`, until that breaks or `stop`. Says nothing to the device: a session
/// would change how it reacts to a lost link.
///
/// # Errors
/// [`LinkError::Port`], and [`LinkError::NoTelemetry`] after `silence_max_us` without measurements.
pub fn listen<T: Transport>(
    transport: &mut T,
    silence_max_us: u64,
    stop: &AtomicBool,
    mut on_event: impl FnMut(Event) -> ControlFlow<()>,
) -> Result<(), LinkError> {
    let mut decoder = Decoder::<DeviceMessage>::new();
    let (mut bytes, mut heard_us) = (Vec::new(), transport.now_us());
    while !stop.load(Ordering::Relaxed) {
        transport.wait_until(heard_us.saturating_add(silence_max_us));
        bytes.clear();
        transport.receive(&mut bytes)?;
        let host_time_us = transport.now_us();
        for frame in bytes.iter().filter_map(|&byte| decoder.push(byte)?.ok()) {
            let event = match frame.message {
                DeviceMessage::Telemetry(message) => {
                    heard_us = host_time_us;
                    Event::Telemetry { host_time_us, message }
                }
                DeviceMessage::Fault(message) => Event::Fault { host_time_us, message },
                _ => continue,
            };
            if on_event(event).is_break() {
                return Ok(());
            }
        }
        let waited_us = host_time_us.saturating_sub(heard_us);
        if waited_us >= silence_max_us {
            return Err(LinkError::NoTelemetry { waited_us });
        }
    }
    Ok(())
}
