//! Bends by finite elements of the section, where the analytic ones err by more than is accepted: confirmation, and goals for another search.
//!
//! A search asks the analytic model, which is thousands of times as fast. A design whose bends fall short by finite elements is searched for
//! again with goals that the analytic model exaggerates as it does at the design found: `q^ q_analytic/q_section`, and the weight divided by
//! the square of that factor, so that both models have the same objective there. The factor changes little from one design to the next.

use fra_model::{ActuatorParameters, Fiber, State};

use super::actuator::{Candidate, Counts};
use super::problem::{Goal, Problem, Segment};
use super::search::Found;
use softlimb_fea::cross_section::{BEND_TOLERANCE, EndLoad, Options, Outcome, Section as Elements, largest_bend_error};
use softlimb_limb::{Bend, StateCurve};

/// Searches after the first one.
pub(super) const ROUNDS: usize = 6;
/// By how much more each of them asks for than the last, so that a change of the factor leaves no goal just out of reach.
const MORE: f64 = 1e-3;
/// Factors that change by less are settled: the mesh is not exact to more.
const SETTLED: f64 = 1e-6;
/// Intervals of the pressure range in which the least of bend and effort is looked for, and halvings of the one that has it.
const INTERVALS: usize = 64;
const GOLDEN_STEPS: usize = 50;

/// A bender at a geometry by finite elements.
pub(crate) struct Section {
    curve: StateCurve,
    /// The highest pressure that it may be given, Pa.
    pub(crate) cap_pa: f64,
}

/// The model of a segment's bends at the geometry found; `None` of one that finite elements are not asked for.
pub(crate) struct Model {
    pub(super) bend: Bend,
    /// `None` where the analytic model is within the tolerance, or finite elements have no answer.
    pub(crate) section: Option<Section>,
}

/// Largest stated error of a candidate's analytic bend up to a pressure, relative. The outer `None` is for a candidate without finite elements, the inner one
/// for a bend without a stated error.
fn stated_error(candidate: &Candidate, cap_pa: f64) -> Option<Option<f64>> {
    let (parameters, second) = candidate.segment.by_section(&candidate.geometry)?;
    if second.is_some() {
        return Some(None);
    }
    let analytic = StateCurve::new(&candidate.actuator, cap_pa);
    Some(largest_bend_error(&parameters, &analytic.states()[1..]))
}

/// Whether the analytic bend of a candidate, whose pressure it allows up to `cap_pa`, may err by more than is accepted.
pub(crate) fn errs(candidate: &Candidate, cap_pa: f64) -> bool {
    stated_error(candidate, cap_pa).is_some_and(|error| error.is_none_or(|error| error > BEND_TOLERANCE))
}

impl Model {
    /// Of a candidate whose pressure the analytic model allows up to `cap_pa`.
    pub(super) fn new(candidate: &Candidate, cap_pa: f64) -> Option<Self> {
        let error = stated_error(candidate, cap_pa)?;
        if error.is_some_and(|error| error <= BEND_TOLERANCE) {
            return Some(Self { bend: Bend::Analytic(error), section: None });
        }
        Self::by_section(candidate, error)
    }

    /// By finite elements where they have an answer, whatever the analytic model states.
    fn by_section(candidate: &Candidate, error: Option<f64>) -> Option<Self> {
        let (_, second) = candidate.segment.by_section(&candidate.geometry)?;
        let section = Section::new(candidate).ok();
        let bend = match (&section, second) {
            (None, _) => Bend::Analytic(error),
            (Some(_), None) => Bend::SectionFe(error),
            (Some(_), Some(_)) => Bend::TwoWindings,
        };
        Some(Self { bend, section })
    }
}

/// The end of the branch where it comes before a pressure.
fn limit_pa(parameters: &ActuatorParameters<f64>, second: Option<&Fiber<f64>>, pressure_pa: f64) -> Option<f64> {
    let options = Options::default();
    let section = match second {
        None => Elements::new(parameters, &options),
        Some(second) => Elements::with_two_windings(parameters, second, &options),
    };
    let curve = section.ok()?.curve(&[pressure_pa], &EndLoad::default()).ok()?;
    match curve.answers.first()?.outcome {
        Outcome::NoEquilibrium { limit_pressure_pa } => Some(limit_pressure_pa),
        _ => None,
    }
}

impl Section {
    /// Of a candidate.
    ///
    /// # Errors
    /// The reason why finite elements have no bends of it.
    pub(crate) fn new(candidate: &Candidate) -> Result<Self, String> {
        let segment = candidate.segment;
        let (parameters, second) = segment.by_section(&candidate.geometry).ok_or("it has no winding")?;
        let (highest_pa, share) = (segment.pressure_max_pa, 1.0 - segment.limit_margin);
        // The very curve that `check` has of such a module.
        let curve = StateCurve::by_section(&parameters, second.as_ref(), highest_pa)?;
        // A limit point above the highest pressure may still leave too little margin.
        let limit_pa = curve.limit_point_pa().or_else(|| limit_pa(&parameters, second.as_ref(), highest_pa / share));
        let allowed_pa = limit_pa.map_or(f64::INFINITY, |limit_pa| share * limit_pa);
        Ok(Self { cap_pa: highest_pa.min(allowed_pa).min(curve.pressure_max_pa()), curve })
    }

    /// The state with a bend angle, rad; `None` beyond the highest pressure.
    pub(crate) fn bent(&self, bend_angle_rad: f64) -> Option<State<f64>> {
        let state = self.curve.find(|state| state.bend_angle_rad, bend_angle_rad)?;
        (state.pressure_pa <= self.cap_pa * (1.0 + 1e-9)).then_some(state)
    }

    /// The state at a pressure; `None` beyond the highest one.
    pub(crate) fn at(&self, pressure_pa: f64) -> Option<State<f64>> {
        (pressure_pa <= self.cap_pa * (1.0 + 1e-9)).then(|| self.curve.at(pressure_pa.min(self.cap_pa)))
    }

    /// The best pressure for a goal, Pa, where it is free: of a goal beyond reach that of the nearest bend, with an effort the best compromise.
    pub(super) fn pressure_pa(&self, goal: Option<&Goal>, effort_per_pa2: f64) -> f64 {
        let Some(goal) = goal.filter(|goal| goal.weight > 0.0) else { return 0.0 };
        let reached =
            self.bent(goal.value).map(|state| state.pressure_pa).filter(|pressure_pa| *pressure_pa <= self.cap_pa);
        if let (Some(pressure_pa), true) = (reached, effort_per_pa2 == 0.0) {
            return pressure_pa;
        }
        let term = |pressure_pa: f64| {
            let away = self.curve.at(pressure_pa).bend_angle_rad - goal.value;
            goal.weight * away * away + effort_per_pa2 * pressure_pa * pressure_pa
        };
        let node = |index: usize| self.cap_pa * index as f64 / INTERVALS as f64;
        let best = (0..=INTERVALS).min_by(|a, b| term(node(*a)).total_cmp(&term(node(*b)))).unwrap_or(0);
        let (mut low, mut high) = (node(best.saturating_sub(1)), node((best + 1).min(INTERVALS)));
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        for _ in 0..GOLDEN_STEPS {
            let (a, b) = (high - golden * (high - low), low + golden * (high - low));
            if term(a) < term(b) { high = b } else { low = a }
        }
        // An end of the range is met exactly.
        let ends = [0.0, self.cap_pa, 0.5 * (low + high)];
        ends.into_iter().min_by(|a, b| term(*a).total_cmp(&term(*b))).unwrap_or(0.0)
    }
}

/// Goals for another search, and the factors that they differ by.
pub(super) struct Aim {
    pub(super) problem: Problem,
    factors: Vec<f64>,
}

impl Aim {
    /// For the search of a round, from 1, by a design whose models are known; `None` where no bend is by finite elements.
    pub(super) fn new(
        problem: &Problem,
        parts: &[Found],
        models: &[Option<Model>],
        round: usize,
        counts: &mut Counts,
    ) -> Option<Self> {
        let mut aim = Self { problem: problem.clone(), factors: Vec::new() };
        let sections = models.iter().map(|model| model.as_ref().and_then(|model| model.section.as_ref()));
        let mut is_needed = false;
        for (index, (found, section)) in parts.iter().zip(sections).enumerate() {
            let Some(section) = section else { continue };
            is_needed = true;
            let segment = &problem.segments[index];
            let candidate = Candidate::new(segment, &found.point)?;
            let is_free = !problem.shared_pressure && segment.effort_per_pa2 == 0.0;
            let more = if is_free { 1.0 + MORE * round as f64 } else { 1.0 };
            let aimed = &mut aim.problem.segments[index];
            aimed.pressure_max_pa = aimed.pressure_max_pa.min(section.cap_pa);
            for (phase, goal) in aimed.goals.iter_mut().enumerate() {
                let pressure_pa = pressure_pa(problem.shared_pressure, segment, section, phase, found);
                let factor = factor(&candidate, section, pressure_pa, counts);
                aim.factors.push(factor);
                if let Some(goal) = goal {
                    goal.value *= factor * more;
                    goal.weight /= factor * factor;
                }
            }
        }
        is_needed.then_some(aim)
    }

    /// Whether the factors are those of another.
    pub(super) fn is_as(&self, other: &Self) -> bool {
        let same = |(a, b): (&f64, &f64)| (a / b - 1.0).abs() <= SETTLED;
        self.factors.len() == other.factors.len() && self.factors.iter().zip(&other.factors).all(same)
    }
}

/// The pressure of a phase by finite elements, Pa: on one supply line that of the search.
pub(super) fn pressure_pa(is_shared: bool, segment: &Segment, section: &Section, phase: usize, found: &Found) -> f64 {
    if is_shared {
        return found.pressures_pa[phase];
    }
    section.pressure_pa(segment.goals[phase].as_ref(), segment.effort_per_pa2)
}

/// The analytic bend over that of finite elements; 1 where they do not bend.
fn factor(candidate: &Candidate, section: &Section, pressure_pa: f64, counts: &mut Counts) -> f64 {
    let pressure_pa = pressure_pa.min(section.cap_pa);
    let by_section = section.curve.at(pressure_pa).bend_angle_rad;
    let analytic = candidate.at(pressure_pa, counts).map(|state| state.bend_angle_rad);
    analytic.map(|analytic| analytic / by_section).filter(|factor| factor.is_finite() && *factor > 0.0).unwrap_or(1.0)
}
