//! Bounds that a limb found lies at, and what each costs: the search goes on from it with that one bound moved.

use serde::Serialize;

use super::evaluate::Judgement;
use super::local_solve::{NOTHING, local};
use super::search::{Found, RAISE, RAISE_STEPS, reserve_from};
use super::space::{HOME, LimbSpace, Variable};
use super::task::LoadedTask;

/// A variable this near to the end of its range, as a share of it, is at its bound.
const AT_END: f64 = 1e-3;
/// By which shares of its range a bound is moved outwards, one after the other.
const MOVES: [f64; 3] = [0.2, 0.5, 1.0];
/// A pressure this near to its limit, as a share of it, is at it; with the reserve that was found.
const AT_PRESSURE: f64 = 0.99;

/// A bound that the limb lies at.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ActiveBound {
    /// Name of its module; `None` for the base and for pressures of all modules.
    pub module: Option<String>,
    /// Its key in a scene.
    pub name: &'static str,
    /// Its value in SI units.
    pub bound: f64,
    /// The value it was moved to.
    pub moved_to: f64,
    /// Whether every margin is kept with the bound moved.
    pub reached: bool,
    /// The reserve that is found with it moved.
    pub reserve: f64,
    /// Remaining share of the shortfall after the move; 0 for a task that is met.
    pub left: f64,
}

/// The bounds that a limb lies at. Of a limb that keeps every margin each is moved once, of another one until the margins are kept.
///
/// Each local solve calls `stop` first.
pub fn active_bounds(
    task: &LoadedTask,
    space: &LimbSpace,
    found: &Found,
    stop: &(dyn Fn() -> bool + Sync),
) -> Vec<ActiveBound> {
    let variables = space.variables();
    let values: Vec<f64> = found.point.iter().zip(&variables).map(|(share, v)| value(v, *share)).collect();
    let mut all = Vec::new();
    for (index, variable) in variables.iter().enumerate() {
        let share = found.point[index];
        let at_high = share >= 1.0 - AT_END;
        if variable.name == HOME || (!at_high && share > AT_END) {
            continue;
        }
        let [low, high] = variable.bounds;
        // Actuators that touch each other are no bound of the task.
        let touching = |module: usize| found.evaluation.sizes.modules[module].spread_m > low;
        if !at_high && is_spread(variable) && variable.module.is_some_and(touching) {
            continue;
        }
        let name = variable.module.map(|module| space.modules[module].name.clone());
        let moved = |by: f64| {
            let by = by * (high - low);
            // A size stays positive, and a length more than what its ends take.
            let ends_m =
                variable.module.filter(|_| variable.name == "length").map(|index| space.modules[index].capped_m());
            let least = ends_m.unwrap_or(0.0);
            let bounds =
                if at_high { [low, high + by] } else { [(low - by).max(least + 0.25 * (low - least).abs()), high] };
            let bounds = if variable.module.is_none() && !at_high { [low - by, high] } else { bounds };
            (space.with_bounds(index, bounds), if at_high { bounds[1] } else { bounds[0] })
        };
        let bound = if at_high { high } else { low };
        all.extend(tried(task, found, (name, variable.name, bound), &values, stop, moved));
    }
    let full = AT_PRESSURE;
    if found.evaluation.poses.iter().any(|pose| pose.shares.iter().any(|share| *share >= full)) {
        let highest = space.modules.iter().map(|module| module.pressure_max_pa).fold(0.0, f64::max);
        let moved = |by: f64| {
            let factor = 1.0 + 0.5 * by;
            (space.with_pressures(factor), highest * factor)
        };
        all.extend(tried(task, found, (None, "pressure_max", highest), &values, stop, moved));
    }
    all
}

fn is_spread(variable: &Variable) -> bool {
    ["spacing", "circle_radius"].contains(&variable.name)
}

fn value(variable: &Variable, share: f64) -> f64 {
    variable.bounds[0] + share * (variable.bounds[1] - variable.bounds[0])
}

fn tried(
    task: &LoadedTask,
    found: &Found,
    (module, name, bound): (Option<String>, &'static str, f64),
    values: &[f64],
    stop: &(dyn Fn() -> bool + Sync),
    moved: impl Fn(f64) -> (LimbSpace, f64),
) -> Option<ActiveBound> {
    let mut best: Option<ActiveBound> = None;
    let before = found.evaluation.objective().max(NOTHING);
    for by in MOVES {
        if stop() {
            break;
        }
        let (wider, moved_to) = moved(by);
        let mut known = values.iter();
        let start = wider.point(|_| known.next().copied().unwrap_or_default());
        let mut bound =
            ActiveBound { module: module.clone(), name, bound, moved_to, reached: false, reserve: 0.0, left: 1.0 };
        if found.reached {
            let higher = Judgement { reserve: found.by.reserve + RAISE, ..found.by.clone() };
            let reserve = reserve_from(task, &wider, (&start, &found.evaluation), &higher);
            return Some(ActiveBound { reached: true, reserve: reserve.max(found.by.reserve), left: 0.0, ..bound });
        }
        let near = &found.evaluation;
        let Some((minimum, _)) = local(task, &wider, &start, near, &found.by, RAISE_STEPS) else { continue };
        bound.reached = minimum.objective <= NOTHING;
        bound.left = if bound.reached { 0.0 } else { (minimum.objective / before).sqrt() };
        let ends = bound.reached;
        best = Some(bound);
        if ends {
            break;
        }
    }
    best
}
