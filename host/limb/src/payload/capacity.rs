//! The largest load that bundles can hold in their shape, with the pressures for it and what limits it.
//!
//! The wrench is affine in the pressures to a percent or two: the program is solved with the derivatives at half of the limits, then once
//! more with those at its own answer. While the model's wrench at the answer differs from the affine one by more than [`AFFINE`], it is solved
//! again. The remaining difference is reported.

use nalgebra::Vector6;

use super::bundle::{Bundle, PayloadError, lever, require};
use super::program::{Outcome, Program};

/// Within this share of its range a limit is active.
const ACTIVE: f64 = 1e-6;
/// Components below this share of the largest are rounding: a load through an axis has no moment about it.
const ROUNDING: f64 = 1e-12;
/// Largest accepted difference of the model's wrench from the affine one, over the largest component.
pub const AFFINE: f64 = 0.03;
/// Largest number of programs solved for one answer.
const PROGRAMS: usize = 20;
/// Number of the program from which on the linearization point moves only halfway to the answer: full steps may oscillate.
const WHOLE_STEPS: usize = 4;

/// A bundle and what it has to balance, in a frame of its own.
#[derive(Clone, Debug)]
pub struct Linearised {
    /// For messages.
    pub name: String,
    /// The actuators.
    pub bundle: Bundle,
    /// The components that pressures balance; the others are left to the walls.
    pub rows: [bool; 6],
    /// The wrench of the surroundings without the load, N and N m.
    pub constant: Vector6<f64>,
    /// What one newton of the load adds to it.
    pub per_load: Vector6<f64>,
    /// Lowest and highest gauge pressure of each actuator, Pa.
    pub limits_pa: Vec<[f64; 2]>,
    /// Largest push of each actuator, N; infinite where there is no such limit.
    pub push_max_n: Vec<f64>,
}

/// Bundles that hold one load together.
#[derive(Clone, Debug)]
pub struct LoadQuery {
    /// The bundles.
    pub bundles: Vec<Linearised>,
    /// What makes moments comparable with forces: a moment of this many N m counts as 1 N, m.
    pub arm_m: f64,
}

/// A limit that holds at the largest load.
#[derive(Clone, Debug, PartialEq)]
pub enum Active {
    /// A pressure at its highest value.
    PressureMax {
        /// Bundle.
        bundle: usize,
        /// Actuator in it.
        actuator: usize,
    },
    /// A pressure at its lowest value.
    PressureMin {
        /// Bundle.
        bundle: usize,
        /// Actuator in it.
        actuator: usize,
    },
    /// A push at its largest value.
    Push {
        /// Bundle.
        bundle: usize,
        /// Actuator in it.
        actuator: usize,
    },
}

/// The largest load.
#[derive(Clone, Debug, PartialEq)]
pub struct Capacity {
    /// How it ended; the rest says nothing unless solved.
    pub outcome: Outcome,
    /// The largest load, N. Below zero where the bundles cannot even hold what is there without it.
    pub load_n: f64,
    /// The bound on it that the multipliers certify, N, for the affine wrenches.
    pub bound_n: f64,
    /// Pressures, Pa, bundle by bundle.
    pub pressures_pa: Vec<Vec<f64>>,
    /// Pushes along the axes by the model, N.
    pub pushes_n: Vec<Vec<f64>>,
    /// Limits that hold.
    pub active: Vec<Active>,
    /// By how much the model's wrench there is off the affine one, at most, N (moments over the arm).
    pub remainder_n: f64,
    /// The largest component of the wrenches there that is balanced, in the same measure.
    pub largest_n: f64,
    /// What is left of the balance of the affine wrenches, N.
    pub residual_n: f64,
    /// Steps of the interior-point method, of both programs.
    pub iterations: u32,
}

/// Finds the largest load.
///
/// # Errors
/// [`PayloadError`] for limits and loads that make no sense, pressures that no state balances, or a solver that fails.
pub fn capacity(question: &LoadQuery) -> Result<Capacity, PayloadError> {
    check(question)?;
    let middle = |bundle: &Linearised| bundle.limits_pa.iter().map(|[low, high]| 0.5 * (low + high)).collect();
    let mut at: Vec<Vec<f64>> = question.bundles.iter().map(middle).collect();
    let mut iterations = 0;
    let mut best: Option<Capacity> = None;
    for program_number in 1..=PROGRAMS {
        let (program, affine) = linearise(question, &at)?;
        let solution = program.solve()?;
        iterations += solution.iterations;
        if solution.outcome != Outcome::Solved {
            // A program linearized at a poor answer may be infeasible: the best earlier answer is kept.
            let failed = Capacity { outcome: solution.outcome, ..nothing() };
            return Ok(Capacity { iterations, ..best.unwrap_or(failed) });
        }
        let answer = split(question, &solution.pressures);
        if program_number > 1 {
            let mut found = Capacity { load_n: solution.load, bound_n: solution.bound, ..nothing() };
            found.residual_n = solution.residual;
            judge(question, &affine, &answer, &mut found)?;
            found.active = active(question, &answer, &found.pushes_n);
            found.pressures_pa = answer.clone();
            if best.as_ref().is_none_or(|best| found.remainder() < best.remainder()) {
                best = Some(found);
            }
        }
        if best.as_ref().is_some_and(|best| best.remainder() <= AFFINE) {
            break;
        }
        let share = if program_number < WHOLE_STEPS { 1.0 } else { 0.5 };
        let towards = |(at, answer): (&f64, &f64)| at + share * (answer - at);
        let moved = |(at, answer): (&Vec<f64>, &Vec<f64>)| at.iter().zip(answer).map(towards).collect();
        at = at.iter().zip(&answer).map(moved).collect();
    }
    Ok(Capacity { iterations, ..best.unwrap_or_else(nothing) })
}

impl Capacity {
    /// Difference of the model's wrench from the affine one, over the largest component. Above [`AFFINE`] the answer is not an equilibrium.
    pub fn remainder(&self) -> f64 {
        if self.largest_n > 0.0 { self.remainder_n / self.largest_n } else { 0.0 }
    }
}

fn nothing() -> Capacity {
    Capacity {
        outcome: Outcome::Solved,
        load_n: 0.0,
        bound_n: 0.0,
        pressures_pa: Vec::new(),
        pushes_n: Vec::new(),
        active: Vec::new(),
        remainder_n: 0.0,
        largest_n: 0.0,
        residual_n: 0.0,
        iterations: 0,
    }
}

fn check(question: &LoadQuery) -> Result<(), PayloadError> {
    let arm = question.arm_m;
    require(arm.is_finite() && arm > 0.0, "arm_m", arm, "finite and > 0")?;
    for bundle in &question.bundles {
        let (count, at) = (bundle.bundle.actuators.len(), &bundle.name);
        let said = bundle.limits_pa.len() as f64;
        require(bundle.limits_pa.len() == count, &format!("{at}.limits_pa"), said, "a pair for each actuator")?;
        let said = bundle.push_max_n.len() as f64;
        require(bundle.push_max_n.len() == count, &format!("{at}.push_max_n"), said, "one for each actuator")?;
        for [low, high] in &bundle.limits_pa {
            require(low.is_finite(), &format!("{at}.limits_pa"), *low, "finite")?;
            let ordered = high.is_finite() && high >= low;
            require(ordered, &format!("{at}.limits_pa"), *high, "finite, the higher not below the lower one")?;
        }
        for most in &bundle.push_max_n {
            require(*most > 0.0, &format!("{at}.push_max_n"), *most, "> 0, or infinite")?;
        }
        for value in bundle.constant.iter().chain(&bundle.per_load) {
            require(value.is_finite(), &format!("{at}.load"), *value, "finite")?;
        }
    }
    Ok(())
}

/// Wrench and columns of a bundle about pressures.
struct Affine {
    /// At no pressure, by the derivatives.
    constant: Vector6<f64>,
    columns: Vec<Vector6<f64>>,
}

fn linearise(question: &LoadQuery, at: &[Vec<f64>]) -> Result<(Program, Vec<Affine>), PayloadError> {
    let width = at.iter().map(Vec::len).sum();
    let mut program = Program { columns: vec![Vec::new(); width], ..Program::default() };
    let (mut affine, mut first) = (Vec::new(), 0);
    for (station, pressures) in question.bundles.iter().zip(at) {
        let mut here = Affine { constant: station.bundle.walls, columns: Vec::new() };
        for (i, (mounted, pressure)) in station.bundle.actuators.iter().zip(pressures).enumerate() {
            let push = mounted.push(*pressure)?;
            let d = lever(&mounted.point_m, &mounted.axis);
            here.columns.push(d * push.by_pressure);
            here.constant += d * (push.load - push.by_pressure * *pressure);
            if station.push_max_n[i].is_finite() {
                let mut row = vec![0.0; width];
                row[first + i] = push.by_pressure.x;
                let rest = push.load.x - push.by_pressure.x * pressure;
                program.sides.push((row, station.push_max_n[i] - rest));
            }
        }
        rows(&mut program, question, station, &here, first);
        program.limits.extend(&station.limits_pa);
        first += pressures.len();
        affine.push(here);
    }
    Ok((program, affine))
}

/// The rows of one bundle. A component that no pressure changes is left to the walls.
fn rows(program: &mut Program, question: &LoadQuery, station: &Linearised, affine: &Affine, first: usize) {
    let arm = |row: usize| if row < 3 { 1.0 } else { question.arm_m };
    let size = |row: usize| {
        let pairs = affine.columns.iter().zip(&station.limits_pa);
        pairs.map(|(column, [low, high])| (column[row] * (high - low)).abs() / arm(row)).fold(0.0, f64::max)
    };
    let largest = (0..6).map(size).fold(0.0, f64::max);
    let size_of_load = (0..6).map(|row| station.per_load[row].abs() / arm(row)).fold(0.0, f64::max);
    for row in (0..6).filter(|row| station.rows[*row] && size(*row) > ROUNDING * largest) {
        for (j, column) in program.columns.iter_mut().enumerate() {
            let own = j.checked_sub(first).and_then(|i| affine.columns.get(i));
            column.push(own.map_or(0.0, |own| own[row]));
        }
        let per_load = station.per_load[row];
        program.load.push(if per_load.abs() / arm(row) > ROUNDING * size_of_load { per_load } else { 0.0 });
        program.constant.push(station.constant[row] + affine.constant[row]);
        program.rows_scale.push(arm(row) * largest.max(f64::MIN_POSITIVE));
    }
}

fn split(question: &LoadQuery, all: &[f64]) -> Vec<Vec<f64>> {
    let mut rest = all;
    let take = |bundle: &Linearised| {
        let (own, others) = rest.split_at(bundle.bundle.actuators.len());
        rest = others;
        own.to_vec()
    };
    question.bundles.iter().map(take).collect()
}

/// The model's own wrenches at the answer, beside the affine ones.
fn judge(question: &LoadQuery, affine: &[Affine], at: &[Vec<f64>], found: &mut Capacity) -> Result<(), PayloadError> {
    let mut size: f64 = 0.0;
    for ((station, affine), pressures) in question.bundles.iter().zip(affine).zip(at) {
        let (mut exact, mut taken) = (station.bundle.walls, affine.constant);
        let mut pushes = Vec::new();
        for ((mounted, column), pressure) in station.bundle.actuators.iter().zip(&affine.columns).zip(pressures) {
            let push = mounted.push(*pressure)?;
            let own = lever(&mounted.point_m, &mounted.axis) * push.load;
            exact += own;
            taken += column * *pressure;
            pushes.push(push.load.x);
            size = size.max((0..6).map(|row| (column[row] * pressure / arm(question, row)).abs()).fold(0.0, f64::max));
        }
        let terms = affine.columns.iter().zip(&station.limits_pa);
        let terms = terms.flat_map(|(column, [low, high])| (0..6).map(move |row| (row, column[row] * (high - low))));
        let span = terms.map(|(row, term)| (term / arm(question, row)).abs()).fold(0.0, f64::max);
        let off = |row: usize| ((exact[row] - taken[row]) / arm(question, row)).abs();
        // With no wrench to balance, the difference is rounding.
        let off = |row: usize| Some(off(row)).filter(|off| *off > ROUNDING.sqrt() * span).unwrap_or(0.0);
        let had = |row: usize| (exact[row] / arm(question, row)).abs();
        for row in (0..6).filter(|row| station.rows[*row]) {
            found.remainder_n = found.remainder_n.max(off(row));
            found.largest_n = found.largest_n.max(had(row));
        }
        found.pushes_n.push(pushes);
    }
    // The program's residual is a share of the largest column.
    found.residual_n *= size;
    Ok(())
}

fn arm(question: &LoadQuery, row: usize) -> f64 {
    if row < 3 { 1.0 } else { question.arm_m }
}

fn active(question: &LoadQuery, at: &[Vec<f64>], pushes_n: &[Vec<f64>]) -> Vec<Active> {
    let mut active = Vec::new();
    for (bundle, station) in question.bundles.iter().enumerate() {
        for (actuator, ([low, high], pressure)) in station.limits_pa.iter().zip(&at[bundle]).enumerate() {
            let near = ACTIVE * (high - low);
            if *pressure >= high - near {
                active.push(Active::PressureMax { bundle, actuator });
            } else if *pressure <= low + near {
                active.push(Active::PressureMin { bundle, actuator });
            }
            // The push is the model's, the limit was put on the affine one.
            if pushes_n[bundle][actuator] >= 0.999 * station.push_max_n[actuator] {
                active.push(Active::Push { bundle, actuator });
            }
        }
    }
    active
}
