//! The units in which the schema states bounds and defaults.

use crate::quantity::show_number;
use crate::unit::{Dimension, Scale};

/// A unit with the symbol a message shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unit {
    /// As a user writes it; empty for a plain number.
    pub(crate) symbol: &'static str,
    /// The SI unit of the same dimension, which a number without a unit has.
    pub(crate) si: &'static str,
    pub(crate) scale: Scale,
}

const fn unit(symbol: &'static str, si: &'static str, dimension: Dimension, num: f64, den: f64) -> Unit {
    Unit { symbol, si, scale: Scale::new(dimension, num, den) }
}

impl Unit {
    pub(crate) const NUMBER: Self = unit("", "", Dimension::RATIO, 1.0, 1.0);
    pub(crate) const PERCENT: Self = unit("%", "", Dimension::RATIO, 1.0, 1e2);
    pub(crate) const M: Self = unit("m", "m", Dimension::LENGTH, 1.0, 1.0);
    pub(crate) const MM: Self = unit("mm", "m", Dimension::LENGTH, 1.0, 1e3);
    pub(crate) const KG: Self = unit("kg", "kg", Dimension::MASS, 1.0, 1.0);
    pub(crate) const N: Self = unit("N", "N", Dimension::FORCE, 1.0, 1.0);
    pub(crate) const N_PER_M: Self = unit("N/m", "N/m", Dimension::STIFFNESS, 1.0, 1.0);
    pub(crate) const V: Self = unit("V", "V", Dimension::VOLTAGE, 1.0, 1.0);
    pub(crate) const S: Self = unit("s", "s", Dimension::TIME, 1.0, 1.0);
    pub(crate) const MS: Self = unit("ms", "s", Dimension::TIME, 1.0, 1e3);
    pub(crate) const K: Self = unit("K", "K", Dimension::TEMPERATURE, 1.0, 1.0);
    pub(crate) const DEG: Self = unit("deg", "rad", Dimension::ANGLE, std::f64::consts::PI, 180.0);
    pub(crate) const KPA: Self = unit("kPa", "Pa", Dimension::PRESSURE, 1e3, 1.0);
    pub(crate) const MPA: Self = unit("MPa", "Pa", Dimension::PRESSURE, 1e6, 1.0);
    pub(crate) const PSI: Self = unit("psi", "Pa", Dimension::PRESSURE, 44_482_216_152_605.0, 6_451_600_000.0);
    pub(crate) const L: Self = unit("L", "m3", Dimension::VOLUME, 1.0, 1e3);
    pub(crate) const ML: Self = unit("mL", "m3", Dimension::VOLUME, 1.0, 1e6);
    pub(crate) const KG_PER_M3: Self = unit("kg/m3", "kg/m3", Dimension::DENSITY, 1.0, 1.0);
    pub(crate) const PERCENT_PER_S: Self = unit("%/s", "1/s", Dimension::FREQUENCY, 1.0, 1e2);
    pub(crate) const MM_PER_S: Self = unit("mm/s", "m/s", Dimension::SPEED, 1.0, 1e3);
    pub(crate) const DEG_PER_S: Self = unit("deg/s", "rad/s", Dimension::ANGULAR_SPEED, std::f64::consts::PI, 180.0);
    pub(crate) const KPA_PER_S: Self = unit("kPa/s", "Pa/s", Dimension::PRESSURE_RATE, 1e3, 1.0);
    pub(crate) const NL_PER_MIN: Self = unit("NL/min", "m3/s", Dimension::VOLUME_FLOW, 1.0, 6e4);
    pub(crate) const DM3_PER_S_BAR: Self = unit("dm3/(s bar)", "m3/(s Pa)", Dimension::SONIC_CONDUCTANCE, 1.0, 1e8);
    pub(crate) const M3_PER_S_PA: Self = unit("m3/(s Pa)", "m3/(s Pa)", Dimension::SONIC_CONDUCTANCE, 1.0, 1.0);
    pub(crate) const W_PER_K: Self = unit("W/K", "W/K", Dimension::HEAT_CONDUCTANCE, 1.0, 1.0);

    /// A value that is already in this unit, with its symbol.
    pub(crate) fn show(&self, value: f64) -> String {
        let number = show_number(value);
        if self.symbol.is_empty() { number } else { format!("{number} {}", self.symbol) }
    }

    /// An SI value, in this unit with its symbol.
    pub(crate) fn show_si(&self, si: f64) -> String {
        self.show(self.scale.of_si(si))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Key, SECTIONS};
    use crate::unit::parse_unit;

    #[test]
    fn units_of_the_schema_are_those_of_their_symbols() {
        let keys = SECTIONS.iter().flat_map(|section| section.keys);
        let units = keys.filter_map(|key| match key {
            Key::Quantity(key) => Some(key.unit),
            Key::Vector(key) => Some(key.unit),
            _ => None,
        });
        for unit in units.filter(|unit| !unit.symbol.is_empty()) {
            let parsed = parse_unit(unit.symbol).unwrap();
            assert_eq!(parsed.dimension, unit.scale.dimension, "{}", unit.symbol);
            let (ours, theirs) = (unit.scale.to_si(7.0), parsed.to_si(7.0));
            assert!((ours - theirs).abs() <= 4.0 * f64::EPSILON * theirs, "{}: {ours} {theirs}", unit.symbol);
            if !unit.si.is_empty() {
                let si = parse_unit(unit.si).unwrap();
                assert_eq!((si.dimension, si.to_si(1.0)), (parsed.dimension, 1.0), "{}", unit.si);
            }
        }
    }

    #[test]
    fn defaults_are_within_their_bounds() {
        use super::super::{Integer, Presence, Quantity};
        for key in SECTIONS.iter().flat_map(|section| section.keys) {
            match *key {
                Key::Quantity(Quantity { name, min, max, presence, .. }) => {
                    assert!(min < max, "{name}");
                    if let Presence::Default(value) = presence {
                        assert!((min..=max).contains(&value), "{name}");
                    }
                }
                Key::Integer(Integer { name, min, max, presence: Presence::Default(value), .. }) => {
                    assert!((min..=max).contains(&value), "{name}");
                }
                _ => {}
            }
        }
    }
}
