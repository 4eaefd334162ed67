//! The answer to a design problem, and how far it can be trusted.

use fra_model::{Load, Motion};
use serde::Serialize;

use super::actuator::{Candidate, Counts};
use super::problem::{Goal, Problem, Segment};
use super::refined::refined;
use super::search::{self, Budget, Found, Progress, SolveCounts};
use super::section::{Aim, Model, ROUNDS, pressure_pa};
use softlimb_limb::{Bent, winding_effect};

/// An objective below this share of `sum w q^2` is reached: differences below 1e-9 of what was asked.
const REACHED: f64 = 1e-18;
/// The same where finite elements have the last word: differences below 1e-5, less than those of two meshes.
const REACHED_BY_SECTION: f64 = 1e-10;
/// A variable as near to a bound, as a share of the bounds' distance, is on it.
const ON_BOUND: f64 = 1e-9;

/// As many starts on one supply line must agree on the least objective.
const SEVERAL: usize = 5;

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// Nowhere within the bounds has the model an equilibrium.
    #[error("segment `{segment}`: the model has no equilibrium anywhere within the bounds that was looked at")]
    NoEquilibrium {
        /// Its name; of several on one supply line the first.
        segment: String,
    },
    /// The equilibria found are not found again from rest.
    #[error("segment `{segment}`, phase {phase}: the pressure found has no equilibrium from rest")]
    NotConfirmed {
        /// Its name.
        segment: String,
        /// From 1.
        phase: usize,
    },
}

/// The terms of eq. (14), each weighted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Terms {
    /// Lengths of extending segments.
    pub length: f64,
    /// Outer radii of expanding segments.
    pub outer_radius: f64,
    /// Bend angles of bending segments.
    pub bend_angle: f64,
    /// Twists of twisting segments.
    pub twist: f64,
    /// The mean of `(P/P_ref)^2`; `None` where it has no weight.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effort: Option<f64>,
}

/// One phase of one segment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhaseAnswer {
    /// Gauge pressure, Pa.
    pub pressure_pa: f64,
    /// What was asked for, m or rad; `None` where nothing was.
    pub target: Option<f64>,
    /// What the model has at that pressure, from rest, m or rad; of a bender by finite elements the bend of those.
    pub found: f64,
    /// The analytic bend at that pressure, rad, where `found` is by finite elements.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub analytic: Option<f64>,
    /// `found - target`, m or rad; 0 where nothing was asked for.
    pub residual: f64,
    /// Weighted square of the residual.
    pub term: f64,
    /// Which end of the pressure range it is at: `"rest"`, `"pressure_max_pa"`, `"limit_margin"`, or none.
    pub bound: Option<&'static str>,
}

/// The model of a bend.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BendAnswer {
    /// `"analytic"`, or `"section-fe"`: finite elements of the section.
    pub model: &'static str,
    /// Largest relative error that the analytic bend states up to the highest pressure; `None` where it states none.
    pub analytic_error: Option<f64>,
    /// Largest relative change of the bends of the phases if every winding is 2 deg off; `None` where nothing bends.
    pub winding_2deg: Option<f64>,
}

/// One segment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SegmentAnswer {
    /// Its name.
    pub name: String,
    /// `R_i`, m.
    pub inner_radius_m: f64,
    /// `R_o`, m.
    pub outer_radius_m: f64,
    /// `R_o - R_i`, m.
    pub wall_m: f64,
    /// `L`, m.
    pub length_m: f64,
    /// Fiber angle from the hoop, deg; 0 for a bender that the analytic model winds as a hoop.
    pub angle_deg: f64,
    /// Angles of both windings from the hoop, deg; empty where there are no two.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub windings_deg: Vec<f64>,
    /// The highest pressure this geometry may be given, Pa: that of the problem, or the margin below its limit point.
    pub pressure_cap_pa: f64,
    /// The phases.
    pub phases: Vec<PhaseAnswer>,
    /// The model of the bends of a wound bender.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bend: Option<BendAnswer>,
    /// Bounds of the geometry that the answer is on, as `"wall_m min"`.
    pub active_bounds: Vec<String>,
    /// The largest condition number of a phase (`Actuator::condition`): a relative error of every parameter changes the deformation by at
    /// most that many times as much. `None` where no phase has a pressure or a derivative does not exist.
    pub condition: Option<f64>,
    /// Descents of the search for this segment; on one supply line of that for all.
    pub starts: SolveCounts,
}

/// A design.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// `"reached"`: nothing is left of the objective, which cannot be less; `"best_found"`: the least of all local solves.
    pub status: &'static str,
    /// Eq. (14), from the forward model at the answer's geometry and pressures.
    pub objective: f64,
    /// Its terms.
    pub terms: Terms,
    /// Whether one pressure served all segments.
    pub shared_pressure: bool,
    /// The segments.
    pub segments: Vec<SegmentAnswer>,
    /// The seed of the starts.
    pub seed: u64,
    /// What the answer has cost, its confirmation included.
    pub cost: Counts,
}

impl Answer {
    /// The starts of a search on one supply line where fewer than five ended at the least objective: there may be a better
    /// design.
    pub fn disagreeing_starts(&self) -> Option<SolveCounts> {
        let starts = self.segments.first()?.starts;
        (self.shared_pressure && self.status != "reached" && starts.agreeing < SEVERAL).then_some(starts)
    }
}

/// Geometry and pressures as a search has found them.
pub struct Design {
    parts: Vec<Found>,
    counts: Counts,
    seed: u64,
}

/// Searches for the best design.
///
/// # Errors
/// [`DesignError::NoEquilibrium`].
pub fn search(problem: &Problem, effort: &Budget) -> Result<Design, DesignError> {
    search_watched(problem, effort, &mut |_| {})
}

/// As [`search`], and `watch` is told whenever an evaluation is better than all before. Segments with pressures of their own are
/// searched one after another: it is told from the first evaluation of the last one on, when all have a design.
///
/// # Errors
/// As [`search`].
pub fn search_watched(
    problem: &Problem,
    effort: &Budget,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Design, DesignError> {
    let (mut counts, mut before) = (Counts::default(), 0.0);
    let mut parts = Vec::new();
    if problem.shared_pressure {
        let nowhere = || DesignError::NoEquilibrium { segment: problem.segments[0].name.clone() };
        let found = search::shared(problem, effort, watch).ok_or_else(nowhere)?;
        return Ok(Design { counts: found.counts, parts: apart(problem, &found), seed: effort.seed });
    }
    for (index, segment) in problem.segments.iter().enumerate() {
        let nowhere = || DesignError::NoEquilibrium { segment: segment.name.clone() };
        let last = index + 1 == problem.segments.len();
        let mut tell = |here: &Progress| {
            let mut all = counts;
            all += here.counts;
            if last {
                watch(&Progress { objective: before + here.objective, counts: all });
            }
        };
        let found = search::separate(segment, index, effort, &mut tell).ok_or_else(nowhere)?;
        counts += found.counts;
        before += found.objective;
        parts.push(found);
    }
    Ok(Design { parts, counts, seed: effort.seed })
}

/// Searches for the best design and confirms it, as [`solve`]; `watch` as in [`search_watched`].
///
/// # Errors
/// As [`solve`].
pub fn solve_watched(
    problem: &Problem,
    effort: &Budget,
    watch: &mut dyn FnMut(&Progress),
) -> Result<Answer, DesignError> {
    let design = search_watched(problem, effort, watch)?;
    let (seed, mut counts) = (design.seed, design.counts);
    let mut tried = Tried::new(problem, design.parts, seed, &mut counts);
    let mut before: Option<Aim> = None;
    let mut last: Option<Tried> = None;
    for round in 1..=ROUNDS {
        let here = last.as_ref().unwrap_or(&tried);
        let Some(aim) = here.aim(problem, round, &mut counts) else { break };
        if tried.is_reached() || before.as_ref().is_some_and(|before| aim.is_as(before)) {
            break;
        }
        // Another seed looks at other geometries.
        let effort = Budget { seed: effort.seed.wrapping_add(round as u64), ..*effort };
        let Ok(other) = search_watched(&aim.problem, &effort, &mut |_| {}) else { break };
        counts += other.counts;
        let other = Tried::new(problem, other.parts, seed, &mut counts);
        before = Some(aim);
        if other.is_better_than(&tried) {
            last = None;
            tried = other;
        } else {
            last = Some(other);
        }
    }
    if !tried.is_reached()
        && let Some(parts) = refined(problem, &tried.parts, &tried.models, &mut counts)
    {
        let further = Tried::new(problem, parts, seed, &mut counts);
        if further.is_better_than(&tried) {
            tried = further;
        }
    }
    tried.answer.map(|answer| Answer { cost: counts, ..answer })
}

/// A design with the models of its bends, and what they say of it.
struct Tried {
    parts: Vec<Found>,
    models: Vec<Option<Model>>,
    answer: Result<Answer, DesignError>,
}

impl Tried {
    fn new(problem: &Problem, parts: Vec<Found>, seed: u64, counts: &mut Counts) -> Self {
        let models = models(problem, &parts, counts);
        let answer = confirmed(problem, &parts, &models, *counts, seed);
        if let Ok(answer) = &answer {
            *counts = answer.cost;
        }
        Self { parts, models, answer }
    }

    fn aim(&self, problem: &Problem, round: usize, counts: &mut Counts) -> Option<Aim> {
        Aim::new(problem, &self.parts, &self.models, round, counts)
    }

    fn is_reached(&self) -> bool {
        self.answer.as_ref().is_ok_and(|answer| answer.status == "reached")
    }

    fn is_better_than(&self, other: &Self) -> bool {
        match (&self.answer, &other.answer) {
            (Ok(own), Ok(other)) => own.objective < other.objective,
            (own, _) => own.is_ok(),
        }
    }
}

/// The models of the bends of wound benders, segment by segment.
fn models(problem: &Problem, parts: &[Found], counts: &mut Counts) -> Vec<Option<Model>> {
    let mut model = |(segment, found): (&Segment, &Found)| {
        segment.section?;
        let candidate = Candidate::new(segment, &found.point)?;
        let cap = candidate.cap(counts)?;
        Model::new(&candidate, cap.pressure_pa)
    };
    problem.segments.iter().zip(parts).map(&mut model).collect()
}

/// Searches for the best design. Forward solves from rest give its deformations and their sensitivity. Finite elements of the section confirm wound
/// benders whose analytic bend errs; where these fall short, the search is repeated.
///
/// # Errors
/// [`DesignError`] where the model has no equilibrium to offer.
pub fn solve(problem: &Problem, effort: &Budget) -> Result<Answer, DesignError> {
    solve_watched(problem, effort, &mut |_| {})
}

/// The answer for all segments, segment by segment.
fn apart(problem: &Problem, found: &Found) -> Vec<Found> {
    let mut first = 0;
    let mut part = |segment: &Segment| {
        let point = found.point[first..first + segment.dimensions()].to_vec();
        first += segment.dimensions();
        let (pressures_pa, counts) = (found.pressures_pa.clone(), Counts::default());
        Found { point, pressures_pa, objective: found.objective, starts: found.starts, counts }
    };
    problem.segments.iter().map(&mut part).collect()
}

/// Asks the forward model from rest what the design does.
pub(super) fn confirm(
    problem: &Problem,
    parts: &[Found],
    mut counts: Counts,
    seed: u64,
) -> Result<Answer, DesignError> {
    let models = models(problem, parts, &mut counts);
    confirmed(problem, parts, &models, counts, seed)
}

fn confirmed(
    problem: &Problem,
    parts: &[Found],
    models: &[Option<Model>],
    mut counts: Counts,
    seed: u64,
) -> Result<Answer, DesignError> {
    let mut segments = Vec::new();
    let (mut terms, mut scale) = (Terms::default(), 0.0);
    for ((segment, found), model) in problem.segments.iter().zip(parts).zip(models) {
        let answer = confirm_segment(problem, (segment, found), model.as_ref(), &mut counts)?;
        let term = match segment.motion {
            Motion::Extension => &mut terms.length,
            Motion::Expansion => &mut terms.outer_radius,
            Motion::Bending => &mut terms.bend_angle,
            Motion::Twisting => &mut terms.twist,
        };
        *term += answer.phases.iter().map(|phase| phase.term).sum::<f64>();
        if segment.effort_per_pa2 > 0.0 {
            let squares: f64 = answer.phases.iter().map(|phase| phase.pressure_pa.powi(2)).sum();
            *terms.effort.get_or_insert_default() += segment.effort_per_pa2 * squares;
        }
        scale += segment.goals.iter().flatten().map(|goal| goal.weight * goal.value.powi(2)).sum::<f64>();
        segments.push(answer);
    }
    let objective = terms.length + terms.outer_radius + terms.bend_angle + terms.twist + terms.effort.unwrap_or(0.0);
    let is_by_section = models.iter().flatten().any(|model| model.section.is_some());
    let reached = if is_by_section { REACHED_BY_SECTION } else { REACHED };
    let status = if objective <= reached * scale { "reached" } else { "best_found" };
    let shared_pressure = problem.shared_pressure;
    Ok(Answer { status, objective, terms, shared_pressure, segments, seed, cost: counts })
}

fn confirm_segment(
    problem: &Problem,
    (segment, found): (&Segment, &Found),
    model: Option<&Model>,
    counts: &mut Counts,
) -> Result<SegmentAnswer, DesignError> {
    let nowhere = || DesignError::NoEquilibrium { segment: segment.name.clone() };
    let candidate = Candidate::new(segment, &found.point).ok_or_else(nowhere)?;
    let section = model.and_then(|model| model.section.as_ref());
    let cap_pa = match section {
        Some(section) => section.cap_pa,
        None => candidate.cap(counts).ok_or_else(nowhere)?.pressure_pa,
    };
    let mut condition: Option<f64> = None;
    let mut phases = Vec::new();
    for (phase, goal) in segment.goals.iter().enumerate() {
        let none = || DesignError::NotConfirmed { segment: segment.name.clone(), phase: phase + 1 };
        let (pressure_pa, bend) = match section {
            Some(section) => {
                let pressure_pa = pressure_pa(problem.shared_pressure, segment, section, phase, found);
                (pressure_pa, Some(section.at(pressure_pa).ok_or_else(none)?.bend_angle_rad))
            }
            None => (found.pressures_pa[phase], None),
        };
        let state = candidate.at(pressure_pa, counts);
        if let Some(state) = state.filter(|_| pressure_pa > 0.0)
            && let Ok(value) = candidate.actuator.condition(&state, &Load::none())
        {
            condition = Some(condition.map_or(value, |most| most.max(value)));
        }
        let bound = match pressure_pa {
            p if p <= 0.0 => Some("rest"),
            p if p < cap_pa * (1.0 - ON_BOUND) => None,
            _ => Some(if cap_pa < segment.pressure_max_pa { "limit_margin" } else { "pressure_max_pa" }),
        };
        let analytic = state.map(|state| candidate.measure(&state));
        let value = bend.or(analytic).ok_or_else(none)?;
        let analytic = analytic.filter(|_| bend.is_some());
        phases.push(PhaseAnswer { analytic, ..phase_answer(goal.as_ref(), pressure_pa, value, bound) });
    }
    let geometry = candidate.geometry;
    let bent = |phase: &PhaseAnswer| Bent { pressure_pa: phase.pressure_pa, bend_angle_rad: phase.found };
    let bends: Vec<Bent> = phases.iter().map(bent).collect();
    let winding_2deg = segment.by_section(&geometry).and_then(|(parameters, second)| {
        winding_effect(&parameters, second.as_ref(), &bends, &Load::none(), section.is_some())
    });
    Ok(SegmentAnswer {
        name: segment.name.clone(),
        inner_radius_m: geometry.inner_radius_m,
        outer_radius_m: geometry.outer_radius_m,
        wall_m: geometry.outer_radius_m - geometry.inner_radius_m,
        length_m: geometry.length_m,
        angle_deg: geometry.angle_rad.to_degrees(),
        windings_deg: segment.windings_rad(&geometry).into_iter().map(f64::to_degrees).collect(),
        pressure_cap_pa: cap_pa,
        phases,
        bend: model.map(|model| BendAnswer {
            model: model.bend.model(),
            analytic_error: model.bend.analytic_error(),
            winding_2deg,
        }),
        active_bounds: active_bounds(segment, &found.point),
        condition,
        starts: found.starts,
    })
}

fn phase_answer(goal: Option<&Goal>, pressure_pa: f64, found: f64, bound: Option<&'static str>) -> PhaseAnswer {
    let residual = goal.map_or(0.0, |goal| found - goal.value);
    let term = goal.map_or(0.0, |goal| goal.weight * residual * residual);
    PhaseAnswer { pressure_pa, target: goal.map(|goal| goal.value), found, analytic: None, residual, term, bound }
}

fn active_bounds(segment: &Segment, place: &[f64]) -> Vec<String> {
    let named = |index: usize| {
        let end = match place[index] {
            x if segment.axis(index)[1] == 0.0 || x <= ON_BOUND => "min",
            x if x >= 1.0 - ON_BOUND => "max",
            _ => return None,
        };
        Some(format!("{} {end}", segment.axis_name(index)))
    };
    (0..segment.dimensions()).filter_map(named).collect()
}
