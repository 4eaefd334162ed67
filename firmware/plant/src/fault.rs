//! Parts that break.

/// A broken part. The faults of the supplies and of the converter belong to no channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartFault {
    /// The fill valve stays open.
    FillStuckOpen,
    /// The fill valve stays closed.
    FillStuckClosed,
    /// The vent valve stays open.
    VentStuckOpen,
    /// The vent valve stays closed.
    VentStuckClosed,
    /// The coils of fill and vent valve are connected to each other's output.
    CoilsSwapped,
    /// A hole in the actuator.
    Leak {
        /// Its sonic conductance, m3/(s Pa); 0..=1e-7. A slow puncture is 2e-11, a torn tube 1e-9.
        conductance_m3_per_s_pa: f64,
    },
    /// The hose between manifold and actuator is kinked.
    HoseKinked {
        /// Remaining share of its sonic conductance, 0..=1.
        share: f64,
    },
    /// The wire of the pressure sensor is off: the converter reads 0.
    SensorOpen,
    /// The sensor repeats its last code.
    SensorFrozen,
    /// The hose of the sensor is off: it measures the room.
    SensorZero,
    /// The offset of the sensor moves.
    SensorDrift {
        /// Change of the reading at an unchanged pressure, Pa/s; -1e5..=1e5.
        pa_per_s: f64,
    },
    /// The sensor and that of the next channel are connected to each other's input; the last channel's next is the first.
    SensorsSwapped,
    /// The valve between supply and fill valves stays open.
    SupplyStuckOpen,
    /// The valve between supply and fill valves stays closed.
    SupplyStuckClosed,
    /// The pump delivers a share of its flow.
    PumpWeak {
        /// Remaining share of its flow, 0..=1.
        share: f64,
    },
    /// The reference voltage of the converter sinks: all codes rise.
    ReferenceSag {
        /// Lost share of the reference, 0..=0.5.
        share: f64,
    },
    /// The voltage of the valves' supply falls, for coils and pump. Below 70 % no valve opens, below 35 % none stays open.
    ValveSupplySag {
        /// Lost share of the voltage, 0..=1.
        share: f64,
    },
}

/// Faults by name, with the severity that a name alone stands for.
const NAMED: [(&str, PartFault); 18] = [
    ("fill-stuck-open", PartFault::FillStuckOpen),
    ("fill-stuck-closed", PartFault::FillStuckClosed),
    ("vent-stuck-open", PartFault::VentStuckOpen),
    ("vent-stuck-closed", PartFault::VentStuckClosed),
    ("coils-swapped", PartFault::CoilsSwapped),
    // 20 normal mL/s at 100 kPa.
    ("leak", PartFault::Leak { conductance_m3_per_s_pa: 1e-10 }),
    // A tear of 10 mm2.
    ("burst", PartFault::Leak { conductance_m3_per_s_pa: 2e-8 }),
    ("hose-kinked", PartFault::HoseKinked { share: 0.02 }),
    ("sensor-open", PartFault::SensorOpen),
    ("sensor-frozen", PartFault::SensorFrozen),
    ("sensor-zero", PartFault::SensorZero),
    ("sensor-drift", PartFault::SensorDrift { pa_per_s: -5e3 }),
    ("sensors-swapped", PartFault::SensorsSwapped),
    ("supply-stuck-open", PartFault::SupplyStuckOpen),
    ("supply-stuck-closed", PartFault::SupplyStuckClosed),
    ("pump-weak", PartFault::PumpWeak { share: 0.1 }),
    ("reference-sag", PartFault::ReferenceSag { share: 0.1 }),
    ("valve-supply-sag", PartFault::ValveSupplySag { share: 0.8 }),
];

impl PartFault {
    /// The fault of a name; [`names`](Self::names) lists them.
    pub fn named(name: &str) -> Option<Self> {
        NAMED.into_iter().find_map(|(known, fault)| (known == name).then_some(fault))
    }

    /// All names.
    pub fn names() -> impl Iterator<Item = &'static str> {
        NAMED.into_iter().map(|(name, _)| name)
    }

    /// Whether the fault is one of a channel; the supplies and the converter serve all.
    pub fn is_of_channel(&self) -> bool {
        !matches!(
            self,
            Self::SupplyStuckOpen
                | Self::SupplyStuckClosed
                | Self::PumpWeak { .. }
                | Self::ReferenceSag { .. }
                | Self::ValveSupplySag { .. }
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_find_their_fault() {
        let names: std::collections::HashSet<_> = PartFault::names().collect();
        assert_eq!(names.len(), NAMED.len());
        assert_eq!(PartFault::named("sensor-zero"), Some(PartFault::SensorZero));
        assert_eq!(PartFault::named("sensor"), None);
    }
}
