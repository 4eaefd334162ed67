//! Inverse kinematics under load: pressures that bring the tip of the loaded limb to an aim.
//!
//! Newton's method on the tip with the tangent of the statics. Where several pressures do, those nearest to `home` are taken, in shares of
//! the ranges; a pressure that leaves its range, and a little more at its high end, is held there.

use std::sync::{Arc, OnceLock};

use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3, Vector4};

use super::built::Built;
use super::nearby::Nearby;
use crate::synthesis::Aim;
use softlimb_limb::statics::{Bends, EquilibriumError, Fidelity, LoadedLimb, Rod, Settled, Shape};

/// The tip has arrived within this, m.
pub(super) const ARRIVED_M: f64 = 1e-6;
const ITERATIONS: usize = 20;
/// Highest share of a pressure. The excess over 1 is a separate residual, because a hard bound would put a kink into the path of the tip.
const MOST: f64 = 1.12;
/// Longest step, as a share of the range of a pressure.
const LONGEST: f64 = 0.3;
const LEAST_STEP: f64 = 1.0 / 1024.0;
/// Pressures are at home, or as near as the aim lets them, within this share; and the least change that is worth a step.
const HOME: f64 = 1e-4;
const LEAST_CHANGE: f64 = 1e-7;
/// Steps that hardly bring the tip nearer, until it counts as near as it gets.
const STALLS: usize = 3;
/// Way of the tip by the curvature of a step, over the square of its largest share, m.
const CURVED_M: f64 = 0.5;
/// Part of the distance that a step with a known Jacobian may leave before the Jacobian is made anew.
const SLOW: f64 = 0.2;
/// Change of a share for a derivative.
const STEP: f64 = 1e-5;
/// A way of the tip below this for the whole range of a pressure counts as none, m.
pub(super) const HARDLY_M: f64 = 1e-3;

/// Derivative of the tip, m, by the shares of the pressures.
pub(super) type Jacobian = DMatrix<f64>;

/// What a search for an aim leads to.
#[derive(Clone, Debug)]
pub(super) struct Reached {
    pub(super) stand: Stand,
    /// From the tip to the aim, m.
    pub(super) missing_m: Vector3<f64>,
    /// The Jacobian of the last step; `None` where no step was taken.
    pub(super) jacobian: Option<Jacobian>,
}

impl Reached {
    /// A limb in equilibrium with its tip where it is.
    pub(super) fn of(stand: Stand, aim: &Aim) -> Self {
        let tip_m = stand.tip_m();
        Self { missing_m: nearest(aim, &tip_m) - tip_m, stand, jacobian: None }
    }
}

/// A limb in equilibrium at shares of its pressures.
#[derive(Clone, Debug)]
pub(super) struct Stand {
    pub(super) shares: Vec<f64>,
    pub(super) limb: LoadedLimb,
    pub(super) rod: Rod,
    pub(super) shape: Shape,
    built: Built,
    /// Made for the first limb beside it.
    nearby: Arc<OnceLock<Option<Nearby>>>,
}

impl Stand {
    pub(super) fn new(built: &Built, shares: &[f64], Settled { limb, rod, shape }: Settled) -> Self {
        Self { shares: shares.to_vec(), limb, rod, shape, built: built.clone(), nearby: Arc::default() }
    }

    /// The equilibrium that `start`, or else the limb at rest, leads to.
    ///
    /// # Errors
    /// The share of pressures and loads that is still carried.
    pub(super) fn at(built: &Built, shares: &[f64], kg: f64, start: Option<&Self>) -> Result<Self, f64> {
        let limb = built.loaded(shares, kg).ok_or(0.0)?;
        let near = start.and_then(|start| limb.at_strains(&start.strains()).ok().zip(Some(&start.shape.q)));
        let settled = match near {
            Some((limb, q)) => limb.settle(Fidelity::Linear, Some(q)),
            None => limb.settle(Fidelity::Linear, None),
        };
        match settled {
            Ok(settled) => Ok(Self::new(built, shares, settled)),
            Err(EquilibriumError::Unstable { share }) => Err(share),
            Err(EquilibriumError::Overstrained { .. } | EquilibriumError::Unsettled) => Err(0.0),
        }
    }

    /// The same just beside `start`, which has the same payload: to first order in the distance it is the same equilibrium.
    pub(super) fn beside(built: &Built, shares: &[f64], kg: f64, start: &Self) -> Option<Self> {
        let nearby = start.nearby.get_or_init(|| Nearby::of(&start.built, &start.shares, kg, start.settled()));
        Some(Self::new(built, shares, nearby.as_ref()?.beside(built, shares, kg)?))
    }

    fn settled(&self) -> Settled {
        Settled { limb: self.limb.clone(), rod: self.rod.clone(), shape: self.shape.clone() }
    }

    /// The same with other shares, to start from.
    pub(super) fn with_shares(&self, shares: Vec<f64>) -> Self {
        Self { shares, nearby: Arc::default(), ..self.clone() }
    }

    /// Tilt of the axis of a body that stood upright when the tip grasped it, rad; 0 without one.
    pub(super) fn tilt_rad(&self, grasp: Option<&UnitQuaternion<f64>>) -> f64 {
        grasp.map_or(0.0, |grasp| tilt_rad(&self.shape.tip().rotation, grasp))
    }

    /// Mean strains of its modules.
    fn strains(&self) -> Vec<Vector4<f64>> {
        self.limb.strains(&self.rod, &self.shape.q)
    }

    /// Position of the tip, m.
    pub(super) fn tip_m(&self) -> Vector3<f64> {
        self.shape.tip().translation.vector
    }
}

/// Tilt of the axis of a body that stood upright when the tip grasped it, rad.
pub(super) fn tilt_rad(turn: &UnitQuaternion<f64>, grasp: &UnitQuaternion<f64>) -> f64 {
    (turn * grasp.inverse() * Vector3::z()).angle(&Vector3::z())
}

/// The place of an aim that is nearest to a point, m.
pub(super) fn nearest(aim: &Aim, point_m: &Vector3<f64>) -> Vector3<f64> {
    match aim {
        Aim::Point(place_m) => *place_m,
        Aim::Inside { center_m, half_m, rotation } => {
            let own = rotation.inverse_transform_vector(&(point_m - center_m));
            let held = Vector3::from_fn(|axis, _| own[axis].clamp(-half_m[axis], half_m[axis]));
            center_m + rotation * held
        }
    }
}

/// The limb with its tip at the aim under a payload, kg, or as near as it gets, and what is missing, m.
///
/// `known` is the Jacobian of a limb of nearly the same sizes and pressures. It is used while the tip comes nearer fast, and spares the
/// derivatives; the pressures are nearest to `home` in its null space.
pub(super) fn reach(
    built: &Built,
    from: &Stand,
    (home, kg): (&[f64], f64),
    aim: &Aim,
    known: Option<&Jacobian>,
) -> Result<Reached, f64> {
    let mut here = Stand::at(built, &from.shares, kg, Some(from))?;
    let miss = |stand: &Stand| {
        let tip_m = stand.tip_m();
        nearest(aim, &tip_m) - tip_m
    };
    let mut missing = miss(&here);
    let (mut jacobian, mut fresh, mut stalls) = (known.cloned(), false, 0);
    for _ in 0..ITERATIONS {
        if jacobian.is_none() {
            (jacobian, fresh) = (tip_jacobian(built, &here, kg), true);
        }
        let Some(step) = jacobian.as_ref().and_then(|by| step(by, &here.shares, home, &missing)) else { break };
        let arrived = missing.norm() <= ARRIVED_M;
        if step.amax() <= if arrived { HOME } else { LEAST_CHANGE } || stalls == STALLS {
            break;
        }
        let Some((there, share)) = nearer(built, &here, kg, &step, missing.norm(), miss) else {
            if fresh {
                break;
            }
            jacobian = None;
            continue;
        };
        let left = miss(&there);
        let slow = share < 1.0 || left.norm() > SLOW * missing.norm();
        stalls += usize::from(fresh && left.norm() > 0.95 * missing.norm());
        (here, missing) = (there, left);
        if (fresh || slow) && missing.norm() > ARRIVED_M {
            (jacobian, fresh) = (None, false);
        }
    }
    Ok(Reached { stand: here, missing_m: missing, jacobian })
}

/// The stand that a step, or a part of it, leads to near the aim, and that part.
fn nearer(
    built: &Built,
    here: &Stand,
    kg: f64,
    step: &DVector<f64>,
    missing_m: f64,
    miss: impl Fn(&Stand) -> Vector3<f64>,
) -> Option<(Stand, f64)> {
    let longest = step.amax().max(1e-12);
    let mut share = f64::min(1.0, LONGEST / longest);
    while share >= LEAST_STEP {
        let shares: Vec<f64> =
            here.shares.iter().zip(step.iter()).map(|(at, by)| (at + share * by).clamp(0.0, MOST)).collect();
        if let Ok(there) = Stand::at(built, &shares, kg, Some(here)) {
            // A step towards home may take the tip away by what its own curvature makes, which the next step takes back.
            let curved_m = CURVED_M * (share * longest).powi(2);
            if miss(&there).norm() < (missing_m * (1.0 - 1e-4 * share)).max(curved_m).max(ARRIVED_M) {
                return Some((there, share));
            }
        }
        share *= 0.5;
    }
    None
}

/// Derivative of the tip, m, by the shares of the pressures.
pub(super) fn tip_jacobian(built: &Built, here: &Stand, kg: f64) -> Option<Jacobian> {
    let count = here.shares.len();
    let strains = here.strains();
    let responding = here.shape.responding(&here.rod, Bends::Linear)?;
    let column = |drive: usize| {
        let sign = if here.shares[drive] < 0.5 { STEP } else { -STEP };
        let mut shares = here.shares.clone();
        shares[drive] += sign;
        let mut rod = here.rod.clone();
        for module in built.driven(drive) {
            let bundle = built.bundle(module, &shares[built.drives_of(module)])?;
            let bundle = bundle.strained(built.motion(module), &strains[module])?;
            rod.pieces[module] = built.piece(module, &bundle, kg);
        }
        Some(responding.to(&rod).0 / sign)
    };
    let columns = (0..count).map(column).collect::<Option<Vec<_>>>()?;
    Some(DMatrix::from_fn(3, count, |row, column| columns[column][row]))
}

/// The step in shares that takes the tip by `missing`, in the ranges.
fn step(jacobian: &Jacobian, shares: &[f64], home: &[f64], missing: &Vector3<f64>) -> Option<DVector<f64>> {
    let count = shares.len();
    // From home the shortest way to where the tip shall be, as the tangent has it.
    let away = DVector::from_fn(count, |index, _| home[index] - shares[index]);
    let mut held = vec![None; count];
    for _ in 0..=count {
        let mut free = jacobian.clone();
        let mut left = DVector::from_column_slice(missing.as_slice()) - jacobian * &away;
        for (index, by) in held.iter().enumerate() {
            let Some(by) = by else { continue };
            left -= jacobian.column(index) * (*by - away[index]);
            free.column_mut(index).fill(0.0);
        }
        let square = &free * free.transpose() + DMatrix::identity(3, 3) * (HARDLY_M * HARDLY_M);
        let mut next = &away + free.transpose() * square.cholesky()?.solve(&left);
        held.iter().enumerate().for_each(|(index, by)| by.iter().for_each(|by| next[index] = *by));
        let outside = |index: usize| {
            let there = shares[index] + next[index];
            (there - MOST).max(-there)
        };
        let open = (0..count).filter(|index| held[*index].is_none());
        let worst = open.max_by(|a, b| outside(*a).total_cmp(&outside(*b)));
        match worst.filter(|index| outside(*index) > 0.0) {
            None => return Some(next),
            Some(index) => held[index] = Some((shares[index] + next[index]).clamp(0.0, MOST) - shares[index]),
        }
    }
    None
}
