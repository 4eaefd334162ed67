//! Writes a run while it happens.

use super::background::{Background, LogFile};
use super::container::{options, partial_path, write_opening};
use super::drawn::connector_frame;
use super::messages::{
    Truth, encode_body, encode_deformation, encode_fault, encode_outputs, encode_point, encode_shape, encode_telemetry,
};
use super::metadata::{check_modules, end_metadata};
use super::samples::encode_samples;
use super::standard::{RATE_HZ, encode_fluid_pressure, encode_imu, encode_joint_state};
use super::ticks::{encode_ticks, first_row};
use super::topics::{Observed, Topics, declare_camera, declare_imu, declare_samples, declare_ticks};
use super::viewer::Viewer;
use super::wire::encode_wire;
use super::{
    Body, DeviceTick, FaultRecord, OutputSample, Posture, RecordError, RunEnd, RunInfo, Sample, SampleRow, Shape,
    WireBytes,
};
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Log time between two closed chunks, s. With the wait for the next sample a kill costs half a second at most.
const CHUNK_S: f64 = 0.4;

/// A run being written.
///
/// The file is `<path>.partial` until [`finish`](Self::finish) gives it its name.
/// A recorder that is dropped instead leaves that file, closed and readable.
/// Every 0.4 s of log time everything so far is handed to the operating system as
/// a closed chunk, so a killed process loses no more than that.
pub struct Recorder {
    mcap: mcap::Writer<LogFile>,
    topics: Topics,
    info: RunInfo,
    path: PathBuf,
    partial: PathBuf,
    samples: u32,
    others: u32,
    /// Start of the open chunk on the clock of the run, s.
    chunk_start_s: Option<f64>,
    /// The same on the host's clock, by the bytes of the link.
    chunk_start_us: Option<u64>,
    standard_slot: Option<i64>,
    /// Digital outputs that were written last.
    outputs: Option<OutputSample>,
    /// What viewers draw; `None` where the limb is not described.
    viewer: Option<Viewer>,
}

impl Recorder {
    /// Starts a log that will be `path`; an older log there stays until the new one
    /// is finished.
    ///
    /// # Errors
    /// [`RecordError::Metadata`] when a module has impossible channels,
    /// [`RecordError::File`] when the partial file or its opening cannot be written.
    pub fn create(path: impl AsRef<Path>, info: &RunInfo) -> Result<Self, RecordError> {
        check_modules(info)?;
        let path = path.as_ref().to_owned();
        let partial = partial_path(&path);
        let file = File::create(&partial).map_err(RecordError::file("create", &partial))?;
        // A simulation waits for the disk, a device does not.
        let file = if info.simulated {
            LogFile::Direct(BufWriter::new(file))
        } else {
            LogFile::Background(Background::new(file).map_err(RecordError::file("write", &partial))?)
        };
        let mut mcap = options()
            .create(file)
            .and_then(|mut mcap| write_opening(&mut mcap, info).map(|()| mcap))
            .map_err(RecordError::written("opening the log", &partial))?;
        let declaring = RecordError::written("declaring the topics", &partial);
        let topics = Topics::declare(&mut mcap, info).map_err(declaring)?;
        let viewer = info.limb.as_ref().map(|limb| Viewer::declare(&mut mcap, info, limb)).transpose();
        let viewer = viewer.map_err(RecordError::written("declaring the topics", &partial))?;
        let mut recorder = Self {
            mcap,
            topics,
            info: info.clone(),
            path,
            partial,
            samples: 0,
            others: 0,
            chunk_start_s: None,
            chunk_start_us: None,
            standard_slot: None,
            outputs: None,
            viewer,
        };
        recorder.open_viewer()?;
        if !info.simulated {
            recorder.mcap.flush().map_err(RecordError::written("opening the log", &recorder.partial))?;
        }
        Ok(recorder)
    }

    fn open_viewer(&mut self) -> Result<(), RecordError> {
        let (Some(viewer), Some(limb)) = (&self.viewer, &self.info.limb) else { return Ok(()) };
        let at = self.stamp(0.0);
        viewer
            .opening(at, &self.info, limb)
            .into_iter()
            .try_for_each(|(topic, message)| self.write_other(topic, at, &message))
    }

    /// Writes the way that the plan has for the tip, for viewers: times, s after the start of the run, and positions, m.
    ///
    /// # Errors
    /// [`RecordError::File`] when the disk refuses.
    pub fn plan(&mut self, places: &[(f64, [f64; 3])]) -> Result<(), RecordError> {
        let Some(viewer) = &self.viewer else { return Ok(()) };
        let at = self.stamp(0.0);
        let places: Vec<_> = places.iter().map(|(time_s, place_m)| (self.stamp(*time_s), *place_m)).collect();
        let (topic, message) = viewer.plan(at, &places);
        self.write_other(topic, at, &message)
    }

    /// Appends the limb for viewers.
    ///
    /// # Errors
    /// [`RecordError::File`] when the disk refuses.
    pub fn posture(&mut self, posture: &Posture) -> Result<(), RecordError> {
        let at = self.stamp(posture.time_s);
        let Some(viewer) = &mut self.viewer else { return Ok(()) };
        let messages = viewer.posture(at, &self.info, posture);
        messages.into_iter().try_for_each(|(topic, message)| self.write_other(topic, at, &message))
    }

    /// Appends a sample.
    ///
    /// # Errors
    /// [`RecordError::Sample`] when its time is not finite or it has not as many
    /// channels and modules as the run, [`RecordError::File`] when the disk
    /// refuses; after the latter every further call fails.
    pub fn sample(&mut self, sample: &Sample) -> Result<(), RecordError> {
        self.check(sample)?;
        self.close_chunk_when_due(sample.time_s)?;
        let at = self.stamp(sample.time_s);
        let sequence = self.samples;
        self.samples = self.samples.wrapping_add(1);

        let setpoints = sample.modules.iter().map(|module| module.setpoint);
        let modelled = sample.modules.iter().map(|module| module.modelled);
        let messages = [
            (self.topics.telemetry, encode_telemetry(at, sample)),
            (self.topics.setpoint, encode_deformation(at, setpoints, sample.tip_setpoint_m)),
            (self.topics.model, encode_deformation(at, modelled, sample.tip_modelled_m)),
        ];
        for (topic, message) in messages {
            self.write(topic, sequence, at, &message)?;
        }
        if let Some(viewer) = &mut self.viewer {
            viewer.sample(sample);
        }
        if let Some(truth) = Truth::of(sample) {
            let topic = self.observed()?.truth;
            self.write(topic, sequence, at, &truth.encode(at))?;
        }
        if self.outputs.replace(sample.outputs) != Some(sample.outputs) {
            let message = encode_outputs(at, sample.time_s, &sample.outputs);
            self.write(self.topics.outputs, sequence, at, &message)?;
        }
        self.standard_messages(sample, sequence, at)
    }

    /// The topics of a limb that is seen, declared when they are needed.
    fn observed(&mut self) -> Result<Observed, RecordError> {
        if let Some(observed) = self.topics.observed {
            return Ok(observed);
        }
        let observed =
            Observed::declare(&mut self.mcap).map_err(RecordError::written("declaring the topics", &self.partial))?;
        self.topics.observed = Some(observed);
        Ok(observed)
    }

    /// Appends a fault.
    ///
    /// # Errors
    /// [`RecordError::File`] when the disk refuses.
    pub fn fault(&mut self, fault: &FaultRecord) -> Result<(), RecordError> {
        let at = self.stamp(fault.time_s);
        if let Some(viewer) = &mut self.viewer {
            viewer.fault(fault);
        }
        self.write_other(self.topics.fault, at, &encode_fault(at, fault))
    }

    /// Appends a backbone shape.
    ///
    /// # Errors
    /// [`RecordError::File`] when the disk refuses.
    pub fn shape(&mut self, shape: &Shape) -> Result<(), RecordError> {
        let at = self.stamp(shape.time_s);
        self.write_other(self.topics.shape, at, &encode_shape(at, shape))?;
        match self.viewer.as_ref().map(|viewer| viewer.shape(at, shape)) {
            Some((topic, message)) => self.write_other(topic, at, &message),
            None => Ok(()),
        }
    }

    /// Appends the limb as a solid.
    ///
    /// # Errors
    /// [`RecordError::File`] when the disk refuses.
    pub fn body(&mut self, body: &Body) -> Result<(), RecordError> {
        let at = self.stamp(body.time_s);
        if let Some(viewer) = &mut self.viewer {
            viewer.body(body);
        }
        let topic = self.observed()?.body;
        self.write_other(topic, at, &encode_body(at, body))
    }

    /// Appends bytes of the link.
    ///
    /// # Errors
    /// [`RecordError::File`] when the disk refuses.
    pub fn wire(&mut self, wire: &WireBytes) -> Result<(), RecordError> {
        let start_us = *self.chunk_start_us.get_or_insert(wire.host_us);
        if wire.host_us.saturating_sub(start_us) as f64 * 1e-6 >= CHUNK_S {
            self.close_chunk()?;
        }
        let at = self.stamp(wire.host_us as f64 * 1e-6);
        self.write_other(self.topics.wire, at, &encode_wire(at, wire))
    }

    /// Appends samples between those of the telemetry.
    ///
    /// # Errors
    /// [`RecordError::File`] when the disk refuses.
    pub fn samples(&mut self, row: &SampleRow) -> Result<(), RecordError> {
        let topic = match self.topics.samples {
            Some(topic) => topic,
            None => {
                declare_samples(&mut self.mcap).map_err(RecordError::written("declaring the topics", &self.partial))?
            }
        };
        self.topics.samples = Some(topic);
        let at = self.stamp(row.time_s);
        self.write_other(topic, at, &encode_samples(at, row))
    }

    /// Appends the position of the tip in a camera's image of a time of the run, s.
    ///
    /// # Errors
    /// [`RecordError::File`] when the disk refuses.
    pub fn image(&mut self, time_s: f64, tip_m: [f64; 3]) -> Result<(), RecordError> {
        let topic = match self.topics.camera {
            Some(topic) => topic,
            None => {
                declare_camera(&mut self.mcap).map_err(RecordError::written("declaring the topics", &self.partial))?
            }
        };
        self.topics.camera = Some(topic);
        let at = self.stamp(time_s);
        self.write_other(topic, at, &encode_point(at, tip_m))
    }

    /// Appends a reading of the IMU on the end plate of a module at a time of the run, s: a unit quaternion, x, y, z, w, in the frame of the scene,
    /// and an angular rate in the frame of the plate, rad/s. A module that is not described has none.
    ///
    /// # Errors
    /// [`RecordError::File`] when the disk refuses.
    pub fn imu(
        &mut self,
        time_s: f64,
        module: usize,
        orientation: [f64; 4],
        rate_rad_per_s: [f64; 3],
    ) -> Result<(), RecordError> {
        let names = self.info.limb.as_ref().map(|limb| &limb.modules);
        let Some(name) = names.and_then(|names| names.get(module)) else { return Ok(()) };
        let frame = connector_frame(name);
        let topic = match self.topics.imu {
            Some(topic) => topic,
            None => declare_imu(&mut self.mcap).map_err(RecordError::written("declaring the topics", &self.partial))?,
        };
        self.topics.imu = Some(topic);
        let at = self.stamp(time_s);
        self.write_other(topic, at, &encode_imu(at, &frame, orientation, rate_rad_per_s))
    }

    /// Appends control ticks of a simulated or emulated device.
    ///
    /// # Errors
    /// [`RecordError::File`] when the disk refuses.
    pub fn ticks(&mut self, ticks: &[DeviceTick], at_pins: bool) -> Result<(), RecordError> {
        let mut rest = ticks;
        while let Some(first) = rest.first() {
            let topic = match self.topics.ticks {
                Some(topic) => topic,
                None => declare_ticks(&mut self.mcap)
                    .map_err(RecordError::written("declaring the topics", &self.partial))?,
            };
            self.topics.ticks = Some(topic);
            let at = self.stamp(first.device_us as f64 * 1e-6);
            let (row, others) = first_row(rest);
            self.write_other(topic, at, &encode_ticks(at, row, at_pins))?;
            rest = others;
        }
        Ok(())
    }

    /// Ends the log: what is known after the run, index, and its final name.
    ///
    /// # Errors
    /// [`RecordError::File`] when the disk refuses; the
    /// partial file then stays.
    pub fn finish(mut self, end: &RunEnd) -> Result<(), RecordError> {
        let end = mcap::records::Metadata { name: super::END_METADATA.into(), metadata: end_metadata(end) };
        self.mcap
            .write_metadata(&end)
            .and_then(|()| self.mcap.finish())
            .map_err(RecordError::written("ending the log", &self.partial))?;
        let file = self.mcap.into_inner().into_inner().map_err(RecordError::file("write", &self.partial))?;
        file.sync_all().map_err(RecordError::file("write", &self.partial))?;
        std::fs::rename(&self.partial, &self.path).map_err(RecordError::file("name", &self.path))
    }

    fn check(&self, sample: &Sample) -> Result<(), RecordError> {
        let refuse = |reason| Err(RecordError::Sample { time_s: sample.time_s, reason });
        let channels = self.info.channel_count();
        let modules = self.info.modules.len();
        if !sample.time_s.is_finite() {
            return refuse("time is not finite".into());
        }
        if sample.channels.len() != channels {
            return refuse(format!("{} channels, the run has {channels}", sample.channels.len()));
        }
        if sample.modules.len() != modules {
            return refuse(format!("{} modules, the run has {modules}", sample.modules.len()));
        }
        Ok(())
    }

    fn close_chunk_when_due(&mut self, time_s: f64) -> Result<(), RecordError> {
        let start_s = *self.chunk_start_s.get_or_insert(time_s);
        // The absolute value: a device whose clock restarted still gets its chunks closed.
        if (time_s - start_s).abs() >= CHUNK_S {
            self.close_chunk()?;
            self.chunk_start_s = Some(time_s);
        }
        Ok(())
    }

    fn close_chunk(&mut self) -> Result<(), RecordError> {
        (self.chunk_start_s, self.chunk_start_us) = (None, None);
        self.mcap.flush().map_err(RecordError::written("closing a chunk", &self.partial))
    }

    /// Time of the run as ns since 1970, not before it.
    fn stamp(&self, time_s: f64) -> u64 {
        // The cast saturates, and takes NaN to 0.
        self.info.start_unix_ns.saturating_add_signed((time_s * 1e9).round() as i64)
    }

    fn standard_messages(&mut self, sample: &Sample, sequence: u32, at: u64) -> Result<(), RecordError> {
        // Half a microsecond forgives a time that falls just short of its slot by rounding.
        let slot = ((sample.time_s + 5e-7) * RATE_HZ).floor() as i64;
        if self.standard_slot.replace(slot) == Some(slot) {
            return Ok(());
        }
        for (channel, values) in sample.channels.iter().enumerate() {
            let message = encode_fluid_pressure(at, values.pressure_pa);
            self.write(self.topics.pressure[channel], sequence, at, &message)?;
        }
        let names = || self.info.modules.iter().map(|module| module.name.as_str());
        let values = |value: fn(&super::ModuleSample) -> f64| {
            encode_joint_state(at, names().zip(sample.modules.iter().map(value)))
        };
        let joints = [values(|module| module.setpoint), values(|module| module.modelled)];
        let achieved = values(|module| module.achieved.unwrap_or(f64::NAN));
        for (topic, message) in self.topics.joints.into_iter().zip(joints) {
            self.write(topic, sequence, at, &message)?;
        }
        match self.topics.observed {
            Some(Observed { achieved: topic, .. }) => self.write(topic, sequence, at, &achieved),
            None => Ok(()),
        }
    }

    fn write_other(&mut self, topic: u16, at: u64, message: &[u8]) -> Result<(), RecordError> {
        let sequence = self.others;
        self.others = self.others.wrapping_add(1);
        self.write(topic, sequence, at, message)
    }

    fn write(&mut self, topic: u16, sequence: u32, at: u64, data: &[u8]) -> Result<(), RecordError> {
        let header = mcap::records::MessageHeader { channel_id: topic, sequence, log_time: at, publish_time: at };
        self.mcap
            .write_to_known_channel(&header, data)
            .map_err(RecordError::written("writing a message", &self.partial))
    }
}

impl std::fmt::Debug for Recorder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recorder").field("path", &self.path).field("samples", &self.samples).finish_non_exhaustive()
    }
}
