//! The phases of a scene on the clock: where each goes, by which way, and how long it takes.

use super::air::{Air, Bottleneck, Reservoir};
use super::goal::{goals, marker, shapes};
use super::path::Path;
use super::plan::PlannedPhase;
use super::profile::PEAK_RATE;
use super::route::{ranges, route};
use super::space::Space;
use super::timing::{Shortest, rate_max, shortest};
use super::unreachable::{Shortcoming, Unreachable};
use softlimb_limb::Limb;
use softlimb_scene::{Goal, Scene};

/// By how much more than required the ways are planned to clear, m, so that setpoints rounded to wire units still do.
const SPARE_M: f64 = 1e-5;
/// Most goals for which a way is looked for.
const GOALS: usize = 4;

/// The space that moves are planned in.
pub(super) fn planning_space<'a>(scene: &'a Scene, limb: &'a Limb) -> Space<'a> {
    Space::new(limb, shapes(scene), scene.limits().clearance_m + SPARE_M)
}

/// Plans all phases from rest, with the moves that valves and supply cannot follow.
///
/// # Errors
/// [`Unreachable`] at the ends of a move.
pub(super) fn schedule(
    scene: &Scene,
    limb: &Limb,
    start: &[f64],
) -> Result<(Vec<PlannedPhase>, Vec<Shortcoming>), Unreachable> {
    let space = planning_space(scene, limb);
    super::clear::start(scene, limb, &space, start)?;
    let air = Air::new(scene, limb);
    let planner = Planner { scene, limb, space, air };
    let (mut phases, mut warnings) = (Vec::<PlannedPhase>::new(), Vec::new());
    let (mut values, mut start_us, mut supply) = (start.to_vec(), 0, planner.air.full());
    for (index, phase) in scene.phases().iter().enumerate() {
        let path = match &phase.goal {
            Goal::Series(_) => planner.series(index, &values)?,
            _ => planner.legs(index, &values, supply, &mut warnings)?,
        };
        let (Path::Legs { rows, times_us } | Path::Series { rows, times_us }) = &path;
        let move_us = times_us.last().map_or(1, |time| *time as u64);
        supply = planner.spent(&path, phase.hold_us, supply);
        values = rows.last().unwrap_or(&values).clone();
        let planned = PlannedPhase {
            name: phase.name.to_string(),
            start_us,
            move_us,
            hold_us: phase.hold_us,
            values: values.clone(),
            gripper: phase.gripper,
            via_points: if matches!(path, Path::Legs { .. }) { rows.len().saturating_sub(2) } else { 0 },
            nearest: None,
            path,
        };
        start_us += planned.move_us + planned.hold_us;
        phases.push(planned);
    }
    Ok((phases, warnings))
}

struct Planner<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
    space: Space<'a>,
    air: Air<'a>,
}

impl Planner<'_> {
    /// A path of straight legs to a goal of a phase.
    fn legs(
        &self,
        phase: usize,
        before: &[f64],
        supply: Reservoir,
        warnings: &mut Vec<Shortcoming>,
    ) -> Result<Path, Unreachable> {
        let rows = self.way(phase, before)?;
        let mut shorts = Vec::new();
        let mut left = supply;
        for leg in rows.windows(2) {
            let short = shortest(self.scene, self.limb, &self.air, (&leg[0], &leg[1]), left);
            left = short.as_ref().map_or(left, |short| self.drawn(&leg[0], &leg[1], short.time_s, left));
            shorts.push(short);
        }
        let whole: Option<f64> = shorts.iter().map(|short| short.as_ref().map(|short| short.time_s)).sum();
        let Some(given) = &self.scene.phases()[phase].move_us else {
            let Some(whole_s) = whole else { return Err(Unreachable::NoSupply { phase }) };
            let times: Vec<f64> = shorts.iter().flatten().map(|short| short.time_s).collect();
            return Ok(Path::legs(rows, &times, (whole_s * 1e6).round() as u64));
        };
        let times: Vec<f64> = match whole {
            Some(_) => shorts.iter().flatten().map(|short| short.time_s).collect(),
            None => vec![1.0; rows.len() - 1],
        };
        let scale = given.value as f64 * 1e-6 / times.iter().sum::<f64>();
        for ((leg, time_s), short) in rows.windows(2).zip(&times).zip(&shorts) {
            self.check_rates(phase, &leg[0], &leg[1], time_s * scale, (scale, whole))?;
            warnings.extend(self.too_fast(phase, leg, time_s * scale, supply, (whole, *short)));
        }
        Ok(Path::legs(rows, &times, given.value))
    }

    /// The way to the first goal that can be reached.
    fn way(&self, phase: usize, before: &[f64]) -> Result<Vec<Vec<f64>>, Unreachable> {
        let ranges = ranges(self.limb);
        let goals = goals(self.scene, self.limb, &self.space, phase, before)?;
        let straight = goals.iter().take(GOALS).find(|goal| self.space.blocked(before, goal).is_none());
        if let Some(goal) = straight {
            return Ok(vec![before.to_vec(), goal.clone()]);
        }
        let found = goals.iter().take(GOALS).find_map(|goal| route(&self.space, &ranges, before, goal));
        found.ok_or_else(|| {
            let goal = goals.first().map_or(before, |goal| goal);
            Unreachable::NoWay { phase, from: before.to_vec(), to: goal.to_vec() }
        })
    }

    /// The path of a marker series.
    fn series(&self, phase: usize, before: &[f64]) -> Result<Path, Unreachable> {
        let markers = self.scene.markers().map_or(&[][..], |markers| &markers.value);
        let (mut rows, mut times_us) = (vec![before.to_vec()], vec![0.0]);
        for (index, row) in markers.iter().enumerate().skip(1) {
            let last = rows.last().map_or(before, |row| row);
            let values = marker(self.scene, self.limb, phase, (index, row.tip_m), last)?;
            rows.push(values);
            times_us.push((row.time_s * 1e6).round());
        }
        let path = Path::Series { rows, times_us };
        self.check_series(phase, &path)?;
        Ok(path)
    }

    fn check_series(&self, phase: usize, path: &Path) -> Result<(), Unreachable> {
        let period_us = u64::from(self.scene.controller().knot_period_us);
        let end_us = self.scene.phases()[phase].move_us.as_ref().map_or(0, |time| time.value);
        let mut before = path.at(0.0);
        for time_us in (0..=end_us).step_by(period_us as usize).skip(1) {
            let here = path.at(time_us as f64);
            for (index, (module, (a, b))) in self.limb.modules().iter().zip(before.iter().zip(&here)).enumerate() {
                let rate = (b - a).abs() / (period_us as f64 * 1e-6);
                if let Some(limit) = rate_max(self.scene.limits(), module.kind).filter(|limit| rate > *limit) {
                    return Err(Unreachable::SeriesRate { phase, module: index, rate, limit, time_us });
                }
            }
            before = here;
        }
        Ok(())
    }

    /// Checks a leg whose time is given. `whole` is the shortest time of all legs and `scale` by how much longer the given one is.
    fn check_rates(
        &self,
        phase: usize,
        from: &[f64],
        to: &[f64],
        seconds: f64,
        (scale, whole): (f64, Option<f64>),
    ) -> Result<(), Unreachable> {
        for (index, (module, (a, b))) in self.limb.modules().iter().zip(from.iter().zip(to)).enumerate() {
            let peak = PEAK_RATE * (b - a).abs() / seconds;
            if let Some(limit) = rate_max(self.scene.limits(), module.kind).filter(|limit| peak > *limit) {
                let enough_s = whole.map_or(seconds, |whole| whole * scale) * peak / limit;
                return Err(Unreachable::MoveRate { phase, module: index, rate: peak, limit, enough_s });
            }
        }
        Ok(())
    }

    /// Whether valves wide open, or the supply, cannot follow a leg.
    fn too_fast(
        &self,
        phase: usize,
        leg: &[Vec<f64>],
        time_s: f64,
        supply: Reservoir,
        (enough_s, short): (Option<f64>, Option<Shortest>),
    ) -> Option<Shortcoming> {
        let draw = self.air.draw(&leg[0], &leg[1])?;
        self.air.limits(&draw, time_s, supply).err()?;
        let because = short.and_then(|short| short.because).unwrap_or(Bottleneck::Supply);
        Some(Shortcoming::TooFast { phase, because, enough_s })
    }

    fn drawn(&self, from: &[f64], to: &[f64], time_s: f64, supply: Reservoir) -> Reservoir {
        self.air.draw(from, to).map_or(supply, |draw| self.air.left(&draw, time_s, supply))
    }

    /// The supply after a phase.
    fn spent(&self, path: &Path, hold_us: u64, supply: Reservoir) -> Reservoir {
        let (Path::Legs { rows, times_us } | Path::Series { rows, times_us }) = path;
        let legs = rows.windows(2).zip(times_us.windows(2));
        let left =
            legs.fold(supply, |left, (leg, time)| self.drawn(&leg[0], &leg[1], (time[1] - time[0]) * 1e-6, left));
        self.air.recharged(left, 0.0, hold_us as f64 * 1e-6)
    }
}
