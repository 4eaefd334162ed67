//! Air, its reference state, and the two pressures that must not be mixed up.

/// Density of the ISO 6358 reference atmosphere, kg/m3.
pub(crate) const REFERENCE_DENSITY_KG_PER_M3: f32 = 1.185;

/// Temperature of the ISO 6358 reference atmosphere, K.
pub(crate) const REFERENCE_TEMPERATURE_K: f32 = 293.15;

/// Specific gas constant of air, J/(kg K).
pub(crate) const GAS_CONSTANT_J_PER_KG_K: f32 = 287.05;

/// Effective polytropic exponent of a chamber that trades heat with its wall during a pulse.
const POLYTROPIC_EXPONENT: f32 = 1.2;

/// Least heat conductance from the air in a chamber to its wall, W/K, and heat capacity of air over its gas constant.
const WALL_W_PER_K: f32 = 0.2;
const HEAT_CAPACITY: f32 = 2.5;

/// Share of the modelled growth of a chamber that is certain.
const CERTAIN: f32 = 0.5;

/// Doubt about a chamber that takes all of its air by growing; distance from the state of the model at which it may not grow at all, Pa.
const GROWING: f32 = 0.8;
const FAR_PA: f32 = 50e3;

/// Absolute pressure, Pa. Flow needs absolute pressure, the actuator model gauge pressure; only the atmosphere converts.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Absolute(f32);

impl Absolute {
    /// From pascals above vacuum.
    pub const fn new(pressure_pa: f32) -> Self {
        Self(pressure_pa)
    }

    /// From pascals above the atmosphere.
    pub fn from_gauge(gauge_pa: f32, atmosphere: Self) -> Self {
        Self(gauge_pa + atmosphere.0)
    }

    /// Pascals above vacuum.
    pub const fn pa(self) -> f32 {
        self.0
    }

    /// Pascals above the atmosphere.
    pub fn gauge_pa(self, atmosphere: Self) -> f32 {
        self.0 - atmosphere.0
    }
}

/// The air volume of one channel about a known state: chamber, fittings and line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chamber {
    /// Gauge pressure the volume belongs to, Pa.
    pub pressure_pa: f32,
    /// Air volume at that pressure, m3, > 0.
    pub volume_m3: f32,
    /// `dV/dP`, m3/Pa, >= 0.
    pub compliance_m3_per_pa: f32,
    /// Volume at zero gauge pressure, m3: the volume is never taken to be less.
    pub rest_volume_m3: f32,
    /// Part of the volume that lies in fittings and line, m3.
    pub dead_volume_m3: f32,
}

impl Chamber {
    /// Air volume at a gauge pressure, m3: along the tangent, never below the volume at rest.
    pub fn volume_at(&self, pressure_pa: f32) -> f32 {
        let tangent = self.volume_m3 + self.compliance_m3_per_pa * (pressure_pa - self.pressure_pa);
        tangent.max(self.rest_volume_m3)
    }

    /// Mass of the air at a gauge pressure and a temperature, kg: `P V / (R T)` with `P` absolute.
    pub fn air_kg(&self, pressure_pa: f32, atmosphere: Absolute, temperature_k: f32) -> f32 {
        let absolute_pa = Absolute::from_gauge(pressure_pa, atmosphere).pa();
        absolute_pa * self.volume_at(pressure_pa) / (GAS_CONSTANT_J_PER_KG_K * temperature_k)
    }

    /// Pressure rise per mass of air, Pa/kg: `n R T / (V + n P dV/dP)` with `P` absolute and `n` about 1.2.
    pub fn stiffness_pa_per_kg(&self, pressure_pa: f32, atmosphere: Absolute, temperature_k: f32) -> f32 {
        POLYTROPIC_EXPONENT * GAS_CONSTANT_J_PER_KG_K * temperature_k / self.capacity_m3(pressure_pa, atmosphere)
    }

    /// Share of the air that fittings and line take of any pressure change, 0 to 1.
    pub fn line_share(&self, pressure_pa: f32, atmosphere: Absolute) -> f32 {
        self.dead_volume_m3 / self.capacity_m3(pressure_pa, atmosphere)
    }

    /// Doubt about the rise that some air causes, as a factor beyond one. The chamber grows with a part of the air, and otherwise than modelled far from its state.
    pub(crate) fn doubt(&self, pressure_pa: f32, atmosphere: Absolute) -> f32 {
        let rigid_share = self.volume_at(pressure_pa) / self.capacity_m3(pressure_pa, atmosphere);
        GROWING * (1.0 - rigid_share)
            + self.far(pressure_pa) * (self.capacity_m3(pressure_pa, atmosphere) / self.rest_volume_m3 - 1.0)
    }

    /// Longest time constant with which the air takes the temperature of the wall, s.
    pub(crate) fn cooling_s(&self, pressure_pa: f32, atmosphere: Absolute, temperature_k: f32) -> f32 {
        let absolute_pa = Absolute::from_gauge(pressure_pa, atmosphere).pa().max(0.0);
        HEAT_CAPACITY * absolute_pa * self.volume_at(pressure_pa) / (temperature_k * WALL_W_PER_K)
    }

    /// Pressure recovery by heat exchange with the wall, relative to that of a rigid chamber. Growth of the chamber reduces it. Half of the modelled
    /// growth is taken as certain near the model's state.
    pub(crate) fn heat_share(&self, pressure_pa: f32, atmosphere: Absolute) -> f32 {
        let absolute_pa = Absolute::from_gauge(pressure_pa, atmosphere).pa().max(0.0);
        let volume_m3 = self.volume_at(pressure_pa);
        let grows = if volume_m3 > self.rest_volume_m3 { 1.0 - self.far(pressure_pa) } else { 0.0 };
        volume_m3 / (volume_m3 + CERTAIN * grows * absolute_pa * self.compliance_m3_per_pa)
    }

    /// Distance from the state of the model, as a share of the one at which the chamber may not grow at all.
    fn far(&self, pressure_pa: f32) -> f32 {
        ((pressure_pa - self.pressure_pa).abs() / FAR_PA).min(1.0)
    }

    /// `V + n P dV/dP`, m3: the rigid volume that would take the same air.
    fn capacity_m3(&self, pressure_pa: f32, atmosphere: Absolute) -> f32 {
        let absolute = Absolute::from_gauge(pressure_pa, atmosphere).pa();
        self.volume_at(pressure_pa) + POLYTROPIC_EXPONENT * absolute * self.compliance_m3_per_pa
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ATMOSPHERE: Absolute = Absolute::new(101_325.0);

    #[test]
    fn heat_share_is_an_upper_bound_of_what_comes_back() {
        let (volume_m3, pressure_pa) = (80e-6, 60e3);
        let absolute_pa = ATMOSPHERE.pa() + pressure_pa;
        for compliance_m3_per_pa in [0.0, 0.2e-9, 2e-9] {
            let (rest_volume_m3, dead_volume_m3) = (0.9 * volume_m3, 0.0);
            let chamber = Chamber { pressure_pa, volume_m3, compliance_m3_per_pa, rest_volume_m3, dead_volume_m3 };
            // Rise of some air without loss of heat, and at the temperature of the wall.
            let rise = |exponent: f32| exponent / (volume_m3 + exponent * absolute_pa * compliance_m3_per_pa);
            let comes_back = 1.0 - rise(1.0) / rise(1.4);
            let share = chamber.heat_share(pressure_pa, ATMOSPHERE);
            assert!(comes_back <= (1.0 - 1.0 / 1.4) * share * 1.000_01, "{comes_back} {share}");
            assert!(compliance_m3_per_pa == 0.0 || share < 0.95, "{share}");
            // Too far from the state of the model, or too small, it may not grow at all.
            assert_eq!(Chamber { pressure_pa: 0.0, ..chamber }.heat_share(pressure_pa, ATMOSPHERE), 1.0);
            assert_eq!(Chamber { rest_volume_m3: volume_m3, ..chamber }.heat_share(pressure_pa, ATMOSPHERE), 1.0);
        }
    }

    #[test]
    fn rigid_chamber_follows_the_polytropic_gas_law() {
        let rigid = Chamber {
            pressure_pa: 0.0,
            volume_m3: 80e-6,
            compliance_m3_per_pa: 0.0,
            rest_volume_m3: 80e-6,
            dead_volume_m3: 8e-6,
        };
        assert!((rigid.line_share(50e3, ATMOSPHERE) - 0.1).abs() < 1e-6);
        // 151325 * 80e-6 / (287.05 * 293.15) = 143.864 mg.
        assert!((rigid.air_kg(5e4, ATMOSPHERE, 293.15) / 143.864e-6 - 1.0).abs() < 1e-4);
        // 1.2 * 287.05 * 293.15 / 80e-6 = 1.26224e9 Pa/kg.
        let stiffness = rigid.stiffness_pa_per_kg(5e4, ATMOSPHERE, 293.15);
        assert!((stiffness / 1.262_24e9 - 1.0).abs() < 1e-4, "{stiffness}");
    }

    #[test]
    fn volume_follows_the_tangent_and_stops_at_rest() {
        let soft = Chamber {
            pressure_pa: 100e3,
            volume_m3: 92e-6,
            compliance_m3_per_pa: 0.12e-9,
            rest_volume_m3: 85e-6,
            dead_volume_m3: 5e-6,
        };
        assert!((soft.volume_at(120e3) - 94.4e-6).abs() < 1e-10);
        assert_eq!(soft.volume_at(-100e3), 85e-6);
    }
}
