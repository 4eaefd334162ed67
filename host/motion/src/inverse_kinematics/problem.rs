//! What the tip shall do, as residuals with their derivatives.

use nalgebra::{DMatrix, DVector, Vector3};

use super::{LEVER_M, Reach, angle};
use crate::carrier::{Carrier, Posture};
use crate::upright::Upright;
use softlimb_limb::LimbModule;
use softlimb_scene::Aim;
use softlimb_scene::collision::{Clearance, Shape};

/// Where the tip shall be.
#[derive(Clone, Copy, Debug)]
pub enum TipGoal<'a> {
    /// At a point, m.
    Point([f64; 3]),
    /// Inside a solid.
    Inside(&'a Shape),
}

impl TipGoal<'_> {
    /// Distance of a point from it, m; 0 inside.
    pub(crate) fn distance_m(&self, point_m: &Vector3<f64>) -> f64 {
        match self {
            Self::Point(target) => (Vector3::from(*target) - point_m).norm(),
            Self::Inside(shape) => shape.distance(point_m).distance_m.max(0.0),
        }
    }

    /// The way from a point into it, m; 0 inside.
    pub(crate) fn missing_m(&self, point_m: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Point(target) => Vector3::from(*target) - point_m,
            Self::Inside(shape) => {
                let there = shape.distance(point_m);
                there.gradient * -there.distance_m.max(0.0)
            }
        }
    }
}

/// What tip and body shall do.
#[derive(Clone, Copy, Debug)]
pub struct TipTask<'a> {
    /// Where the tip shall be.
    pub goal: TipGoal<'a>,
    /// How the end effector shall point.
    pub aim: Option<Aim>,
    /// The held object that it keeps upright.
    pub upright: Option<Upright>,
    /// What the body keeps clear of.
    pub obstacles: &'a [&'a Shape],
    /// Least distance from every obstacle, m.
    pub clearance_m: f64,
}

/// The obstacle that a body is nearest to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstruction {
    /// Index of the obstacle.
    pub obstacle: usize,
    /// How near, and where.
    pub clearance: Clearance,
}

/// By how much more than required a solution clears, and a tip is in its region, m: more than what a proof of a move loses.
const SPARE_M: f64 = 2e-5;
/// By which share of its largest tilt an object stays below it.
const SPARE_TILT: f64 = 5e-3;
/// Weights of what must hold beside the tip's place, one descent after the other: with the first it goes down smoothly, and the last
/// leaves less than the spare to be missed where the tip cannot be at its place.
pub(super) const WEIGHTS: [f64; 2] = [30.0, 1000.0];

/// A task of a limb, in shares of the drives' pressure ranges.
pub(super) struct Problem<'a, 'l> {
    carrier: &'a Carrier<'l>,
    task: &'a TipTask<'a>,
    spans: Vec<f64>,
}

/// Residuals at a point, and their derivatives by the shares.
pub(super) struct Linear {
    pub(super) residual: DVector<f64>,
    pub(super) jacobian: DMatrix<f64>,
}

impl<'a, 'l> Problem<'a, 'l> {
    /// With whole ranges, or with those that leave a margin to the highest pressure and the limit point.
    pub(super) fn new(carrier: &'a Carrier<'l>, task: &'a TipTask<'a>, margin: bool) -> Self {
        let span = |module: &LimbModule| {
            let whole_pa = module.single_valued_max_pa();
            if margin { whole_pa.min(carrier.pressure_share() * module.ceiling_pa()) } else { whole_pa }
        };
        Self { carrier, task, spans: carrier.limb().drives().map(|drive| span(&drive)).collect() }
    }

    /// Whether anything stands in the way.
    pub(super) fn has_obstacles(&self) -> bool {
        !self.task.obstacles.is_empty()
    }

    /// Pressures as shares of the ranges, within them.
    pub(super) fn shares(&self, pressures_pa: &[f64]) -> Vec<f64> {
        let share = |(p, span): (&f64, &f64)| if *span > 0.0 { (p / span).clamp(0.0, 1.0) } else { 0.0 };
        pressures_pa.iter().zip(&self.spans).map(share).collect()
    }

    fn pressures(&self, shares: &[f64]) -> Vec<f64> {
        shares.iter().zip(&self.spans).map(|(share, span)| share * span).collect()
    }

    /// What holds at a point, without weights; infinitely far off where the limb does not stand.
    pub(super) fn reach(&self, shares: &[f64]) -> Reach {
        let pressures_pa = self.pressures(shares);
        let Some(body) = self.carrier.body(&pressures_pa) else {
            let [distance_m, angle_rad, tilt_rad, shortfall_m] = [f64::INFINITY; 4];
            return Reach { pressures_pa, tip_m: [f64::NAN; 3], distance_m, angle_rad, tilt_rad, shortfall_m };
        };
        let tip = body.end().translation.vector;
        let distance_m = self.task.goal.distance_m(&tip);
        let axis = body.end().rotation * Vector3::z();
        let angle_rad = self
            .task
            .aim
            .map_or(0.0, |aim| (angle(&axis, &Vector3::from(*aim.direction)) - aim.tolerance_rad).max(0.0));
        let tilts = |upright: Upright| (upright.tilt_rad(&body.end().rotation) - upright.most_rad()).max(0.0);
        let tilt_rad = self.task.upright.map_or(0.0, tilts);
        let nearest = self.task.obstacles.iter().filter_map(|shape| body.nearest(shape, self.task.clearance_m));
        let shortfall_m = nearest.map(|found| self.task.clearance_m - found.distance_m).fold(0.0, f64::max);
        Reach { pressures_pa, tip_m: tip.into(), distance_m, angle_rad, tilt_rad, shortfall_m }
    }

    /// Residuals; `None` where the limb does not stand.
    pub(super) fn residual(&self, shares: &[f64], weight: f64) -> Option<DVector<f64>> {
        let body = self.carrier.body(&self.pressures(shares))?;
        Some(residual(&self.rows(&Posture::Moved(body, Vec::new()), weight)))
    }

    /// Residuals and derivatives; `None` where the limb does not stand.
    pub(super) fn linear(&self, shares: &[f64], weight: f64) -> Option<Linear> {
        let at = self.carrier.posture(&self.pressures(shares))?;
        let rows = self.rows(&at, weight);
        let residual = residual(&rows);
        let count = self.spans.len();
        let jacobian = DMatrix::from_fn(rows.len(), count, |row, column| rows[row].1[column] * self.spans[column]);
        Some(Linear { residual, jacobian })
    }

    /// Each residual with its derivatives by the pressures.
    fn rows(&self, at: &Posture<'_>, weight: f64) -> Vec<(f64, Vec<f64>)> {
        let mut rows = Vec::new();
        self.tip_rows(at, &mut rows);
        self.aim_row(at, weight, &mut rows);
        self.tilt_row(at, weight, &mut rows);
        self.obstacle_rows(at, weight, &mut rows);
        rows
    }

    fn tip_rows(&self, at: &Posture<'_>, rows: &mut Vec<(f64, Vec<f64>)>) {
        let (tip, velocities) = (at.tip().translation.vector, at.tip_velocities());
        match self.task.goal {
            TipGoal::Point(target) => {
                let miss = tip - Vector3::from(target);
                rows.extend((0..3).map(|axis| (miss[axis], velocities.iter().map(|v| v[axis]).collect())));
            }
            TipGoal::Inside(shape) => {
                let there = shape.distance(&tip);
                let miss = there.gradient * (there.distance_m + SPARE_M).max(0.0);
                // The way to the nearest point inside, as if that stood still: its length falls as the distance does, and where the tip
                // hardly moves along it the other directions still say how far a step may go.
                let slope =
                    |axis: usize| velocities.iter().map(|v| if miss.norm() > 0.0 { v[axis] } else { 0.0 }).collect();
                rows.extend((0..3).map(|axis| (miss[axis], slope(axis))));
            }
        }
    }

    fn aim_row(&self, at: &Posture<'_>, weight: f64, rows: &mut Vec<(f64, Vec<f64>)>) {
        let Some(aim) = self.task.aim else { return };
        let (axis, wanted) = (at.tip().rotation * Vector3::z(), Vector3::from(*aim.direction));
        let off = angle(&axis, &wanted);
        let spare = 1e-3 * aim.tolerance_rad;
        rows.push(one_sided(off - aim.tolerance_rad + spare, turning(at, &axis, &wanted), weight * LEVER_M));
    }

    /// No row while the object is upright enough: others then decide alone.
    fn tilt_row(&self, at: &Posture<'_>, weight: f64, rows: &mut Vec<(f64, Vec<f64>)>) {
        let Some(upright) = self.task.upright else { return };
        let beyond = upright.tilt_rad(&at.tip().rotation) - (1.0 - SPARE_TILT) * upright.most_rad();
        if beyond > 0.0 {
            let axis = upright.axis_at(&at.tip().rotation);
            rows.push(one_sided(beyond, turning(at, &axis, &Vector3::z()), weight * LEVER_M));
        }
    }

    fn obstacle_rows(&self, at: &Posture<'_>, weight: f64, rows: &mut Vec<(f64, Vec<f64>)>) {
        if self.task.obstacles.is_empty() {
            return;
        }
        let wanted_m = self.task.clearance_m + SPARE_M;
        for shape in self.task.obstacles {
            let Some(found) = at.body().nearest(shape, wanted_m + 1e-6) else { continue };
            let (velocities, growth) = at.body_velocities(&found);
            let slope = velocities.iter().zip(growth).map(|(v, grows)| grows - found.away.dot(v)).collect();
            rows.push(one_sided(wanted_m - found.distance_m, slope, weight));
        }
    }
}

fn residual(rows: &[(f64, Vec<f64>)]) -> DVector<f64> {
    DVector::from_iterator(rows.len(), rows.iter().map(|(value, _)| *value))
}

/// Growth of the angle between an axis that turns with the tip and a direction, by each pressure, rad/Pa.
fn turning(at: &Posture<'_>, axis: &Vector3<f64>, wanted: &Vector3<f64>) -> Vec<f64> {
    // The turn that lessens the angle fastest; any across where the axis is opposite.
    let turn = axis.cross(wanted).try_normalize(1e-12).unwrap_or_else(|| at.tip().rotation * Vector3::x());
    at.tip_rotations().iter().map(|rotation| -turn.dot(rotation)).collect()
}

/// A residual that counts above zero only.
fn one_sided(value: f64, slope: Vec<f64>, weight: f64) -> (f64, Vec<f64>) {
    if value <= 0.0 {
        return (0.0, vec![0.0; slope.len()]);
    }
    (weight * value, slope.into_iter().map(|slope| weight * slope).collect())
}
