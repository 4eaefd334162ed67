//! Columns of numbers as the page reads them: differences from row to row, byte by byte, then compressed.

use std::io::Write;

use data_encoding::BASE64;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;

/// Stands for a number that is not finite, or too large for its step.
const ABSENT: i32 = i32::MIN;

/// A column's place in the bytes is that in the list: four bytes a row.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Column {
    /// Name, unique in its table.
    pub(super) name: String,
    /// Distance of two values that follow each other.
    pub(super) step: f64,
}

/// Columns of one length.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(super) struct Table {
    /// Number of rows.
    pub(super) rows: usize,
    /// The columns.
    pub(super) columns: Vec<Column>,
    #[serde(skip)]
    bytes: Vec<u8>,
}

impl Table {
    /// A table without columns.
    pub(super) fn new(rows: usize) -> Self {
        Self { rows, ..Self::default() }
    }

    /// Adds a column of values to a step. Absent and infinite values stay absent.
    pub(super) fn add(&mut self, name: impl Into<String>, step: f64, values: impl Iterator<Item = f64>) {
        let mut last = 0_i32;
        let differences = values.map(|value| {
            let units = (value / step).round();
            let units = if units.abs() < f64::from(i32::MAX) { units as i32 } else { ABSENT };
            let difference = units.wrapping_sub(last);
            last = units;
            // Small differences of either sign have zeros in their high bytes.
            ((difference << 1) ^ (difference >> 31)).to_le_bytes()
        });
        let differences: Vec<[u8; 4]> = differences.collect();
        assert_eq!(differences.len(), self.rows, "a column is as long as its table");
        (0..4).for_each(|plane| self.bytes.extend(differences.iter().map(|bytes| bytes[plane])));
        self.columns.push(Column { name: name.into(), step });
    }
}

/// The bytes of tables, one after the other, compressed and as text.
pub(super) fn packed(tables: &[&Table]) -> String {
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    let written = tables.iter().try_for_each(|table| packed.write_all(&table.bytes));
    let bytes = written.and_then(|()| packed.finish()).expect("memory takes every byte");
    BASE64.encode(&bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_planes_of_bytes_by_hand() {
        let mut table = Table::new(4);
        // Units 3, 1, absent, 300: differences 3, -2, i32::MIN - 1 (wrapped), 300 - i32::MIN.
        table.add("x", 0.5, [1.5, 0.5, f64::NAN, 150.0].into_iter());
        // As even numbers for those that rise, odd for those that fall: 6, 3, u32::MAX - 1, 0xFFFF_FDA7.
        assert_eq!(table.bytes, [6, 3, 0xFE, 0xA7, 0, 0, 0xFF, 0xFD, 0, 0, 0xFF, 0xFF, 0, 0, 0xFF, 0xFF]);
    }

    #[test]
    fn numbers_beyond_the_steps_are_absent() {
        let mut far = Table::new(3);
        far.add("x", 0.1, [f64::MAX, f64::INFINITY, 3e8].into_iter());
        let mut absent = Table::new(3);
        absent.add("x", 0.1, [f64::NAN; 3].into_iter());
        assert_eq!(far.bytes, absent.bytes);
    }
}
