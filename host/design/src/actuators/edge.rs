//! The edge of the geometries that have no limit point.
//!
//! A limit point may vanish at a finite pressure: a little less fiber angle, and the pressure rises with the deformation throughout. The
//! solver tells only on which side of that edge a geometry is. So halving finds it, and its slopes `dx_k/dx_j` are one-sided differences.

use super::actuator::{Candidate, Cap, Counts};
use super::problem::Segment;

/// A local solve within this distance of an edge has been stopped by it, as a share of the box.
const NEAR: f64 = 1e-3;
/// First distance at which the other side is looked for, and its growth.
const ASIDE: f64 = 1e-8;
const FARTHER: f64 = 8.0;
/// Distance of both sides at the end ...
const SAME: f64 = 1e-9;
/// ... and for slopes.
const SAME_FOR_SLOPES: f64 = 4e-9;
/// Width of a difference.
const WIDTH: f64 = 1e-4;
/// A limit point is looked for up to so many times the pressure that matters: farther along the branch the solver takes long.
const AHEAD: f64 = 1.5;
/// The following variable by preference: the limit point depends most on the angle, then on the wall.
const FOLLOWING: [usize; 3] = [3, 1, 0];
/// Halvings of an interval of a grid.
const HALVINGS: usize = 20;
/// Largest cap beside an edge, as a share of the highest pressure: the limit point does not pass the highest pressure there, it vanishes.
const BELOW: f64 = 0.999;

/// The edge of one segment: a variable that follows from the others.
pub(super) struct Edge<'a> {
    segment: &'a Segment,
    /// The variable that follows ...
    pub(super) follows: usize,
    /// ... and the direction in which there is a limit point: 1 or -1.
    outwards: f64,
    /// Limit points are looked for up to this pressure, Pa.
    pressure_pa: f64,
    /// A geometry near or on the edge, and the slopes of the edge there by each variable, 0 where they are not known.
    pub(super) last: Vec<f64>,
    pub(super) slopes: Vec<f64>,
}

impl<'a> Edge<'a> {
    /// The edge that stops a local solve: the geometry has no limit point, but one beside it has, below a pressure in use.
    pub(super) fn beside(
        segment: &'a Segment,
        place: &[f64],
        used_pa: f64,
        highest_pa: f64,
        counts: &mut Counts,
    ) -> Option<Self> {
        let is_variable = |axis: &usize| *axis < place.len() && segment.axis(*axis)[1] > 0.0;
        let ways = FOLLOWING.into_iter().filter(is_variable).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]);
        for (follows, outwards) in ways {
            let (last, slopes) = (place.to_vec(), vec![0.0; place.len()]);
            let mut edge = Self { segment, follows, outwards, pressure_pa: 0.0, last, slopes };
            edge.look_ahead(used_pa, highest_pa);
            let (mut there, x) = (place.to_vec(), place[follows]);
            let beside = Some(x + outwards * NEAR).filter(|x| (0.0..=1.0).contains(x));
            let cap = beside.and_then(|x| edge.cap(&mut there, x, counts)).flatten();
            let is_below = cap.is_some_and(|cap| cap.limit.is_some() && cap.pressure_pa < used_pa);
            if is_below && edge.is_free(&mut there, x, counts) == Some(true) {
                return Some(edge);
            }
        }
        None
    }

    /// Looks for limit points as far as a pressure in use makes necessary.
    pub(super) fn look_ahead(&mut self, used_pa: f64, highest_pa: f64) {
        self.pressure_pa = highest_pa.min(AHEAD * used_pa);
    }

    /// The cap with the variable that follows at `x`; `None` where the solver gives up.
    fn cap(&self, place: &mut [f64], x: f64, counts: &mut Counts) -> Option<Option<Cap>> {
        place[self.follows] = x;
        Candidate::new(self.segment, place)?.cap_below(self.pressure_pa, counts)
    }

    /// Whether there is no limit point, for certain, with the variable that follows at `x`; `None` beyond its bounds.
    fn is_free(&self, place: &mut [f64], x: f64, counts: &mut Counts) -> Option<bool> {
        (0.0..=1.0).contains(&x).then_some(())?;
        Some(self.cap(place, x, counts).is_some_and(|cap| cap.is_none_or(|cap| cap.limit.is_none())))
    }

    /// Moves the variable that follows to the edge, on the side without a limit point.
    pub(super) fn meet(&self, place: &mut [f64], counts: &mut Counts) -> Option<()> {
        self.meet_within(SAME, place, counts)
    }

    /// The same, until both sides are as near to each other as stated.
    fn meet_within(&self, same: f64, place: &mut [f64], counts: &mut Counts) -> Option<()> {
        let moved = (0..place.len()).map(|axis| self.slopes[axis] * (place[axis] - self.last[axis]));
        let start = (self.last[self.follows] + moved.sum::<f64>()).clamp(0.0, 1.0);
        let begins = self.is_free(place, start, counts)?;
        let towards = if begins { self.outwards } else { -self.outwards };
        let (mut here, mut aside) = (start, ASIDE);
        let mut there = start + towards * aside;
        while self.is_free(place, there, counts)? == begins {
            aside *= FARTHER;
            (here, there) = (there, start + towards * aside);
        }
        while (there - here).abs() > same {
            let middle = 0.5 * (here + there);
            if self.is_free(place, middle, counts)? == begins { here = middle } else { there = middle }
        }
        place[self.follows] = if begins { here } else { there };
        Some(())
    }

    /// Finds the slopes at a geometry on the edge.
    pub(super) fn find_slopes(&mut self, place: &[f64], counts: &mut Counts) -> Option<()> {
        self.last = place.to_vec();
        let mut slopes = vec![0.0; place.len()];
        for (axis, slope) in slopes.iter_mut().enumerate() {
            // The length moves no limit point.
            if axis == self.follows || axis == 2 || self.segment.axis(axis)[1] == 0.0 {
                continue;
            }
            let by = if place[axis] > 0.5 { -WIDTH } else { WIDTH };
            let mut there = place.to_vec();
            there[axis] += by;
            self.meet_within(SAME_FOR_SLOPES, &mut there, counts)?;
            *slope = (there[self.follows] - place[self.follows]) / by;
        }
        self.slopes = slopes;
        Some(())
    }
}

/// The side without a limit point of an edge between a geometry without one and one with a cap; `None` where the limit point does not
/// vanish there.
pub(super) fn between(
    segment: &Segment,
    [mut free, mut bounded]: [Vec<f64>; 2],
    mut cap_pa: f64,
    highest_pa: f64,
    counts: &mut Counts,
) -> Option<Vec<f64>> {
    for _ in 0..HALVINGS {
        let middle: Vec<f64> = free.iter().zip(&bounded).map(|(a, b)| 0.5 * (a + b)).collect();
        match Candidate::new(segment, &middle)?.cap_below(highest_pa.min(AHEAD * cap_pa), counts)? {
            Some(Cap { pressure_pa, limit: Some(_) }) => (bounded, cap_pa) = (middle, pressure_pa),
            _ => free = middle,
        }
    }
    (cap_pa < BELOW * highest_pa).then_some(free)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuators::kinds::wide_line;

    #[test]
    fn pressure_rises_throughout_on_one_side_of_an_edge_alone() {
        let problem = wide_line(12);
        let segment = &problem.segments()[0];
        let mut counts = Counts::default();
        for (inner, wall) in [(0.1, 0.3), (0.08, 0.45), (0.3, 0.2)] {
            let sides = [0.75, 1.0].map(|angle| vec![inner, wall, 0.5, angle]);
            let free = between(segment, sides, 120e3, 120e3, &mut counts).unwrap();
            let mut bounded = free.clone();
            bounded[3] += 1e-4;
            // Radii at which the pressure is the next one in turn: beyond a limit point there is none.
            let rising = |place: &[f64]| {
                let candidate = Candidate::new(segment, place).unwrap();
                let radius_m = |index: i32| candidate.geometry.outer_radius_m * 1.05_f64.powi(index);
                let states = (1..55).map(|index| candidate.inverse(radius_m(index), &mut Counts::default()));
                let mut before_pa = 0.0;
                let is_higher = |state: &Option<fra_model::State<f64>>| {
                    let pressure_pa = state.as_ref().map_or(f64::NAN, |state| state.pressure_pa);
                    pressure_pa > std::mem::replace(&mut before_pa, pressure_pa)
                };
                states.take_while(is_higher).count()
            };
            assert_eq!(rising(&free), 54, "{inner} {wall}");
            assert!((20..50).contains(&rising(&bounded)), "{inner} {wall}: {}", rising(&bounded));
        }
    }

    #[test]
    fn edge_is_met_and_its_slopes_are_its_secants() {
        let problem = wide_line(12);
        let segment = &problem.segments()[0];
        let mut counts = Counts::default();
        let on_edge = |inner: f64, wall: f64, counts: &mut Counts| {
            let sides = [0.75, 1.0].map(|angle| vec![inner, wall, 0.5, angle]);
            between(segment, sides, 120e3, 120e3, counts).unwrap()
        };
        let place = on_edge(0.1, 0.4, &mut counts);
        let mut edge = Edge::beside(segment, &place, 119e3, 120e3, &mut counts).unwrap();
        let mut met = place.clone();
        edge.meet(&mut met, &mut counts).unwrap();
        // The grid's halving ends at a quarter over 2^20.
        assert!((met[3] - place[3]).abs() < 5e-7, "{met:?} {place:?}");
        edge.find_slopes(&met, &mut counts).unwrap();
        let secant = |by: [f64; 2], counts: &mut Counts| {
            let [below, above] = [-1.0, 1.0].map(|sign| on_edge(0.1 + sign * by[0], 0.4 + sign * by[1], counts)[3]);
            (above - below) / 2e-2
        };
        let secants = [secant([1e-2, 0.0], &mut counts), secant([0.0, 1e-2], &mut counts)];
        for (slope, secant) in edge.slopes.iter().zip(secants) {
            assert!((slope / secant - 1.0).abs() < 0.02, "{slope} {secant}");
        }
    }
}
