//! Counts of a sweep.

use std::collections::BTreeMap;

use fra_model::{Motion, Placement, Solution, State, Status};

use super::scalar::Scalar;
use super::wall::Rule;

/// An answer may be off by this many roundings per condition number.
pub(crate) const ROUNDINGS: f64 = 10.0;
/// Farther off than this it is another equilibrium.
const OTHER_BRANCH: f64 = 1e-3;
/// Relative error of a limit pressure where its condition allows no more.
pub(crate) const LIMIT_PRESSURE: f64 = 1e-6;

/// Quadrature: to find branches, to refine states in `f64`, and in pairs.
pub(crate) struct Rules {
    pub(crate) rough: Rule,
    pub(crate) fine: Rule,
    pub(crate) exact: Rule,
}

/// What became of one question.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Verdict {
    /// Solved, with the error in roundings per condition number.
    Solved(f64),
    /// On the right branch but less exact than the rule asks for.
    Inexact(f64),
    /// Refused, and the oracle confirms that and the limit.
    Refused,
    /// Refused although a state exists.
    FalseRefusal,
    /// Rightly refused, with a wrong limit pressure.
    WrongLimit,
    /// The solver gave up and says so.
    NotConverged,
    /// Another equilibrium than that of the branch connected to rest; the relative error.
    OtherBranch(#[allow(dead_code, reason = "printed with a failure")] f64),
    /// A number is not finite.
    NotFinite,
    /// The oracle itself has no answer.
    OracleStuck,
}

type Kind = (&'static str, &'static str);

/// Counts by motion and placement.
#[derive(Default)]
pub(crate) struct Tally {
    rows: BTreeMap<Kind, Row>,
    skipped: usize,
    failures: Vec<String>,
}

#[derive(Default)]
struct Row {
    ratios: Vec<f64>,
    counts: [usize; 8],
}

impl Row {
    fn print(&mut self, (motion, placement): Kind) {
        self.ratios.sort_by(f64::total_cmp);
        let at =
            |share: f64| self.ratios.get(((self.ratios.len().max(1) - 1) as f64 * share) as usize).map_or(0.0, |r| *r);
        let [solved, inexact, refused, refusals, limits, not_converged, wrong, stuck] = self.counts;
        println!(
            "{motion:<10} {placement:<8} {solved:>7} {inexact:>8} {refused:>8} {refusals:>8} {limits:>7} {not_converged:>8} {wrong:>7} \
             {stuck:>6}   {:>7.2} {:>7.2} {:>9.2}",
            at(0.5),
            at(0.99),
            at(1.0)
        );
    }
}

fn kind((motion, placement): (Motion, Option<Placement>)) -> Kind {
    let motion = match motion {
        Motion::Extension => "extension",
        Motion::Expansion => "expansion",
        Motion::Bending => "bending",
        Motion::Twisting => "twisting",
    };
    let placement = match placement {
        Some(Placement::Sheet) => "sheet",
        Some(Placement::Layer) => "layer",
        Some(Placement::Smeared) => "smeared",
        None => "-",
    };
    (motion, placement)
}

impl Tally {
    pub(crate) fn skip(&mut self) {
        self.skipped += 1;
    }

    pub(crate) fn add(&mut self, of: (Motion, Option<Placement>), verdict: Verdict, describe: impl FnOnce() -> String) {
        let row = self.rows.entry(kind(of)).or_default();
        let (column, ratio) = match verdict {
            Verdict::Solved(ratio) => (0, Some(ratio)),
            Verdict::Inexact(ratio) => (1, Some(ratio)),
            Verdict::Refused => (2, None),
            Verdict::FalseRefusal => (3, None),
            Verdict::WrongLimit => (4, None),
            Verdict::NotConverged => (5, None),
            Verdict::OtherBranch(_) | Verdict::NotFinite => (6, None),
            Verdict::OracleStuck => (7, None),
        };
        row.counts[column] += 1;
        row.ratios.extend(ratio);
        if column != 0 && column != 2 {
            self.failures.push(format!("{verdict:?}: {}", describe()));
        }
    }

    pub(crate) fn join(mut self, other: Self) -> Self {
        for (kind, row) in other.rows {
            let mine = self.rows.entry(kind).or_default();
            mine.ratios.extend(row.ratios);
            mine.counts.iter_mut().zip(row.counts).for_each(|(a, b)| *a += b);
        }
        self.failures.extend(other.failures);
        self.skipped += other.skipped;
        self
    }

    /// Prints the table of a sweep over a number of actuators and demands that nothing is left unexplained.
    pub(crate) fn check(mut self, scalar: &str, actuators: u32) {
        println!(
            "{scalar}                 solved  inexact  refused  falsely  limits not conv   wrong oracle   error / (eps condition): median, 99 %, max"
        );
        let mut all = Row::default();
        for (kind, row) in &mut self.rows {
            all.ratios.extend(&row.ratios);
            all.counts.iter_mut().zip(row.counts).for_each(|(a, b)| *a += b);
            row.print(*kind);
        }
        all.print(("all", ""));
        println!("not asked: {}", self.skipped);
        self.failures.iter().for_each(|failure| println!("{failure}"));
        let shown = self.failures.iter().take(20).map(String::as_str).collect::<Vec<_>>().join("\n");
        let answered: usize = all.counts.iter().sum();
        let asked = answered + self.skipped;
        assert!(
            10 * answered > 45 * actuators as usize && self.skipped * 20 < asked,
            "only {answered} of {asked} questions were asked"
        );
        assert!(self.failures.is_empty(), "{} answers in {scalar} fail:\n{shown}", self.failures.len());
    }
}

/// The verdict on an answer that cannot be looked at further.
pub(crate) fn unusable<T: Scalar>(solution: &Solution<T>) -> Option<Verdict> {
    let limit = solution.status == Status::NoSolution;
    let mut finite = solution.residual.exact().is_finite();
    State::combine([&solution.state], |[value]| {
        // At a limit point the compliance is infinite.
        finite &= value.exact().is_finite() || (limit && !value.exact().is_nan());
        value
    });
    let unusable = (!finite).then_some(Verdict::NotFinite);
    unusable.or((solution.status == Status::NotConverged).then_some(Verdict::NotConverged))
}

/// The verdict on a state of a relative error, where `unit` is a rounding times the condition number.
pub(crate) fn rated(error: f64, unit: f64) -> Verdict {
    match error / unit {
        ratio if ratio <= ROUNDINGS => Verdict::Solved(ratio),
        ratio if error < OTHER_BRANCH => Verdict::Inexact(ratio),
        _ => Verdict::OtherBranch(error),
    }
}
