//! Every tube as a geometrically exact rod of its own, clamped to rigid plates at both ends.
//!
//! Between two plates each tube is a short chain of rods ([`Rod`]) whose end is held where the plate behind has it: six coordinates of three points
//! there, by six forces. Shapes are where the energy of all tubes less the work of the weights is stationary under these conditions. Newton's method
//! takes poses of the plates, shapes of the tubes and forces together; each tube's own unknowns are eliminated before the plates are moved
//! (static condensation), so that there are six unknowns a plate. A shape is a minimum where each tube is one between plates that are held, and
//! the condensed tangent is positive definite.

mod start;
mod tube;

use fra_model::Motion;
use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, SVector, Translation3, UnitQuaternion, Vector3};

use self::tube::{Follows, Held, about, torque, turned};
use super::buckling::{Buckling, critical_n};
use super::load::LoadedLimb;
use super::rod::Behind;
use super::solve::{LONGEST_TURN_RAD, follow_load, size};

/// Iterations with the plates held, and of all together; how small the last step of the latter is, in strain and in rad.
const HELD: usize = 6;
const ITERATIONS: usize = 25;
const CONVERGED: f64 = 1e-9;

/// Tubes between two plates.
#[derive(Clone, Debug)]
struct Bay {
    /// Index of its bundle.
    bundle: usize,
    /// Length of the rigid part before it, m.
    before_m: f64,
    tubes: Vec<Held>,
    /// From where the tubes start to the plate behind.
    way: Isometry3<f64>,
    /// Masses at distances behind that plate: m, kg.
    masses: Vec<(f64, f64)>,
}

/// A limb whose tubes are rods of their own, in equilibrium.
#[derive(Clone, Debug)]
pub struct Plates {
    base: Isometry3<f64>,
    bays: Vec<Bay>,
    /// Length of the rigid part behind the last plate, m.
    tool_m: f64,
    gravity_m_per_s2: Vector3<f64>,
    tip_force_n: Vector3<f64>,
    /// Second derivatives of the potential by the motion of the plates: shift and turn of each in the frame of the scene.
    tangent: DMatrix<f64>,
    /// How many pieces its tubes have ([`LoadedLimb::tubes_near`]).
    pub fine: usize,
}

/// All tubes with their own unknowns eliminated.
struct Whole {
    gradient: DVector<f64>,
    tangent: DMatrix<f64>,
    follows: Vec<Vec<Follows>>,
}

impl Plates {
    /// Poses of the plates.
    fn poses(&self) -> Vec<Isometry3<f64>> {
        let mut pose = self.base;
        let follow = |bay: &Bay| {
            pose *= Translation3::new(0.0, 0.0, bay.before_m) * bay.way;
            pose
        };
        self.bays.iter().map(follow).collect()
    }

    /// Pose of the tip.
    pub fn tip(&self) -> Isometry3<f64> {
        self.poses().last().unwrap_or(&self.base) * Translation3::new(0.0, 0.0, self.tool_m)
    }

    /// Newton's method, first with the plates held.
    fn settle(&mut self, share: f64) -> Option<()> {
        let none = DVector::zeros(6 * self.bays.len());
        for _ in 0..HELD {
            let whole = self.condense(share)?;
            if self.go(&whole.follows, &none) < 1e-3 * LONGEST_TURN_RAD {
                break;
            }
        }
        for _ in 0..ITERATIONS {
            let whole = self.condense(share)?;
            let step = -whole.tangent.clone().cholesky()?.solve(&whole.gradient);
            let size = self.go(&whole.follows, &step);
            if size <= CONVERGED {
                self.tangent = whole.tangent;
                return Some(());
            }
            if size > LONGEST_TURN_RAD || !size.is_finite() {
                return None;
            }
        }
        None
    }

    /// The potential by the motion of the plates.
    fn condense(&mut self, share: f64) -> Option<Whole> {
        let poses = self.poses();
        let count = 6 * self.bays.len();
        let (mut gradient, mut tangent) = (DVector::zeros(count), DMatrix::zeros(count, count));
        let mut follows = Vec::with_capacity(self.bays.len());
        let last = self.bays.len().saturating_sub(1);
        for (index, bay) in self.bays.iter_mut().enumerate() {
            let before = if index == 0 { self.base } else { poses[index - 1] };
            let (start, behind) = (before * Translation3::new(0.0, 0.0, bay.before_m), &poses[index]);
            let mut dead = Behind::none();
            let along = |distance_m: f64| behind.translation.vector + behind.rotation * Vector3::z() * distance_m;
            bay.masses
                .iter()
                .for_each(|(distance_m, kg)| dead.add(&along(*distance_m), &(self.gravity_m_per_s2 * *kg * share)));
            if index == last {
                dead.add(&along(self.tool_m), &(self.tip_force_n * share));
            }
            let moment = about(&dead, &behind.translation.vector);
            let at = 6 * index;
            let mut add = |row: usize, values: &[f64]| {
                values.iter().enumerate().for_each(|(a, value)| gradient[row + a] += value);
            };
            add(at, (-dead.force).as_slice());
            add(at + 3, (-torque(&moment)).as_slice());
            let mut view = tangent.view_mut((at + 3, at + 3), (3, 3));
            view += turned(&moment);
            let origins = [before.translation.vector, behind.translation.vector];
            let mut of_bay = Vec::with_capacity(bay.tubes.len());
            for tube in &mut bay.tubes {
                tube.rod.base = start * tube.at;
                let own = tube.condense(share, origins, &(behind * tube.at))?;
                // The base does not move.
                let first = if index == 0 { 6 } else { 0 };
                let to = at + first - 6;
                add(to, &own.gradient.as_slice()[first..]);
                let mut view = tangent.view_mut((to, to), (12 - first, 12 - first));
                view += own.tangent.view((first, first), (12 - first, 12 - first));
                of_bay.push(own.follows);
            }
            follows.push(of_bay);
        }
        let tangent = 0.5 * (&tangent + tangent.transpose());
        Some(Whole { gradient, tangent, follows })
    }

    /// Moves the plates by a step, and the tubes as they follow. The largest turn of a piece or a plate against the one before, or strain.
    fn go(&mut self, follows: &[Vec<Follows>], step: &DVector<f64>) -> f64 {
        let poses = self.poses();
        let mut largest: f64 = 0.0;
        for (index, (bay, follows)) in self.bays.iter_mut().zip(follows).enumerate() {
            let before = if index == 0 { self.base } else { poses[index - 1] };
            let mut own = SVector::<f64, 12>::zeros();
            own.fixed_rows_mut::<6>(6).copy_from(&step.fixed_rows::<6>(6 * index));
            if index > 0 {
                own.fixed_rows_mut::<6>(0).copy_from(&step.fixed_rows::<6>(6 * index - 6));
            }
            let [shift_before, turn_before, shift, turn] =
                [0, 3, 6, 9].map(|at: usize| own.fixed_rows::<3>(at).into_owned());
            let apart = poses[index].translation.vector - before.translation.vector;
            let shift = before.rotation.inverse() * (shift - shift_before - turn_before.cross(&apart));
            let turn = before.rotation.inverse() * (turn - turn_before);
            bay.way.translation.vector += shift;
            bay.way.rotation = UnitQuaternion::from_scaled_axis(turn) * bay.way.rotation;
            largest = largest.max(turn.amax()).max(shift.norm() / bay.way.translation.vector.norm());
            for (tube, follows) in bay.tubes.iter_mut().zip(follows) {
                let change = &follows.q.0 + &follows.q.1 * own;
                tube.q += &change;
                tube.forces_n += follows.forces.0 + follows.forces.1 * own;
                largest = largest.max(size(&tube.rod, &change));
            }
        }
        largest
    }

    /// How far the tip gives way to a small force on it, m/N: column by direction of the force.
    pub fn compliance_m_per_n(&self) -> Option<Matrix3<f64>> {
        let last = *self.poses().last()?;
        let arm = self.tip().translation.vector - last.translation.vector;
        let count = self.tangent.nrows();
        let mut lever = DMatrix::zeros(count, 3);
        lever.view_mut((count - 6, 0), (3, 3)).copy_from(&Matrix3::identity());
        lever.view_mut((count - 3, 0), (3, 3)).copy_from(&arm.cross_matrix());
        let given = lever.tr_mul(&self.tangent.clone().cholesky()?.solve(&lever));
        Some(given.fixed_view::<3, 3>(0, 0).into_owned())
    }

    /// The tube that is closest to buckling, of the limb that this is.
    pub fn buckling(&self, limb: &LoadedLimb) -> Option<Buckling> {
        let of_bay = |bay: &Bay| {
            let (index, bundle) = (bay.bundle, &limb.bundles[bay.bundle]);
            let tube = |(tube, force_n): (usize, f64)| {
                let critical_n =
                    critical_n(&bundle.tubes[tube].1, bundle.free.stretch, limb.column_m(index, bundle.free.stretch));
                Buckling { module: limb.modules[index], tube, compression_n: -force_n, critical_n }
            };
            let forces: Vec<f64> = if limb.motions[index] == Motion::Bending {
                let strain = bay.tubes[0].strain();
                (0..bundle.tubes.len()).map(|tube| limb.force_n(index, tube, &strain)).collect()
            } else {
                bay.tubes.iter().map(Held::axial_n).collect()
            };
            forces.into_iter().enumerate().map(tube).collect::<Vec<_>>()
        };
        self.bays.iter().flat_map(of_bay).max_by(|a, b| a.ratio().total_cmp(&b.ratio()))
    }

    /// The share of all loads at which the plates lose their stability, as [`Shape::load_factor_to`] of rods.
    ///
    /// [`Shape::load_factor_to`]: super::Shape::load_factor_to
    pub fn load_factor_to(&self, most: f64) -> f64 {
        let mut plates = self.clone();
        follow_load(most, |share| {
            let mut next = plates.clone();
            let found = next.settle(share).is_some();
            if found {
                plates = next;
            }
            found
        })
    }
}
