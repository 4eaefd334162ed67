//! Swing after a move: the natural vibrations of the loaded limb at its end, excited by the acceleration of the planned way.
//!
//! On its way the limb is where the statics have it, plus a swing. Per natural vibration that swing is a damped oscillator whose base moves
//! (modal superposition): the way, projected on the vibration's shape, is a course of one coordinate, whose jumps of velocity from step to step are
//! impulses. Between them the oscillator is exact (Duhamel's integral of a polygon). Frequencies and shapes are those at the end of the move,
//! all along it. Pressures are those of the setpoints, and constant in a swing.

use fra_model::State;
use nalgebra::Vector3;

use super::nominal::{Nominal, PoseError, pressures_pa};
use crate::path::Path;
use crate::payload::{Carried, Carrying, carried};
use crate::plan::{Plan, PlannedPhase};
use crate::profile::Shaper;
use crate::unreachable::Unreachable;
use softlimb_limb::Limb;
use softlimb_limb::statics::{EquilibriumError, Fidelity, Gyration, Mode, Part};
use softlimb_numerics::least_squares::{LeastSquares, StoppingCriteria, minimise};
use softlimb_scene::{Excess, Scene, Shaping};

/// Rods of the vibrations: with four pieces the second frequency of a single module is right to 0.1 %, with two to 0.8 %.
const TIER: Fidelity = Fidelity::Fourfold;
/// Vibrations that are taken into account, and those of them that a move may be shaped against.
const MODES: usize = 6;
const SHAPED: usize = 3;
/// Parts of a leg between poses, and of a marker series.
const NODES: usize = 32;
const SERIES_NODES: usize = 200;
/// Time step of the projected way, s.
const STEP_S: f64 = 2.5e-3;
/// Points of the slowest period after a move.
const AFTER: usize = 100;
/// Frequencies over the predicted ones for which a bound on the swing holds.
const OFF: [f64; 3] = [0.9, 1.0, 1.1];
/// The next longer move that is tried, and the longest, s.
const LONGER: f64 = 1.01;
const LONGEST_S: f64 = 600.0;
/// Durations are rounded up to this, s.
const ROUND_S: f64 = 0.01;
/// Steps of an adapted course.
const STEPS: usize = 13;
/// Least relative gain of a step that adapts it, most evaluations, and the width of differences.
const GAIN: f64 = 1e-3;
const ADAPTATIONS: usize = 60;
const WIDTH: f64 = 1e-5;
/// Largest damping ratio: beyond it there is nothing to shape.
const DAMPING_MAX: f64 = 0.95;

/// The first two natural vibrations of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibrations {
    /// Natural frequencies, Hz.
    pub frequency_hz: [f64; 2],
    /// Damping ratios.
    pub damping: [f64; 2],
}

/// Vibrations of a phase, and what its move leaves of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// At the end of the move.
    pub moved: Vibrations,
    /// At the end of the hold, where a mass changes hands in it.
    pub held: Option<Vibrations>,
    /// Largest distance of the tip from where it comes to rest, after the move, m. A swing from before the move is left out.
    pub residual_m: f64,
    /// The same with frequencies up to 10 % off, at worst, m.
    pub residual_worst_m: f64,
    /// Distance of the tip's places at both ends of the move, m.
    pub way_m: f64,
}

/// Swings of all phases of a plan; none of a limb whose setpoints are not corrected for weight. Corrections of the scene are left out.
///
/// # Errors
/// [`Unreachable::NotCarried`] where the limb falls.
pub(crate) fn swings(scene: &Scene, limb: &Limb, plan: &Plan) -> Result<Vec<Swing>, Unreachable> {
    if plan.weighed().is_none() {
        return Ok(Vec::new());
    }
    let mut swinging = Swinging::new(scene, limb);
    let carried = carried(scene.phases());
    let of_phase = |(index, phase): (usize, &PlannedPhase)| {
        let carried = carried[index];
        let excited = swinging.excited(index, phase, carried.moved)?;
        let held = swinging.held(index, phase, &carried)?;
        let way = excited.way(&phase.path, 1.0);
        Ok(Swing {
            moved: swinging.vibrations(&excited.modes),
            held,
            residual_m: excited.residual_m(&way, 1.0),
            residual_worst_m: excited.worst_m(&way),
            way_m: excited.way_m,
        })
    };
    plan.phases.iter().enumerate().map(of_phase).collect()
}

/// Natural vibrations in all poses at the ends of moves and, where a mass changes hands, of holds; none of a limb whose setpoints are not corrected for weight.
///
/// # Errors
/// [`Unreachable::NotCarried`] where the limb falls.
pub(crate) fn vibrations(scene: &Scene, limb: &Limb, plan: &Plan) -> Result<Vec<Vibrations>, Unreachable> {
    if plan.weighed().is_none() {
        return Ok(Vec::new());
    }
    let mut swinging = Swinging::new(scene, limb);
    let carried = carried(scene.phases());
    let mut found = Vec::new();
    for (index, (phase, carried)) in plan.phases.iter().zip(&carried).enumerate() {
        let states = swinging.states(&phase.values);
        let modes = swinging.modes(&states, carried.moved).map_err(|cause| fallen(index, phase, cause))?;
        found.push(swinging.vibrations(&modes));
        found.extend(swinging.held(index, phase, carried)?);
    }
    Ok(found)
}

fn fallen(index: usize, phase: &PlannedPhase, cause: PoseError) -> Unreachable {
    Unreachable::NotCarried { phase: index, time_us: phase.start_us + phase.move_us, cause }
}

/// Shapes the moves of a schedule, and stretches those that leave too much swing, as the scene asks for. All later times shift.
///
/// # Errors
/// [`Unreachable::Swings`], [`Unreachable::NotCarried`].
pub(crate) fn calmed(scene: &Scene, limb: &Limb, phases: &mut [PlannedPhase]) -> Result<(), Unreachable> {
    let asked = scene.swing();
    if asked.shaping == Shaping::None && asked.residual_max_m.is_none() {
        return Ok(());
    }
    let mut swinging = Swinging::new(scene, limb);
    let carried = carried(scene.phases());
    let mut later_us = 0_u64;
    for (index, phase) in phases.iter_mut().enumerate() {
        phase.start_us += later_us;
        phase.gripper_us += later_us;
        let excited = swinging.excited(index, phase, carried[index].moved)?;
        let shaper = excited.shaper(&phase.path, asked.shaping);
        let mut path = phase.path.retimed(1.0, &shaper);
        if let Some(limit) = asked.residual_max_m {
            let worst_m = excited.worst_m(&excited.way(&path, 1.0));
            if worst_m > *limit {
                let enough = excited.enough(&phase.path, &shaper, *limit);
                match (asked.excess, enough) {
                    (Excess::Stretch, Some(by)) if matches!(path, Path::Legs { .. }) => {
                        path = phase.path.retimed(by, &shaper);
                    }
                    _ => {
                        let enough_s = enough.map(|by| by * phase.move_us as f64 * 1e-6);
                        let way_m = excited.way_m;
                        return Err(Unreachable::Swings { phase: index, worst_m, way_m, enough_s });
                    }
                }
            }
        }
        let longer_us = path.move_us() - phase.move_us;
        phase.path = path;
        phase.move_us += longer_us;
        phase.gripper_us += longer_us;
        later_us += longer_us;
    }
    Ok(())
}

/// The limb whose vibrations are found.
struct Swinging<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
    nominal: Nominal<'a>,
}

/// Vibrations at the end of a move, and the move as they feel it.
struct Excited {
    modes: Vec<Mode>,
    damping: Vec<f64>,
    /// Per leg the modal coordinates at even shares of its way; of a series one leg over the time.
    legs: Vec<Vec<Vec<f64>>>,
    way_m: f64,
}

impl<'a> Swinging<'a> {
    fn new(scene: &'a Scene, limb: &'a Limb) -> Self {
        Self { scene, limb, nominal: Nominal::new(scene, limb, TIER) }
    }

    fn states(&self, values: &[f64]) -> Vec<State<f64>> {
        let drives = self.limb.drives().zip(values);
        drives.map(|(drive, value)| drive.state_at(*value).unwrap_or_else(|| drive.actuator.rest())).collect()
    }

    fn gyration(&self, carrying: Carrying) -> Vec<Gyration> {
        let object = carrying.object.map(|index| &self.scene.objects()[index]);
        Gyration::of_limb(self.scene, self.limb, object)
    }

    /// The parts of the limb in a pose, and its tip, m.
    fn parts(&mut self, states: &[State<f64>], carrying: Carrying) -> Result<(Vec<Part>, Vector3<f64>), PoseError> {
        let pose = self.nominal.at(&pressures_pa(states), carrying.payload_kg)?;
        Ok((pose.rod.parts(&pose.shape.q, &self.gyration(carrying)), pose.tip_m()))
    }

    /// Vibrations in a pose.
    fn modes(&mut self, states: &[State<f64>], carrying: Carrying) -> Result<Vec<Mode>, PoseError> {
        let pose = self.nominal.at(&pressures_pa(states), carrying.payload_kg)?;
        let unstable = PoseError::EquilibriumError(EquilibriumError::Unstable { share: 1.0 });
        pose.shape.modes(&pose.rod, &self.gyration(carrying), MODES).ok_or(unstable)
    }

    /// Vibrations at the end of a hold in which a mass changes hands; `None` of others.
    fn held(
        &mut self,
        index: usize,
        phase: &PlannedPhase,
        carried: &Carried,
    ) -> Result<Option<Vibrations>, Unreachable> {
        if carried.held.payload_kg == carried.moved.payload_kg {
            return Ok(None);
        }
        let states = self.states(phase.last());
        let modes = self.modes(&states, carried.held).map_err(|cause| fallen(index, phase, cause))?;
        Ok(Some(self.vibrations(&modes)))
    }

    fn damping(&self, mode: &Mode) -> f64 {
        mode.damping(self.scene.swing().loss_factor).clamp(0.0, DAMPING_MAX)
    }

    fn vibrations(&self, modes: &[Mode]) -> Vibrations {
        let of = |value: &dyn Fn(&Mode) -> f64| [0, 1].map(|index: usize| modes.get(index).map_or(f64::NAN, value));
        Vibrations { frequency_hz: of(&|mode| mode.frequency_hz), damping: of(&|mode| self.damping(mode)) }
    }

    /// The vibrations at the end of a move, and the move as they feel it.
    fn excited(&mut self, index: usize, phase: &PlannedPhase, carrying: Carrying) -> Result<Excited, Unreachable> {
        let falls = |cause| fallen(index, phase, cause);
        let modes = self.modes(&self.states(&phase.values), carrying).map_err(falls)?;
        let values: Vec<Vec<Vec<f64>>> = match &phase.path {
            Path::Legs { rows, .. } => rows.windows(2).map(|leg| between(&leg[0], &leg[1])).collect(),
            path @ Path::Series { .. } => {
                let step_us = path.move_us() as f64 / SERIES_NODES as f64;
                vec![(0..=SERIES_NODES).map(|node| path.at(node as f64 * step_us)).collect()]
            }
        };
        let mut place = vec![0.0; modes.len()];
        let mut last: Option<(Vec<Part>, Vector3<f64>)> = None;
        let mut first_m = None;
        let mut legs = Vec::with_capacity(values.len());
        for leg in values {
            let mut nodes = Vec::with_capacity(leg.len());
            for row in leg {
                let (parts, tip_m) = self.parts(&self.states(&row), carrying).map_err(falls)?;
                if let Some((before, _)) = &last {
                    modes.iter().zip(&mut place).for_each(|(mode, place)| *place += projected(mode, before, &parts));
                }
                first_m.get_or_insert(tip_m);
                last = Some((parts, tip_m));
                nodes.push(place.clone());
            }
            legs.push(nodes);
        }
        let way_m = first_m.zip(last).map_or(0.0, |(first, (_, last))| (last - first).norm());
        let damping = modes.iter().map(|mode| self.damping(mode)).collect();
        Ok(Excited { modes, damping, legs, way_m })
    }
}

/// Setpoints at even shares of a leg.
fn between(from: &[f64], to: &[f64]) -> Vec<Vec<f64>> {
    let row = |node: usize| {
        let share = node as f64 / NODES as f64;
        from.iter().zip(to).map(|(a, b)| a + (b - a) * share).collect()
    };
    (0..=NODES).map(row).collect()
}

/// Inertia of a small motion of all parts, on a vibration.
fn projected(mode: &Mode, from: &[Part], to: &[Part]) -> f64 {
    let of_part = |([shift, turn], (from, to)): (&[Vector3<f64>; 2], (&Part, &Part))| {
        from.kg * shift.dot(&(to.place_m - from.place_m)) + turn.dot(&from.spun(&from.turn_to(to)))
    };
    mode.motion.iter().zip(from.iter().zip(to)).map(of_part).sum()
}

/// Value between nodes at even shares, by a cubic through them with the slopes of its neighbours.
fn cubic(nodes: &[Vec<f64>], share: f64, mode: usize) -> f64 {
    let last = nodes.len() - 1;
    let place = share.clamp(0.0, 1.0) * last as f64;
    let cell = (place as usize).min(last.saturating_sub(1));
    let at = |node: usize| nodes[node.min(last)][mode];
    let slope = |node: usize| match node {
        0 => at(1) - at(0),
        end if end == last => at(last) - at(last - 1),
        inner => 0.5 * (at(inner + 1) - at(inner - 1)),
    };
    let (t, a, b) = (place - cell as f64, at(cell), at(cell + 1));
    let (t2, t3) = (t * t, t * t * t);
    a + (b - a) * (3.0 * t2 - 2.0 * t3) + slope(cell) * (t3 - 2.0 * t2 + t) + slope(cell + 1) * (t3 - t2)
}

/// The modal coordinates of a move at even times.
struct Way {
    step_s: f64,
    places: Vec<Vec<f64>>,
}

impl Excited {
    /// The move on a path of the same rows, in a multiple of its time.
    fn way(&self, path: &Path, by: f64) -> Way {
        let move_us = path.move_us() as f64;
        let steps = (by * move_us * 1e-6 / STEP_S).ceil().max(2.0);
        let (step_us, modes) = (move_us / steps, self.modes.len());
        let at = |step: usize| {
            let time_us = step as f64 * step_us;
            let (leg, share) = match path {
                Path::Legs { times_us, shaper, .. } => {
                    let leg = times_us.partition_point(|time| *time <= time_us).clamp(1, times_us.len() - 1) - 1;
                    (leg, shaper.share(time_us - times_us[leg], times_us[leg + 1] - times_us[leg]))
                }
                Path::Series { .. } => (0, time_us / move_us),
            };
            (0..modes).map(|mode| cubic(&self.legs[leg], share, mode)).collect()
        };
        Way { step_s: by * step_us * 1e-6, places: (0..=steps as usize).map(at).collect() }
    }

    /// Largest distance of the tip from where it comes to rest, after the move, with all frequencies times a factor.
    fn residual_m(&self, way: &Way, off: f64) -> f64 {
        let oscillators: Vec<Oscillator> = self
            .modes
            .iter()
            .zip(&self.damping)
            .map(|(mode, z)| Oscillator::new(off * mode.frequency_hz, *z))
            .collect();
        let swings: Vec<[f64; 2]> =
            oscillators.iter().enumerate().map(|(mode, oscillator)| oscillator.after(way, mode)).collect();
        let slowest = self.modes.first().map_or(1.0, |mode| 1.0 / (off * mode.frequency_hz));
        let distance_m = |point: usize| {
            let time_s = slowest * point as f64 / AFTER as f64;
            let of_mode = |((mode, oscillator), swing): ((&Mode, &Oscillator), &[f64; 2])| {
                mode.tip * oscillator.free(*swing, time_s)[0]
            };
            self.modes.iter().zip(&oscillators).zip(&swings).map(of_mode).sum::<Vector3<f64>>().norm()
        };
        (0..=AFTER).map(distance_m).fold(0.0, f64::max)
    }

    fn worst_m(&self, way: &Way) -> f64 {
        OFF.iter().map(|off| self.residual_m(way, *off)).fold(0.0, f64::max)
    }

    /// The shaper that leaves the least swing of a move.
    fn shaper(&self, path: &Path, shaping: Shaping) -> Shaper {
        let of_mode = |(mode, damping): (&Mode, &f64)| match shaping {
            Shaping::None => Shaper::none(),
            Shaping::ZeroVibration => Shaper::zero_vibration(mode.frequency_hz, *damping),
            Shaping::ZeroDerivative | Shaping::Adapted => Shaper::zero_derivative(mode.frequency_hz, *damping),
        };
        let left_m = |shaper: Shaper| (self.worst_m(&self.way(&path.retimed(1.0, &shaper), 1.0)), shaper);
        let all = self.modes.iter().zip(&self.damping).take(SHAPED).map(of_mode);
        let best = all.map(left_m).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((least_m, shaper)) = best else { return Shaper::none() };
        if shaping != Shaping::Adapted {
            return shaper;
        }
        let longer_us = shaper.longer_us();
        let starts = [[1.0; STEPS], Adapting::steps_of(&shaper)];
        let adapted = starts.iter().filter_map(|start| {
            let mut adapting = Adapting { excited: self, path, longer_us };
            let criteria =
                StoppingCriteria { least_gain: GAIN, evaluations: ADAPTATIONS, ..StoppingCriteria::default() };
            minimise(&mut adapting, start, criteria).map(|found| adapting.shaper(&found.point))
        });
        let gentle = adapted.filter(|adapted| path.is_gentle(adapted)).map(left_m);
        gentle.chain([(least_m, shaper)]).min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(Shaper::none, |best| best.1)
    }

    /// Places of all vibrations after a move, and their velocities over the frequencies, as ways of the tip, m; for all of [`OFF`].
    fn left_m(&self, way: &Way) -> Vec<f64> {
        let of_mode = |(off, index): (f64, usize)| {
            let mode = &self.modes[index];
            let oscillator = Oscillator::new(off * mode.frequency_hz, self.damping[index]);
            let [place, velocity] = oscillator.after(way, index);
            [place, velocity / oscillator.natural].map(|part| mode.tip.norm() * part)
        };
        OFF.iter().flat_map(|off| (0..self.modes.len()).map(move |index| (*off, index))).flat_map(of_mode).collect()
    }

    /// By how much longer a move swings no more than a limit, m, at a whole number of [`ROUND_S`] before it is shaped.
    fn enough(&self, path: &Path, shaper: &Shaper, limit_m: f64) -> Option<f64> {
        let move_s = path.move_us() as f64 * 1e-6;
        let mut longer_s = move_s;
        while longer_s <= LONGEST_S {
            longer_s = (longer_s * LONGER / ROUND_S).ceil() * ROUND_S;
            let by = longer_s / move_s;
            let way = match path {
                Path::Legs { .. } => self.way(&path.retimed(by, shaper), 1.0),
                Path::Series { .. } => self.way(path, by),
            };
            if self.worst_m(&way) <= limit_m {
                return Some(by);
            }
        }
        None
    }
}

/// A smooth course of a move that leaves the least swing on its way. Impulses leave more swing the more the way is curved.
struct Adapting<'a> {
    excited: &'a Excited,
    path: &'a Path,
    longer_us: f64,
}

impl Adapting<'_> {
    fn shaper(&self, steps: &[f64]) -> Shaper {
        Shaper::smooth(steps, self.longer_us)
    }

    /// Steps of a course as steep as another shaper.
    fn steps_of(shaper: &Shaper) -> [f64; STEPS] {
        // Its own move as long as half of the whole.
        let length_us = 2.0 * shaper.longer_us();
        let share = |index: usize| shaper.share(length_us * index as f64 / STEPS as f64, length_us);
        std::array::from_fn(|index| share(index + 1) - share(index))
    }
}

impl LeastSquares for Adapting<'_> {
    type Evaluation = (Vec<f64>, Vec<f64>);

    fn evaluate(&mut self, steps: &[f64]) -> Option<Self::Evaluation> {
        let way = self.excited.way(&self.path.retimed(1.0, &self.shaper(steps)), 1.0);
        Some((steps.to_vec(), self.excited.left_m(&way)))
    }

    fn residuals(&self, (_, left): &Self::Evaluation) -> Vec<f64> {
        left.clone()
    }

    fn jacobian(&mut self, (steps, left): &Self::Evaluation) -> Option<Vec<Vec<f64>>> {
        let mut columns = Vec::with_capacity(steps.len());
        for axis in 0..steps.len() {
            let by = if steps[axis] > 0.5 { -WIDTH } else { WIDTH };
            let mut there = steps.clone();
            there[axis] += by;
            let (_, moved) = self.evaluate(&there)?;
            columns.push(moved.iter().zip(left).map(|(to, from)| (to - from) / by).collect::<Vec<f64>>());
        }
        Some((0..left.len()).map(|row| columns.iter().map(|column| column[row]).collect()).collect())
    }
}

/// A damped oscillator.
struct Oscillator {
    /// Natural and damped angular frequency, and the rate of decay, 1/s.
    natural: f64,
    damped: f64,
    decay: f64,
}

impl Oscillator {
    fn new(frequency_hz: f64, damping: f64) -> Self {
        let natural = std::f64::consts::TAU * frequency_hz;
        Self { natural, damped: natural * (1.0 - damping * damping).sqrt(), decay: natural * damping }
    }

    /// Place and velocity after a time without excitation.
    fn free(&self, [place, velocity]: [f64; 2], time_s: f64) -> [f64; 2] {
        let fades = (-self.decay * time_s).exp();
        let (sin, cos) = (self.damped * time_s).sin_cos();
        let inner = (velocity + self.decay * place) / self.damped;
        let pull = (self.natural * self.natural * place + self.decay * velocity) / self.damped;
        [fades * (place * cos + inner * sin), fades * (velocity * cos - pull * sin)]
    }

    /// Place and velocity, against where it comes to rest, at the end of a way of its base that begins at rest.
    fn after(&self, way: &Way, mode: usize) -> [f64; 2] {
        let (mut swing, mut before) = ([0.0; 2], 0.0);
        for pair in way.places.windows(2) {
            let velocity = (pair[1][mode] - pair[0][mode]) / way.step_s;
            swing[1] -= velocity - before;
            swing = self.free(swing, way.step_s);
            before = velocity;
        }
        swing[1] += before;
        swing
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A base that moves by `1 - cos(w t)`, which has a closed form: of an oscillator without damping of the frequency `n` the swing is
    /// `w^2/(n^2 - w^2) (cos(n t) - cos(w t))`.
    #[test]
    fn swing_of_a_base_that_moves_by_a_cosine_is_its_closed_form() {
        let (hz, w, end_s) = (0.8, 3.0, 1.7);
        let n = std::f64::consts::TAU * hz;
        let steps = 700;
        let places =
            (0..=steps).map(|step| vec![1.0 - (w * end_s * f64::from(step) / f64::from(steps)).cos()]).collect();
        let way = Way { step_s: end_s / f64::from(steps), places };
        let found = Oscillator::new(hz, 0.0).after(&way, 0);
        let factor = w * w / (n * n - w * w);
        // The base stops at the end, which takes its velocity away from the swing.
        let place = factor * ((n * end_s).cos() - (w * end_s).cos());
        let velocity = factor * (w * (w * end_s).sin() - n * (n * end_s).sin()) + w * (w * end_s).sin();
        assert!((found[0] - place).abs() < 1e-4 && (found[1] - velocity).abs() < 1e-3, "{found:?} {place} {velocity}");
    }

    #[test]
    fn free_vibration_decays_and_keeps_its_energy_without_damping() {
        let energy = |oscillator: &Oscillator, at: [f64; 2]| at[1] * at[1] + (oscillator.natural * at[0]).powi(2);
        let still = Oscillator::new(1.3, 0.0);
        let moved = still.free([0.02, -0.3], 7.7);
        assert!((energy(&still, moved) / energy(&still, [0.02, -0.3]) - 1.0).abs() < 1e-12);
        let damped = Oscillator::new(1.3, 0.04);
        let period_s = std::f64::consts::TAU / damped.damped;
        let after = damped.free([0.02, -0.3], period_s);
        let fades = (-damped.decay * period_s).exp();
        assert!((after[0] - 0.02 * fades).abs() < 1e-12 && (after[1] + 0.3 * fades).abs() < 1e-12);
    }

    #[test]
    fn cubic_passes_nodes_and_is_near_a_smooth_course_between_them() {
        let nodes: Vec<Vec<f64>> = (0..=NODES).map(|node| vec![(2.0 * node as f64 / NODES as f64).sin()]).collect();
        for step in 0..=200 {
            let share = f64::from(step) / 200.0;
            assert!((cubic(&nodes, share, 0) - (2.0 * share).sin()).abs() < 1e-3);
        }
    }
}
