//! Source of the air: a regulated line, or a pump with its reservoir.

use crate::gas::{Orifice, R_AIR, REFERENCE_DENSITY_KG_PER_M3};
use crate::settings::{PlantSettings, PumpSettings, Supply};

/// The relief valve is fully open this share of its cracking pressure above it.
pub(crate) const RELIEF_BAND: f64 = 0.05;

/// State of the supply.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    /// Holds its absolute pressure whatever is drawn.
    Regulated(f64),
    Reservoir(Reservoir),
}

/// A pump behind a check valve, a reservoir at room temperature and a relief valve.
#[derive(Clone, Debug)]
pub(crate) struct Reservoir {
    mass_kg: f64,
    /// `R T0 / V_r`, Pa/kg.
    pa_per_kg: f64,
    pump: PumpSettings,
    relief: Orifice,
    ambient_abs_pa: f64,
    released_kg: f64,
    pumped_kg: f64,
}

impl Source {
    pub(crate) fn new(settings: &PlantSettings) -> Self {
        match settings.supply {
            Supply::Regulated { pressure_pa } => Self::Regulated(pressure_pa + settings.atmosphere_pa),
            Supply::Pump(pump) => Self::Reservoir(Reservoir::new(pump, settings.atmosphere_pa, settings.temperature_k)),
        }
    }

    /// Absolute pressure, Pa.
    pub(crate) fn abs_pa(&self) -> f64 {
        match self {
            Self::Regulated(abs_pa) => *abs_pa,
            Self::Reservoir(r) => r.abs_pa(),
        }
    }

    /// Advances by `h_s` during which the channels drew `drawn_kg` and the pump ran at the share
    /// `speed` of its full speed.
    pub(crate) fn step(&mut self, drawn_kg: f64, speed: f64, h_s: f64) {
        if let Self::Reservoir(r) = self {
            r.step(drawn_kg, speed, h_s);
        }
    }
}

impl Reservoir {
    pub(crate) fn new(pump: PumpSettings, ambient_abs_pa: f64, room_k: f64) -> Self {
        let pa_per_kg = R_AIR * room_k / pump.reservoir_volume_m3;
        Self {
            mass_kg: (pump.initial_pressure_pa + ambient_abs_pa) / pa_per_kg,
            pa_per_kg,
            pump,
            relief: Orifice::new(pump.relief_conductance_m3_per_s_pa, 0.3, room_k),
            ambient_abs_pa,
            released_kg: 0.0,
            pumped_kg: 0.0,
        }
    }

    fn abs_pa(&self) -> f64 {
        self.mass_kg * self.pa_per_kg
    }

    fn step(&mut self, drawn_kg: f64, speed: f64, h_s: f64) {
        let abs_pa = self.abs_pa();
        let gauge_pa = abs_pa - self.ambient_abs_pa;
        // The check valve passes nothing back above the stall pressure.
        let head = (1.0 - gauge_pa / self.pump.stall_pressure_pa).max(0.0);
        let pumped = h_s * speed * head * REFERENCE_DENSITY_KG_PER_M3 * self.pump.free_flow_normal_m3_per_s;
        let cracking = self.pump.relief_pressure_pa;
        let opening = ((gauge_pa - cracking) / (RELIEF_BAND * cracking)).clamp(0.0, 1.0);
        let chord = self.relief.chord(abs_pa, self.ambient_abs_pa);
        let released = h_s * opening * chord * (abs_pa - self.ambient_abs_pa);
        self.mass_kg += pumped - released - drawn_kg;
        self.pumped_kg += pumped;
        self.released_kg += released;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pump() -> PumpSettings {
        PumpSettings { initial_pressure_pa: 0.0, ..PumpSettings::default() }
    }

    #[test]
    fn pump_alone_approaches_its_stall_pressure_exponentially() {
        // dP/dt = R T rho0 Q0 (1 - P/p_max)/V, hence P = p_max (1 - exp(-t/tau)).
        let settings = PumpSettings { relief_pressure_pa: 400e3, ..pump() };
        let mut r = Reservoir::new(settings, 101_325.0, 293.15);
        let seconds = 20;
        for _ in 0..seconds * 1_000 {
            r.step(0.0, 1.0, 1e-3);
        }
        let rate = 287.05 * 293.15 * 1.185 * 1e-4 / 1e-3 / 250e3;
        let expected = 250e3 * (1.0 - (-rate * f64::from(seconds)).exp());
        let gauge = r.abs_pa() - 101_325.0;
        assert!((gauge - expected).abs() < 20.0, "{gauge} {expected}");
    }

    #[test]
    fn relief_caps_the_pressure() {
        let settings = PumpSettings { relief_pressure_pa: 150e3, ..pump() };
        let mut r = Reservoir::new(settings, 101_325.0, 293.15);
        for _ in 0..120_000 {
            r.step(0.0, 1.0, 1e-3);
        }
        let gauge = r.abs_pa() - 101_325.0;
        assert!((150e3..150e3 * (1.0 + RELIEF_BAND)).contains(&gauge), "{gauge}");
    }

    #[test]
    fn reservoir_keeps_the_books() {
        let mut r = Reservoir::new(PumpSettings::default(), 101_325.0, 293.15);
        let before = r.mass_kg;
        let mut drawn = 0.0;
        for k in 0..50_000 {
            let take = if k % 3 == 0 { 2e-7 } else { 0.0 };
            drawn += take;
            r.step(take, 0.8, 1e-3);
        }
        let balance = r.mass_kg - (before + r.pumped_kg - r.released_kg - drawn);
        assert!(balance.abs() < 1e-9 * before, "{balance}");
    }

    #[test]
    fn resting_pump_keeps_the_pressure() {
        let mut r = Reservoir::new(PumpSettings::default(), 101_325.0, 293.15);
        let before = r.abs_pa();
        for _ in 0..1_000 {
            r.step(0.0, 0.0, 1e-3);
        }
        assert_eq!(r.abs_pa(), before);
    }
}
