//! Inverse kinematics under load: pressures that bring the tip of the loaded limb to an aim.
//!
//! Newton's method on the tip with the tangent of the statics. Where several pressures do, those nearest to `home` are taken, in shares of
//! the ranges; a pressure that leaves its range is held at its end.

use nalgebra::{DMatrix, DVector, Vector3, Vector4};

use super::built::Built;
use crate::synthesis::Aim;
use softlimb_limb::statics::{Bends, EquilibriumError, Fidelity, LoadedLimb, Rod, Settled, Shape};

/// The tip has arrived within this, m.
pub(super) const ARRIVED_M: f64 = 1e-7;
const ITERATIONS: usize = 20;
/// Longest step, as a share of the range of a pressure.
const LONGEST: f64 = 0.3;
const LEAST_STEP: f64 = 1.0 / 32.0;
/// Change of a share for a derivative.
const STEP: f64 = 1e-5;
/// A way of the tip below this for the whole range of a pressure counts as none, m.
const HARDLY_M: f64 = 1e-3;

/// A limb in equilibrium at shares of its pressures.
#[derive(Clone, Debug)]
pub(super) struct Stand {
    pub(super) shares: Vec<f64>,
    pub(super) limb: LoadedLimb,
    pub(super) rod: Rod,
    pub(super) shape: Shape,
}

impl Stand {
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
            Ok(Settled { limb, rod, shape }) => Ok(Self { shares: shares.to_vec(), limb, rod, shape }),
            Err(EquilibriumError::Unstable { share }) => Err(share),
            Err(EquilibriumError::Overstrained { .. } | EquilibriumError::Unsettled) => Err(0.0),
        }
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
pub(super) fn reach(
    built: &Built,
    from: &Stand,
    home: &[f64],
    kg: f64,
    aim: &Aim,
) -> Result<(Stand, Vector3<f64>), f64> {
    let mut here = Stand::at(built, &from.shares, kg, Some(from))?;
    let miss = |stand: &Stand| {
        let tip_m = stand.tip_m();
        nearest(aim, &tip_m) - tip_m
    };
    let mut missing = miss(&here);
    for _ in 0..ITERATIONS {
        if missing.norm() <= ARRIVED_M {
            break;
        }
        let Some(step) = step(built, &here, home, kg, &missing) else { break };
        let mut share = f64::min(1.0, LONGEST / step.amax().max(1e-12));
        let found = loop {
            let tried: Vec<f64> =
                here.shares.iter().zip(step.iter()).map(|(at, by)| (at + share * by).clamp(0.0, 1.0)).collect();
            if let Ok(there) = Stand::at(built, &tried, kg, Some(&here)) {
                let left = miss(&there);
                if left.norm() < f64::max(missing.norm() * (1.0 - 1e-4 * share), ARRIVED_M) {
                    break Some((there, left));
                }
            }
            share *= 0.5;
            if share < LEAST_STEP * LEAST_STEP {
                break None;
            }
        };
        let Some((there, left)) = found else { break };
        let gain = missing.norm() - left.norm();
        (here, missing) = (there, left);
        if gain < 1e-3 * ARRIVED_M {
            break;
        }
    }
    Ok((here, missing))
}

/// The step in shares that takes the tip by `missing`, in the ranges.
fn step(built: &Built, here: &Stand, home: &[f64], kg: f64, missing: &Vector3<f64>) -> Option<DVector<f64>> {
    let count = here.shares.len();
    let signs: Vec<f64> = here.shares.iter().map(|share| if *share < 0.5 { STEP } else { -STEP }).collect();
    let strains = here.strains();
    let responding = here.shape.responding(&here.rod, Bends::Linear)?;
    let column = |module: usize| {
        let bundle = built.bundle(module, here.shares[module] + signs[module])?;
        let bundle = bundle.strained(built.motion(module), &strains[module])?;
        let mut rod = here.rod.clone();
        rod.pieces[module] = built.piece(module, &bundle, kg);
        Some(responding.to(&rod).0 / signs[module])
    };
    let columns = (0..count).map(column).collect::<Option<Vec<_>>>()?;
    let jacobian = DMatrix::from_fn(3, count, |row, column| columns[column][row]);
    // From home the shortest way to where the tip shall be, as the tangent has it.
    let away = DVector::from_fn(count, |index, _| home[index] - here.shares[index]);
    let mut held = vec![None; count];
    for _ in 0..=count {
        let mut free = jacobian.clone();
        let mut left = DVector::from_column_slice(missing.as_slice()) - &jacobian * &away;
        for (index, by) in held.iter().enumerate() {
            let Some(by) = by else { continue };
            left -= jacobian.column(index) * (*by - away[index]);
            free.column_mut(index).fill(0.0);
        }
        let square = &free * free.transpose() + DMatrix::identity(3, 3) * (HARDLY_M * HARDLY_M);
        let mut next = &away + free.transpose() * square.cholesky()?.solve(&left);
        held.iter().enumerate().for_each(|(index, by)| by.iter().for_each(|by| next[index] = *by));
        let outside = |index: usize| {
            let there = here.shares[index] + next[index];
            (there - 1.0).max(-there)
        };
        let open = (0..count).filter(|index| held[*index].is_none());
        let worst = open.max_by(|a, b| outside(*a).total_cmp(&outside(*b)));
        match worst.filter(|index| outside(*index) > 0.0) {
            None => return Some(next),
            Some(index) => held[index] = Some((here.shares[index] + next[index]).clamp(0.0, 1.0) - here.shares[index]),
        }
    }
    None
}
