//! Inverse kinematics: pressures of the drives that put the tip where it shall be, the body clear of obstacles.
//!
//! Damped Gauss-Newton in the shares of each drive's pressure range, the bounds kept by holding what would leave
//! them. The tip counts in m, a direction as an angle times a length, a clearance that is missing as a length. The last two are one-sided and
//! weigh more, so that what cannot be had leaves the tip off its target and not the limb in an obstacle.

mod descent;
mod nearby;
mod problem;
mod redundancy;

pub use problem::{Obstruction, TipGoal, TipTask};

use nalgebra::Vector3;

use super::carrier::Carrier;
use descent::descend;
use problem::Problem;
use softlimb_limb::Limb;

/// The tip counts as arrived within this distance, m.
const ARRIVED_M: f64 = 1e-7;
/// Distance from a target up to which it counts as reached, m.
pub(super) const REACHED_M: f64 = 1e-4;

/// What the limb can do about a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// Gauge pressure of each drive, Pa.
    pub pressures_pa: Vec<f64>,
    /// Where the tip then is, m.
    pub tip_m: [f64; 3],
    /// Its distance from the target, m.
    pub distance_m: f64,
    /// By how much its direction misses the tolerance, rad.
    pub angle_rad: f64,
    /// By how much the held object tilts more than it may, rad.
    pub tilt_rad: f64,
    /// By how much the nearest obstacle is nearer than it may be, m.
    pub shortfall_m: f64,
}

impl Reach {
    /// Whether that is at the target, in the direction asked for, upright and clear.
    pub fn reached(&self) -> bool {
        self.distance_m <= REACHED_M && self.allowed()
    }

    /// Whether direction, tilt and clearance are kept, wherever the tip is.
    pub fn allowed(&self) -> bool {
        self.angle_rad <= 1e-6 && self.tilt_rad <= 1e-6 && self.shortfall_m <= 1e-9
    }

    fn arrived(&self) -> bool {
        self.distance_m <= ARRIVED_M && self.allowed()
    }
}

/// The pressures nearest to `start_pa` that bring the tip to `target_m`; where the limb cannot reach it, as near as it gets.
pub fn solve_tip(limb: &Limb, target_m: [f64; 3], start_pa: &[f64]) -> Reach {
    let task = TipTask { goal: TipGoal::Point(target_m), aim: None, upright: None, obstacles: &[], clearance_m: 0.0 };
    solve(limb, &task, start_pa)
}

/// The pressures that do a task, as [`solutions`] prefers them; where there are none, the nearest to it that keep direction and clearance,
/// or, where nothing found keeps those, the nearest at all.
pub fn solve(limb: &Limb, task: &TipTask<'_>, start_pa: &[f64]) -> Reach {
    // There is always one.
    solutions(limb, task, start_pa).swap_remove(0)
}

/// Where the descent from `start_pa` alone ends.
pub(super) fn solve_near(carrier: &Carrier<'_>, task: &TipTask<'_>, start_pa: &[f64]) -> Reach {
    let end = |margin: bool| {
        let problem = Problem::new(carrier, task, margin);
        let home = problem.shares(start_pa);
        problem.reach(&redundancy::settle(&problem, descend(&problem, home.clone()), &home))
    };
    let kept = carrier.is_loaded().then(|| end(true)).filter(Reach::reached);
    kept.unwrap_or_else(|| end(false))
}

/// The pressures next to `start_pa` for a goal next to its tip: the limb under load keeps the margin of its pressures.
pub(super) fn solve_step(carrier: &Carrier<'_>, task: &TipTask<'_>, start_pa: &[f64]) -> Reach {
    let problem = Problem::new(carrier, task, carrier.is_loaded());
    problem.reach(&nearby::descend(&problem, problem.shares(start_pa)))
}

/// All different solutions found from `start_pa` and from starts spread over the range. First the one that the first descent from
/// `start_pa` arrives at, then by the distance from there in shares of the pressure ranges. Where there is none, the nearest miss alone.
///
/// Of a limb that can reach its target in many ways each solution is moved along them towards `start_pa`.
pub fn solutions(limb: &Limb, task: &TipTask<'_>, start_pa: &[f64]) -> Vec<Reach> {
    solutions_of(&Carrier::free(limb), task, start_pa)
}

/// [`solutions`] of a limb with what it carries. Under load those are sought first that leave a margin to the highest pressures.
pub(super) fn solutions_of(carrier: &Carrier<'_>, task: &TipTask<'_>, start_pa: &[f64]) -> Vec<Reach> {
    let within = |margin: bool| solutions_within(&Problem::new(carrier, task, margin), start_pa);
    let kept = carrier.is_loaded().then(|| within(true)).filter(|found| found[0].reached());
    kept.unwrap_or_else(|| within(false))
}

fn solutions_within(problem: &Problem<'_, '_>, start_pa: &[f64]) -> Vec<Reach> {
    let home = problem.shares(start_pa);
    let mut all = ends(problem, &home);
    let from_home = |reach: &Reach| distance(&problem.shares(&reach.pressures_pa), &home);
    let mut good: Vec<Reach> = all.iter().filter(|reach| reach.reached()).cloned().collect();
    let keeps_first = all[0].reached();
    good[usize::from(keeps_first)..].sort_by(|a, b| from_home(a).total_cmp(&from_home(b)));
    let mut found = different(problem, good);
    if found.is_empty() {
        let badness = |reach: &Reach| {
            let turned_rad = reach.angle_rad + reach.tilt_rad;
            (!reach.allowed(), reach.distance_m + reach.shortfall_m + LEVER_M * turned_rad)
        };
        all.sort_by(|a, b| badness(a).0.cmp(&badness(b).0).then(badness(a).1.total_cmp(&badness(b).1)));
        found.extend(all.into_iter().take(1));
    }
    found
}

/// Where a task cannot be done: what keeps direction, tilt and clearance, the nearest to its place first.
pub(super) fn misses(carrier: &Carrier<'_>, task: &TipTask<'_>, start_pa: &[f64]) -> Vec<Reach> {
    let problem = Problem::new(carrier, task, false);
    let mut kept: Vec<Reach> = ends(&problem, &problem.shares(start_pa)).into_iter().filter(Reach::allowed).collect();
    kept.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
    different(&problem, kept)
}

/// Where the descents from a posture and, if that is not enough, from starts spread over the range end.
fn ends(problem: &Problem<'_, '_>, home: &[f64]) -> Vec<Reach> {
    let end = |start: Vec<f64>| problem.reach(&redundancy::settle(problem, descend(problem, start), home));
    let first = end(home.to_vec());
    let needs_more = !first.arrived() || problem.has_obstacles();
    std::iter::once(first).chain(starts(home.len()).take(if needs_more { STARTS } else { 0 }).map(end)).collect()
}

/// The first of those that are the same.
fn different(problem: &Problem<'_, '_>, all: Vec<Reach>) -> Vec<Reach> {
    let mut found: Vec<Reach> = Vec::new();
    for reach in all {
        let shares = problem.shares(&reach.pressures_pa);
        if found.iter().all(|known| distance(&problem.shares(&known.pressures_pa), &shares) > SAME) {
            found.push(reach);
        }
    }
    found
}

/// Descents beside the first.
const STARTS: usize = 24;
/// Distance of solutions that count as the same, in shares.
const SAME: f64 = 1e-3;
/// Length at which an angle counts, m: about that of a module.
const LEVER_M: f64 = 0.2;

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Points spread over the unit box: the middle, then those of Halton's sequence. Which of several ways a plan takes depends on these very
/// points, so that the sequence of `softlimb-numerics` would alter plans and logs.
fn starts(dimensions: usize) -> impl Iterator<Item = Vec<f64>> {
    const BASES: [u32; 9] = [2, 3, 5, 7, 11, 13, 17, 19, 23];
    let halton = move |index: u32, base: u32| {
        let (mut value, mut share, mut rest) = (0.0, 1.0, index);
        while rest > 0 {
            share /= f64::from(base);
            value += share * f64::from(rest % base);
            rest /= base;
        }
        value
    };
    let point = move |i: u32| (0..dimensions).map(|d| halton(i + (d / 9) as u32, BASES[d % 9])).collect();
    std::iter::once(vec![0.5; dimensions]).chain((1..).map(point))
}

/// Angle between two directions, rad, also where they are nearly equal or opposite.
pub(super) fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}
