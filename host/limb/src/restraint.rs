//! Modules of twisting actuators beside the axis, which their plates hold back.
//!
//! Such a module does not do as one of its actuators does alone: its states are equilibria of its tubes between its plates
//! ([`Bundle`]). `docs/explanation/bundles.md` derives them.

use std::f64::consts::PI;

use fra_model::{Actuator, Load, Motion, State, Status};

use crate::statics::{Bundle, Spring};
use crate::{Limb, LimbModule, StateCurve};

/// Slide of the ends of a tube over the distance of its plates up to which a twisting bundle is followed.
const LEAN_MAX: f64 = 0.3;

/// Share of the twist of one actuator alone below which a bundle is warned about.
pub const TWIST_SHARE_MIN: f64 = 0.5;

impl LimbModule {
    /// Whether plates hold its actuators back: twisting ones beside the axis.
    pub fn is_restrained(&self) -> bool {
        self.motion == Motion::Twisting && self.reach_m() > 0.0
    }

    /// Pressure at the end of its curve, gauge Pa, and the share of the twist that one of its actuators has there alone; `None` for a module that
    /// is not restrained.
    pub fn twist_share(&self) -> Option<(f64, f64)> {
        let end = self.curve.states().last().filter(|state| self.is_restrained() && state.pressure_pa > 0.0)?;
        let alone = self.actuator.forward(end.pressure_pa, &Load::none()).ok()?;
        (alone.status == Status::Solved).then_some((end.pressure_pa, end.twist_rad / alone.state.twist_rad))
    }

    /// The state without load of this module where plates hold back these actuators, each with the state that it has alone: one for each place.
    ///
    /// `None` where they have no common equilibrium. Radii and volume are the means of theirs.
    pub fn held_back(&self, alone: &[(Actuator<f64>, State<f64>)]) -> Option<State<f64>> {
        let tubes = self.positions_m().into_iter().zip(alone);
        let tubes = tubes.map(|(place, (actuator, state))| {
            // Below ambient pressure the wall keeps its springs at rest.
            Some((place, Spring::new(actuator, state.pressure_pa.max(0.0))?.about(state)))
        });
        let bundle = Bundle::of_springs(self.motion, tubes.collect::<Option<_>>()?, self.bay_m())?;
        let states: Vec<&State<f64>> = alone.iter().map(|(_, state)| state).collect();
        let (first, others) = states.split_first()?;
        let sum = others.iter().fold(**first, |sum, state| State::combine([&sum, state], |[a, b]| a + b));
        let mean = State::combine([&sum], |[sum]| sum / states.len() as f64);
        let (axial_stretch, twist_rad) = (bundle.free.stretch, bundle.free.twist_rad_per_m * self.length_m());
        Some(State { axial_stretch, axial_strain: axial_stretch - 1.0, twist_rad, ..mean })
    }
}

impl Limb {
    /// Warnings of modules whose plates leave their actuators less than [`TWIST_SHARE_MIN`] of the twist of one alone.
    pub fn restraint_warnings(&self) -> Vec<String> {
        let low = |module: &LimbModule| {
            let (pressure_pa, share) = module.twist_share().filter(|(_, share)| *share < TWIST_SHARE_MIN)?;
            Some(format!(
                "plates hold the actuators of `{}` back: at {:.2} kPa it has {:.0} % of the twist of one alone; fewer `spacers`, a smaller \
                 `circle_radius` or `actuators = 1` leave more",
                module.name,
                1e-3 * pressure_pa,
                100.0 * share
            ))
        };
        self.modules().iter().filter_map(low).collect()
    }
}

impl StateCurve {
    /// The curve of a bundle of equal twisting actuators on a circle, which plates hold back that are `bay_m` apart at rest.
    ///
    /// Stretch and twist of the states are those of the bundle; radii and volume are those of an actuator in it. The curve ends where the ends of a
    /// tube slide by 0.3 of the distance of their plates, or where the tubes touch halfway between them.
    pub fn restrained(&self, actuator: &Actuator<f64>, positions_m: &[[f64; 2]], bay_m: f64) -> Self {
        let held = |free: &State<f64>| held(actuator, free, positions_m, bay_m);
        let mut states = vec![self.states()[0]];
        states.extend(self.states().iter().skip(1).map_while(held));
        let volumes_m3: Vec<f64> = states.iter().map(|state| state.volume_m3).collect();
        for (node, state) in states.iter_mut().enumerate() {
            if let Some(slope) = slope(&volumes_m3, node) {
                state.compliance_m3_per_pa = slope / self.step_pa();
            }
        }
        self.with_states(states)
    }
}

/// Derivative by the node of values at evenly spaced nodes, of the polynomial through five of them; `None` for fewer.
fn slope(values: &[f64], node: usize) -> Option<f64> {
    const WEIGHTS: [[f64; 5]; 5] = [
        [-25.0, 48.0, -36.0, 16.0, -3.0],
        [-3.0, -10.0, 18.0, -6.0, 1.0],
        [1.0, -8.0, 0.0, 8.0, -1.0],
        [-1.0, 6.0, -18.0, 10.0, 3.0],
        [3.0, -16.0, 36.0, -48.0, 25.0],
    ];
    let first = node.saturating_sub(2).min(values.len().checked_sub(5)?);
    let weights = WEIGHTS.get(node - first)?;
    Some(weights.iter().zip(&values[first..]).map(|(weight, value)| weight * value).sum::<f64>() / 12.0)
}

/// The state of a bundle whose actuators alone have the state `free`.
fn held(actuator: &Actuator<f64>, free: &State<f64>, positions_m: &[[f64; 2]], bay_m: f64) -> Option<State<f64>> {
    let length_m = actuator.parameters().length_m;
    // Equal tubes on a circle do as one of them does about the axis.
    let [x, y] = *positions_m.first()?;
    let radius_m = x.hypot(y);
    let tube = ([radius_m, 0.0], Spring::at(actuator, free)?);
    let bundle = Bundle::of_springs(Motion::Twisting, vec![tube], bay_m)?;
    let leaning = bundle.leaning(Motion::Twisting, 0).filter(|leaning| leaning.slide.abs() <= LEAN_MAX)?;
    let tube = actuator.blocked(free.pressure_pa, leaning.stretch, leaning.twist_rad_per_m * length_m).ok()?;
    // Halfway a tube is in the middle of the chord between its ends.
    let turn_rad = bundle.free.twist_rad_per_m * bay_m;
    let half_m = radius_m * (0.5 * turn_rad).cos() * (PI / positions_m.len() as f64).sin();
    let clear = turn_rad.abs() < PI && half_m >= tube.state.outer_radius_m;
    (tube.status == Status::Solved && clear).then_some(State {
        axial_stretch: bundle.free.stretch,
        axial_strain: bundle.free.stretch - 1.0,
        twist_rad: bundle.free.twist_rad_per_m * length_m,
        ..tube.state
    })
}
