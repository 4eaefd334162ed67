//! The recording of a run: what a device does goes to the log, and the log becomes the report.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use softlimb_sim::plant::Truth;

use super::assemble::{Assembler, Seen, link_summary};
use super::feedback::Frame;
use super::prepared::{Origin, Prepared};
use super::tape::Tape;
use super::timed_fault::TimedFault;
use super::{Progress, RunError, RunFiles, write_report};
use crate::imu::Reading;
use crate::link::{Event, LinkError, LinkStatistics, Transport};
use crate::record;
use crate::record::{
    Body, DeviceTick, FaultRecord, InjectedFault, Posture, RecordError, Recorder, RunEnd, RunInfo, Sample,
    TargetRecord, WireBytes,
};
use softlimb_files::make_folder;

/// Least number of ticks in a message of the log: fewer would be smaller than their header.
const TICKS: usize = 20;

/// A device under a run, with whoever looks on.
pub(super) trait Bench: Transport {
    /// The truth at a device time, us, where somebody sees it.
    fn truth_at(&self, device_us: u64) -> Option<Truth>;

    /// Bytes of the link, and ticks of a device that shows them.
    fn tape(&mut self) -> &mut Tape;

    /// The trajectory starts at a device time, us.
    fn armed(&mut self, _start_us: u64) {}

    /// Highest true gauge pressure of each chamber so far, Pa; empty on a device.
    fn peak_chamber_pa(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Whether the outputs of the ticks are those of pins.
    fn is_at_pins(&self) -> bool {
        false
    }

    /// Injects a fault at once.
    ///
    /// # Errors
    /// The reason in words: no such part, or a device that is not simulated.
    fn break_now(&mut self, _fault: TimedFault) -> Result<(), String> {
        Err("only a simulated device breaks on purpose".to_owned())
    }
}

/// An event of the link, with what the device shows at it.
pub(super) struct Moment {
    event: Event,
    truth: Option<Truth>,
    wire: Vec<WireBytes>,
    ticks: Vec<DeviceTick>,
    is_at_pins: bool,
}

impl Moment {
    pub(super) fn of(device: &mut impl Bench, event: Event) -> Self {
        if let Event::Armed { start_us, .. } = event {
            device.armed(start_us);
        }
        let truth = match &event {
            Event::Telemetry { message, .. } => device.truth_at(message.time_us),
            _ => None,
        };
        let is_at_pins = device.is_at_pins();
        let tape = device.tape();
        Self { event, truth, wire: tape.take_wire(), ticks: tape.take_ticks(0), is_at_pins }
    }
}

/// A session with a device, and the destination of its record.
pub(super) struct Session<'a> {
    /// Number of the link session.
    pub(super) number: u16,
    pub(super) origin: Origin,
    /// Faults that it meets on purpose.
    pub(super) injected: Vec<InjectedFault>,
    /// The simulated limb in words.
    pub(super) truth: Option<String>,
    /// The folder that takes `run.mcap` and `run.html`.
    pub(super) out: &'a Path,
}

/// Streams what is prepared to a device, records it and writes the report.
pub(super) fn recorded<D: Bench>(
    prepared: &Prepared<'_>,
    assembler: Assembler<'_>,
    device: &mut D,
    session: &Session<'_>,
    cancel: &AtomicBool,
    mut on_progress: impl FnMut(Progress),
) -> Result<RunFiles, RunError> {
    let period_us = u64::from(prepared.scene().controller().telemetry_period_us);
    let duration_s = prepared.plan().duration_us() as f64 * 1e-6;
    let info = RunInfo {
        injected_faults: session.injected.clone(),
        truth: session.truth.clone(),
        ..prepared.info(session.origin)
    };
    recorded_by(device, (info, assembler, period_us), session.out, |device, recording| {
        prepared.stream(device, &prepared.options(session.number, cancel), |device, event| {
            if let Some(sample) = recording.take(device, event) {
                on_progress(Progress { time_s: sample.time_s.min(duration_s), duration_s });
            }
            recording.take_frame()
        })
    })
}

/// Records a session with a device in a folder, and writes the report. The period is that of the measurements, us.
pub(super) fn recorded_by<'a, D: Bench, R>(
    device: &mut D,
    (info, assembler, period_us): (RunInfo, Assembler<'a>, u64),
    out: &Path,
    session: impl FnOnce(&mut D, &mut Recording<'a>) -> Result<R, LinkError>,
) -> Result<RunFiles, RunError> {
    make_folder(out)?;
    let path = out.join("run.mcap");

    let began = Instant::now();
    let mut recording = Recording::new(info, assembler, period_us, path.clone());
    let ended = session(device, &mut recording);
    let is_at_pins = device.is_at_pins();
    let (wire, ticks) = (device.tape().take_wire(), device.tape().take_ticks(0));
    recording.keep((wire, ticks, is_at_pins), 0);
    let link = link_summary(&recording.statistics, device.tape().traffic(), recording.gaps.lost);
    let last_s = recording.last_s;
    let wall_s = Some(began.elapsed().as_secs_f64());
    let targets = std::mem::take(&mut recording.targets);
    let (peak_chamber_pa, contacts) = (device.peak_chamber_pa(), recording.assembler.contacts());
    let logged = recording.finish(&RunEnd { link, peak_chamber_pa, wall_s, targets, contacts });
    match (ended, logged) {
        (Ok(_), Ok(true)) => finish_report(&path),
        (Ok(_), Ok(false)) => Err(RunError::NotRecorded),
        (Err(cause), Ok(true)) => {
            let files = finish_report(&path)?;
            Err(RunError::Stopped { cause: Box::new(cause), files: Box::new(files) })
        }
        (Err(cause), Ok(false)) => Err(RunError::Link(Box::new(cause))),
        (ended, Err(cause)) => Err(RunError::LogLost { cause, last_s, ended: ended.err().map(Box::new) }),
    }
}

/// Reads the log back, so that the report shows what the log holds and nothing else.
fn finish_report(log: &Path) -> Result<RunFiles, RunError> {
    let run = record::read(log)?;
    let report = log.with_extension("html");
    write_report(&report, &run)?;
    Ok(RunFiles { log: log.to_owned(), report, run })
}

/// The recording of a run, from the moment its configuration is known.
pub(super) struct Recording<'a> {
    info: RunInfo,
    path: PathBuf,
    assembler: Assembler<'a>,
    recorder: Option<Recorder>,
    failure: Option<RecordError>,
    /// Time of the last sample in the log, s after the start of the run.
    last_s: Option<f64>,
    /// The latest look at the limb.
    body: Option<Body>,
    /// Its frames then.
    posture: Option<Posture>,
    /// Measurements of camera and IMUs at the latest report.
    frame: Option<Frame>,
    /// How the targets were met by hand.
    pub(super) targets: Vec<TargetRecord>,
    /// Bytes and ticks that are not in the log yet.
    wire: Vec<WireBytes>,
    ticks: Vec<DeviceTick>,
    statistics: LinkStatistics,
    gaps: Gaps,
}

/// Measurements that did not arrive, by the times of those that did.
struct Gaps {
    period_us: u64,
    last_us: Option<u64>,
    lost: u64,
}

impl Gaps {
    fn add(&mut self, time_us: u64) {
        let since_us = self.last_us.replace(time_us).map_or(0, |last_us| time_us.saturating_sub(last_us));
        self.lost += (since_us.saturating_add(self.period_us / 2) / self.period_us).saturating_sub(1);
    }
}

impl<'a> Recording<'a> {
    fn new(info: RunInfo, assembler: Assembler<'a>, period_us: u64, path: PathBuf) -> Self {
        let gaps = Gaps { period_us, last_us: None, lost: 0 };
        Self {
            info,
            path,
            assembler,
            recorder: None,
            failure: None,
            last_s: None,
            body: None,
            posture: None,
            frame: None,
            targets: Vec::new(),
            wire: Vec::new(),
            ticks: Vec::new(),
            statistics: LinkStatistics::default(),
            gaps,
        }
    }

    /// Takes an event of the link. A log that cannot be written does not stop the limb; it is told at the end.
    pub(super) fn take(&mut self, device: &mut impl Bench, event: Event) -> Option<Sample> {
        self.observe(Moment::of(device, event))
    }

    /// [`Self::take`] of an event whose device is elsewhere.
    pub(super) fn observe(&mut self, moment: Moment) -> Option<Sample> {
        let Moment { event, truth, wire, ticks, is_at_pins } = moment;
        let noted = self.note(event, truth.as_ref());
        let sample = self.unless_lost(noted).flatten();
        self.keep((wire, ticks, is_at_pins), TICKS);
        sample
    }

    /// The look at the limb since the last call.
    pub(super) fn take_body(&mut self) -> Option<Body> {
        self.body.take()
    }

    /// Measurements of camera and IMUs since the last call.
    pub(super) fn take_frame(&mut self) -> Option<Frame> {
        self.frame.take()
    }

    /// The frames of that look.
    pub(super) fn take_posture(&mut self) -> Option<Posture> {
        self.posture.take()
    }

    /// Notes a fault that was injected now.
    pub(super) fn on_purpose(&mut self, fault: &InjectedFault) {
        let note = FaultRecord {
            time_s: self.last_s.unwrap_or(0.0),
            channel: fault.channel.and_then(|channel| u8::try_from(channel).ok()).unwrap_or(u8::MAX),
            code: FaultRecord::ON_PURPOSE,
            value: 0,
            text: format!("{}, on purpose", fault.name),
        };
        let written = self.recorder.as_mut().map_or(Ok(()), |recorder| recorder.fault(&note));
        self.unless_lost(written);
    }

    /// Writes bytes, and ticks where there are at least `ticks_min`. Before there is a log, they are kept.
    fn keep(&mut self, (wire, ticks, is_at_pins): (Vec<WireBytes>, Vec<DeviceTick>, bool), ticks_min: usize) {
        self.wire.extend(wire);
        self.ticks.extend(ticks);
        if self.recorder.is_none() && self.failure.is_none() {
            return;
        }
        let wire = std::mem::take(&mut self.wire);
        let ticks = if self.ticks.len() < ticks_min { Vec::new() } else { std::mem::take(&mut self.ticks) };
        let Some(recorder) = &mut self.recorder else { return };
        let taken =
            wire.iter().try_for_each(|wire| recorder.wire(wire)).and_then(|()| recorder.ticks(&ticks, is_at_pins));
        self.unless_lost(taken);
    }

    /// Handles the result of writing to the log. After a failure there is no log any more.
    fn unless_lost<T>(&mut self, written: Result<T, RecordError>) -> Option<T> {
        written
            .map_err(|error| {
                self.recorder = None;
                self.failure.get_or_insert(error);
            })
            .ok()
    }

    fn note(&mut self, event: Event, truth: Option<&Truth>) -> Result<Option<Sample>, RecordError> {
        match event {
            Event::Connected(connected) => self.info.firmware_version = connected.firmware.to_string(),
            Event::Configured { config_hash } if self.failure.is_none() => {
                self.info.config_hash = config_hash;
                // The period is the configuration's from here on.
                self.gaps.last_us = None;
                let mut recorder = Recorder::create(&self.path, &self.info)?;
                let path = self.assembler.planned_path();
                if !path.is_empty() {
                    recorder.plan(&path)?;
                }
                self.recorder = Some(recorder);
            }
            Event::Closed(statistics) => self.statistics = statistics,
            Event::Armed { start_us, .. } => self.assembler.start(start_us),
            Event::Telemetry { message, .. } => {
                if self.recorder.is_some() {
                    self.gaps.add(message.time_us);
                }
                if let Some(Seen { sample, frame, shape, body, shown, posture, faults }) =
                    self.assembler.sample(&message, truth)
                {
                    self.body = shown.or(self.body.take());
                    if let Some(recorder) = &mut self.recorder {
                        recorder.sample(&sample)?;
                        self.last_s = Some(sample.time_s);
                        shape.map_or(Ok(()), |shape| recorder.shape(&shape))?;
                        body.map_or(Ok(()), |body| recorder.body(&body))?;
                        posture.as_ref().map_or(Ok(()), |posture| recorder.posture(posture))?;
                        faults.iter().try_for_each(|fault| recorder.fault(fault))?;
                        frame.tip_m.map_or(Ok(()), |tip_m| recorder.image(frame.time_s, tip_m))?;
                        for (module, reading) in frame.readings.iter().enumerate() {
                            let Some(Reading { orientation, rate_rad_per_s }) = reading else { continue };
                            let orientation = orientation.coords.into();
                            recorder.imu(frame.time_s, module, orientation, (*rate_rad_per_s).into())?;
                        }
                    }
                    self.frame = Some(frame);
                    self.posture = posture.or(self.posture.take());
                    return Ok(Some(sample));
                }
            }
            Event::Fault { message, .. } => {
                let fault = self.assembler.fault(&message);
                if let Some(recorder) = &mut self.recorder {
                    recorder.fault(&fault)?;
                }
            }
            Event::Samples { message, .. } => {
                if let (Some(recorder), Some(row)) = (&mut self.recorder, self.assembler.samples(&message)) {
                    recorder.samples(&row)?;
                }
            }
            _ => {}
        }
        Ok(None)
    }

    /// Closes the log; `false` when there is none.
    fn finish(self, end: &RunEnd) -> Result<bool, RecordError> {
        match (self.failure, self.recorder) {
            (Some(failure), _) => Err(failure),
            (None, Some(recorder)) => {
                recorder.finish(end)?;
                Ok(true)
            }
            (None, None) => Ok(false),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measurements_between_two_that_came_are_counted() {
        let mut gaps = Gaps { period_us: 20_000, last_us: None, lost: 0 };
        for (time_us, lost) in
            [(70_000, 0), (90_000, 0), (110_001, 0), (150_000, 1), (230_000, 4), (5_000, 4), (25_000, 4)]
        {
            gaps.add(time_us);
            assert_eq!(gaps.lost, lost, "at {time_us} us");
        }
    }
}
