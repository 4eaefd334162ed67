//! Recovers a log that was cut off or damaged, as a whole file.

use super::container::options;
use super::reader::read_bytes;
use super::viewer;
use super::{
    BODY_TOPIC, CAMERA_TOPIC, FAULT_TOPIC, IMU_TOPIC, RecordError, SAMPLES_TOPIC, SHAPE_TOPIC, TELEMETRY_TOPIC,
    TICKS_TOPIC, WIRE_TOPIC,
};
use mcap::records::{Record, op};
use softlimb_files::write_whole;
use std::collections::{BTreeMap, HashMap};
use std::io::Cursor;
use std::path::Path;

/// Opcode and length of a record.
const RECORD_HEADER: usize = 1 + 8;

/// Topics that number their own messages, instead of taking the number of the sample.
const ALONE: [&str; 8] =
    [FAULT_TOPIC, SHAPE_TOPIC, BODY_TOPIC, WIRE_TOPIC, SAMPLES_TOPIC, TICKS_TOPIC, CAMERA_TOPIC, IMU_TOPIC];

/// Outcome of a recovery.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Recovered {
    /// Messages in the new file.
    pub messages: u64,
    /// Those of them from a chunk that was not closed: no checksum covers them.
    pub unchecked: u64,
    /// Chunks that were closed and undamaged.
    pub chunks: u64,
    /// Chunks that are damaged and left out.
    pub chunks_damaged: u64,
    /// Bytes of the old file that hold nothing readable.
    pub bytes_lost: u64,
    /// Whether the old file was a finished log.
    pub was_finished: bool,
}

/// Writes all that a log still holds to a new file, which any reader opens: the closed chunks, and of one that was not closed the messages up
/// to the last sample.
///
/// # Errors
/// [`RecordError`]: no such file, no log, a compressed chunk, a full disk.
pub fn recover(log: impl AsRef<Path>, out: impl AsRef<Path>) -> Result<Recovered, RecordError> {
    let (log, out) = (log.as_ref(), out.as_ref());
    let bytes = read_bytes(log)?;
    let container = RecordError::container("writing what was recovered");
    let mut copy = Copy::new(options().create(Cursor::new(Vec::new())).map_err(container)?);
    copy.take_file(bytes.get(mcap::MAGIC.len()..).unwrap_or_default())?;
    if !copy.is_a_run {
        return Err(RecordError::NotARun { path: log.to_owned() });
    }
    let (recovered, bytes) = copy.finish()?;
    write_whole(out, &bytes).map_err(|error| RecordError::File {
        action: error.doing,
        path: error.path,
        source: error.source,
    })?;
    Ok(recovered)
}

/// The record at the front, its length in the file, and its body as far as it is there; `None` where not even its length is.
fn record(bytes: &[u8]) -> Option<(u8, u64, &[u8])> {
    let (header, rest) = bytes.split_at_checked(RECORD_HEADER)?;
    let (&opcode, length) = header.split_first()?;
    let length = u64::from_le_bytes(length.try_into().ok()?);
    let body = usize::try_from(length).ok().and_then(|length| rest.get(..length)).unwrap_or(rest);
    Some((opcode, length, body))
}

/// The records of an uncompressed chunk that was not closed.
fn open_chunk(body: &[u8]) -> Option<&[u8]> {
    let compression_at = 8 + 8 + 8 + 4;
    let compression: [u8; 4] = body.get(compression_at..compression_at + 4)?.try_into().ok()?;
    // Another length than 0 is a name: what is compressed needs all of its bytes.
    (u32::from_le_bytes(compression) == 0).then(|| body.get(compression_at + 4 + 8..))?
}

/// A log that is copied record by record.
struct Copy {
    mcap: mcap::Writer<Cursor<Vec<u8>>>,
    schemas: HashMap<u16, u16>,
    topics: HashMap<u16, (u16, String)>,
    /// Number of the last sample in the old log, and of the next one in the new: a damaged chunk leaves a gap.
    sample: (Option<u32>, u32),
    is_a_run: bool,
    recovered: Recovered,
}

impl Copy {
    fn new(mcap: mcap::Writer<Cursor<Vec<u8>>>) -> Self {
        let (schemas, topics) = (HashMap::new(), HashMap::new());
        Self { mcap, schemas, topics, sample: (None, 0), is_a_run: false, recovered: Recovered::default() }
    }

    fn take_file(&mut self, mut rest: &[u8]) -> Result<(), RecordError> {
        while let Some((opcode, length, body)) = record(rest) {
            if (body.len() as u64) < length {
                return self.take_last(opcode, body, rest.len() as u64);
            }
            rest = &rest[RECORD_HEADER + body.len()..];
            match mcap::parse_record(opcode, body) {
                Ok(Record::Chunk { header, data }) => self.take_chunk(header, &data)?,
                Ok(Record::Footer(_)) => return Ok(()),
                Ok(record) => self.take(record)?,
                Err(_) => self.recovered.bytes_lost += (RECORD_HEADER + body.len()) as u64,
            }
        }
        self.recovered.bytes_lost += rest.len() as u64;
        Ok(())
    }

    fn take_chunk(&mut self, header: mcap::records::ChunkHeader, data: &[u8]) -> Result<(), RecordError> {
        let records = mcap::read::ChunkReader::new(header, data).and_then(Iterator::collect::<Result<Vec<_>, _>>);
        match records {
            Ok(records) => {
                records.into_iter().try_for_each(|record| self.take(record))?;
                self.recovered.chunks += 1;
                self.mcap.flush().map_err(RecordError::container("writing what was recovered"))
            }
            Err(reason @ mcap::McapError::UnsupportedCompression(_)) => {
                Err(RecordError::container("reading a chunk")(reason))
            }
            Err(_) => {
                self.recovered.chunks_damaged += 1;
                Ok(())
            }
        }
    }

    /// Takes the record in which the file ends.
    fn take_last(&mut self, opcode: u8, body: &[u8], length: u64) -> Result<(), RecordError> {
        let mut rest = if opcode == op::CHUNK { open_chunk(body).unwrap_or_default() } else { &[] };
        let mut records = Vec::new();
        while let Some((opcode, length, body)) = record(rest).filter(|(_, length, body)| body.len() as u64 == *length) {
            let Ok(record) = mcap::parse_record(opcode, body) else { break };
            rest = &rest[RECORD_HEADER + length as usize..];
            records.push(record.into_owned());
        }
        let telemetry = |record: &Record<'_>| match record {
            Record::Message { header, .. } => self.is_telemetry(header.channel_id),
            _ => false,
        };
        // The last sample may lack messages.
        let whole = records.iter().rposition(telemetry).unwrap_or(records.len());
        let before = self.recovered.messages;
        records.drain(..whole).try_for_each(|record| self.take(record))?;
        self.recovered.unchecked = self.recovered.messages - before;
        self.recovered.bytes_lost += if self.recovered.unchecked == 0 { length } else { rest.len() as u64 };
        Ok(())
    }

    fn is_telemetry(&self, channel: u16) -> bool {
        self.topics.get(&channel).is_some_and(|(_, topic)| topic == TELEMETRY_TOPIC)
    }

    fn take(&mut self, record: Record<'_>) -> Result<(), RecordError> {
        self.copy(record).map_err(RecordError::container("writing what was recovered"))
    }

    fn copy(&mut self, record: Record<'_>) -> mcap::McapResult<()> {
        match record {
            Record::Schema { header, data } => {
                self.schemas.insert(header.id, self.mcap.add_schema(&header.name, &header.encoding, &data)?);
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id).copied().unwrap_or(0);
                let id = self.mcap.add_channel(schema, &channel.topic, &channel.message_encoding, &channel.metadata)?;
                self.topics.insert(channel.id, (id, channel.topic));
            }
            Record::Message { header, data } => {
                let Some((channel_id, topic)) = self.topics.get(&header.channel_id).cloned() else { return Ok(()) };
                let Some(sequence) = self.sequence(&topic, header.sequence) else { return Ok(()) };
                self.mcap
                    .write_to_known_channel(&mcap::records::MessageHeader { channel_id, sequence, ..header }, &data)?;
                self.recovered.messages += 1;
            }
            Record::Attachment { header, data, .. } => self.mcap.attach(&mcap::Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name,
                media_type: header.media_type,
                data,
            })?,
            Record::Metadata(metadata) => {
                self.is_a_run |= metadata.name == super::RUN_METADATA;
                self.recovered.was_finished |= metadata.name == super::END_METADATA;
                self.mcap.write_metadata(&metadata)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Number of a message in the new log; `None` for one whose sample is lost.
    fn sequence(&mut self, topic: &str, old: u32) -> Option<u32> {
        if ALONE.contains(&topic) || viewer::TOPICS.contains(&topic) {
            return Some(old);
        }
        if topic == TELEMETRY_TOPIC {
            self.sample = (Some(old), self.sample.1 + 1);
        }
        (self.sample.0 == Some(old)).then(|| self.sample.1 - 1)
    }

    fn finish(mut self) -> Result<(Recovered, Vec<u8>), RecordError> {
        let Recovered { messages, unchecked, chunks_damaged, bytes_lost, .. } = self.recovered;
        let about = [
            ("messages", messages),
            ("unchecked", unchecked),
            ("chunks_damaged", chunks_damaged),
            ("bytes_lost", bytes_lost),
        ];
        let metadata: BTreeMap<String, String> = about.map(|(key, value)| (key.to_owned(), value.to_string())).into();
        let note = mcap::records::Metadata { name: super::RECOVERED_METADATA.into(), metadata };
        let written = self.mcap.write_metadata(&note).and_then(|()| self.mcap.finish());
        written.map_err(RecordError::container("writing what was recovered"))?;
        Ok((self.recovered, self.mcap.into_inner().into_inner()))
    }
}
