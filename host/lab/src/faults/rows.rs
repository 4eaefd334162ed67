//! Faults with their expectations: names that the device may give them, and the time that it may take.

use std::ops::Range;

use softlimb_protocol::FaultCode::{
    self, EmergencyStop, ExcessAir, FillWithoutEffect, LinkLost, MissingAir, OverPressure, ReadingJumped, SensorFrozen,
    SensorImplausible, SupplyLow, ValveSupplyLow,
};
use softlimb_sim::plant::PartFault::{
    self, CoilsSwapped, FillStuckClosed, FillStuckOpen, HoseKinked, Leak, PumpWeak, ReferenceSag, SensorDrift,
    SensorOpen, SensorZero, SensorsSwapped, SupplyStuckClosed, SupplyStuckOpen, ValveSupplySag, VentStuckClosed,
    VentStuckOpen,
};

use super::bench::CHANNELS;

/// One fault on purpose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// A part of the pneumatics.
    Part(PartFault),
    /// The emergency stop is pressed.
    Stop,
    /// The device resets.
    Reset,
    /// The link carries nothing any more.
    Silence,
    /// The host does nothing for 600 ms.
    Stall,
}

/// Latest time of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deadline {
    /// So many ms after the fault, which shows at once.
    Fault(u32),
    /// So many ms after its first effect on a true pressure: a part at rest shows nothing.
    Effect(u32),
    /// When the readings of the vented chambers are compared with their zeros, if they are too far off by then.
    Zero,
    /// None: no report is needed.
    Never,
}

/// A row of the matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Name, with the severity.
    pub name: &'static str,
    /// What breaks, all of it at the same time.
    pub faults: &'static [Fault],
    /// Codes that name it.
    pub codes: &'static [FaultCode],
    /// Latest time of the report.
    pub deadline: Deadline,
    /// Reason of failures that are left; empty where none is.
    pub reason: &'static str,
}

impl Row {
    /// The channels that it is tried on: one, where it belongs to none.
    #[must_use]
    pub fn channels(&self) -> Range<usize> {
        let is_of_channel = |fault: &Fault| matches!(fault, Fault::Part(part) if part.is_of_channel());
        if self.faults.iter().any(is_of_channel) { 0..CHANNELS } else { 0..1 }
    }
}

const fn row(
    name: &'static str,
    faults: &'static [Fault],
    codes: &'static [FaultCode],
    deadline: Deadline,
    reason: &'static str,
) -> Row {
    Row { name, faults, codes, deadline, reason }
}

const ANY: &[FaultCode] =
    &[SensorFrozen, ReadingJumped, FillWithoutEffect, ExcessAir, MissingAir, OverPressure, SupplyLow];
const DRIFT: &[FaultCode] = &[SensorImplausible, FillWithoutEffect, ReadingJumped, MissingAir];
const AT_REST: &str = "named once the loop fills or vents again: a chamber at rest shows no effect";
const NO_NAME: &str = "the loop compensates it, and takes too little air for it to tell";
const EMPTY: &str = "named once the pressure rises: from an almost empty chamber little air flows";

/// All rows.
#[must_use]
pub fn rows() -> [Row; 36] {
    use Deadline::{Effect, Never, Zero};
    use Fault::{Part, Reset, Silence, Stall, Stop};
    [
        row("sensor-open", &[Part(SensorOpen)], &[SensorImplausible], Deadline::Fault(10), ""),
        row("sensor-frozen", &[Part(PartFault::SensorFrozen)], &[SensorFrozen], Effect(300), AT_REST),
        row(
            "sensor-zero",
            &[Part(SensorZero)],
            &[SensorFrozen, ReadingJumped, FillWithoutEffect, MissingAir],
            Deadline::Fault(300),
            AT_REST,
        ),
        row("sensor-drift -5 kPa/s", &[Part(SensorDrift { pa_per_s: -5e3 })], DRIFT, Zero, NO_NAME),
        row("sensor-drift -1 kPa/s", &[Part(SensorDrift { pa_per_s: -1e3 })], DRIFT, Zero, NO_NAME),
        row("sensors-swapped", &[Part(SensorsSwapped)], ANY, Deadline::Fault(300), AT_REST),
        row("fill-stuck-open", &[Part(FillStuckOpen)], ANY, Effect(300), ""),
        row("fill-stuck-closed", &[Part(FillStuckClosed)], ANY, Effect(500), AT_REST),
        row("vent-stuck-open", &[Part(VentStuckOpen)], ANY, Effect(300), EMPTY),
        row("vent-stuck-closed", &[Part(VentStuckClosed)], ANY, Effect(500), AT_REST),
        row("coils-swapped", &[Part(CoilsSwapped)], ANY, Effect(500), AT_REST),
        row("burst 10 mm2", &[Part(Leak { conductance_m3_per_s_pa: 2e-8 })], ANY, Effect(100), EMPTY),
        row("burst 2.5 mm2", &[Part(Leak { conductance_m3_per_s_pa: 5e-9 })], ANY, Effect(100), EMPTY),
        row("leak 20 mL/s", &[Part(Leak { conductance_m3_per_s_pa: 1e-10 })], ANY, Effect(5_000), NO_NAME),
        row("leak 4 mL/s", &[Part(Leak { conductance_m3_per_s_pa: 2e-11 })], ANY, Effect(5_000), NO_NAME),
        row("hose-kinked 2 %", &[Part(HoseKinked { share: 0.02 })], ANY, Effect(500), AT_REST),
        row("hose-kinked 10 %", &[Part(HoseKinked { share: 0.1 })], ANY, Effect(500), ""),
        row("supply-stuck-open", &[Part(SupplyStuckOpen)], &[], Never, ""),
        row("supply-stuck-closed", &[Part(SupplyStuckClosed)], ANY, Effect(500), AT_REST),
        row("pump-weak 10 %", &[Part(PumpWeak { share: 0.1 })], &[], Never, ""),
        row("pump-weak 50 %", &[Part(PumpWeak { share: 0.5 })], &[], Never, ""),
        row("reference-sag 10 %", &[Part(ReferenceSag { share: 0.1 })], &[], Never, ""),
        row("reference-sag 3 %", &[Part(ReferenceSag { share: 0.03 })], &[], Never, ""),
        row(
            "valve-supply-sag 80 %",
            &[Part(ValveSupplySag { share: 0.8 })],
            &[ValveSupplyLow],
            Deadline::Fault(10),
            "",
        ),
        row(
            "valve-supply-sag 40 %",
            &[Part(ValveSupplySag { share: 0.4 })],
            &[ValveSupplyLow],
            Deadline::Fault(10),
            "",
        ),
        row("emergency-stop", &[Stop], &[EmergencyStop], Deadline::Fault(5), ""),
        row("device-reset", &[Reset], &[], Never, ""),
        row("link-silent", &[Silence], &[LinkLost], Deadline::Fault(300), ""),
        row("host-stall", &[Stall], &[], Never, ""),
        row("frozen + fill open", &[Part(PartFault::SensorFrozen), Part(FillStuckOpen)], ANY, Effect(300), AT_REST),
        row("hose off + fill open", &[Part(SensorZero), Part(FillStuckOpen)], ANY, Deadline::Fault(300), ""),
        row("frozen + supply open", &[Part(PartFault::SensorFrozen), Part(SupplyStuckOpen)], ANY, Effect(300), AT_REST),
        row("hose off + supply open", &[Part(SensorZero), Part(SupplyStuckOpen)], ANY, Deadline::Fault(300), AT_REST),
        row(
            "frozen + link silent",
            &[Part(PartFault::SensorFrozen), Silence],
            &[SensorFrozen, LinkLost],
            Deadline::Fault(300),
            "",
        ),
        row("fill open + vent closed", &[Part(FillStuckOpen), Part(VentStuckClosed)], ANY, Effect(300), ""),
        row("fill open + reset", &[Part(FillStuckOpen), Reset], &[], Never, ""),
    ]
}
