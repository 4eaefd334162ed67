//! The best limbs for a given order of modules.

use super::candidate::{Candidate, REACHED_M, Shortfall};
use super::confirm::confirm;
use super::layout::Layout;
use super::objective::Objective;
use super::realise::{Exact, fine_tables, sections};
use super::search::{LocalMinimum, search};
use super::table::Table;
use super::task::{Aim, MOST_PARTS, Space, Task, TaskError, count};
use softlimb_numerics::Random;

/// Configurations looked at on every move during the search.
const ON_A_MOVE: usize = 3;
/// Objective at which the search is content, mm2: less than the interpolation is good for.
const CONTENT_MM2: f64 = 1e-4;
/// Objective beyond which the model is not asked about an end, if there are others, mm2.
const PROMISING_MM2: f64 = 1.0;
/// Ends that are confirmed.
const CONFIRMED: usize = 3;

/// How long to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Seed of the starts.
    pub seed: u64,
    /// Evaluations of all way-points with derivatives after which no descent begins; at least 1.
    pub evaluations: usize,
}

impl Default for Budget {
    fn default() -> Self {
        Self { seed: 1, evaluations: 20_000 }
    }
}

/// The limb that does the task best, made of the given modules from the base outwards.
///
/// Where something is left, [`Candidate::shortfall`] says what and why, and the limb is the nearest that was found.
///
/// # Errors
/// [`TaskError`] for numbers out of their range and for bounds that leave nothing which the model can solve.
pub fn design(task: &Task, modules: &[Space], effort: &Budget) -> Result<Candidate, TaskError> {
    task.check()?;
    count("modules and segments", modules.len(), 1..=MOST_PARTS)?;
    modules.iter().try_for_each(Space::check)?;
    let before = std::iter::once(None).chain(modules.iter().map(Some));
    modules.iter().zip(before).try_for_each(|(own, before)| own.check_joint(before))?;
    let tables = modules.iter().map(Table::new).collect::<Result<Vec<_>, _>>()?;
    let order: Vec<usize> = (0..modules.len()).collect();
    let mut random = Random::new(effort.seed, 0);
    Order { task, spaces: modules.iter().collect(), tables: order.iter().map(|index| &tables[*index]).collect() }
        .best(&mut random, effort.evaluations)
}

/// One order of modules with their tables.
pub(super) struct Order<'a> {
    pub(super) task: &'a Task,
    pub(super) spaces: Vec<&'a Space>,
    pub(super) tables: Vec<&'a Table>,
}

impl Order<'_> {
    /// The best limb, with the reason where something is left.
    pub(super) fn best(&self, random: &mut Random, evaluations: usize) -> Result<Candidate, TaskError> {
        let mut best = self.nearest(random, evaluations)?;
        if !best.does_it() {
            best.shortfall = Some(self.shortfall(&best, random, evaluations)?);
        }
        Ok(best)
    }

    /// The best limb of searches that go on until one does it or the evaluations are spent.
    pub(super) fn nearest(&self, random: &mut Random, evaluations: usize) -> Result<Candidate, TaskError> {
        let layout = Layout::new(&self.spaces, self.task.way_points.len());
        let mut objective = Objective::new(self.task, layout, self.tables.clone(), ON_A_MOVE);
        let mut best: Option<Candidate> = None;
        let mut spent = 0;
        loop {
            let found = search(&mut objective, random, CONTENT_MM2, evaluations.saturating_sub(spent).max(1));
            spent += found.evaluations;
            // What is far from doing it is settled only if it is all there is.
            let last = spent >= evaluations && best.is_none();
            let promising =
                |(index, minimum): &(usize, &LocalMinimum)| minimum.value <= PROMISING_MM2 || (last && *index == 0);
            for (_, minimum) in found.minima.iter().enumerate().take(CONFIRMED).filter(promising) {
                let (candidate, settled) = self.confirmed(&objective.layout, minimum)?;
                spent += settled;
                if best.as_ref().is_none_or(|best| badness(&candidate) < badness(best)) {
                    best = Some(candidate);
                }
            }
            let best = best.as_mut().filter(|best| best.does_it() || spent >= evaluations);
            if let Some(best) = best {
                best.evaluations = spent;
                return Ok(best.clone());
            }
        }
    }

    /// A minimum, settled and confirmed by the model; and the evaluations that took.
    fn confirmed(&self, layout: &Layout, minimum: &LocalMinimum) -> Result<(Candidate, usize), TaskError> {
        let sections = sections(&self.spaces, layout, &minimum.place);
        let tables = fine_tables(&sections)?;
        let mut exact = Exact::new(self.task, &sections, &tables, (layout, minimum), ON_A_MOVE);
        let spent = exact.settle();
        Ok((confirm(&exact, &sections)?, spent))
    }

    /// Why something is left.
    fn shortfall(&self, best: &Candidate, random: &mut Random, evaluations: usize) -> Result<Shortfall, TaskError> {
        if let Some(blocked) = blocked(self.task) {
            return Ok(blocked);
        }
        let free = Task { obstacles: Vec::new(), ..self.task.clone() };
        let without = Order { task: &free, spaces: self.spaces.clone(), tables: self.tables.clone() };
        let alone = if self.task.obstacles.is_empty() { best.clone() } else { without.nearest(random, evaluations)? };
        let missed = |candidate: &Candidate| {
            let errors =
                candidate.way_points.iter().map(|answer| answer.tip_error_m + 0.1 * answer.direction_error_rad);
            errors.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
        };
        let (way_point, by_m) = missed(&alone);
        if by_m > REACHED_M {
            return Ok(Shortfall::OutOfReach { way_point: way_point + 1, by_m });
        }
        Ok(self.in_the_way(best, missed(best).0))
    }

    /// The obstacle that is nearest where the limb is worst off.
    fn in_the_way(&self, best: &Candidate, missed: usize) -> Shortfall {
        let short = |answer: &super::WayPointAnswer| {
            [answer.clearance_m, answer.move_clearance_m].into_iter().flatten().fold(f64::INFINITY, f64::min)
        };
        let worst = best.way_points.iter().enumerate().min_by(|a, b| short(a.1).total_cmp(&short(b.1)));
        let spare = best.figures.spare_clearance_m.unwrap_or(0.0);
        let at = if spare < -super::CLEAR_M { worst.map_or(missed, |(index, _)| index) } else { missed };
        let nearest = best.way_points[at].nearest_obstacle.clone().unwrap_or_default();
        Shortfall::Obstacle { way_point: at + 1, obstacle: nearest, by_m: (-spare).max(0.0) }
    }
}

/// What the best limb has least of: tip error and missing clearance together, mm2.
fn badness(candidate: &Candidate) -> f64 {
    let missing = candidate.figures.spare_clearance_m.map_or(0.0, |spare| (-1e3 * spare).max(0.0));
    candidate.objective_mm2 + missing * missing
}

/// A way-point that the end of the tool cannot be at, whatever the limb.
fn blocked(task: &Task) -> Option<Shortfall> {
    for (index, way_point) in task.way_points.iter().enumerate() {
        let Some(Aim::Point(point)) = &way_point.aim else { continue };
        for obstacle in &task.obstacles {
            let spare = obstacle.shape.distance(point).distance_m - task.tool_m[1] - obstacle.clearance_m;
            if spare < 0.0 && task.tool_m[0] > 0.0 {
                let obstacle = obstacle.name.clone();
                return Some(Shortfall::TargetBlocked { way_point: index + 1, obstacle, by_m: -spare });
            }
        }
    }
    None
}

/// The objective of a task as a function on the unit box, for searches of other kinds: the very function that [`design`] searches.
pub struct Evaluator<'a> {
    task: &'a Task,
    layout: Layout,
    tables: Vec<Table>,
}

impl<'a> Evaluator<'a> {
    /// # Errors
    /// As [`design`].
    pub fn new(task: &'a Task, modules: &[Space]) -> Result<Self, TaskError> {
        task.check()?;
        let tables = modules.iter().map(Table::new).collect::<Result<_, _>>()?;
        let layout = Layout::new(&modules.iter().collect::<Vec<_>>(), task.way_points.len());
        Ok(Self { task, layout, tables })
    }

    /// Number of variables: what the bounds leave free of each module (two sizes, fiber angle, length, mount angle), then for every
    /// way-point the share of its reach that each module is deformed by.
    pub fn width(&self) -> usize {
        self.layout.width()
    }

    /// The objective at a place, mm2.
    ///
    /// # Panics
    /// When there are not [`width`](Self::width) values.
    pub fn objective(&self, place: &[f64]) -> f64 {
        assert_eq!(place.len(), self.width(), "one value for each variable");
        let objective = Objective::new(self.task, self.layout.clone(), self.tables.iter().collect(), ON_A_MOVE);
        objective.at(place).value
    }
}
