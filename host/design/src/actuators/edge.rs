//! The edge of the geometries that have no limit point.
//!
//! A limit point may vanish at a finite pressure: a little less fiber angle, and the pressure rises with the deformation throughout. At a
//! limit point the tangent stiffness `k` of the unloaded actuator at constant pressure is zero. On the edge it touches zero: it is least
//! there along its softest direction. So pressure, stretch, twist and one variable `x_k` of the geometry on the edge solve
//!
//! ```text
//! N = 0,     M = 0,     k = K_ll - K_lt K_tl/K_tt = 0,     dk/dl = 0 along dt = -K_tl/K_tt dl
//! ```
//!
//! by Newton's method, with force, torque and stiffness `K` of the blocked actuator. Derivatives of these four by the other variables give
//! the slopes `dx_k/dx_j` of the edge.

use nalgebra::{Matrix4, Vector4};

use super::actuator::{Candidate, Cap, Counts};
use super::problem::Segment;
use fra_model::Status;

/// A local solve within this distance of an edge has been stopped by it, as a share of the box.
const NEAR: f64 = 1e-3;
/// Halvings of that distance for the start of Newton's method: the stretch of the limit point goes with the root of the distance.
const NEARER: usize = 5;
/// Distance from the edge of a geometry on it, on the side without a limit point.
const ASIDE: f64 = 1e-9;
/// A step of Newton's method that is shorter ends it ...
const LAST_STEP: f64 = 1e-11;
/// ... and so does this number of steps. A step of the stretch above `SHORT` takes new derivatives, and `LONGEST` bounds it.
const STEPS: usize = 16;
const SHORT: f64 = 1e-4;
const LONGEST: f64 = 3e-3;
/// Most change of the pressure, as a share, and of the variable that follows on the way.
const FAR: f64 = 0.3;
/// Where Newton's method fails, it solves geometries on the way first: it halves the way at most this many times.
const APPROACHES: usize = 3;
/// Width of the difference for the softening, as a share of the stretch ...
const WIDTH_OF_SOFTENING: f64 = 1e-4;
/// ... and for derivatives of the conditions, of the pressure as a share.
const WIDTH: f64 = 1e-6;
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
    /// The geometry that was met last, or one near the edge ...
    last: Vec<f64>,
    /// ... and where its limit point vanishes: pressure, Pa, axial stretch, twist, rad, and the variable that follows.
    solution: Vector4<f64>,
    /// Inverse of the derivatives of the conditions by these four.
    inverse: Option<Matrix4<f64>>,
    /// Derivatives of the four by each variable, 0 where they are not known.
    slopes: Vec<Vector4<f64>>,
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
        let pressure_pa = highest_pa.min(AHEAD * used_pa);
        for (follows, outwards) in ways {
            let mut limit_at = |x: f64| {
                let mut there = place.to_vec();
                there[follows] = Some(x).filter(|x| (0.0..=1.0).contains(x))?;
                let cap = Candidate::new(segment, &there)?.cap_below(pressure_pa, counts)??;
                cap.limit.filter(|_| cap.pressure_pa < used_pa).map(|limit| (x, limit))
            };
            let Some(mut bounded) = limit_at(place[follows] + outwards * NEAR) else { continue };
            let mut free = place[follows];
            for _ in 0..NEARER {
                let middle = 0.5 * (free + bounded.0);
                match limit_at(middle) {
                    Some(nearer) => bounded = nearer,
                    None => free = middle,
                }
            }
            if is_free(segment, place, pressure_pa, counts) {
                let (x, limit) = bounded;
                let solution = Vector4::new(limit.pressure_pa, limit.axial_stretch, limit.twist_rad, x);
                let slopes = vec![Vector4::zeros(); place.len()];
                return Some(Self {
                    segment,
                    follows,
                    outwards,
                    last: place.to_vec(),
                    solution,
                    inverse: None,
                    slopes,
                });
            }
        }
        None
    }

    /// The variable that follows, at the geometry that was met last.
    pub(super) fn value(&self) -> f64 {
        self.solution[3].clamp(0.0, 1.0)
    }

    /// `dx_k/dx_j`.
    pub(super) fn slope(&self, axis: usize) -> f64 {
        self.slopes[axis][3]
    }

    /// What vanishes on the edge: force, N, torque, N m, softest stiffness, N/m, and its slope by the stretch, N/m.
    fn conditions(&self, place: &[f64], solution: &Vector4<f64>, counts: &mut Counts) -> Option<Vector4<f64>> {
        let [pressure_pa, stretch, twist_rad, x] = (*solution).into();
        let mut place = place.to_vec();
        place[self.follows] = x;
        let candidate = Candidate::new(self.segment, &place)?;
        let mut held = |stretch: f64, twist_rad: f64| {
            counts.solves += 1;
            let held = candidate.actuator.blocked(pressure_pa, stretch, twist_rad).ok()?;
            (held.status == Status::Solved).then_some(held)
        };
        let here = held(stretch, twist_rad)?;
        let softest = |[[ll, lt], [tl, tt]]: [[f64; 2]; 2]| ll - lt * tl / tt;
        let turn = -here.stiffness[1][0] / here.stiffness[1][1] * candidate.geometry.length_m;
        let by = WIDTH_OF_SOFTENING * stretch;
        let mut beside = |by: f64| Some(softest(held(stretch + by, twist_rad + turn * by)?.stiffness));
        let softening = (beside(by)? - beside(-by)?) / (2.0 * by);
        Some(Vector4::new(here.force_n, here.torque_nm, softest(here.stiffness), softening))
    }

    /// Inverse of the derivatives of the conditions by pressure, stretch, twist and the variable that follows.
    fn invert(&self, place: &[f64], solution: &Vector4<f64>, counts: &mut Counts) -> Option<Matrix4<f64>> {
        let mut derivatives = Matrix4::zeros();
        for (index, width) in [WIDTH * solution[0], WIDTH, WIDTH, WIDTH].into_iter().enumerate() {
            let mut beside = |by: f64| {
                let mut there = *solution;
                there[index] += by;
                self.conditions(place, &there, counts)
            };
            derivatives.set_column(index, &((beside(width)? - beside(-width)?) / (2.0 * width)));
        }
        derivatives.try_inverse()
    }

    /// Moves the variable that follows to the edge, on the side without a limit point.
    pub(super) fn meet(&mut self, place: &mut [f64], counts: &mut Counts) -> Option<()> {
        self.approach(place, APPROACHES, counts)?;
        let x = self.solution[3] - self.outwards * ASIDE;
        place[self.follows] = Some(x).filter(|x| (0.0..=1.0).contains(x))?;
        Some(())
    }

    /// Solves the conditions at a geometry, if need be after the geometry halfway from the last one.
    fn approach(&mut self, place: &[f64], times: usize, counts: &mut Counts) -> Option<()> {
        if self.solve(place, counts).is_some() {
            return Some(());
        }
        let times = times.checked_sub(1)?;
        let middle: Vec<f64> = self.last.iter().zip(place).map(|(from, to)| 0.5 * (from + to)).collect();
        self.approach(&middle, times, counts)?;
        self.approach(place, times, counts)
    }

    /// Newton's method from the last solution, carried on by the slopes.
    fn solve(&mut self, place: &[f64], counts: &mut Counts) -> Option<()> {
        let moved = self.slopes.iter().zip(place.iter().zip(&self.last)).map(|(slope, (to, from))| slope * (to - from));
        let mut solution = moved.fold(self.solution, |solution, moved| solution + moved);
        for _ in 0..STEPS {
            let here = self.conditions(place, &solution, counts)?;
            let by_old = self.inverse.map(|inverse| inverse * here).filter(|step| step[1].abs() <= SHORT);
            let step = match by_old {
                Some(step) => step,
                None => {
                    let inverse = self.invert(place, &solution, counts)?;
                    self.inverse = Some(inverse);
                    inverse * here
                }
            };
            let step = step * (LONGEST / step[1].abs()).min(1.0);
            solution -= step;
            // Farther away is another limit point.
            let is_near =
                (solution[0] / self.solution[0] - 1.0).abs() <= FAR && (solution[3] - self.solution[3]).abs() <= FAR;
            is_near.then_some(())?;
            if step[3].abs() <= LAST_STEP {
                (self.last, self.solution) = (place.to_vec(), solution);
                return Some(());
            }
        }
        None
    }

    /// Finds the slopes at a geometry on the edge.
    pub(super) fn find_slopes(&mut self, place: &[f64], counts: &mut Counts) -> Option<()> {
        let mut place = place.to_vec();
        self.meet(&mut place, counts)?;
        let solution = self.solution;
        let inverse = self.invert(&place, &solution, counts)?;
        self.inverse = Some(inverse);
        for axis in 0..place.len() {
            // The length moves no limit point.
            if axis == self.follows || axis == 2 || self.segment.axis(axis)[1] == 0.0 {
                continue;
            }
            let mut beside = |by: f64| {
                let mut there = place.clone();
                there[axis] += by;
                self.conditions(&there, &solution, counts)
            };
            self.slopes[axis] = -inverse * (beside(WIDTH)? - beside(-WIDTH)?) / (2.0 * WIDTH);
        }
        Some(())
    }
}

/// Whether a geometry has no limit point below a pressure, for certain.
fn is_free(segment: &Segment, place: &[f64], pressure_pa: f64, counts: &mut Counts) -> bool {
    let cap = Candidate::new(segment, place).and_then(|candidate| candidate.cap_below(pressure_pa, counts));
    cap.is_some_and(|cap| cap.is_none_or(|cap| cap.limit.is_none()))
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
        // The solver finds the limit point on one side only.
        assert!(is_free(segment, &met, 120e3, &mut counts));
        edge.find_slopes(&met, &mut counts).unwrap();
        met[3] += 2.0 * ASIDE;
        assert!(!is_free(segment, &met, 120e3, &mut counts));
        for axis in 0..2 {
            let slope = edge.slope(axis);
            let [below, above] = [-1e-3, 1e-3].map(|by| {
                let mut there = met.clone();
                there[axis] += by;
                edge.meet(&mut there, &mut counts).unwrap();
                there[3]
            });
            let difference = (above - below) / 2e-3;
            assert!((slope / difference - 1.0).abs() < 1e-5, "{axis}: {slope} {difference}");
        }
        let secant = |by: [f64; 2], counts: &mut Counts| {
            let [below, above] = [-1.0, 1.0].map(|sign| on_edge(0.1 + sign * by[0], 0.4 + sign * by[1], counts)[3]);
            (above - below) / 2e-2
        };
        let secants = [secant([1e-2, 0.0], &mut counts), secant([0.0, 1e-2], &mut counts)];
        for (axis, secant) in secants.into_iter().enumerate() {
            let slope = edge.slope(axis);
            assert!((slope / secant - 1.0).abs() < 2e-3, "{slope} {secant}");
        }
    }
}
