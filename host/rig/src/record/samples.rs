//! Measurements between those of the telemetry.

use super::cdr::{CdrError, CdrReader};
use super::messages::{begin, open};
use serde::Serialize;

/// Consecutive measurements of one message of the device.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampleRow {
    /// Time of the first one in the run, s.
    pub time_s: f64,
    /// Time from one to the next, s.
    pub period_s: f64,
    /// Measurements that the device could not send, so far.
    pub left_out: u32,
    /// State of the device, one a measurement.
    pub states: Vec<u8>,
    /// Pressure at the manifold, gauge, Pa, and duty from -1 to 1: one a channel, of the measurements in order.
    pub channels: Vec<Vec<(f64, f64)>>,
}

/// Encodes a row.
pub(super) fn encode_samples(unix_ns: u64, row: &SampleRow) -> Vec<u8> {
    let mut cdr = begin(unix_ns);
    cdr.f64(row.time_s);
    cdr.f64(row.period_s);
    cdr.u32(row.left_out);
    cdr.u32(row.channels.first().map_or(0, |channels| channels.len() as u32));
    cdr.u8_sequence(&row.states);
    let values: Vec<(f64, f64)> = row.channels.iter().flatten().copied().collect();
    cdr.f64_sequence(values.iter().map(|value| value.0));
    cdr.f64_sequence(values.iter().map(|value| value.1));
    cdr.into_bytes()
}

/// Decodes a row; a measurement has as many pressures and duties as there are channels.
pub(super) fn decode_samples(message: &[u8]) -> Result<SampleRow, CdrError> {
    let mut cdr = open(message)?;
    let (time_s, period_s, left_out, count) = (cdr.f64()?, cdr.f64()?, cdr.u32()?, cdr.u32()?);
    let states = cdr.u8_sequence()?;
    let (pressures, duties) = (cdr.sequence(CdrReader::f64)?, cdr.sequence(CdrReader::f64)?);
    let values: Vec<(f64, f64)> = pressures.into_iter().zip(duties).collect();
    let channels = values.chunks(count.max(1) as usize).map(<[_]>::to_vec).collect();
    Ok(SampleRow { time_s, period_s, left_out, states, channels })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_have_the_layout_of_their_definition() {
        let channels = vec![vec![(10.0, 0.5), (20.0, -1.0)], vec![(30.0, 0.0), (40.0, 1.0)]];
        let row = SampleRow { time_s: 1.5, period_s: 0.002, left_out: 7, states: vec![2, 3], channels };
        let bytes = encode_samples(0, &row);
        let mut cdr = open(&bytes).unwrap();
        assert_eq!((cdr.f64(), cdr.f64(), cdr.u32(), cdr.u32()), (Ok(1.5), Ok(0.002), Ok(7), Ok(2)));
        assert_eq!(cdr.u8_sequence(), Ok(vec![2, 3]));
        let mut values = || cdr.sequence(CdrReader::f64).unwrap();
        assert_eq!((values(), values()), (vec![10.0, 20.0, 30.0, 40.0], vec![0.5, -1.0, 0.0, 1.0]));
        assert_eq!(decode_samples(&bytes), Ok(row));
    }
}
