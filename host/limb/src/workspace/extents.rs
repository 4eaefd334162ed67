//! How far the tip gets: corners of the pressure box and ascents from the best of them.
//!
//! What is sought is the largest value of a smooth function over a box. All corners are looked at where there are at most 2^14, that
//! many of them otherwise, and points inside; from the best ones a projected quasi-Newton ascent goes on. The answer is asked of the model.

use super::ascent::{Goal, Place, ascend};
use super::space::Workspace;
use softlimb_numerics::Kronecker;

/// Most corners that are looked at, as a power of two, and points inside.
const CORNERS_LOG2: usize = 14;
const INSIDE: usize = 4096;
/// Ascents from corners, and from points inside.
const STARTS: usize = 4;

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// A coordinate of the tip in the scene's frame: 0 to 2.
    Coordinate(usize),
    /// Distance of the tip from the start of the limb.
    Distance,
}

/// An extreme and where in the box it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// The extreme of the measure, m, by the model.
    pub value_m: f64,
    /// The tip there, m.
    pub tip_m: [f64; 3],
    /// Gauge pressure of each axis, Pa.
    pub pressures_pa: Vec<f64>,
    /// Value at the best corner alone, m.
    pub corner_m: f64,
    /// How far the polynomials were off at the extreme, m.
    pub table_error_m: f64,
}

/// Least and largest of each coordinate and of the distance.
#[derive(Clone, Debug, PartialEq)]
pub struct Extents {
    /// By coordinate, then the distance: least and largest.
    pub of: [[Reach; 2]; 4],
}

impl Extents {
    /// Largest less least value of a coordinate (0 to 2) or of the distance (3), m.
    pub fn range_m(&self, index: usize) -> f64 {
        let [least, largest] = &self.of[index];
        largest.value_m - least.value_m
    }
}

/// The extents; `None` where the model has no equilibrium at one of them.
pub fn extents(space: &Workspace<'_>) -> Option<Extents> {
    let [corners, inside] = starts(space);
    let find = |measure| {
        let both = [-1.0, 1.0].map(|sign| extreme(space, Goal { measure, sign }, &corners, &inside));
        let [least, largest] = both;
        Some([least?, largest?])
    };
    let of = [Measure::Coordinate(0), Measure::Coordinate(1), Measure::Coordinate(2), Measure::Distance].map(find);
    let [x, y, z, distance] = of;
    Some(Extents { of: [x?, y?, z?, distance?] })
}

/// Corners and points inside with their tips.
fn starts(space: &Workspace<'_>) -> [Vec<(Place, [f64; 3])>; 2] {
    let axes = space.axes().len();
    let (corners, corner) = corners(axes, CORNERS_LOG2);
    let sequence = Kronecker::new(axes, 0);
    [gather(space, corners, corner), gather(space, INSIDE, |index, axis| sequence.coordinate(index, axis))]
}

/// The corners of a box, or `2^most` of them that are far apart: those whose bits are those of odd multiples of their number.
pub(super) fn corners(axes: usize, most: usize) -> (usize, impl Fn(usize, usize) -> f64 + Sync) {
    let corner = move |index: usize, axis: usize| {
        let code = if axes > most { (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 24 } else { index as u64 };
        if code >> axis & 1 == 1 { 1.0 } else { 0.0 }
    };
    (1 << axes.min(most), corner)
}

fn gather(space: &Workspace<'_>, count: usize, share: impl Fn(usize, usize) -> f64) -> Vec<(Place, [f64; 3])> {
    let mut tips = vec![[0.0; 3]; count];
    space.tips(count, &share, &mut tips);
    let axes = space.axes().len();
    let place = |index: usize| std::array::from_fn(|axis| if axis < axes { share(index, axis) } else { 0.0 });
    tips.into_iter().enumerate().map(|(index, tip)| (place(index), tip)).collect()
}

fn extreme(
    space: &Workspace<'_>,
    goal: Goal,
    corners: &[(Place, [f64; 3])],
    inside: &[(Place, [f64; 3])],
) -> Option<Reach> {
    let base = space.base();
    let (first, second) = (best(corners, goal, &base), best(inside, goal, &base));
    let corner_m = goal.sign * first.first()?.0;
    let climbed = first.iter().chain(&second).map(|(_, place)| ascend(space, goal, place));
    let (_, place) = climbed.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let axes = space.axes();
    let tip_m = space.tip_by_the_model(&place[..axes.len()])?;
    let value = goal.of(&tip_m, &base);
    let off = space.tip(&place[..axes.len()]);
    Some(Reach {
        value_m: goal.sign * value,
        tip_m,
        pressures_pa: axes.iter().zip(place).map(|(axis, share)| axis.pressure_max_pa * share).collect(),
        corner_m,
        table_error_m: off.iter().zip(tip_m).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max),
    })
}

/// The best few, best first.
pub(super) fn best(points: &[(Place, [f64; 3])], goal: Goal, base: &[f64; 3]) -> Vec<(f64, Place)> {
    let mut kept: Vec<(f64, Place)> = Vec::new();
    for (place, tip) in points {
        let value = goal.of(tip, base);
        if kept.len() < STARTS || kept.last().is_some_and(|last| value > last.0) {
            kept.push((value, *place));
            kept.sort_by(|a, b| b.0.total_cmp(&a.0));
            kept.truncate(STARTS);
        }
    }
    kept
}
