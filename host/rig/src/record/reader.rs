//! Reads a run back, also one that was cut off.

use super::cdr::CdrError;
use super::messages::{
    BODY, DEFORMATION, FAULT, MessageType, OUTPUTS, SHAPE, TELEMETRY, TRUTH, Truth, decode_body, decode_deformation,
    decode_fault, decode_outputs, decode_shape, decode_telemetry,
};
use super::metadata::{Metadata, read_end, read_run};
use super::{ModuleSample, RecordError, RunEnd, RunInfo, RunLog, Sample};
use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::HashMap;
use std::path::Path;

/// Reads a log.
///
/// A log that was cut off gives what is there; [`RunLog::incomplete`] then says why.
///
/// # Errors
/// The variants of [`RecordError`] except [`RecordError::Sample`]; each names the
/// file or the message that is at fault.
pub fn read(path: impl AsRef<Path>) -> Result<RunLog, RecordError> {
    let path = path.as_ref();
    let bytes = read_bytes(path)?;
    let mut log = PartialLog::default();
    let stop = for_each_record(&bytes, |record| log.take(record))?;
    log.into_run(path, stop)
}

/// The bytes of a file that begins with the magic of MCAP.
///
/// # Errors
/// [`RecordError::File`], [`RecordError::NotMcap`].
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, RecordError> {
    let bytes = std::fs::read(path).map_err(RecordError::file("read", path))?;
    if bytes.starts_with(mcap::MAGIC) { Ok(bytes) } else { Err(RecordError::NotMcap { path: path.to_owned() }) }
}

/// Feeds every record to `take`. Where the container stops being readable, the
/// reason is the value: everything before it counts.
pub(super) fn for_each_record(
    bytes: &[u8],
    mut take: impl FnMut(Record<'_>) -> Result<(), RecordError>,
) -> Result<Option<mcap::McapError>, RecordError> {
    let mut reader = LinearReader::new_with_options(
        LinearReaderOptions::default()
            .with_record_length_limit(bytes.len())
            .with_prevalidate_chunk_crcs(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true),
    );
    let mut rest = bytes;
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(wanted)) => {
                let (now, later) = rest.split_at(wanted.min(rest.len()));
                reader.insert(now.len()).copy_from_slice(now);
                reader.notify_read(now.len());
                rest = later;
            }
            Ok(LinearReadEvent::Record { opcode, data }) => match mcap::parse_record(opcode, data) {
                Ok(record) => take(record)?,
                Err(reason) => return Ok(Some(reason)),
            },
            Err(reason) => return Ok(Some(reason)),
        }
    }
    Ok(None)
}

/// One of the topics that a run is read from.
#[derive(Debug, Clone, Copy)]
enum Topic {
    Telemetry,
    Setpoint,
    Model,
    Truth,
    Fault,
    Outputs,
    Shape,
    Body,
}

impl Topic {
    const ALL: [(Self, &'static str, MessageType); 8] = [
        (Self::Telemetry, super::TELEMETRY_TOPIC, TELEMETRY),
        (Self::Setpoint, super::SETPOINT_TOPIC, DEFORMATION),
        (Self::Model, super::MODEL_TOPIC, DEFORMATION),
        (Self::Truth, super::TRUTH_TOPIC, TRUTH),
        (Self::Fault, super::FAULT_TOPIC, FAULT),
        (Self::Outputs, super::OUTPUTS_TOPIC, OUTPUTS),
        (Self::Shape, super::SHAPE_TOPIC, SHAPE),
        (Self::Body, super::BODY_TOPIC, BODY),
    ];
}

/// A log as far as it has been read.
#[derive(Debug, Default)]
struct PartialLog {
    run: Option<Metadata>,
    end: Option<Metadata>,
    scene_text: Option<String>,
    schemas: HashMap<u16, (String, Vec<u8>)>,
    topics: HashMap<u16, (Topic, &'static str)>,
    samples: Vec<Sample>,
    faults: Vec<super::FaultRecord>,
    shapes: Vec<super::Shape>,
    bodies: Vec<super::Body>,
}

impl PartialLog {
    fn take(&mut self, record: Record<'_>) -> Result<(), RecordError> {
        match record {
            Record::Metadata(metadata) if metadata.name == super::RUN_METADATA => {
                self.run = Some(metadata.metadata);
            }
            Record::Metadata(metadata) if metadata.name == super::END_METADATA => {
                self.end = Some(metadata.metadata);
            }
            Record::Attachment { header, data, .. } if header.name == super::SCENE_ATTACHMENT => {
                self.scene_text = Some(String::from_utf8_lossy(&data).into_owned());
            }
            Record::Schema { header, data } => {
                self.schemas.insert(header.id, (header.name, data.into_owned()));
            }
            Record::Channel(channel) => self.take_channel(channel)?,
            Record::Message { header, data } => {
                if let Some(&(topic, name)) = self.topics.get(&header.channel_id) {
                    self.take_message(topic, name, header.sequence, &data)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn take_channel(&mut self, channel: mcap::records::Channel) -> Result<(), RecordError> {
        let ours = Topic::ALL.into_iter().find(|(_, name, _)| *name == channel.topic);
        let Some((topic, name, expected)) = ours else {
            return Ok(());
        };
        let schema = self.schemas.get(&channel.schema_id);
        let matches = schema.is_some_and(|(found, text)| found == expected.name && expected.has_fields_of(text));
        if !matches {
            return Err(RecordError::Schema {
                topic: channel.topic,
                found: schema.map(|(found, _)| found.clone()).unwrap_or_default(),
                expected: expected.name,
            });
        }
        self.topics.insert(channel.id, (topic, name));
        Ok(())
    }

    fn take_message(
        &mut self,
        topic: Topic,
        name: &'static str,
        sequence: u32,
        data: &[u8],
    ) -> Result<(), RecordError> {
        let undecodable = |source: CdrError| RecordError::Message { topic: name, sequence, source };
        let inconsistent = |reason: String| RecordError::Inconsistent { topic: name, sequence, reason };
        match topic {
            Topic::Telemetry => {
                let outputs = self.samples.last().map(|sample| sample.outputs).unwrap_or_default();
                let sample = decode_telemetry(data).map_err(undecodable)?;
                self.samples.push(Sample { outputs, ..sample });
            }
            Topic::Outputs => {
                let outputs = decode_outputs(data).map_err(undecodable)?;
                self.current(sequence).map_err(inconsistent)?.outputs = outputs;
            }
            Topic::Fault => self.faults.push(decode_fault(data).map_err(undecodable)?),
            Topic::Shape => self.shapes.push(decode_shape(data).map_err(undecodable)?),
            Topic::Body => {
                let body = decode_body(data).map_err(undecodable)?;
                let (points, radii) = (body.line_m.len(), body.radius_m.len());
                if points != radii {
                    return Err(inconsistent(format!("{radii} radii for {points} points")));
                }
                self.bodies.push(body);
            }
            Topic::Setpoint => {
                let (setpoints, tip) = decode_deformation(data).map_err(undecodable)?;
                let sample = self.current(sequence).map_err(inconsistent)?;
                sample.modules = setpoints.into_iter().map(module_with_setpoint).collect();
                sample.tip_setpoint_m = tip;
            }
            Topic::Model => {
                let (modelled, tip) = decode_deformation(data).map_err(undecodable)?;
                let sample = self.current(sequence).map_err(inconsistent)?;
                sample.tip_modelled_m = tip;
                each(&mut sample.modules, modelled, |module, value| module.modelled = value).map_err(inconsistent)?;
            }
            Topic::Truth => {
                let truth = Truth::decode(data).map_err(undecodable)?;
                let sample = self.current(sequence).map_err(inconsistent)?;
                apply_truth(sample, truth).map_err(inconsistent)?;
            }
        }
        Ok(())
    }

    /// The sample that a message belongs to: the one whose telemetry came last.
    fn current(&mut self, sequence: u32) -> Result<&mut Sample, String> {
        let count = self.samples.len();
        match self.samples.last_mut() {
            Some(sample) if count as u64 == u64::from(sequence) + 1 => Ok(sample),
            _ => Err("its telemetry is missing".into()),
        }
    }

    fn into_run(self, path: &Path, stop: Option<mcap::McapError>) -> Result<RunLog, RecordError> {
        if let Some(reason @ mcap::McapError::UnsupportedCompression(_)) = stop {
            return Err(RecordError::container("reading a chunk")(reason));
        }
        let run = self.run.ok_or_else(|| RecordError::NotARun { path: path.to_owned() })?;
        let info = read_run(path, &run, self.scene_text.unwrap_or_default())?;
        let incomplete = match (&self.end, stop) {
            (Some(_), None) => None,
            (None, None) => Some("the run was not finished".to_owned()),
            (_, Some(reason)) => Some(format!("the file is cut off or damaged, and the rest is lost ({reason})")),
        };
        let RunEnd { link, peak_chamber_pa, wall_s, targets, contacts } = match self.end {
            Some(end) => read_end(&end)?,
            None => RunEnd::default(),
        };
        check_counts(&info, &self.samples)?;
        Ok(RunLog {
            info,
            samples: self.samples,
            faults: self.faults,
            shapes: self.shapes,
            bodies: self.bodies,
            link,
            peak_chamber_pa,
            wall_s,
            targets,
            contacts,
            incomplete,
        })
    }
}

fn module_with_setpoint(setpoint: f64) -> ModuleSample {
    ModuleSample { setpoint, modelled: f64::NAN, achieved: None }
}

/// Sets one value in each element, which must be as many as the values.
fn each<T, V>(elements: &mut [T], values: Vec<V>, set: impl Fn(&mut T, V)) -> Result<(), String> {
    if elements.len() != values.len() {
        return Err(format!("{} values for {}", values.len(), elements.len()));
    }
    elements.iter_mut().zip(values).for_each(|(element, value)| set(element, value));
    Ok(())
}

fn apply_truth(sample: &mut Sample, truth: Truth) -> Result<(), String> {
    sample.tip_achieved_m = truth.tip_m;
    each(&mut sample.modules, truth.modules, |module, value| module.achieved = value)?;
    each(&mut sample.channels, truth.pressure_pa, |channel, value| {
        channel.true_pressure_pa = value;
    })
}

/// Every sample must have the channels and modules that the run declares.
fn check_counts(info: &RunInfo, samples: &[Sample]) -> Result<(), RecordError> {
    let (channels, modules) = (info.channel_count(), info.modules.len());
    for (sequence, sample) in (0..).zip(samples) {
        if sample.channels.len() != channels || sample.modules.len() != modules {
            return Err(RecordError::Inconsistent {
                topic: super::TELEMETRY_TOPIC,
                sequence,
                reason: format!("not the {channels} channels and {modules} modules of the run"),
            });
        }
    }
    Ok(())
}
