//! Derivatives of a segment's deformation by its geometry and pressure, as central differences of model solves.
//!
//! A closed-form solve takes less than a microsecond and an exact derivative, in double-double arithmetic, fifty. A search on one supply
//! line asks for hundreds of thousands. The relative error is below 1e-7; it does not move the minimum that a search ends at.

use fra_model::{Motion, State};

use super::actuator::{Candidate, Counts};
use super::problem::Segment;

/// Half the width of a difference, as a share of the size or the pressure, or in rad.
const HALF: f64 = 1e-5;
/// Least value whose share is taken: of the highest pressure, or in rad.
const LEAST: f64 = 0.01;

/// The derivatives at one pressure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Slopes {
    /// By each variable of the unit box, m or rad.
    pub(super) by_place: [f64; 4],
    /// m/Pa or rad/Pa.
    pub(super) by_pressure: f64,
}

/// A segment moved along one variable.
struct Moved<'a> {
    candidate: Candidate<'a>,
    /// By how much, in the unit box.
    by: f64,
}

/// The derivatives at each of the states of a candidate at `place`, from pressures at given deformations if `is_explicit`; `None` where
/// the model answers on neither side.
pub(super) fn slopes(
    candidate: &Candidate,
    place: &[f64],
    states: &[State<f64>],
    is_explicit: bool,
    counts: &mut Counts,
) -> Option<Vec<Slopes>> {
    let segment = candidate.segment;
    let mut all = vec![Slopes::default(); states.len()];
    // The pressure of a bender depends on ratios of lengths alone, so that one of its sizes needs no differences.
    let has_scale = is_explicit && segment.motion == Motion::Bending && segment.axis(1)[1] > 0.0;
    for axis in 0..segment.dimensions() {
        let [low, width] = segment.axis(axis);
        if width == 0.0 || (axis == 0 && has_scale) {
            continue;
        }
        if axis == 2 {
            // Stretch, radii and the twist and bend per length do not depend on the length.
            if segment.motion != Motion::Expansion {
                let by_length = |state| candidate.measure(state) / candidate.geometry.length_m * width;
                all.iter_mut().zip(states).for_each(|(slopes, state)| slopes.by_place[axis] = by_length(state));
            }
            continue;
        }
        let step = if axis == 3 { HALF } else { HALF * (low + place[axis] * width) } / width;
        let moved = |by: f64| {
            let mut there = place.to_vec();
            there[axis] += by;
            Some(Moved { candidate: Candidate::new(segment, &there)?, by })
        };
        let sides = [moved(-step), moved(step)];
        for (slopes, state) in all.iter_mut().zip(states) {
            let mut at = |side: &Option<Moved>| {
                let moved = side.as_ref()?;
                let at_pressure = |counts: &mut Counts| {
                    Some(moved.candidate.measure(&moved.candidate.near(state, state.pressure_pa, counts)?))
                };
                let pressure_pa =
                    |counts: &mut Counts| Some(moved.candidate.inverse(candidate.measure(state), counts)?.pressure_pa);
                Some((moved.by, if is_explicit { pressure_pa(counts)? } else { at_pressure(counts)? }))
            };
            let here = if is_explicit { state.pressure_pa } else { candidate.measure(state) };
            slopes.by_place[axis] = slope(at(&sides[0]), here, at(&sides[1]))?;
        }
    }
    for (slopes, state) in all.iter_mut().zip(states) {
        if is_explicit {
            let value = candidate.measure(state);
            let step = HALF * value.max(LEAST);
            let mut at = |by: f64| Some((by, candidate.inverse(value + by, counts)?.pressure_pa));
            slopes.by_pressure = match candidate.bend_by_pressure(state) {
                Some(by_pressure) => by_pressure,
                None => 1.0 / slope(at(-step), state.pressure_pa, at(step))?,
            };
            if has_scale {
                slopes.by_place[0] = by_scale(segment, place, value / slopes.by_pressure, slopes.by_place[1]);
            }
            // At a given pressure: dq/dx = -(dP/dx)/(dP/dq).
            [0, 1, 3].into_iter().for_each(|axis| slopes.by_place[axis] *= -slopes.by_pressure);
            continue;
        }
        let step = HALF * state.pressure_pa.max(LEAST * segment.pressure_max_pa);
        let mut at = |by: f64| {
            let there = candidate.near(state, state.pressure_pa + by, counts)?;
            Some((by, candidate.measure(&there)))
        };
        slopes.by_pressure = slope(at(-step), candidate.measure(state), at(step))?;
    }
    Some(all)
}

/// `dP/dx_0` of a bender from `q dP/dq` and `dP/dx_1`. With its sizes `a` and `b` times a factor it has the same pressure at its bend `q`
/// divided by the factor. So Euler's theorem gives `a dP/da + b dP/db = q dP/dq`.
fn by_scale(segment: &Segment, place: &[f64], along_bend: f64, by_second: f64) -> f64 {
    let [[first, width], [second, other]] = [0, 1].map(|axis| {
        let [low, width] = segment.axis(axis);
        [low + place[axis] * width, width]
    });
    (along_bend - second * by_second / other) / first * width
}

/// From both sides, or from the one that there is.
fn slope(below: Option<(f64, f64)>, here: f64, above: Option<(f64, f64)>) -> Option<f64> {
    let (from, to) = (below.unwrap_or((0.0, here)), above.unwrap_or((0.0, here)));
    let slope = (to.1 - from.1) / (to.0 - from.0);
    slope.is_finite().then_some(slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuators::kinds::wide_line;
    use crate::actuators::problem::Winding;
    use fra_model::{Families, Placement};

    #[test]
    fn differences_are_the_exact_derivatives() {
        let (mut counts, mut compared) = (Counts::default(), 0);
        for seed in 0..20 {
            let problem = wide_line(seed);
            for segment in problem.segments() {
                let place = &[0.4, 0.7, 0.3, 0.2][..segment.dimensions()];
                let candidate = Candidate::new(segment, place).unwrap();
                let cap = candidate.cap(&mut counts).unwrap().pressure_pa;
                let states = [0.3, 0.9].map(|share| candidate.at(share * cap, &mut counts).unwrap());
                let is_explicit = segment.bends_without_limit();
                let found = slopes(&candidate, place, &states, is_explicit, &mut counts).unwrap();
                for (slopes, state) in found.iter().zip(&states) {
                    let exact = candidate.by_place(state, &mut counts).unwrap();
                    let most = exact.iter().fold(0.0, |most: f64, slope| most.max(slope.abs()));
                    for (found, exact) in slopes.by_place.iter().zip(exact) {
                        assert!((found - exact).abs() <= 1e-7 * most, "{:?}: {found} {exact}", segment.motion);
                    }
                    let exact = candidate.by_pressure(state, &mut counts).unwrap();
                    assert!((slopes.by_pressure / exact - 1.0).abs() <= 1e-7, "{:?}", segment.motion);
                    compared += 1;
                }
            }
        }
        assert!(compared > 100, "{compared}");
    }

    #[test]
    fn slopes_of_a_wound_bender_are_the_exact_derivatives() {
        let mut counts = Counts::default();
        let hoops = (0..20).flat_map(|seed| wide_line(seed).segments().to_vec());
        let winding = Winding {
            families: Families::Two,
            modulus_pa: 361e6,
            placement: Placement::Sheet,
            thickness_m: 0.178e-3,
            wall_share: 0.7,
        };
        let wound = hoops.filter(|segment| segment.motion == Motion::Bending).map(|mut segment| {
            segment.winding = Some(winding);
            segment
        });
        for segment in wound.take(3) {
            for place in [[0.4, 0.7, 0.3, 0.1], [0.0, 1.0, 1.0, 0.6]] {
                let candidate = Candidate::new(&segment, &place).unwrap();
                let states = [0.1, 0.3].map(|bend_rad| candidate.inverse(bend_rad, &mut counts).unwrap());
                let found = slopes(&candidate, &place, &states, true, &mut counts).unwrap();
                for (slopes, state) in found.iter().zip(&states) {
                    let exact = candidate.by_place(state, &mut counts).unwrap();
                    let most = exact.iter().fold(0.0, |most: f64, slope| most.max(slope.abs()));
                    for (found, exact) in slopes.by_place.iter().zip(exact) {
                        assert!((found - exact).abs() <= 1e-7 * most, "{place:?}: {found} {exact}");
                    }
                }
            }
        }
    }
}
