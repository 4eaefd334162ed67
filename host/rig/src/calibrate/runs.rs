//! Whether residuals look like noise or like a model that does not hold.

use softlimb_numerics::statistics::student_quantile;

use super::estimate::ALONE;
use super::{Fit, Observation};

/// Fewer points than this have no order that could be judged.
const LEAST: usize = 12;
/// The quantile of the normal distribution below which an order is no accident: once in 200.
const UNLIKELY: f64 = -2.576;
/// Probability that data without an outlier have an observation that is named as one.
const FALSE_ALARM: f64 = 0.01;
/// Fewer points less unknowns do not show the scatter of the others.
const FREEDOM_LEAST: usize = 3;

/// An outlier among the observations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// Index of the observation.
    pub index: usize,
    /// Distance from the fit to the other observations, in its SI unit.
    pub off: f64,
    /// Externally studentized residual.
    pub ratio: f64,
}

impl Fit {
    /// The bodies whose residuals of some quantity, in the order of the pressures, change their sign too seldom for noise (the runs test of Wald and
    /// Wolfowitz): the model does not follow these data, and intervals are narrower than they should be.
    pub fn systematic(&self, observations: &[Observation]) -> Vec<usize> {
        let mut found = Vec::new();
        for (index, _) in self.bodies.iter().enumerate() {
            let of = |k: &usize| observations[*k].body == index;
            let all: Vec<usize> = (0..observations.len()).filter(of).collect();
            let kinds = all.iter().map(|k| observations[*k].quantity);
            let seldom =
                kinds.clone().enumerate().filter(|(n, kind)| kinds.clone().position(|k| k == *kind) == Some(*n));
            let mut groups = seldom.map(|(_, kind)| {
                let mut of: Vec<usize> = all.iter().copied().filter(|k| observations[*k].quantity == kind).collect();
                of.sort_by(|a, b| observations[*a].reading_pa.total_cmp(&observations[*b].reading_pa));
                of.iter().map(|k| self.after[*k] > observations[*k].value).collect::<Vec<bool>>()
            });
            if groups.any(|signs| too_few_runs(&signs)) {
                found.push(index);
            }
        }
        found
    }

    /// Outliers: observations farther from the fit to the others than their accuracy, with a studentized residual above the quantile of Student's
    /// distribution.
    pub fn outliers(&self, observations: &[Observation]) -> Vec<Outlier> {
        let count = observations.len() as f64;
        if self.freedom < FREEDOM_LEAST {
            return Vec::new();
        }
        let most = student_quantile(1.0 - FALSE_ALARM / count, self.freedom - 1);
        let all = self.freedom as f64 * self.scatter.powi(2);
        let ratio = |(k, seen): (usize, &Observation)| {
            let residual = ((self.after[k] - seen.value) / seen.accuracy).abs();
            // An observation pulls the fit towards itself: the fit without it is farther away.
            let left = Some(1.0 - self.leverage[k]).filter(|left| *left > ALONE)?;
            let off = residual / left;
            // The scatter of all would hide one that is far off: of few points it is never beyond four times of that.
            let others = ((all - residual * off).max(0.0) / (self.freedom - 1) as f64).sqrt();
            let ratio = residual / left.sqrt() / others;
            (off > 1.0 && ratio > most).then_some(Outlier { index: k, off: off * seen.accuracy, ratio })
        };
        observations.iter().enumerate().filter_map(ratio).collect()
    }
}

fn too_few_runs(signs: &[bool]) -> bool {
    let above = signs.iter().filter(|sign| **sign).count() as f64;
    let n = signs.len() as f64;
    let below = n - above;
    if signs.len() < LEAST || above == 0.0 || below == 0.0 {
        return false;
    }
    let runs = 1.0 + signs.windows(2).filter(|pair| pair[0] != pair[1]).count() as f64;
    let mean = 1.0 + 2.0 * above * below / n;
    let variance = (mean - 1.0) * (mean - 2.0) / (n - 1.0);
    (runs - mean) / variance.sqrt() < UNLIKELY
}

#[cfg(test)]
mod tests {
    use super::too_few_runs;

    #[test]
    fn half_above_and_half_below_is_no_noise_and_alternation_is_none_that_is_blamed() {
        let half: Vec<bool> = (0..20).map(|k| k < 10).collect();
        // 2 runs where 11 are expected with a deviation of 2.18.
        assert!(too_few_runs(&half));
        let alternating: Vec<bool> = (0..20).map(|k| k % 2 == 0).collect();
        assert!(!too_few_runs(&alternating));
        assert!(!too_few_runs(&half[5..15]), "too few to judge");
    }
}
