//! How far the tip gets under weight: the best samples and corners, and ascents from them through equilibria.

use std::cell::RefCell;

use nalgebra::DVector;

use super::ascent::{Goal, Place, Surface, ascend};
use super::extents::{Measure, best, corners};
use super::loaded::{Loaded, LoadedPoseError};
use super::sample::{Points, shares};
use crate::statics::{Fidelity, LoadedLimb};

/// Most corners that are looked at, as a power of two.
const CORNERS_LOG2: usize = 10;
/// Ascents for an extreme, from the best places.
const STARTS: usize = 3;
/// How far around an extreme is looked for poses that are not reached, as a share of an axis.
const AROUND: f64 = 2e-3;

/// An extreme of the poses that are reached under load.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedReach {
    /// The extreme of the measure, m, by the finest tier.
    pub value_m: f64,
    /// The tip there, m.
    pub tip_m: [f64; 3],
    /// Gauge pressure of each axis, Pa.
    pub pressures_pa: Vec<f64>,
    /// Distance of the tip by the linear tier, m, which has found it.
    pub error_m: f64,
    /// Whether a step on, poses are no longer reached: the extreme is not one of the tip but of what is.
    pub at_border: bool,
}

/// Least and largest of each coordinate and of the distance, under load.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedExtents {
    /// By coordinate, then the distance: least and largest.
    pub of: [[LoadedReach; 2]; 4],
}

impl LoadedExtents {
    /// Largest less least value of a coordinate (0 to 2) or of the distance (3), m.
    pub fn range_m(&self, index: usize) -> f64 {
        let [least, largest] = &self.of[index];
        largest.value_m - least.value_m
    }
}

/// Equilibria near each other: each begins from the one before.
struct Near<'c, 'a, 'b, H> {
    loaded: &'c Loaded<'a, 'b, H>,
    last: RefCell<Option<DVector<f64>>>,
}

impl<H: Fn(&[f64]) -> Option<LoadedLimb> + Sync> Surface for Near<'_, '_, '_, H> {
    fn axes(&self) -> usize {
        self.loaded.space().axes().len()
    }

    fn base(&self) -> [f64; 3] {
        self.loaded.space().base()
    }

    fn resolution_m(&self) -> f64 {
        1e-8
    }

    fn tips(&self, count: usize, share: impl Fn(usize, usize) -> f64, tips: &mut [[f64; 3]]) {
        for (index, tip) in tips[..count].iter_mut().enumerate() {
            let start = self.last.borrow().clone();
            let pose = self.loaded.pose(|axis| share(index, axis), Fidelity::Linear, start.as_ref());
            *tip = pose.as_ref().map_or([f64::NAN; 3], |pose| pose.tip_m);
            if let Ok(pose) = pose {
                *self.last.borrow_mut() = Some(pose.shape.q);
            }
        }
    }
}

/// The extents of the poses that are reached; `samples` are those of [`Loaded::sample`] with the same points and seed. `None` where no pose is reached.
pub fn loaded_extents<H: Fn(&[f64]) -> Option<LoadedLimb> + Sync>(
    loaded: &Loaded<'_, '_, H>,
    samples: &[Result<[f64; 3], LoadedPoseError>],
    (points, seed): (Points, u64),
    threads: usize,
) -> Option<LoadedExtents> {
    let axes = loaded.space().axes().len();
    let (count, corner) = corners(axes, CORNERS_LOG2);
    let share = shares(axes, points, seed);
    let cornered = loaded.each(count, threads, |index| {
        loaded.pose(|axis| corner(index, axis), Fidelity::Linear, None).map(|pose| pose.tip_m)
    });
    let place = |share: &dyn Fn(usize) -> f64| -> Place {
        std::array::from_fn(|axis| if axis < axes { share(axis) } else { 0.0 })
    };
    let mut starts: Vec<(Place, [f64; 3])> = Vec::new();
    for (index, tip) in samples.iter().enumerate() {
        starts.extend(tip.iter().map(|tip| (place(&|axis| share(index, axis)), *tip)));
    }
    for (index, tip) in cornered.iter().enumerate() {
        starts.extend(tip.iter().map(|tip| (place(&|axis| corner(index, axis)), *tip)));
    }
    let measures = [Measure::Coordinate(0), Measure::Coordinate(1), Measure::Coordinate(2), Measure::Distance];
    let goals: Vec<Goal> =
        measures.into_iter().flat_map(|measure| [-1.0, 1.0].map(|sign| Goal { measure, sign })).collect();
    let mut found = loaded.each(goals.len(), threads, |index| extreme(loaded, goals[index], &starts)).into_iter();
    let mut pair = || Some([found.next()??, found.next()??]);
    Some(LoadedExtents { of: [pair()?, pair()?, pair()?, pair()?] })
}

/// The best end of several ascents, as growing weight leads there: an ascent may have followed the branch of another shape.
fn extreme<H: Fn(&[f64]) -> Option<LoadedLimb> + Sync>(
    loaded: &Loaded<'_, '_, H>,
    goal: Goal,
    starts: &[(Place, [f64; 3])],
) -> Option<LoadedReach> {
    let base = loaded.space().base();
    let begun: Vec<Place> = best(starts, goal, &base).into_iter().take(STARTS).map(|(_, place)| place).collect();
    let climbed = begun.iter().map(|start| ascend(&Near { loaded, last: RefCell::new(None) }, goal, start).1);
    let reaches = climbed.chain(begun.iter().copied()).filter_map(|place| reach(loaded, goal, &place));
    reaches.max_by(|a, b| (goal.sign * a.value_m).total_cmp(&(goal.sign * b.value_m)))
}

fn reach<H: Fn(&[f64]) -> Option<LoadedLimb> + Sync>(
    loaded: &Loaded<'_, '_, H>,
    goal: Goal,
    place: &Place,
) -> Option<LoadedReach> {
    let axes = loaded.space().axes();
    let linear = loaded.pose(|axis| place[axis], Fidelity::Linear, None).ok()?.tip_m;
    let fine = loaded.pose(|axis| place[axis], Fidelity::Fourfold, None).ok()?.tip_m;
    let error_m = linear.iter().zip(fine).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    let beyond = |moved: usize, by: f64| {
        let there = (place[moved] + by).clamp(0.0, 1.0);
        loaded.pose(|axis| if axis == moved { there } else { place[axis] }, Fidelity::Linear, None).is_err()
    };
    Some(LoadedReach {
        value_m: goal.sign * goal.of(&fine, &loaded.space().base()),
        tip_m: fine,
        pressures_pa: axes.iter().zip(place).map(|(axis, share)| axis.pressure_max_pa * share).collect(),
        error_m,
        at_border: (0..axes.len()).any(|axis| beyond(axis, AROUND) || beyond(axis, -AROUND)),
    })
}
