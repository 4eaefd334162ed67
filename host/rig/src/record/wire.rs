//! Reads and writes the bytes of the link in a log, and gathers the inputs of a re-run.

use super::RecordError;
use super::cdr::CdrError;
use super::messages::{MessageType, SAMPLES, TICKS, WIRE, begin, open};
use super::reader::{for_each_record, read_bytes};
use super::samples::{SampleRow, decode_samples};
use super::ticks::{DeviceTick, decode_ticks};
use mcap::records::Record;
use serde::Serialize;
use std::collections::HashMap;
use std::path::Path;

/// Direction of bytes on the link.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// From the host to the device.
    ToDevice,
    /// From the device to the host.
    ToHost,
}

/// Bytes that the host handed to its port, or took from it, at once.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct WireBytes {
    /// The host's monotonic clock, us.
    pub host_us: u64,
    /// Their direction.
    pub direction: Direction,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// Encodes bytes of the link.
pub(super) fn encode_wire(unix_ns: u64, wire: &WireBytes) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.u64(wire.host_us);
    cdr.u8(match wire.direction {
        Direction::ToDevice => 0,
        Direction::ToHost => 1,
    });
    cdr.u8_sequence(&wire.bytes);
    cdr.into_bytes()
}

fn decode_wire(message: &[u8]) -> Result<WireBytes, CdrError> {
    let mut cdr = open(message)?;
    let (host_us, direction) = (cdr.u64()?, cdr.u8()?);
    let direction = if direction == 0 { Direction::ToDevice } else { Direction::ToHost };
    Ok(WireBytes { host_us, direction, bytes: cdr.u8_sequence()? })
}

/// Link, ticks and samples of a whole log.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Capture {
    /// Bytes of the link in order of time.
    pub wire: Vec<WireBytes>,
    /// Control ticks in order of time; none in the log of a device that does not show them.
    pub ticks: Vec<DeviceTick>,
    /// The outputs of the ticks are those of the pins of an emulated chip, one tick later.
    pub at_pins: bool,
    /// Measurements between those of the telemetry, in order of time; none where none were requested.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub samples: Vec<SampleRow>,
}

impl Capture {
    /// All bytes of one direction, each piece with its time on the host's clock, us.
    pub fn bytes(&self, direction: Direction) -> impl Iterator<Item = (u64, &[u8])> {
        let of = self.wire.iter().filter(move |wire| wire.direction == direction);
        of.map(|wire| (wire.host_us, wire.bytes.as_slice()))
    }
}

/// Reads the link, the ticks and the samples of a log; of a log that was cut off, as much as it has.
///
/// # Errors
/// As [`super::read`].
pub fn read_capture(path: impl AsRef<Path>) -> Result<Capture, RecordError> {
    let bytes = read_bytes(path.as_ref())?;
    let (mut capture, mut topics) = (Capture::default(), HashMap::new());
    for_each_record(&bytes, |record| {
        match record {
            Record::Channel(channel) => {
                let ours = [(super::WIRE_TOPIC, WIRE), (super::TICKS_TOPIC, TICKS), (super::SAMPLES_TOPIC, SAMPLES)];
                if let Some(of) = ours.into_iter().find(|(name, _)| *name == channel.topic) {
                    topics.insert(channel.id, of);
                }
            }
            Record::Message { header, data } => {
                if let Some((topic, of)) = topics.get(&header.channel_id) {
                    let undecodable = |source| RecordError::Message { topic, sequence: header.sequence, source };
                    capture.take(of, &data).map_err(undecodable)?;
                }
            }
            _ => {}
        }
        Ok(())
    })?;
    Ok(capture)
}

impl Capture {
    fn take(&mut self, of: &MessageType, data: &[u8]) -> Result<(), CdrError> {
        if of.name == WIRE.name {
            self.wire.push(decode_wire(data)?);
        } else if of.name == SAMPLES.name {
            self.samples.push(decode_samples(data)?);
        } else {
            let (ticks, at_pins) = decode_ticks(data)?;
            self.ticks.extend(ticks);
            self.at_pins = at_pins;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_the_link_have_the_layout_of_their_definition() {
        let wire = WireBytes { host_us: 0x0102, direction: Direction::ToHost, bytes: vec![0x55, 0x00] };
        let mut expected = vec![0, 1, 0, 0];
        expected.extend([0; 8]); // stamp
        expected.extend([6, 0, 0, 0, b'w', b'o', b'r', b'l', b'd', 0]); // frame at 8..18
        expected.extend([0; 6]); // padding to 24
        expected.extend([2, 1, 0, 0, 0, 0, 0, 0]); // host_us at 24
        expected.push(1); // direction at 32
        expected.extend([0; 3]); // padding to 36
        expected.extend([2, 0, 0, 0, 0x55, 0x00]);
        assert_eq!(encode_wire(0, &wire), expected);
        assert_eq!(decode_wire(&expected), Ok(wire));
    }
}
