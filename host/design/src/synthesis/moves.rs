//! The least clearance along a move, without gaps between samples.
//!
//! On the straight line between two deformations no point of the body is faster than the sum of what every module's length, bend and
//! twist can do to it. So an interval of the move holds nothing nearer than the clearance in its middle, less that speed over half of it.

use super::chain::Chain;
use super::objective::{Objective, Pose};
use super::table::Curve;
use softlimb_scene::collision::{Body, Clearance, Shape};

/// Largest error of a clearance along a move, m: never more than this above the true one.
const TOLERANCE_M: f64 = 2e-5;
/// Deformations at which speeds are asked for; they change little in between, and a tenth is added.
const SAMPLES: usize = 9;
const RESERVE: f64 = 1.1;
/// Most configurations of a move that are looked at.
const MOST: usize = 20_000;

/// The nearest that a move comes to a solid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub(super) clearance: Clearance,
    /// How much of the move is done there, 0 to 1.
    pub(super) share: f64,
}

/// A move of a limb: from a way-point, or from rest, to the next.
pub(super) struct Move<'a, 'b> {
    pub(super) objective: &'a Objective<'b>,
    pub(super) place: &'a [f64],
    pub(super) curves: &'a [Curve],
    pub(super) from: Option<usize>,
    pub(super) to: usize,
}

impl Move<'_, '_> {
    fn chain(&self, share: f64) -> Chain {
        let mut chain = Chain::default();
        self.objective.chain(self.place, self.curves, &Pose { from: self.from, to: self.to, share }, &mut chain);
        chain
    }

    /// The body when a share of the move is done.
    pub(super) fn body(&self, share: f64) -> Body {
        self.chain(share).body(self.objective.task, &self.objective.start())
    }

    /// A bound of the speed of any surface point, m per whole move.
    fn speed(&self) -> f64 {
        let chains: Vec<Chain> = (0..SAMPLES).map(|i| self.chain(i as f64 / (SAMPLES - 1) as f64)).collect();
        let most = |value: &dyn Fn(usize) -> f64| (0..SAMPLES).map(value).fold(0.0, f64::max);
        let mut speed = 0.0;
        for module in 0..self.curves.len() {
            let lengths = |chain: &Chain| chain.joints[module..].iter().flat_map(|j| j.lengths()).sum::<f64>();
            let behind = most(&|i| lengths(&chains[i]));
            let radius = most(&|i| chains[i].joints[module].radius().0);
            let rate = |field: usize| {
                most(&|i| {
                    let value = |i: usize| chains[i].joints[module].values()[field];
                    (value((i + 1).min(SAMPLES - 1)) - value(i)).abs() * (SAMPLES - 1) as f64
                })
            };
            speed += rate(0) + (rate(1) + rate(2)) * (behind + radius) + rate(3);
        }
        RESERVE * speed
    }

    /// Where it comes nearest to a solid, along the move where moves count, else at its end; `None` where it keeps `enough_m`.
    pub(super) fn nearest(&self, shape: &Shape, enough_m: f64) -> Option<Nearest> {
        let mut best = None;
        improve(&mut best, self.body(1.0).nearest(shape, enough_m), 1.0);
        if self.objective.task.move_to(self.to) {
            improve(&mut best, self.body(0.0).nearest(shape, enough_m), 0.0);
            self.between(shape, enough_m, &mut best);
        }
        best
    }

    /// The same between the ends, where it is nearer than the best so far.
    fn between(&self, shape: &Shape, enough_m: f64, best: &mut Option<Nearest>) {
        let speed = self.speed();
        let mut waiting = vec![(0.5, 0.5)];
        let mut looked_at = 0;
        while let Some((middle, half)) = waiting.pop() {
            looked_at += 1;
            let least = best.map_or(enough_m, |best| best.clearance.distance_m);
            // A body that keeps as much in the middle hides nothing nearer within the interval.
            let keeps = least - TOLERANCE_M + speed * half;
            let Some(clearance) = self.body(middle).nearest(shape, keeps) else { continue };
            if clearance.distance_m < least {
                improve(best, Some(clearance), middle);
            }
            if looked_at < MOST {
                waiting.extend([(middle - 0.5 * half, 0.5 * half), (middle + 0.5 * half, 0.5 * half)]);
            }
        }
    }
}

fn improve(best: &mut Option<Nearest>, found: Option<Clearance>, share: f64) {
    let Some(clearance) = found else { return };
    if best.is_none_or(|best| clearance.distance_m < best.clearance.distance_m) {
        *best = Some(Nearest { clearance, share });
    }
}

/// Where on the limb a piece of its body is: the module, and the share of it, beyond 1 of the rigid parts behind it.
pub(super) fn spot(objective: &Objective, clearance: &Clearance) -> (usize, f64) {
    let mut piece = clearance.piece;
    for module in 0..objective.tables.len() {
        let [connector_m, tool_m] = objective.rigid_parts_m(module);
        if piece == 0 {
            return (module, clearance.share);
        }
        piece -= 1;
        // A part of no length has no piece of its own.
        for (before_m, length_m) in [(0.0, connector_m), (connector_m, tool_m)] {
            if length_m > 0.0 {
                if piece == 0 {
                    return (module, 1.0 + (before_m + clearance.share * length_m) / (connector_m + tool_m));
                }
                piece -= 1;
            }
        }
    }
    (objective.tables.len() - 1, 2.0)
}
