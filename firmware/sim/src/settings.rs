//! Settings of the simulated device: plain data, checked once by
//! [`SimulatedMcu::new`](crate::SimulatedMcu::new).

use softlimb_plant::PlantSettings;

use crate::error::SimError;

/// The device and the line to it.
#[derive(Clone, Debug, PartialEq)]
pub struct SimSettings {
    /// Pneumatics and actuators; at most as many channels as the controller has.
    pub plant: PlantSettings,
    /// Speed of the line, bits per second each way, ten bits a byte; 1200..=100_000_000.
    pub baud: u32,
    /// Device clock when the host's clock is 0, us; at most 2^52.
    pub clock_offset_us: u64,
    /// Relative speed of the device's clock by the host's, less one, 1e-6; -1000..=1000.
    pub clock_drift_ppm: f64,
    /// Faults of the line, each way.
    pub line_faults: LineFaults,
    /// Seed of the line faults; the plant has its own.
    pub seed: u64,
}

impl SimSettings {
    /// A device with a perfect line of 921600 baud and a clock equal to the host's.
    pub fn new(plant: PlantSettings) -> Self {
        Self { plant, baud: 921_600, clock_offset_us: 0, clock_drift_ppm: 0.0, line_faults: LineFaults::NONE, seed: 0 }
    }

    pub(crate) fn check(&self) -> Result<(), SimError> {
        within("baud", f64::from(self.baud), 1_200.0, 1e8)?;
        // Beyond 2^52 a time in us has no exact f64.
        within("clock_offset_us", self.clock_offset_us as f64, 0.0, (1_u64 << 52) as f64)?;
        within("clock_drift_ppm", self.clock_drift_ppm, -1_000.0, 1_000.0)?;
        self.line_faults.check()
    }
}

/// Probabilities per byte, independent of each other; 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineFaults {
    /// The byte is lost.
    pub drop: f64,
    /// One bit of the byte is inverted.
    pub flip: f64,
    /// The byte arrives twice.
    pub duplicate: f64,
}

impl LineFaults {
    /// A perfect line.
    pub const NONE: Self = Self { drop: 0.0, flip: 0.0, duplicate: 0.0 };

    /// A cut cable.
    pub const CUT: Self = Self { drop: 1.0, flip: 0.0, duplicate: 0.0 };

    pub(crate) fn check(&self) -> Result<(), SimError> {
        within("line_faults.drop", self.drop, 0.0, 1.0)?;
        within("line_faults.flip", self.flip, 0.0, 1.0)?;
        within("line_faults.duplicate", self.duplicate, 0.0, 1.0)
    }
}

/// Refuses NaN as well.
fn within(field: &'static str, value: f64, low: f64, high: f64) -> Result<(), SimError> {
    if (low..=high).contains(&value) { Ok(()) } else { Err(SimError::OutOfRange { field, value, low, high }) }
}
