//! The true actuator: the model solved along pressure once, volume and shape read from that table.

use fra_model::{Actuator, Load, State, Status};

use crate::curve::{Node, VolumeCurve};
use crate::error::PlantError;
use crate::settings::{ActuatorLaw, ChannelSettings};
use crate::spread::{TrueParameters, TrueSegment};

/// Intervals of the table between zero and the highest pressure.
const INTERVALS: usize = 128;

/// An actuator with its equilibria at equidistant gauge pressures from zero to the highest one, or
/// to the end of its branch.
#[derive(Clone, Debug)]
pub(crate) struct TrueActuator {
    /// `None` where a law has given the states, and of a series.
    model: Option<Actuator<f64>>,
    load: Load<f64>,
    states: Vec<State<f64>>,
    /// The states of the segments, where it is a series of them.
    segments: Vec<Vec<State<f64>>>,
    width_pa: f64,
}

impl TrueActuator {
    /// Solves the actuator from zero to the highest pressure, or to the end of its branch.
    ///
    /// # Errors
    /// When the model refuses the parameters or has no equilibrium without pressure.
    pub(crate) fn new(
        channel: usize,
        nominal: &ChannelSettings,
        true_parameters: &TrueParameters,
    ) -> Result<Self, PlantError> {
        let load = nominal.load;
        let width_pa = nominal.pressure_max_pa / INTERVALS as f64;
        let solve = |made: &TrueSegment, law: Option<ActuatorLaw>| branch(channel, made, law, &load, width_pa);
        if nominal.segments.is_empty() {
            let (model, states) = solve(&true_parameters.whole(), nominal.law)?;
            return Ok(Self { model, load, states, segments: Vec::new(), width_pa });
        }
        let made = true_parameters.segments.iter().zip(&nominal.segments);
        let segments = made.map(|(made, nominal)| solve(made, nominal.law).map(|(_, states)| states));
        let segments = segments.collect::<Result<Vec<_>, _>>()?;
        // The series ends with the first of its branches.
        let count = segments.iter().map(Vec::len).min().unwrap_or_default();
        let lengths_m = || true_parameters.segments.iter().map(|segment| segment.actuator.length_m);
        let at = |node: usize| State::in_series(lengths_m().zip(segments.iter().map(|states| states[node])));
        let states = (0..count).filter_map(at).collect();
        Ok(Self { model: None, load, states, segments, width_pa })
    }

    /// Gas volume over gauge pressure: the model's volume times `scale` plus `dead_volume_m3`.
    pub(crate) fn volume_curve(&self, scale: f64, dead_volume_m3: f64) -> Option<VolumeCurve> {
        let node = |(k, state): (usize, &State<f64>)| Node {
            pressure_pa: k as f64 * self.width_pa,
            volume_m3: scale * state.volume_m3 + dead_volume_m3,
            slope_m3_per_pa: scale * state.compliance_m3_per_pa,
        };
        let nodes: Vec<Node> = self.states.iter().enumerate().map(node).collect();
        VolumeCurve::through(&nodes, self.width_pa)
    }

    /// The equilibrium at a gauge pressure, Pa, from zero on, and whether the branch reaches that
    /// far; its last tabulated state where not. Above the table the model is solved, where there is one.
    pub(crate) fn shape(&self, pressure_pa: f64) -> (State<f64>, bool) {
        let s = pressure_pa.max(0.0) / self.width_pa;
        let last = self.states.len() - 1;
        if s <= last as f64 {
            return (interpolate(&self.states, s), true);
        }
        let end = self.states[last];
        match self.model.map(|model| model.forward_from(&end, pressure_pa, &self.load)) {
            Some(Ok(found)) if found.status == Status::Solved => (found.state, true),
            _ => (end, false),
        }
    }

    /// The equilibria of the segments at a gauge pressure, Pa, as in [`shape`](Self::shape); none where it is no series.
    pub(crate) fn segment_shapes(&self, pressure_pa: f64) -> impl Iterator<Item = State<f64>> {
        let last = self.states.len() - 1;
        let s = (pressure_pa.max(0.0) / self.width_pa).min(last as f64);
        self.segments.iter().map(move |states| interpolate(&states[..=last], s))
    }
}

/// A model, where there is one, and its equilibria.
type Branch = (Option<Actuator<f64>>, Vec<State<f64>>);

/// The equilibria of an actuator or of a segment, and its model where no law has given them.
fn branch(
    channel: usize,
    made: &TrueSegment,
    law: Option<ActuatorLaw>,
    load: &Load<f64>,
    width_pa: f64,
) -> Result<Branch, PlantError> {
    let refuse = |source| PlantError::Actuator { channel, source };
    if let Some(ActuatorLaw(law)) = law {
        let pressures_pa: Vec<f64> = (0..=INTERVALS).map(|node| node as f64 * width_pa).collect();
        let states = law(&made.actuator, made.second_fiber.as_ref(), &pressures_pa).filter(|states| !states.is_empty());
        return Ok((None, states.ok_or(PlantError::NoEquilibrium { channel, pressure_pa: 0.0 })?));
    }
    let model = made.model().map_err(refuse)?;
    let mut states = Vec::with_capacity(INTERVALS + 1);
    let mut solution = model.forward(0.0, load).map_err(refuse)?;
    while solution.status == Status::Solved {
        states.push(solution.state);
        if states.len() > INTERVALS {
            break;
        }
        let pressure_pa = states.len() as f64 * width_pa;
        solution = model.forward_from(&solution.state, pressure_pa, load).map_err(refuse)?;
    }
    if states.is_empty() {
        return Err(PlantError::NoEquilibrium { channel, pressure_pa: 0.0 });
    }
    Ok((Some(model), states))
}

/// The cubic through the four states around the place `s`, in units of the width.
fn interpolate(states: &[State<f64>], s: f64) -> State<f64> {
    let count = states.len();
    if count < 4 {
        return states[(s.round() as usize).min(count - 1)];
    }
    let first = (s as usize).saturating_sub(1).min(count - 4);
    let around: [&State<f64>; 4] = std::array::from_fn(|node| &states[first + node]);
    let weights = lagrange(s - first as f64);
    State::combine(around, |values| values.into_iter().zip(weights).map(|(value, weight)| weight * value).sum())
}

/// Weights of the nodes 0, 1, 2, 3 at the place `t`.
fn lagrange(t: f64) -> [f64; 4] {
    let (a, b, c, d) = (t, t - 1.0, t - 2.0, t - 3.0);
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0]
}

#[cfg(test)]
mod tests {
    use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement};

    use super::*;
    use crate::random::Random;
    use crate::settings::Spread;

    fn actuator(motion: Motion, angle_rad: f64, families: Families) -> ActuatorParameters<f64> {
        ActuatorParameters {
            motion,
            inner_radius_m: 6e-3,
            outer_radius_m: 8e-3,
            length_m: 0.1,
            material: Material::Yeoh { c_pa: [86_560.0, 13_805.0, -1_466.1] },
            fiber: Some(Fiber {
                angle_rad,
                families,
                modulus_pa: 361e6,
                placement: Placement::Sheet,
                thickness_m: 0.178e-3,
                radius_m: 8e-3,
            }),
        }
    }

    fn build(actuator: ActuatorParameters<f64>, pressure_max_pa: f64) -> TrueActuator {
        let settings = ChannelSettings { pressure_max_pa, ..ChannelSettings::new(actuator) };
        let parameters = TrueParameters::draw(&settings, &Spread::NONE, &mut Random::new(1, 0));
        TrueActuator::new(0, &settings, &parameters).unwrap()
    }

    #[test]
    fn weights_reproduce_a_cubic() {
        let cubic = |t: f64| 1.0 + t * (2.0 + t * (-3.0 + t * 0.5));
        for t in [0.0, 0.4, 1.5, 2.9] {
            let sum: f64 = lagrange(t).iter().zip(0..4).map(|(w, k)| w * cubic(f64::from(k))).sum();
            assert!((sum - cubic(t)).abs() < 1e-12);
        }
    }

    #[test]
    fn table_agrees_with_the_solver() {
        for (motion, angle_rad, families) in [
            (Motion::Extension, 0.05, Families::Two),
            (Motion::Twisting, 0.5, Families::One),
            (Motion::Bending, 0.0, Families::Two),
        ] {
            let built = build(actuator(motion, angle_rad, families), 80e3);
            let curve = built.volume_curve(1.0, 0.0).unwrap();
            for pressure_pa in [0.0, 137.0, 5_001.0, 33_333.0, 79_900.0] {
                let solved = built.model.unwrap().forward(pressure_pa, &Load::none()).unwrap().state;
                let (read, within_branch) = built.shape(pressure_pa);
                assert!(within_branch);
                for (one, other) in [
                    (read.axial_stretch, solved.axial_stretch),
                    (read.twist_rad, solved.twist_rad),
                    (read.bend_angle_rad, solved.bend_angle_rad),
                    (read.outer_radius_m * 1e2, solved.outer_radius_m * 1e2),
                    (curve.at(pressure_pa).0 * 1e5, solved.volume_m3 * 1e5),
                ] {
                    assert!((one - other).abs() < 1e-6, "{motion:?} {pressure_pa}: {one} {other}");
                }
            }
        }
    }

    #[test]
    fn table_ends_with_its_branch() {
        // Two axial families have no equilibrium above mu ln(R_o/R_i), about 70 kPa here.
        let built = build(actuator(Motion::Expansion, core::f64::consts::FRAC_PI_2, Families::Two), 200e3);
        let end_pa = (built.states.len() - 1) as f64 * built.width_pa;
        assert!((40e3..75e3).contains(&end_pa), "{end_pa}");
        let (state, within_branch) = built.shape(150e3);
        assert!(!within_branch);
        assert_eq!(state, built.states[built.states.len() - 1]);
        let curve = built.volume_curve(1.0, 0.0).unwrap();
        assert!(curve.at(150e3).0 > curve.at(end_pa).0);
    }
}
