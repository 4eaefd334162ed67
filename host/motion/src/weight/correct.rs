//! The pressures that bring the tip under load to where it shall be, as near to those without load as can be.
//!
//! Newton's method on three equations with the shortest step from home: a limb with more modules than equations has no single minimum of
//! their squares, which a least-squares solver would need.

use nalgebra::{DMatrix, DVector, Vector3};

use super::nominal::{Nominal, OnLimb, Pose, PoseError};
use softlimb_limb::{Limb, LimbModule};

/// The tip has arrived within this, m: on the way, and at a goal.
pub(super) const ON_THE_WAY_M: f64 = 1e-6;
pub(super) const AT_GOAL_M: f64 = 1e-8;
const ITERATIONS: usize = 25;
/// A way of the tip below this, for the whole range of a pressure, counts as none, m: a module that hardly moves the tip is not asked to.
const HARDLY_M: f64 = 1e-4;
/// Least share of a step that is tried.
const LEAST_STEP: f64 = 1.0 / 64.0;

/// Corrected pressures.
#[derive(Clone, Debug)]
pub(super) struct Corrected {
    pub(super) pressures_pa: Vec<f64>,
    /// The shape there.
    pub(super) pose: Pose,
    /// How far the tip is from where it shall be, m.
    pub(super) off_m: f64,
}

/// The limb with the ranges of its pressures.
pub(super) struct Corrector<'a> {
    nominal: Nominal<'a>,
    pub(super) spans_pa: Vec<f64>,
}

impl<'a> Corrector<'a> {
    pub(super) fn new(limb: &Limb, nominal: Nominal<'a>) -> Self {
        Self { nominal, spans_pa: limb.modules().iter().map(LimbModule::single_valued_max_pa).collect() }
    }

    /// From the pressures without load, `home_pa`, and a start: the shortest way from home, in shares of the ranges, that brings the tip to
    /// `wanted_m` within `arrived_m`, or as near as it gets.
    ///
    /// Newton's method on the tip with the tangent of the statics. Where several pressures do, `x = home + J^+ (r + J (x - home))` is the
    /// nearest to home; `J^+` is damped where the tip hardly moves, and a pressure that leaves its range is held at its end.
    pub(super) fn correct(
        &mut self,
        home_pa: &[f64],
        start_pa: &[f64],
        wanted_m: &Vector3<f64>,
        (on, arrived_m): (OnLimb, f64),
    ) -> Result<Corrected, PoseError> {
        let home = self.shares(home_pa);
        let mut shares = self.shares(start_pa);
        let mut here = self.at(&shares, wanted_m, on)?;
        for _ in 0..ITERATIONS {
            let Some(next) = self.step(&here, &shares, &home, wanted_m, on) else { break };
            let far = (&next - &shares).amax();
            let mut share = 1.0;
            let found = loop {
                let tried = &shares + (&next - &shares) * share;
                if let Ok(there) = self.at(&tried, wanted_m, on)
                    && (there.off_m < here.off_m || there.off_m <= arrived_m)
                {
                    break Some((tried, there));
                }
                share *= 0.5;
                if share < LEAST_STEP {
                    break None;
                }
            };
            let Some((moved, there)) = found else { break };
            (shares, here) = (moved, there);
            // The last step also went as near to home as there is need for.
            if here.off_m <= arrived_m && far * far <= arrived_m {
                break;
            }
        }
        Ok(here)
    }

    fn at(&mut self, shares: &DVector<f64>, wanted_m: &Vector3<f64>, on: OnLimb) -> Result<Corrected, PoseError> {
        let pressures_pa: Vec<f64> = shares.iter().zip(&self.spans_pa).map(|(share, span)| share * span).collect();
        let pose = self.nominal.at(&pressures_pa, on)?;
        let off_m = (pose.tip_m() - wanted_m).norm();
        Ok(Corrected { pressures_pa, pose, off_m })
    }

    fn shares(&self, pressures_pa: &[f64]) -> DVector<f64> {
        let share = |(pressure, span): (&f64, &f64)| if *span > 0.0 { (pressure / span).clamp(0.0, 1.0) } else { 0.0 };
        DVector::from_iterator(pressures_pa.len(), pressures_pa.iter().zip(&self.spans_pa).map(share))
    }

    /// The next shares, within their ranges.
    fn step(
        &self,
        here: &Corrected,
        shares: &DVector<f64>,
        home: &DVector<f64>,
        wanted_m: &Vector3<f64>,
        on: OnLimb,
    ) -> Option<DVector<f64>> {
        let columns = self.nominal.velocities_m(&here.pose, &here.pressures_pa, on, &self.spans_pa)?;
        let jacobian = DMatrix::from_fn(3, columns.len(), |row, column| columns[column][row]);
        let aim =
            DVector::from_iterator(3, (wanted_m - here.pose.tip_m()).iter().copied()) + &jacobian * (shares - home);
        let mut held: Vec<Option<f64>> = vec![None; home.len()];
        for _ in 0..=home.len() {
            let mut free = jacobian.clone();
            let mut left = aim.clone();
            for (index, end) in held.iter().enumerate() {
                let Some(end) = end else { continue };
                left -= jacobian.column(index) * (end - home[index]);
                free.column_mut(index).fill(0.0);
            }
            let square = &free * free.transpose() + DMatrix::identity(3, 3) * (HARDLY_M * HARDLY_M);
            let mut next = home + free.transpose() * square.cholesky()?.solve(&left);
            held.iter().enumerate().for_each(|(index, end)| end.iter().for_each(|end| next[index] = *end));
            let worst = (0..next.len()).max_by(|a, b| outside(next[*a]).total_cmp(&outside(next[*b])))?;
            if outside(next[worst]) <= 0.0 {
                return Some(next);
            }
            held[worst] = Some(next[worst].clamp(0.0, 1.0));
        }
        None
    }
}

/// By how much a share is outside its range.
fn outside(share: f64) -> f64 {
    (share - 1.0).max(-share)
}
