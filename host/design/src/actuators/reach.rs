//! A segment with pressures of its own: given the geometry, the best pressure of every phase is an explicit result.
//!
//! This is the variable projection of eq. (14): what is left to search is the geometry alone. A phase whose goal is within reach
//! leaves no difference; one beyond reach is held at the end of the pressure range, or where the deformation turns back before it.
//! Either way the derivative of what is left is that at the pressure held (the envelope theorem).

use fra_model::{Motion, State};

use super::actuator::{Candidate, Cap, Counts};
use super::problem::{Goal, Segment};
use super::search::Counted;
use softlimb_numerics::least_squares::LeastSquares;

/// Intervals of the pressure range in which a deformation that turns back is looked for.
const INTERVALS: usize = 16;
const BISECTIONS: usize = 60;

/// What holds the pressure of a phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Held {
    /// Nothing is asked.
    Free,
    /// The goal is reached.
    Reached,
    /// The goal is beyond the state without pressure.
    Rest,
    /// The goal is beyond the highest pressure.
    Highest,
    /// The goal is beyond where the deformation turns back.
    Turning,
    /// A nearer pressure would cost more effort than it gains.
    Balanced,
}

/// One phase at one geometry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Phase {
    pub(super) pressure_pa: f64,
    /// Weighted difference: its square is the term of eq. (14).
    pub(super) residual: f64,
    pub(super) held: Held,
    pub(super) state: State<f64>,
}

/// A geometry with the best pressures.
pub(super) struct Reach<'a> {
    pub(super) candidate: Candidate<'a>,
    pub(super) cap: Cap,
    pub(super) phases: Vec<Phase>,
}

/// What a geometry spans, without pressures: enough to rank it.
pub(super) struct Span<'a> {
    pub(super) candidate: Candidate<'a>,
    pub(super) cap: Cap,
    /// At rest and at the cap; `None` where every goal is known to be between them.
    pub(super) ends: Option<[State<f64>; 2]>,
    /// The state at the largest goal, where it was asked for.
    pub(super) largest: Option<(f64, State<f64>)>,
}

/// The ends of the pressure range.
struct Ends {
    states: [State<f64>; 2],
    values: [f64; 2],
    /// `dq/dP`, where it was asked for.
    slopes: [Option<f64>; 2],
}

impl<'a> Span<'a> {
    pub(super) fn new(segment: &'a Segment, place: &[f64], counts: &mut Counts) -> Option<Self> {
        counts.evaluations += 1;
        let candidate = Candidate::new(segment, place)?;
        let cap = candidate.cap(counts)?;
        Self::with_cap(candidate, cap, counts)
    }

    /// With a highest pressure that is known.
    pub(super) fn with_cap(candidate: Candidate<'a>, cap: Cap, counts: &mut Counts) -> Option<Self> {
        let segment = candidate.segment;
        let mut span = Self { candidate, cap, ends: None, largest: None };
        if segment.bends_without_limit() {
            // One inverse tells the same as the far dearer forward solve of a bend.
            let value = segment.goals.iter().flatten().map(|goal| goal.value).fold(0.0, f64::max);
            let state = span.candidate.inverse(value, counts);
            span.largest = state.filter(|state| state.pressure_pa <= cap.pressure_pa).map(|state| (value, state));
        }
        if span.largest.is_none() {
            span.ends = Some(span.find_ends(counts)?);
        }
        Some(span)
    }

    /// A length at which this section has every goal within reach, or nearly so where there is none: deformations are proportional to
    /// it. `None` where it makes no difference or is not known.
    pub(super) fn better_length(&self) -> Option<f64> {
        let segment = self.candidate.segment;
        let [low, high] = segment.bounds.length_m;
        let pressed = self.ends?[1];
        let values = || segment.goals.iter().flatten().filter(|goal| goal.weight > 0.0).map(|goal| goal.value);
        let range = match segment.motion {
            Motion::Extension => {
                let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
                let stretch = pressed.axial_stretch;
                [most / stretch.max(1.0), least / stretch.min(1.0)]
            }
            Motion::Twisting | Motion::Bending => {
                let per_length = self.candidate.measure(&pressed) / self.candidate.geometry.length_m;
                [values().map(|value| value / per_length).fold(low, f64::max), high]
            }
            Motion::Expansion => return None,
        };
        let middle = 0.5 * (range[0].max(low) + range[1].min(high));
        middle.is_finite().then(|| middle.clamp(low, high))
    }

    fn find_ends(&self, counts: &mut Counts) -> Option<[State<f64>; 2]> {
        Some([self.candidate.actuator.rest(), self.candidate.at(self.cap.pressure_pa, counts)?])
    }

    /// Eq. (14), if the deformation rises or falls throughout with the pressure.
    pub(super) fn estimate(&self) -> f64 {
        let Some(states) = self.ends else { return 0.0 };
        let ends = states.map(|state| self.candidate.measure(&state));
        let goals = self.candidate.segment.goals.iter().flatten();
        goals.map(|goal| goal.weight * beyond(ends, goal.value).powi(2)).sum()
    }

    /// Finds the pressures.
    pub(super) fn reach(mut self, counts: &mut Counts) -> Option<Reach<'a>> {
        let segment = self.candidate.segment;
        if segment.effort_per_pa2 > 0.0 {
            return self.reach_with_effort(counts);
        }
        let goals: Vec<Option<&Goal>> = segment.goals.iter().map(|g| g.as_ref().filter(|g| g.weight > 0.0)).collect();
        let phases = match self.ends {
            None => goals.iter().map(|goal| self.easily(*goal, counts)).collect::<Option<Vec<_>>>(),
            Some(_) => None,
        };
        if let Some(phases) = phases {
            return Some(Reach { candidate: self.candidate, cap: self.cap, phases });
        }
        let states = match self.ends {
            Some(states) => states,
            None => self.find_ends(counts)?,
        };
        self.ends = Some(states);
        let mut ends = Ends { states, values: states.map(|state| self.candidate.measure(&state)), slopes: [None; 2] };
        let phases = goals.iter().map(|goal| self.phase(*goal, &mut ends, counts)).collect::<Option<Vec<_>>>()?;
        Some(Reach { candidate: self.candidate, cap: self.cap, phases })
    }

    fn easily(&self, goal: Option<&Goal>, counts: &mut Counts) -> Option<Phase> {
        goal.map_or_else(|| Some(self.idle()), |goal| self.reached(goal, counts))
    }

    pub(super) fn idle(&self) -> Phase {
        Phase { pressure_pa: 0.0, residual: 0.0, held: Held::Free, state: self.candidate.actuator.rest() }
    }

    fn phase(&self, goal: Option<&Goal>, ends: &mut Ends, counts: &mut Counts) -> Option<Phase> {
        let Some(goal) = goal else { return Some(self.idle()) };
        let short = beyond(ends.values, goal.value);
        if short == 0.0
            && let Some(phase) = self.reached(goal, counts)
        {
            return Some(phase);
        }
        let away = ends.values.map(|value| goal.value - value);
        let end = usize::from(away[1].abs() < away[0].abs());
        let slope = match ends.slopes[end] {
            Some(slope) => slope,
            None => self.candidate.by_pressure(&ends.states[end], counts)?,
        };
        ends.slopes[end] = Some(slope);
        // Whether a little less pressure (more, from rest) comes nearer to the goal.
        let inwards = if end == 0 { 1.0 } else { -1.0 };
        if short == 0.0 || slope * inwards * away[end] > 0.0 {
            return self.inside(goal, &ends.states, counts);
        }
        let held = if end == 0 { Held::Rest } else { Held::Highest };
        Some(self.at(&ends.states[end], goal, held))
    }

    pub(super) fn at(&self, state: &State<f64>, goal: &Goal, held: Held) -> Phase {
        let residual = goal.weight.sqrt() * (self.candidate.measure(state) - goal.value);
        Phase { pressure_pa: state.pressure_pa, residual, held, state: *state }
    }

    fn reached(&self, goal: &Goal, counts: &mut Counts) -> Option<Phase> {
        let known = self.largest.filter(|(value, _)| *value == goal.value).map(|(_, state)| state);
        let mut state = known.or_else(|| self.candidate.inverse(goal.value, counts))?;
        let slack = 1e-12 * self.cap.pressure_pa;
        let within = state.pressure_pa >= -slack && state.pressure_pa <= self.cap.pressure_pa + slack;
        state.pressure_pa = state.pressure_pa.clamp(0.0, self.cap.pressure_pa);
        within.then(|| self.at(&state, goal, Held::Reached))
    }

    /// The pressure between the ends that comes nearest to a goal where the deformation turns back on the way.
    fn inside(&self, goal: &Goal, ends: &[State<f64>; 2], counts: &mut Counts) -> Option<Phase> {
        let away = |state: &State<f64>| self.candidate.measure(state) - goal.value;
        let step = self.cap.pressure_pa / INTERVALS as f64;
        let mut states = vec![ends[0]];
        for index in 1..INTERVALS {
            states.push(self.candidate.at(step * index as f64, counts)?);
        }
        states.push(ends[1]);
        if let Some(pair) = states.windows(2).find(|pair| away(&pair[0]) * away(&pair[1]) <= 0.0) {
            return self.bisect([pair[0], pair[1]], goal, Held::Reached, counts, |state, _| Some(away(state)));
        }
        let nearest = (0..states.len()).min_by(|a, b| away(&states[*a]).abs().total_cmp(&away(&states[*b]).abs()))?;
        let around = [states[nearest.saturating_sub(1)], states[(nearest + 1).min(INTERVALS)]];
        self.bisect(around, goal, Held::Turning, counts, |state, counts| self.candidate.by_pressure(state, counts))
    }

    /// Halves a range of pressures at whose ends `value` has opposite signs.
    fn bisect(
        &self,
        [mut low, mut high]: [State<f64>; 2],
        goal: &Goal,
        held: Held,
        counts: &mut Counts,
        value: impl Fn(&State<f64>, &mut Counts) -> Option<f64>,
    ) -> Option<Phase> {
        let at_low = value(&low, counts)?;
        for _ in 0..BISECTIONS {
            let middle = self.candidate.at(0.5 * (low.pressure_pa + high.pressure_pa), counts)?;
            if middle.pressure_pa <= low.pressure_pa || middle.pressure_pa >= high.pressure_pa {
                break;
            }
            if value(&middle, counts)? * at_low > 0.0 { low = middle } else { high = middle }
        }
        Some(self.at(&high, goal, held))
    }
}

/// How far a value is beyond a range, whichever end is the higher one.
fn beyond([a, b]: [f64; 2], value: f64) -> f64 {
    let (low, high) = (a.min(b), a.max(b));
    (low - value).max(value - high).max(0.0)
}

impl Reach<'_> {
    /// Whether nothing is left of the objective but rounding.
    pub(super) fn exact(&self) -> bool {
        self.phases.iter().all(|phase| matches!(phase.held, Held::Free | Held::Reached))
    }

    /// The derivatives of one residual by the geometry.
    fn row(&self, phase: &Phase, goal: &Goal, counts: &mut Counts) -> Option<[f64; 4]> {
        let scaled = |row: [f64; 4]| Some(row.map(|slope| goal.weight.sqrt() * slope));
        match phase.held {
            Held::Free | Held::Reached => Some([0.0; 4]),
            Held::Rest | Held::Turning | Held::Balanced => scaled(self.candidate.by_place(&phase.state, counts)?),
            Held::Highest => {
                let mut row = self.candidate.by_place(&phase.state, counts)?;
                if self.cap.limit.is_some() {
                    let slope = self.candidate.by_pressure(&phase.state, counts)?;
                    let moved = self.candidate.cap_by_place(&self.cap, counts)?;
                    row.iter_mut().zip(moved).for_each(|(row, moved)| *row += slope * moved);
                }
                scaled(row)
            }
        }
    }
}

/// The least squares of a segment over its unit box.
pub(super) struct Separate<'a> {
    pub(super) segment: &'a Segment,
    pub(super) counts: Counts,
}

impl Counted for Separate<'_> {
    fn counts(&self) -> Counts {
        self.counts
    }
}

impl<'a> LeastSquares for Separate<'a> {
    type Evaluation = Reach<'a>;

    fn evaluate(&mut self, point: &[f64]) -> Option<Reach<'a>> {
        Span::new(self.segment, point, &mut self.counts)?.reach(&mut self.counts)
    }

    fn residuals(&self, reach: &Reach<'a>) -> Vec<f64> {
        let per_pa = self.segment.effort_per_pa2.sqrt();
        let pressures = reach.phases.iter().filter(|_| per_pa > 0.0).map(|phase| per_pa * phase.pressure_pa);
        reach.phases.iter().map(|phase| phase.residual).chain(pressures).collect()
    }

    fn jacobian(&mut self, reach: &Reach<'a>) -> Option<Vec<Vec<f64>>> {
        self.counts.evaluations += 1;
        if self.segment.effort_per_pa2 > 0.0 {
            return self.jacobian_with_effort(reach);
        }
        let mut known: Vec<(Held, [f64; 4], f64)> = Vec::new();
        let mut rows = Vec::new();
        for (phase, goal) in reach.phases.iter().zip(&self.segment.goals) {
            let Some(goal) = goal else {
                rows.push(vec![0.0; self.segment.dimensions()]);
                continue;
            };
            // Phases held at the same end differ by their weights only.
            let same = known.iter().find(|(held, ..)| *held == phase.held && *held != Held::Turning);
            let row = match same {
                Some((_, row, weight)) if *weight > 0.0 => row.map(|slope| slope * (goal.weight / weight).sqrt()),
                _ => reach.row(phase, goal, &mut self.counts)?,
            };
            known.push((phase.held, row, goal.weight));
            rows.push(row[..self.segment.dimensions()].to_vec());
        }
        Some(rows)
    }
}
