//! The phases of a scene on the clock: where each goes, by which way, and how long it takes.

use super::air::{Air, Bottleneck, Reservoir};
use super::carrier::Carrier;
use super::goal::{goals, kept, marker, near_goal, off_m, shapes, tip_m, with_targets};
use super::path::Path;
use super::payload::{Carrying, carried};
use super::plan::PlannedPhase;
use super::profile::PEAK_RATE;
use super::route::{ranges, route};
use super::space::Space;
use super::timing::{Shortest, rate_max, shortest};
use super::unreachable::{Shortcoming, Unreachable};
use super::upright::{Grip, Upright};
use softlimb_limb::Limb;
use softlimb_limb::statics::Fidelity;
use softlimb_scene::{Goal, Gripper, Scene};

/// By how much more than required the ways are planned to clear, m, so that setpoints rounded to wire units still do.
pub(super) const SPARE_M: f64 = 1e-5;
/// Share of the largest tilt of a held object that the ways are planned within: for the same reason, and for finer statics.
pub(super) const TILT_SHARE: f64 = 0.995;
/// Most goals for which a way is looked for.
const GOALS: usize = 4;
/// Parts of a mass that changes hands.
const HANDED: usize = 4;

/// The space that the move of a phase is planned in: under load by the statics of a tier, or without load.
pub(super) fn planning_space<'a>(scene: &'a Scene, limb: &'a Limb, phase: usize, tier: Option<Fidelity>) -> Space<'a> {
    let moved = carried(scene.phases()).get(phase).map_or_else(Carrying::default, |carried| carried.moved);
    Space::new(Carrier::new(scene, limb, tier, moved), shapes(scene), scene.limits().clearance_m + SPARE_M)
}

/// A held object with a reserve of its largest tilt.
fn within(upright: Upright) -> Upright {
    upright.within(TILT_SHARE)
}

/// Plans all phases from rest, with the moves that valves and supply cannot follow.
///
/// # Errors
/// [`Unreachable`] at the ends of a move.
pub(super) fn schedule(
    scene: &Scene,
    limb: &Limb,
    tier: Option<Fidelity>,
    start: &[f64],
) -> Result<(Vec<PlannedPhase>, Vec<Shortcoming>), Unreachable> {
    super::clear::start(scene, &planning_space(scene, limb, 0, tier), start)?;
    let air = Air::new(scene, limb);
    let planner = Planner { scene, limb, tier, air };
    let (mut phases, mut warnings) = (Vec::<PlannedPhase>::new(), Vec::new());
    let (mut values, mut start_us, mut supply) = (start.to_vec(), 0, planner.air.full());
    // Setpoints as they are asked for, before they are corrected for a load.
    let mut asked = values.clone();
    let (carried, mut grip) = (carried(scene.phases()), Grip::empty(scene));
    for (index, phase) in scene.phases().iter().enumerate() {
        let space = planning_space(scene, limb, index, tier);
        let moved = grip.hold(carried[index].moved.object, &space, &values);
        let space = space.keeping(moved.map(within));
        let path = match &phase.goal {
            Goal::Series(_) => planner.series(&space, index, &values)?,
            _ => planner.legs(&space, index, (&values, &asked), supply, &mut warnings)?,
        };
        let (Path::Legs { rows, .. } | Path::Series { rows, .. }) = &path;
        let move_us = path.move_us();
        values = rows.last().unwrap_or(&values).clone();
        asked = match &phase.goal {
            Goal::Targets(targets) => with_targets(limb, targets, &asked),
            _ => values.clone(),
        };
        if tier.is_some() && matches!(phase.goal, Goal::Targets(_)) {
            let distance_m = off_m(space.carrier(), &values, &asked);
            warnings.extend((distance_m > 0.0).then_some(Shortcoming::Off { phase: index, distance_m }));
        }
        let uprights = [moved, grip.hold(carried[index].held.object, &space, &values)];
        let held = planner.held(&space, index, &values)?;
        supply = planner.moved(&path, supply);
        warnings.extend(planner.handed_too_fast(index, &held, supply));
        supply = planner.held_on(&held, phase.hold_us, supply);
        let planned = PlannedPhase {
            name: phase.name.to_string(),
            start_us,
            move_us,
            hold_us: phase.hold_us,
            values: values.clone(),
            gripper: phase.gripper,
            gripper_us: planner.gripper_us(index, start_us + move_us),
            via_points: if matches!(path, Path::Legs { .. }) { rows.len().saturating_sub(2) } else { 0 },
            nearest: None,
            tilt_rad: None,
            uprights,
            path,
            held,
        };
        values = planned.last().to_vec();
        start_us += planned.move_us + planned.hold_us;
        phases.push(planned);
    }
    Ok((phases, warnings))
}

struct Planner<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
    tier: Option<Fidelity>,
    air: Air<'a>,
}

impl Planner<'_> {
    /// A path of straight legs to a goal of a phase.
    fn legs(
        &self,
        space: &Space<'_>,
        phase: usize,
        from: (&[f64], &[f64]),
        supply: Reservoir,
        warnings: &mut Vec<Shortcoming>,
    ) -> Result<Path, Unreachable> {
        let rows = self.way(space, phase, from)?;
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
    fn way(
        &self,
        space: &Space<'_>,
        phase: usize,
        (before, asked): (&[f64], &[f64]),
    ) -> Result<Vec<Vec<f64>>, Unreachable> {
        let ranges = ranges(self.limb);
        // Under load the other goals take long to find.
        if let Some(near) = near_goal(self.scene, space, phase, before)
            && space.blocked(before, &near).is_none()
        {
            return Ok(vec![before.to_vec(), near]);
        }
        let goals = goals(self.scene, space, phase, (before, asked))?;
        let straight = goals.iter().take(GOALS).find(|goal| space.blocked(before, goal).is_none());
        if let Some(goal) = straight {
            return Ok(vec![before.to_vec(), goal.clone()]);
        }
        let found = goals.iter().take(GOALS).find_map(|goal| route(space, &ranges, before, goal));
        found.ok_or_else(|| {
            let goal = goals.first().map_or(before, |goal| goal);
            Unreachable::NoWay { phase, from: before.to_vec(), to: goal.to_vec(), upright: space.upright() }
        })
    }

    /// Setpoints that keep the tip where it is while a mass changes hands, at equal shares of it; those at the end of the move alone where none does.
    fn held(&self, space: &Space<'_>, phase: usize, values: &[f64]) -> Result<Vec<Vec<f64>>, Unreachable> {
        let carried = carried(self.scene.phases())[phase];
        let mut rows = vec![values.to_vec()];
        if self.tier.is_none() || carried.held.payload_kg == carried.moved.payload_kg {
            return Ok(rows);
        }
        let Some(tip_m) = tip_m(space.carrier(), values) else { return Ok(rows) };
        let carrier = Carrier::new(self.scene, self.limb, self.tier, Carrying { object: None, ..carried.held });
        for part in 1..=HANDED {
            carrier.load(carried.handed_kg(part as f64 / HANDED as f64));
            rows.push(kept(&carrier, phase, &rows[part - 1], tip_m)?);
        }
        Ok(rows)
    }

    /// The path of a marker series.
    fn series(&self, space: &Space<'_>, phase: usize, before: &[f64]) -> Result<Path, Unreachable> {
        let markers = self.scene.markers().map_or(&[][..], |markers| &markers.value);
        let (mut rows, mut times_us) = (vec![before.to_vec()], vec![0.0]);
        for (index, row) in markers.iter().enumerate().skip(1) {
            let last = rows.last().map_or(before, |row| row);
            let values = marker(self.scene, space, phase, (index, row.tip_m), last)?;
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
            for (drive, (a, b)) in self.limb.drives().zip(before.iter().zip(&here)) {
                let rate = (b - a).abs() / (period_us as f64 * 1e-6);
                if let Some(limit) = rate_max(self.scene.limits(), drive.kind).filter(|limit| rate > *limit) {
                    return Err(Unreachable::SeriesRate { phase, module: drive.index, rate, limit, time_us });
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
        for (drive, (a, b)) in self.limb.drives().zip(from.iter().zip(to)) {
            let peak = PEAK_RATE * (b - a).abs() / seconds;
            if let Some(limit) = rate_max(self.scene.limits(), drive.kind).filter(|limit| peak > *limit) {
                let enough_s = whole.map_or(seconds, |whole| whole * scale) * peak / limit;
                return Err(Unreachable::MoveRate { phase, module: drive.index, rate: peak, limit, enough_s });
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

    /// Whether valves wide open, or the supply, cannot follow a mass that changes hands.
    fn handed_too_fast(&self, phase: usize, held: &[Vec<f64>], supply: Reservoir) -> Option<Shortcoming> {
        let hold_us = self.scene.phases()[phase].hold_us;
        let [first, .., last] = held else { return None };
        let draw = self.air.draw(first, last).filter(|_| hold_us > 0)?;
        let because = self.air.limits(&draw, hold_us as f64 * 1e-6, supply).err()?;
        let enough_s = shortest(self.scene, self.limb, &self.air, (first, last), supply).map(|short| short.time_s);
        Some(Shortcoming::HandedTooFast { phase, because, enough_s })
    }

    /// When the gripper is told, us, for a move that ends at a time of the run, us. What it holds is put down before it opens.
    fn gripper_us(&self, phase: usize, moved_us: u64) -> u64 {
        let phase = &self.scene.phases()[phase];
        match phase.gripper {
            Some(Gripper::Open) => moved_us + phase.hold_us.saturating_sub(self.dwell_us()),
            _ => moved_us,
        }
    }

    fn dwell_us(&self) -> u64 {
        (1e6 * self.scene.gripper_time_s()).round() as u64
    }

    /// The supply after the move of a phase.
    fn moved(&self, path: &Path, supply: Reservoir) -> Reservoir {
        let (Path::Legs { rows, times_us, .. } | Path::Series { rows, times_us }) = path;
        let legs = rows.windows(2).zip(times_us.windows(2));
        legs.fold(supply, |left, (leg, time)| self.drawn(&leg[0], &leg[1], (time[1] - time[0]) * 1e-6, left))
    }

    /// The supply after the pause behind it.
    fn held_on(&self, held: &[Vec<f64>], hold_us: u64, left: Reservoir) -> Reservoir {
        let hold_s = hold_us as f64 * 1e-6;
        match held {
            [first, .., last] if hold_us > 0 => self.drawn(first, last, hold_s, left),
            _ => self.air.recharged(left, 0.0, hold_s),
        }
    }
}
