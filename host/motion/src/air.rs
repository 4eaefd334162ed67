//! How fast valves and supply can move a limb: the air that a move needs against what ISO 6358 lets through.

use fra_model::State;

use super::profile::minimum_jerk;
use super::sent::Sent;
use softlimb_limb::Limb;
use softlimb_scene::{Line, Scene, Supply};

/// Specific gas constant of dry air, J/(kg K).
const GAS_CONSTANT: f64 = 287.05;
/// Effective polytropic exponent of a chamber that trades heat with its wall during a pulse.
const POLYTROPIC: f64 = 1.2;
/// Reference density of ISO 8778, kg/m3.
const REFERENCE_DENSITY_KG_PER_M3: f64 = 1.185;
/// Share of a valve's flow that a plan counts on. The rest is for valves that pass less than they should, for the time they take to
/// switch, and for the controller to correct with.
const VALVE_SHARE: f64 = 0.6;
/// How far the supply stays above the fullest chamber, Pa.
const SUPPLY_MARGIN_PA: f64 = 10e3;
/// Below this gauge pressure a chamber may lag, Pa: what is left of a bend there is below what the sensors see.
const LAG_PA: f64 = 500.0;
/// Steps of a move.
const STEPS: usize = 100;

/// The pneumatics of a scene as a plan counts on them.
pub(super) struct Air<'a> {
    limb: &'a Limb,
    supply: Supply,
    supply_min_pa: f64,
    ambient_pa: f64,
    temperature_k: f64,
    dead_volume_m3: f64,
    /// Conductance of the line, and of valve and line in series, m3/(s Pa).
    line: f64,
    conductance: f64,
    critical_ratio: f64,
}

/// The pressure of the supply, Pa gauge, as it is drawn from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reservoir(f64);

/// The limit on the speed of a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bottleneck {
    /// The rate of a drive's setpoint.
    Rate(usize),
    /// The fill or vent valve of a drive.
    Valve(usize),
    /// The supply.
    Supply,
}

/// A move between two rows of setpoints, sampled over its time: pressures and masses of air of every drive's chambers.
pub(super) struct Draw {
    /// Per step and drive: gauge pressure of a chamber, Pa, and mass of its air, kg.
    rows: Vec<Vec<(f64, f64)>>,
}

impl<'a> Air<'a> {
    pub(super) fn new(scene: &Scene, limb: &'a Limb) -> Self {
        let plant = scene.plant();
        let (valve, line) = (plant.valve.conductance_m3_per_s_pa, line_conductance_m3_per_s_pa(&plant.line));
        Self {
            limb,
            supply: plant.supply.clone(),
            supply_min_pa: scene.limits().supply_min_pa,
            ambient_pa: plant.ambient.pressure_pa,
            temperature_k: plant.ambient.temperature_k,
            dead_volume_m3: dead_volume_m3(scene),
            // Two restrictions in series.
            line,
            conductance: valve * line / valve.hypot(line),
            critical_ratio: plant.valve.critical_ratio,
        }
    }

    /// The supply at the start of a run.
    pub(super) fn full(&self) -> Reservoir {
        Reservoir(self.supply.pressure_pa())
    }

    /// Samples a minimum-jerk move between two rows of setpoints; `None` where a drive has no state on the way.
    pub(super) fn draw(&self, from: &[f64], to: &[f64]) -> Option<Draw> {
        let row = |step: usize| -> Option<Vec<(f64, f64)>> {
            let share = minimum_jerk(step as f64 / STEPS as f64);
            let values = from.iter().zip(to).map(|(a, b)| a + (b - a) * share);
            self.limb.drives().zip(values).map(|(drive, value)| Some(self.air(&drive.state_at(value)?))).collect()
        };
        Some(Draw { rows: (0..=STEPS).map(row).collect::<Option<_>>()? })
    }

    fn air(&self, state: &State<f64>) -> (f64, f64) {
        let gauge_pa = state.pressure_pa.max(0.0);
        let volume = state.volume_m3 + self.dead_volume_m3;
        (gauge_pa, (gauge_pa + self.ambient_pa) * volume / (GAS_CONSTANT * self.temperature_k))
    }

    /// The larger change of pressure by opening one valve of a chamber for a short time, Pa; gauge pressure, m3, m3/Pa, s.
    pub(super) fn step_pa(&self, pressure_pa: f64, volume_m3: f64, compliance: f64, open_s: f64) -> f64 {
        let flow = self.valve_flow(self.supply.pressure_pa(), pressure_pa).max(self.valve_flow(pressure_pa, 0.0));
        let stiffness = POLYTROPIC * (pressure_pa + self.ambient_pa) * compliance + volume_m3 + self.dead_volume_m3;
        POLYTROPIC * GAS_CONSTANT * self.temperature_k * flow * open_s / stiffness
    }

    /// Conductance of a valve that makes the flow a share of the present one, m3/(s Pa).
    pub(super) fn valve_of(&self, share: f64) -> f64 {
        let both = share * self.conductance;
        both * self.line / (self.line * self.line - both * both).sqrt()
    }

    /// Whether a move can be so fast with a reserve.
    ///
    /// # Errors
    /// What keeps it from being so fast.
    pub(super) fn after(&self, draw: &Draw, time_s: f64, start: Reservoir) -> Result<Reservoir, Bottleneck> {
        self.moved(draw, time_s, start, VALVE_SHARE)
    }

    /// Whether nominal valves wide open can follow a move.
    ///
    /// # Errors
    /// As [`Air::after`].
    pub(super) fn limits(&self, draw: &Draw, time_s: f64, start: Reservoir) -> Result<Reservoir, Bottleneck> {
        self.moved(draw, time_s, start, 1.0)
    }

    /// The supply after a move, whether or not the valves can follow.
    pub(super) fn left(&self, draw: &Draw, time_s: f64, start: Reservoir) -> Reservoir {
        let step_s = time_s / STEPS as f64;
        draw.rows.windows(2).fold(start, |supply, pair| self.recharged(supply, self.drawn_kg(pair), step_s))
    }

    /// Air that the fill valves take in a step, kg.
    fn drawn_kg(&self, pair: &[Vec<(f64, f64)>]) -> f64 {
        let drives = self.limb.drives().zip(pair[0].iter().zip(&pair[1]));
        drives.map(|(drive, (before, after))| (after.1 - before.1).max(0.0) * drive.channels.len() as f64).sum()
    }

    fn moved(&self, draw: &Draw, time_s: f64, start: Reservoir, valve_share: f64) -> Result<Reservoir, Bottleneck> {
        let step_s = time_s / STEPS as f64;
        let mut supply = start;
        for pair in draw.rows.windows(2) {
            let mut fullest_pa = 0.0_f64;
            for (index, (before, after)) in pair[0].iter().zip(&pair[1]).enumerate() {
                let (flow, low_pa, high_pa) =
                    ((after.1 - before.1) / step_s, before.0.min(after.0), before.0.max(after.0));
                let passes = if flow > 0.0 {
                    fullest_pa = fullest_pa.max(high_pa);
                    flow <= valve_share * self.valve_flow(supply.0, high_pa)
                } else {
                    low_pa <= LAG_PA || -flow <= valve_share * self.valve_flow(low_pa, 0.0)
                };
                if !passes {
                    return Err(Bottleneck::Valve(index));
                }
            }
            supply = self.recharged(supply, self.drawn_kg(pair), step_s);
            if fullest_pa > 0.0 && supply.0 < self.supply_min_pa.max(fullest_pa + SUPPLY_MARGIN_PA) {
                return Err(Bottleneck::Supply);
            }
        }
        Ok(supply)
    }

    /// Mass flow of a valve and its line between two gauge pressures, kg/s.
    fn valve_flow(&self, from_pa: f64, to_pa: f64) -> f64 {
        let (p1, p2) = (from_pa + self.ambient_pa, to_pa + self.ambient_pa);
        if p2 >= p1 {
            return 0.0;
        }
        let x = ((p2 / p1 - self.critical_ratio) / (1.0 - self.critical_ratio)).max(0.0);
        self.conductance * REFERENCE_DENSITY_KG_PER_M3 * p1 * (1.0 - x * x).sqrt()
    }

    /// The supply after a time in which some air was drawn and the pump ran.
    pub(super) fn recharged(&self, supply: Reservoir, drawn_kg: f64, time_s: f64) -> Reservoir {
        let Supply::Pump { pressure_pa, flow_m3_per_s, stall_pressure_pa, reservoir_volume_m3 } = self.supply else {
            return supply;
        };
        let stiffness = GAS_CONSTANT * self.temperature_k / reservoir_volume_m3;
        // The pump's flow falls to zero at the stall pressure, so the charge relaxes towards it exponentially.
        let rate = stiffness * flow_m3_per_s * REFERENCE_DENSITY_KG_PER_M3 / stall_pressure_pa;
        let charged = stall_pressure_pa + (supply.0 - stall_pressure_pa) * (-rate * time_s).exp();
        Reservoir(charged.min(pressure_pa.max(supply.0)) - stiffness * drawn_kg)
    }
}

/// Air that the fill valves take and the lowest supply in one run of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirDemand {
    /// Volume of the air at the reference state of ISO 8778 (100 kPa, 20 degC), m3.
    pub volume_m3: f64,
    /// The lowest gauge pressure of the supply, Pa; that of a regulated one.
    pub supply_min_pa: f64,
}

/// Air that the setpoints of a run need, knot by knot, by the free volumes of their states.
pub fn air_demand(scene: &Scene, limb: &Limb, sent: &Sent) -> AirDemand {
    let air = Air::new(scene, limb);
    let step_s = sent.knot_period_us() as f64 * 1e-6;
    let row = |knot: usize| -> Vec<f64> {
        sent.states_at((knot as u64 * sent.knot_period_us()) as f64).iter().map(|state| air.air(state).1).collect()
    };
    let (mut supply, mut drawn_kg, mut supply_min_pa) = (air.full(), 0.0, air.full().0);
    for knot in 1..sent.knots().len() {
        let (before, after) = (row(knot - 1), row(knot));
        let own_kg = before.iter().zip(&after).map(|(before, after)| (after - before).max(0.0)).sum();
        supply = air.recharged(supply, own_kg, step_s);
        (drawn_kg, supply_min_pa) = (drawn_kg + own_kg, f64::min(supply_min_pa, supply.0));
    }
    AirDemand { volume_m3: drawn_kg / REFERENCE_DENSITY_KG_PER_M3, supply_min_pa }
}

/// Sonic conductance of a tube by Eckersten's formula, `0.029 d^2/sqrt(L/d^1.25 + 510)`.
pub fn line_conductance_m3_per_s_pa(line: &Line) -> f64 {
    let d = line.inner_diameter_m;
    0.029 * d * d / (line.length_m / d.powf(1.25) + 510.0).sqrt()
}

/// Air that is not in the actuator: fittings and line.
pub fn dead_volume_m3(scene: &Scene) -> f64 {
    let line = &scene.plant().line;
    let section = std::f64::consts::FRAC_PI_4 * line.inner_diameter_m * line.inner_diameter_m;
    scene.plant().chamber.dead_volume_m3 + section * line.length_m
}
