//! The gas of one channel: line node and chamber between supply and atmosphere.
//!
//! Unknowns of a step are the absolute pressures of line and chamber. Every orifice enters as a
//! chord, `m' = K (p_up - p_down)` with `K >= 0` frozen over the step, and both pressures are
//! solved together and implicitly:
//!
//! ```text
//! V_l/(R T0) (x - P_l)         = h [K_f (P_s - x) - K_v (x - P_a) - K_t (x - y)]
//! (V + g P dV/dP)/(g R T) (y - P) = h [K_t (x - y) - K_k (y - P_a)]
//! ```
//!
//! That matrix is an M-matrix: new pressures lie between the old ones, the supply and the
//! atmosphere whatever the step, so a short wide tube costs no stability and no pressure can
//! become negative. Masses move by the same flows, so none is made or lost.

use crate::curve::VolumeCurve;
use crate::gas::{GAMMA, Orifice, R_AIR};

/// Pressure difference between line and chamber below which a channel with closed valves takes
/// the rest of the tick in one step, Pa.
const SETTLED_PA: f64 = 50.0;

/// Boundary conditions of the gas and its flow paths.
#[derive(Clone, Debug)]
pub(crate) struct Piping {
    pub(crate) fill: Orifice,
    pub(crate) vent: Orifice,
    pub(crate) tube: Orifice,
    pub(crate) leak: Option<Orifice>,
    /// Volume of the line node, m3.
    pub(crate) line_volume_m3: f64,
    /// Heat conductance from chamber gas to its wall, W/K.
    pub(crate) wall_w_per_k: f64,
    /// Absolute pressure outside, Pa.
    pub(crate) ambient_abs_pa: f64,
    /// Temperature of the room, the walls, the line and the supply, K.
    pub(crate) room_k: f64,
    pub(crate) volume: VolumeCurve,
}

/// Which valves are open during a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Openings {
    pub(crate) fill: bool,
    pub(crate) vent: bool,
}

/// Pressures, chamber mass and totals since the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gas {
    /// Absolute pressure of the line node, Pa.
    pub(crate) line_abs_pa: f64,
    /// Absolute pressure of the chamber, Pa.
    pub(crate) chamber_abs_pa: f64,
    /// Air in the chamber, kg.
    pub(crate) chamber_kg: f64,
    /// Change of the chamber's volume from outside, m3.
    pub(crate) displaced_m3: f64,
    /// Air taken from the supply so far, kg; less what flowed back.
    pub(crate) filled_kg: f64,
    /// Air vented or leaked so far, kg.
    pub(crate) released_kg: f64,
}

impl Gas {
    /// Everything at ambient pressure and room temperature.
    pub(crate) fn at_rest(piping: &Piping) -> Self {
        Self::at(piping, piping.ambient_abs_pa)
    }

    /// Everything at one absolute pressure, Pa, and room temperature.
    pub(crate) fn at(piping: &Piping, abs_pa: f64) -> Self {
        let volume = piping.volume.at(abs_pa - piping.ambient_abs_pa).0;
        Self {
            line_abs_pa: abs_pa,
            chamber_abs_pa: abs_pa,
            chamber_kg: abs_pa * volume / (R_AIR * piping.room_k),
            displaced_m3: 0.0,
            filled_kg: 0.0,
            released_kg: 0.0,
        }
    }

    /// Air temperature in the chamber, K.
    pub(crate) fn temperature_k(&self, piping: &Piping) -> f64 {
        self.chamber_abs_pa * self.volume(piping).0 / (self.chamber_kg * R_AIR)
    }

    /// Air in line and chamber, kg.
    #[cfg(test)]
    pub(crate) fn total_kg(&self, piping: &Piping) -> f64 {
        self.chamber_kg + self.line_abs_pa * piping.line_volume_m3 / (R_AIR * piping.room_k)
    }

    /// Whether line and chamber have come together.
    pub(crate) fn is_settled(&self) -> bool {
        (self.line_abs_pa - self.chamber_abs_pa).abs() < SETTLED_PA
    }

    /// One step of `h_s` seconds with the supply held at `supply_abs_pa`.
    pub(crate) fn step(&mut self, piping: &Piping, open: Openings, supply_abs_pa: f64, h_s: f64) {
        let (volume, slope) = self.volume(piping);
        let (line, chamber) = (self.line_abs_pa, self.chamber_abs_pa);
        let ambient = piping.ambient_abs_pa;
        let gas_k = chamber * volume / (self.chamber_kg * R_AIR);

        let pass = |wanted: bool, orifice: &Orifice, from: f64, to: f64| {
            if wanted { h_s * orifice.chord(from, to) } else { 0.0 }
        };
        let fill = pass(open.fill, &piping.fill, supply_abs_pa, line);
        let vent = pass(open.vent, &piping.vent, line, ambient);
        let leak = piping.leak.as_ref().map_or(0.0, |orifice| h_s * orifice.chord(chamber, ambient));
        // What leaves the chamber carries its own temperature, what enters that of the line.
        let mut tube = h_s * piping.tube.chord(line, chamber);
        let mut carried_k = piping.room_k;
        if chamber > line {
            tube *= (piping.room_k / gas_k).sqrt();
            carried_k = gas_k;
        }

        let storage = piping.line_volume_m3 / (R_AIR * piping.room_k);
        let response = GAMMA * R_AIR / (volume + GAMMA * chamber * slope);
        let (through, lost) = (response * carried_k * tube, response * gas_k * leak);
        // Chamber: y = alone + share x; inserted into the balance of the line.
        let inverse = 1.0 / (1.0 + through + lost);
        let alone = (chamber + lost * ambient) * inverse;
        let share = through * inverse;
        let x = (storage * line + fill * supply_abs_pa + vent * ambient + tube * alone)
            / (storage + fill + vent + tube * (1.0 - share));
        let y = alone + share * x;

        let (leaked, delivered) = (leak * (y - ambient), tube * (x - y));
        self.line_abs_pa = x;
        self.chamber_abs_pa = y;
        self.chamber_kg += delivered - leaked;
        self.filled_kg += fill * (supply_abs_pa - x);
        self.released_kg += vent * (x - ambient) + leaked;
        self.exchange_heat(piping, h_s);
    }

    /// Chamber gas towards its wall, implicit in the pressure at constant mass:
    /// `(V + g P dV/dP) dP/dt = -(g - 1) hA (T - T_wall)`.
    fn exchange_heat(&mut self, piping: &Piping, h_s: f64) {
        let (volume, slope) = self.volume(piping);
        let pressure = self.chamber_abs_pa;
        let per_kelvin = 1.0 / (self.chamber_kg * R_AIR);
        let excess_k = pressure * volume * per_kelvin - piping.room_k;
        let k_per_pa = (volume + pressure * slope) * per_kelvin;
        let loss = h_s * (GAMMA - 1.0) * piping.wall_w_per_k;
        let stiffness = volume + GAMMA * pressure * slope;
        self.chamber_abs_pa -= loss * excess_k / (stiffness + loss * k_per_pa);
    }

    /// Changes the chamber's volume from outside to `displaced_m3`, adiabatically and at constant
    /// mass: `(V + g P dV/dP) dP = -g P dV`, by the implicit midpoint rule.
    pub(crate) fn displace(&mut self, piping: &Piping, displaced_m3: f64) {
        let change = displaced_m3 - self.displaced_m3;
        let (volume, slope) = self.volume(piping);
        let work = GAMMA * change;
        let stiffness = volume + 0.5 * change + GAMMA * self.chamber_abs_pa * slope;
        self.chamber_abs_pa -= work * self.chamber_abs_pa / (stiffness + 0.5 * work);
        self.displaced_m3 = displaced_m3;
    }

    /// Chamber volume, m3, and its slope against pressure, m3/Pa.
    fn volume(&self, piping: &Piping) -> (f64, f64) {
        let (volume, slope) = piping.volume.at(self.chamber_abs_pa - piping.ambient_abs_pa);
        (volume + self.displaced_m3, slope)
    }
}

#[cfg(test)]
mod tests;
