//! Inverse kinematics: module setpoints that put the tip at a point.

use nalgebra::{DMatrix, DVector, Vector3};

use crate::design::Limb;

/// The tip counts as arrived within this distance, m.
const ARRIVED_M: f64 = 1e-7;
/// Distance from a target up to which it counts as reached, m.
const REACHED_M: f64 = 1e-4;
const ITERATIONS: usize = 200;
/// Share of a module's pressure range by which a derivative is probed.
const PROBE: f64 = 1e-5;

/// What the limb can do about a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// Gauge pressure of each module, Pa.
    pub pressures_pa: Vec<f64>,
    /// Where the tip then is, m.
    pub tip_m: [f64; 3],
    /// Its distance from the target, m.
    pub distance_m: f64,
}

impl Reach {
    /// Whether that is at the target.
    pub fn reached(&self) -> bool {
        self.distance_m <= REACHED_M
    }
}

/// The pressures nearest to `start_pa` that bring the tip to `target_m`; where the limb cannot reach it, as near as it gets.
///
/// Damped Gauss-Newton in the share of each module's pressure range, with the bounds kept by holding what would leave them.
/// Other starts are tried when the first does not arrive, since the distance may have several minima.
pub fn solve_tip(limb: &Limb, target_m: [f64; 3], start_pa: &[f64]) -> Reach {
    let spans: Vec<f64> = limb.modules().iter().map(|module| module.curve.pressure_max_pa()).collect();
    let first = start_pa.iter().zip(&spans).map(|(p, span)| if *span > 0.0 { p / span } else { 0.0 }).collect();
    let mut best = descend(limb, &spans, target_m, first);
    for start in starts(spans.len()) {
        if best.distance_m <= ARRIVED_M {
            break;
        }
        let other = descend(limb, &spans, target_m, start);
        if other.distance_m < best.distance_m {
            best = other;
        }
    }
    best
}

/// Points spread over the unit box: the middle, then those of a low-discrepancy (Halton) sequence.
fn starts(dimensions: usize) -> impl Iterator<Item = Vec<f64>> {
    const BASES: [u32; 9] = [2, 3, 5, 7, 11, 13, 17, 19, 23];
    let halton = move |index: u32, base: u32| {
        let (mut value, mut share, mut rest) = (0.0, 1.0, index);
        while rest > 0 {
            share /= f64::from(base);
            value += share * f64::from(rest % base);
            rest /= base;
        }
        value
    };
    let point = move |i: u32| (0..dimensions).map(|d| halton(i + (d / 9) as u32, BASES[d % 9])).collect();
    std::iter::once(vec![0.5; dimensions]).chain((1..24).map(point))
}

fn tip_at(limb: &Limb, spans: &[f64], shares: &[f64]) -> Vector3<f64> {
    let states: Vec<_> =
        limb.modules().iter().zip(spans).zip(shares).map(|((m, span), share)| m.curve.at(span * share)).collect();
    Vector3::from(limb.tip(&states))
}

fn descend(limb: &Limb, spans: &[f64], target_m: [f64; 3], start: Vec<f64>) -> Reach {
    let target = Vector3::from(target_m);
    let count = spans.len();
    let mut shares: Vec<f64> = start.into_iter().map(|share| share.clamp(0.0, 1.0)).collect();
    let mut tip = tip_at(limb, spans, &shares);
    let mut damping = 1e-3;
    for _ in 0..ITERATIONS {
        let miss = target - tip;
        if miss.norm() <= ARRIVED_M || damping > 1e12 {
            break;
        }
        let jacobian = jacobian(limb, spans, &shares);
        let pull = jacobian.transpose() * miss;
        // A module at an end of its range that is pulled outwards stays there.
        let free = |i: usize| !((shares[i] <= 0.0 && pull[i] < 0.0) || (shares[i] >= 1.0 && pull[i] > 0.0));
        let mut normal: DMatrix<f64> = jacobian.transpose() * &jacobian;
        let scale = normal.diagonal().max().max(f64::MIN_POSITIVE);
        for i in 0..count {
            normal[(i, i)] += damping * scale;
            if !free(i) {
                normal.row_mut(i).fill(0.0);
                normal.column_mut(i).fill(0.0);
                normal[(i, i)] = 1.0;
            }
        }
        let right = DVector::from_fn(count, |i, _| if free(i) { pull[i] } else { 0.0 });
        let Some(step) = normal.cholesky().map(|factors| factors.solve(&right)) else { break };
        let next: Vec<f64> = shares.iter().zip(step.iter()).map(|(s, d)| (s + d).clamp(0.0, 1.0)).collect();
        let next_tip = tip_at(limb, spans, &next);
        if (target - next_tip).norm() < miss.norm() {
            (shares, tip) = (next, next_tip);
            damping = (damping * 0.2).max(1e-15);
        } else {
            damping *= 10.0;
        }
    }
    let pressures_pa = spans.iter().zip(&shares).map(|(span, share)| span * share).collect();
    Reach { pressures_pa, tip_m: tip.into(), distance_m: (target - tip).norm() }
}

/// Derivative of the tip by the shares, by central differences (one-sided at the ends).
fn jacobian(limb: &Limb, spans: &[f64], shares: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(3, shares.len());
    let mut probe = shares.to_vec();
    for i in 0..shares.len() {
        let (below, above) = ((shares[i] - PROBE).max(0.0), (shares[i] + PROBE).min(1.0));
        probe[i] = above;
        let ahead = tip_at(limb, spans, &probe);
        probe[i] = below;
        let behind = tip_at(limb, spans, &probe);
        probe[i] = shares[i];
        matrix.set_column(i, &((ahead - behind) / (above - below)));
    }
    matrix
}
