//! Records what a device sends, without a scene. Sends one Hello and nothing else.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use fra_model::StateQuantity;
use softlimb_protocol::{Decoder, DeviceMessage, RetryPolicy, SCHEMA_HASH, Samples, Telemetry};

use super::assemble::sample_row;
use super::{RunError, unix_ns};
use crate::link::port::{Port, session_number};
use crate::link::{
    DeviceFault, DeviceInfo, Event, LinkError, PortErrors, SampleRequest, Sampling, StreamOptions, Traffic, Transport,
    identify, listen, request_samples, valve_supply_v,
};
use crate::record::{
    Direction, FaultRecord, LinkSummary, ModuleInfo, ModuleSample, Recorder, RunEnd, RunInfo, Sample, WireBytes,
};

/// Longest wait for a measurement of a device that samples are requested from, us: more than the longest period of telemetry.
const SILENCE_MAX_US: u64 = 11_000_000;

/// Longest wait for bytes between two looks at `stop`, us.
const LOOK_US: u64 = 50_000;

/// What was heard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Heard {
    /// Bytes of the device.
    pub bytes: u64,
    /// Measurements in the log.
    pub samples: u64,
    /// Measurements with another number of channels than the first: the log has only their bytes.
    pub others: u64,
}

/// Records all bytes, measurements and faults of the device behind a port until `stop`. Asks it first who it is, by a Hello that commands nothing
/// where another host commands. The setpoint of a channel is the pressure that its loop tracks. With `samples`, a period in us and the baud of a
/// serial line, the device also sends samples of pressures and duties that often.
///
/// # Errors
/// [`RunError`]. A port that is lost ends the log, which is whole.
pub fn record_behind(
    mut port: Port,
    samples: Option<(u32, Option<u32>)>,
    log: &Path,
    stop: &AtomicBool,
) -> Result<Heard, RunError> {
    let began_us = port.now_us();
    let session = session_number();
    let device = who(&mut port, session)?;
    if let Some((period_us, baud)) = samples {
        request(&mut port, session, (period_us, baud), stop)?;
    }
    let mut listener = Listener {
        log,
        device,
        unix_ns: unix_ns(),
        recorder: None,
        channels: 0,
        zero_us: 0,
        early: Vec::new(),
        heard: Heard::default(),
    };
    let (mut decoder, mut bytes) = (Decoder::<DeviceMessage>::new(), Vec::new());
    let (mut lost, mut port_errors) = (None, None);
    while lost.is_none() && !stop.load(Ordering::Relaxed) {
        port.wait_until(port.now_us().saturating_add(LOOK_US));
        bytes.clear();
        lost = port.receive(&mut bytes).err();
        if bytes.is_empty() {
            continue;
        }
        listener.wire(WireBytes { host_us: port.now_us(), direction: Direction::ToHost, bytes: bytes.clone() })?;
        for frame in bytes.iter().filter_map(|&byte| decoder.push(byte)?.ok()) {
            match frame.message {
                DeviceMessage::Telemetry(message) => listener.telemetry(&message)?,
                DeviceMessage::Samples(message) => listener.samples(&message)?,
                DeviceMessage::Fault(message) => listener.fault(&message)?,
                DeviceMessage::LinkErrors(message) => port_errors = Some(PortErrors::from(&message)),
                _ => {}
            }
        }
    }
    let counters = decoder.counters();
    let link = LinkSummary {
        frames_received: u64::from(counters.accepted),
        bytes_received: listener.heard.bytes,
        crc_errors: u64::from(counters.crc),
        port_errors,
        ..LinkSummary::default()
    };
    let wall_s = port.now_us().saturating_sub(began_us) as f64 * 1e-6;
    let heard = listener.finish(link, wall_s)?;
    lost.map_or(Ok(heard), |error| Err(RunError::Link(Box::new(LinkError::Port(error)))))
}

/// The device's answer; `None` where there is none, since it may send measurements nevertheless.
fn who(port: &mut Port, session: u16) -> Result<Option<DeviceInfo>, RunError> {
    let retry = RetryPolicy { attempts_max: 5, ..RetryPolicy::default() };
    match identify(port, &StreamOptions { retry, ..StreamOptions::new(session) }) {
        Err(error @ LinkError::Port(_)) => Err(RunError::Link(Box::new(error))),
        answer => Ok(answer.ok()),
    }
}

/// Requests samples. Two measurements tell how many channels the device has, and how often its telemetry takes the line.
fn request(
    port: &mut Port,
    session: u16,
    (period_us, baud): (u32, Option<u32>),
    stop: &AtomicBool,
) -> Result<(), RunError> {
    let mut told: Vec<Telemetry> = Vec::new();
    let heard = listen(port, SILENCE_MAX_US, stop, |event| {
        if let Event::Telemetry { message, .. } = event {
            told.push(message);
        }
        if told.len() < 2 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    match (heard, told.as_slice()) {
        (Ok(()), [first, second]) => {
            let telemetry_us = u32::try_from(second.time_us.saturating_sub(first.time_us)).unwrap_or(u32::MAX).max(1);
            let channels = second.channels.len();
            let traffic = Traffic { channels, telemetry_us, knot_us: u64::MAX, heartbeat_us: u64::MAX };
            let sampling = Sampling::new(SampleRequest::Measurements(period_us), &traffic, baud)?;
            let requested = request_samples(port, &StreamOptions::new(session), sampling);
            requested.map_err(|error| RunError::Link(Box::new(error)))
        }
        // Stopped before.
        (Ok(()), _) => Ok(()),
        (Err(LinkError::NoTelemetry { .. }), _) => Err(RunError::NoMeasurements),
        (Err(error), _) => Err(RunError::Link(Box::new(error))),
    }
}

struct Listener<'a> {
    log: &'a Path,
    device: Option<DeviceInfo>,
    unix_ns: u64,
    recorder: Option<Recorder>,
    channels: usize,
    /// Device time of the first measurement, us.
    zero_us: u64,
    /// Bytes before the first measurement, which tells the number of channels.
    early: Vec<WireBytes>,
    heard: Heard,
}

impl Listener<'_> {
    fn wire(&mut self, wire: WireBytes) -> Result<(), RunError> {
        self.heard.bytes += wire.bytes.len() as u64;
        match &mut self.recorder {
            Some(recorder) => recorder.wire(&wire)?,
            None => self.early.push(wire),
        }
        Ok(())
    }

    /// Creates the log of a device with this number of channels, if there is none yet.
    fn begin(&mut self, channels: usize) -> Result<(), RunError> {
        if self.recorder.is_none() {
            let mut recorder = Recorder::create(self.log, &info(channels, self.unix_ns, self.device.as_ref()))?;
            self.early.drain(..).try_for_each(|wire| recorder.wire(&wire))?;
            self.channels = channels;
            self.recorder = Some(recorder);
        }
        Ok(())
    }

    fn telemetry(&mut self, message: &Telemetry) -> Result<(), RunError> {
        if self.recorder.is_none() {
            self.zero_us = message.time_us;
        }
        let sample = sample(message, self.zero_us);
        self.begin(sample.channels.len())?;
        if sample.channels.len() == self.channels {
            self.heard.samples += 1;
            self.recorder.as_mut().map_or(Ok(()), |recorder| recorder.sample(&sample))?;
        } else {
            self.heard.others += 1;
        }
        Ok(())
    }

    fn samples(&mut self, message: &Samples) -> Result<(), RunError> {
        let Some(recorder) = &mut self.recorder else { return Ok(()) };
        let Some(time_us) = message.time_us.checked_sub(self.zero_us) else { return Ok(()) };
        Ok(recorder.samples(&sample_row(message, time_us as f64 * 1e-6))?)
    }

    fn fault(&mut self, message: &softlimb_protocol::Fault) -> Result<(), RunError> {
        let Some(recorder) = &mut self.recorder else { return Ok(()) };
        let time_s = (message.time_us as f64 - self.zero_us as f64) * 1e-6;
        let text = DeviceFault::from(message).to_string();
        let (channel, code, value) = (message.channel, message.code.raw(), message.value);
        Ok(recorder.fault(&FaultRecord { time_s, channel, code, value, text })?)
    }

    fn finish(mut self, link: LinkSummary, wall_s: f64) -> Result<Heard, RunError> {
        self.begin(0)?;
        let end = RunEnd { link, wall_s: Some(wall_s), ..RunEnd::default() };
        self.recorder.map_or(Ok(()), |recorder| recorder.finish(&end))?;
        Ok(self.heard)
    }
}

fn info(channels: usize, start_unix_ns: u64, device: Option<&DeviceInfo>) -> RunInfo {
    let module = |channel| ModuleInfo {
        name: format!("channel {channel}"),
        motion: "unknown".to_owned(),
        quantity: StateQuantity::Pressure,
        channels: channel..channel + 1,
        pressure_limit_pa: None,
    };
    RunInfo {
        scene_name: "recorded".to_owned(),
        scene_text: String::new(),
        tool_version: env!("CARGO_PKG_VERSION").to_owned(),
        firmware_version: device.map_or_else(String::new, |device| device.firmware.to_string()),
        schema_hash: device.map_or(SCHEMA_HASH, |device| device.schema_hash),
        config_hash: device.and_then(|device| device.config_hash).unwrap_or(0),
        seed: None,
        start_unix_ns,
        modules: (0..channels).map(module).collect(),
        phases: Vec::new(),
        limb: None,
        solids: Vec::new(),
        clearance_m: None,
        carried: Vec::new(),
        simulated: false,
        weightless: false,
        truth: None,
        feedback: None,
        corrections: false,
        injected_faults: Vec::new(),
    }
}

/// A measurement without a limb: the tip is unknown.
fn sample(message: &Telemetry, zero_us: u64) -> Sample {
    let channels = super::assemble::channels(message, None);
    let module = |channel: &crate::record::ChannelSample| ModuleSample {
        setpoint: channel.reference_pa,
        modelled: channel.pressure_pa,
        achieved: None,
    };
    Sample {
        time_s: (message.time_us as f64 - zero_us as f64) * 1e-6,
        state: message.state.raw(),
        fault_bits: message.fault_bits,
        supply_pa: 10.0 * f64::from(message.supply_10pa),
        valve_supply_v: valve_supply_v(message),
        outputs: crate::record::OutputSample { bits: message.outputs.bits(), gripper_closure: None },
        modules: channels.iter().map(module).collect(),
        channels,
        tip_setpoint_m: [f64::NAN; 3],
        tip_modelled_m: [f64::NAN; 3],
        tip_achieved_m: None,
    }
}
