//! The controller's picture of one channel's air path: supply, valve, line, chamber, atmosphere.

use crate::flow::Orifice;
use crate::gas::{Absolute, Chamber, REFERENCE_TEMPERATURE_K};
use crate::valve::{Direction, ValveTiming};
use nalgebra::ComplexField;

/// Pneumatics that all channels share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pneumatics {
    valve: Orifice,
    line: Orifice,
    path: Orifice,
    temperature_factor: f32,
    /// Absolute pressure of the atmosphere.
    pub atmosphere: Absolute,
    /// Temperature of the air, K.
    pub temperature_k: f32,
    /// Delays of the valves.
    pub timing: ValveTiming,
}

impl Pneumatics {
    /// Valves and lines as stated; pressures and temperature of the surroundings.
    pub fn new(valve: Orifice, line: Orifice, atmosphere: Absolute, temperature_k: f32, timing: ValveTiming) -> Self {
        Self {
            valve,
            line,
            path: valve.in_series_with(&line),
            temperature_factor: ComplexField::sqrt(REFERENCE_TEMPERATURE_K / temperature_k),
            atmosphere,
            temperature_k,
            timing,
        }
    }

    /// Rate of the chamber pressure while the valve is open, Pa/s: positive when filling, negative when venting.
    pub fn rate_pa_per_s(&self, direction: Direction, chamber: &Chamber, pressure_pa: f32, supply_pa: f32) -> f32 {
        let inside = Absolute::from_gauge(pressure_pa, self.atmosphere);
        let (sign, upstream, downstream) = match direction {
            Direction::Fill => (1.0, Absolute::from_gauge(supply_pa, self.atmosphere), inside),
            Direction::Vent => (-1.0, inside, self.atmosphere),
        };
        let flow = self.temperature_factor * self.path.mass_flow_kg_per_s(upstream, downstream);
        sign * flow * chamber.stiffness_pa_per_kg(pressure_pa, self.atmosphere, self.temperature_k)
    }

    /// Gauge pressure at which line and chamber would come to rest, were the open valve closed now, Pa.
    ///
    /// The manifold reads `sensor_pa` and the flow is steady: the line takes its share of the valve's flow, the rest drops the
    /// pressure from manifold to chamber.
    pub fn settled_pa(&self, direction: Direction, chamber: &Chamber, sensor_pa: f32, supply_pa: f32) -> f32 {
        let share = chamber.line_share(sensor_pa, self.atmosphere);
        let inside_pa = self.chamber_behind_line_pa(direction, sensor_pa, supply_pa, 1.0 - share);
        inside_pa + (sensor_pa - inside_pa) * share
    }

    /// Gauge pressure behind the line when `passed` of the valve's flow goes through it, Pa.
    fn chamber_behind_line_pa(&self, direction: Direction, sensor_pa: f32, supply_pa: f32, passed: f32) -> f32 {
        let node = Absolute::from_gauge(sensor_pa, self.atmosphere);
        let chamber = match direction {
            Direction::Fill => {
                let supply = Absolute::from_gauge(supply_pa, self.atmosphere);
                self.line.downstream(node, passed * self.valve.mass_flow_kg_per_s(supply, node))
            }
            Direction::Vent => self.line.upstream(node, passed * self.valve.mass_flow_kg_per_s(node, self.atmosphere)),
        };
        chamber.gauge_pa(self.atmosphere)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nominal() -> Pneumatics {
        let timing = ValveTiming { on_delay_us: 3_500, off_delay_us: 2_000 };
        Pneumatics::new(Orifice::new(1.44e-9, 0.3), Orifice::line(3.78e-9), Absolute::new(101_325.0), 293.15, timing)
    }

    fn chamber() -> Chamber {
        Chamber {
            pressure_pa: 0.0,
            volume_m3: 80e-6,
            compliance_m3_per_pa: 0.12e-9,
            rest_volume_m3: 80e-6,
            dead_volume_m3: 0.0,
        }
    }

    #[test]
    fn rates_are_those_of_the_reference_scene() {
        // Stated for 80 mL, 0.144 dm3/(s bar), 200 kPa supply: fill 497 kPa/s at 10 kPa, vent 174 kPa/s at 40 and 256 at 100 kPa.
        let fill = nominal().rate_pa_per_s(Direction::Fill, &chamber(), 10e3, 200e3);
        let vent_40 = nominal().rate_pa_per_s(Direction::Vent, &chamber(), 40e3, 200e3);
        let vent_100 = nominal().rate_pa_per_s(Direction::Vent, &chamber(), 100e3, 200e3);
        assert!((fill / 497e3 - 1.0).abs() < 0.1, "{fill}");
        assert!((vent_40 / -174e3 - 1.0).abs() < 0.1, "{vent_40}");
        assert!((vent_100 / -256e3 - 1.0).abs() < 0.1, "{vent_100}");
    }

    #[test]
    fn manifold_reads_22_kpa_high_while_filling_at_60_kpa() {
        // Flow balance by hand: valve 1.44 * 301.3 * 0.896 = 388.6, line 3.78 * 183.3 * 0.560 = 388.1.
        let chamber = nominal().chamber_behind_line_pa(Direction::Fill, 82e3, 200e3, 1.0);
        assert!((chamber - 60e3).abs() < 300.0, "{chamber}");
    }

    #[test]
    fn nothing_flows_out_of_an_empty_chamber() {
        assert_eq!(nominal().rate_pa_per_s(Direction::Vent, &chamber(), 0.0, 200e3), 0.0);
        assert_eq!(nominal().rate_pa_per_s(Direction::Fill, &chamber(), 200e3, 200e3), 0.0);
    }
}
