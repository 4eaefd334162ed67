//! The table in memory, and as a terminal shows it.

use std::fmt::Write;

use super::callgrind::Count;
use super::measure::Accuracy;
use super::reference::Doubt;

/// What an answer costs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Time over that of the baseline: Newton's method from rest to 1e-10, extension, double precision.
    pub time: Option<f64>,
    /// Counts on this machine.
    pub count: Option<Count>,
    /// That of a Cortex-M4F for one actuator of the motion, wound with a sheet, see [`mcu`](super::mcu).
    pub mcu: Option<McuCost>,
}

/// What an answer costs a microcontroller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct McuCost {
    /// Instructions, counted in an emulator.
    pub instructions: f64,
    /// Cycles, estimated from them, each with the weight of its kind.
    pub cycles: f64,
}

/// One line: a method for a motion in a scalar.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Number of the line among all there could be.
    pub(super) entry: usize,
    /// Problem, method, motion, scalar.
    pub names: [String; 4],
    /// How far off.
    pub accuracy: Accuracy,
    /// How much work.
    pub cost: Cost,
}

/// The whole table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Seed of the set.
    pub seed: u64,
    /// Actuators of the set.
    pub asked: usize,
    /// Actuators for which the reference has an answer.
    pub answered: usize,
    /// How well the reference is known, at worst.
    pub doubt: Doubt,
    /// The lines.
    pub rows: Vec<Row>,
    /// Counts of a polynomial of degree 8, which takes 16 operations: whether the instruments count right.
    pub polynomial: Option<Count>,
}

impl Report {
    /// The table as text, aligned. Writing to a string cannot fail.
    pub fn table(&self) -> String {
        let mut text = self.heading() + "\n\n";
        let _ = writeln!(
            text,
            "{:<8} {:<22} {:<10} {:<4} {:>5} {:>5} {:>9} {:>9} {:>6} {:>8} {:>9} {:>8} {:>7} {:>7}",
            "problem",
            "method",
            "motion",
            "",
            "asked",
            "found",
            "max err",
            "median",
            "steps",
            "time",
            "instr",
            "flops",
            "MCU",
            "cycles"
        );
        for row in &self.rows {
            let [problem, method, motion, scalar] = &row.names;
            let Accuracy { asked, solved, max_error, median_error, steps } = row.accuracy;
            let (instructions, flops) = row.cost.counted();
            let (mcu, cycles) = row.cost.emulated();
            let _ = writeln!(
                text,
                "{problem:<8} {method:<22} {motion:<10} {scalar:<4} {asked:>5} {solved:>5} {max_error:>9.1e} {median_error:>9.1e} \
                 {steps:>6.1} {:>8} {:>9} {:>8} {:>7} {:>7}",
                significant(row.cost.time),
                figure(instructions, 0),
                figure(flops, 0),
                figure(mcu, 0),
                figure(cycles, 0),
            );
        }
        text
    }

    /// What was asked and how well the truth is known, in a sentence.
    pub fn heading(&self) -> String {
        let Doubt { residual, step, quadrature } = self.doubt;
        format!(
            "{} of {} actuators of seed {} answered by the reference: residual {residual:.0e}, last step {step:.0e}, \
             quadrature {quadrature:.0e} at most",
            self.answered, self.asked, self.seed
        )
    }
}

impl Cost {
    /// Instructions and operations.
    pub fn counted(&self) -> (Option<f64>, Option<f64>) {
        (self.count.map(|count| count.instructions), self.count.and_then(|count| count.flops))
    }

    /// Instructions and cycles of the microcontroller.
    pub fn emulated(&self) -> (Option<f64>, Option<f64>) {
        (self.mcu.map(|mcu| mcu.instructions), self.mcu.map(|mcu| mcu.cycles))
    }
}

/// Two digits, or all before the point.
pub(super) fn significant(value: Option<f64>) -> String {
    let digits = value.map_or(0.0, |value| 1.0 - value.abs().max(1e-9).log10().floor());
    figure(value, digits.clamp(0.0, 8.0) as usize)
}

/// A figure, or a dash where there is none.
pub(super) fn figure(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
}
