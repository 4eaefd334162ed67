//! A tube beside the axis of a bundle whose plates turn against each other.
//!
//! Plates that turn by `t` slide the ends of a tube at the radius `a` against each other by the chord `c = 2 a sin(t/2)`; both ends stay
//! parallel to their plates. The tube bends to an S and its wall shears, and the force `F` along the chord holds the plates back with the
//! moment `a F cos(t/2)`. With a tube `h` long between the plates the leans by bending and by shear are
//!
//! ```text
//! b = F h^2/(12 EI),   s = F/GA,   r = s/b
//! c/h = (1 + r) b + c3 b^3 + c5 b^5
//! H/h = 1 - (3/5 + r) b^2 + ...
//! ```
//!
//! where `H` is the distance of the plates and all stiffnesses are those of the tube as it is stretched: to first order
//! `1/K = h/GA + h^3/(12 EI)`. The coefficients expand the shape that takes the least energy, of a rod whose shear force is along its sections
//! (Haringx); the moment in a leaning tube bends it out of the plane of the S, which adds `12/5 (a cos(t/2)/h)^2` to `c3`. No pressure beside
//! the stiffnesses counts: the thrust on the ends of a tube without an axial force is in balance with the pull in its wall.
//!
//! Plates that slide against each other by `g` per length add `g . e` to the chord, with the direction `e` of the lean, and turn the chord
//! where they slide across it. At one chord an axial force `N` moves `b` against `s`: the tube yields by `N (c/h - 4/5 b)^2/((1 + r) GA)` more. Plates that bend by `u` pull a tube at `r` by `-(u . r) cos(t/2)` and turn it by `b (u . r)/a` about its leaning
//! axis. So bends and slides of leaning tubes are coupled, and such a bundle bends more easily the more it is twisted.

use nalgebra::{Matrix2, Matrix4, Matrix6, SMatrix, Vector2, Vector3, Vector4, Vector6};

use super::bundle::{mean_nm2, slide_n};
use super::tube::Tangent;

/// Slide over the distance of the plates beyond which the series are of no use.
const SLIDE_MAX: f64 = 0.6;
/// Iterations for a lean, for the stretch of a tube, and for the equilibrium of a bundle; and the change at which they end.
const ITERATIONS: usize = 60;
const CONVERGED: f64 = 1e-13;
/// Slide over the distance of the plates below which a tube stands upright.
const UPRIGHT: f64 = 1e-7;
/// Steps of differences: of a stretch, and of a turn of plates, rad.
const STEPS: [f64; 2] = [1e-5, 1e-5];

/// A tube between plates that are turned against each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leaning {
    /// Mean stretch of the tube, which leans and is longer than the distance of the plates.
    pub(crate) stretch: f64,
    /// Its derivatives by the stretch, by the twist, rad/m, and by the slide of the plates per length along the lean.
    by_stretch: f64,
    by_twist_m: f64,
    by_slide: f64,
    /// Stretch by the lean by bending at one chord, where the lean by shear changes as much; and the slope of the force against that, N.
    longer: f64,
    longer_by: [f64; 3],
    bend_n: f64,
    /// Lean by shear over that by bending.
    pub(crate) shear: f64,
    /// Lean by bending, and its derivatives by the same.
    pub(crate) bend: f64,
    bend_by: [f64; 3],
    /// Twist along the tube, rad per length at rest.
    pub(crate) twist_rad_per_m: f64,
    /// Slide of its ends over the distance of the plates.
    pub(crate) slide: f64,
    /// Mean axial force in it that comes from the slide, N.
    pub(crate) pull_n: f64,
    /// Force along the slide, N.
    force_n: f64,
    /// Moment about the axis of the bundle that the slide takes, N m.
    pub(crate) moment_nm: f64,
}

impl Leaning {
    /// A tube at a radius, m, with plates `bay_m` apart at rest, where the bundle has a stretch and a twist, rad/m.
    ///
    /// `None` where it would lean too far for the series.
    pub(crate) fn of(tube: &Tangent, radius_m: f64, bay_m: f64, stretch: f64, twist_rad_per_m: f64) -> Option<Self> {
        Self::slid(tube, radius_m, bay_m, stretch, twist_rad_per_m, 0.0)
    }

    /// The same where the plates slide against each other along the lean, by `along` per length at rest.
    fn slid(tube: &Tangent, radius_m: f64, bay_m: f64, stretch: f64, twist_rad_per_m: f64, along: f64) -> Option<Self> {
        let chord_at = |turn_rad: f64| 2.0 * radius_m * (0.5 * turn_rad).sin() + along * bay_m;
        let arm_at = |turn_rad: f64| radius_m * (0.5 * turn_rad).cos();
        let turn_rad = twist_rad_per_m * bay_m;
        let (chord_m, arm_m) = (chord_at(turn_rad), arm_at(turn_rad));
        let slide = chord_m / (stretch * bay_m);
        (stretch > 0.0 && slide.abs() <= SLIDE_MAX).then_some(())?;
        // Distance of the plates over the length of the tube, with its lean and the lean by bending per force.
        let leant = |own: f64, chord_m: f64, arm_m: f64, near: Option<f64>| {
            let long_m = own * bay_m;
            let bent = long_m * bay_m / (12.0 * mean_nm2(tube));
            let series = Series::new(1.0 / (tube.shear_n * own * bent), arm_m / long_m);
            let bend = series.bend(chord_m / long_m, near)?;
            Some((series.height(bend), bend, bent, series))
        };
        let (mut own, mut last, mut near) = (stretch, None, None);
        for _ in 0..ITERATIONS {
            let (height, bend, bent, series) = leant(own, chord_m, arm_m, near)?;
            near = Some(bend);
            let short = stretch - own * height;
            // A secant from the second step on.
            let by_own = last
                .map_or(height, |(own_before, short_before): (f64, f64)| (short_before - short) / (own - own_before));
            let next = own + short / by_own;
            if (next - own).abs() > CONVERGED {
                last = Some((own, short));
                own = next;
                continue;
            }
            let force_n = bend / bent;
            let [step, turned] = STEPS;
            let longer = |own: f64, chord_m: f64, bend: f64| {
                own * (chord_m / (own * bay_m) - 0.8 * bend) / (1.0 + 0.4 * bend * bend)
            };
            let at = |own: f64, chord_m: f64, arm_m: f64| {
                let (height, bend, ..) = leant(own, chord_m, arm_m, near)?;
                Some(Vector3::new(height, bend, longer(own, chord_m, bend)))
            };
            let slope = |more: Option<Vector3<f64>>, less: Option<Vector3<f64>>, step: f64| {
                Some((more? - less?) / (2.0 * step))
            };
            let turn = |by: f64| at(own, chord_at(turn_rad + by), arm_at(turn_rad + by));
            let slide = |by: f64| at(own, chord_m + by * bay_m, arm_m);
            let more = |by: f64| at(own + by, chord_m, arm_m);
            let of_own = slope(more(step), more(-step), step)?;
            let of_turn = slope(turn(turned), turn(-turned), turned)?;
            let of_slide = slope(slide(step), slide(-step), step)?;
            let yields = height + own * of_own.x;
            let owns = [1.0, -own * of_turn.x * bay_m, -own * of_slide.x].map(|change| change / yields);
            let by = |axis: usize| {
                let direct = [0.0, of_turn[axis] * bay_m, of_slide[axis]];
                [0, 1, 2].map(|strain: usize| direct[strain] + of_own[axis] * owns[strain])
            };
            let chord = chord_m / (own * bay_m);
            return Some(Self {
                stretch: own,
                by_stretch: owns[0],
                by_twist_m: owns[1],
                by_slide: owns[2],
                longer: longer(own, chord_m, bend),
                longer_by: by(2),
                bend_n: own * (1.0 + 1.0 / series.shear) / bent,
                shear: series.shear,
                bend,
                bend_by: by(1),
                twist_rad_per_m: twist_rad_per_m + 2.4 * series.arm * bend.powi(3) / bay_m,
                slide: chord_m / (stretch * bay_m),
                pull_n: force_n * (chord - series.shear * bend),
                force_n,
                moment_nm: force_n * arm_m,
            });
        }
        None
    }
}

/// Slide and height of a tube by its lean `b`, over its length.
struct Series {
    /// `r`, and `a cos(t/2)/h`.
    shear: f64,
    arm: f64,
    slide: [f64; 3],
    height: [f64; 3],
}

impl Series {
    /// By `r` and `a cos(t/2)/h`.
    fn new(shear: f64, arm: f64) -> Self {
        let r = shear;
        Self {
            shear,
            arm,
            slide: [
                1.0 + r,
                -36.0 / 35.0 + r * -2.4 + 2.4 * arm * arm,
                3807.0 / 1925.0 + r * (54.0 / 7.0 + r * 153.0 / 35.0),
            ],
            height: [
                -(0.6 + r),
                36.0 / 35.0 + r * (114.0 / 35.0 + r * 1.2),
                -(57_402.0 / 25_025.0 + r * (837.0 / 77.0 + r * (372.0 / 35.0 + r * 51.0 / 35.0))),
            ],
        }
    }

    /// The lean by bending at a slide, found from one that is near; `None` where a larger lean would slide less.
    fn bend(&self, slide: f64, near: Option<f64>) -> Option<f64> {
        let [first, third, fifth] = self.slide;
        let mut bend = near.unwrap_or(slide / first);
        for _ in 0..ITERATIONS {
            let square = bend * bend;
            let off = bend * (first + square * (third + square * fifth)) - slide;
            let slope = first + square * (3.0 * third + square * 5.0 * fifth);
            if slope <= 0.0 {
                return None;
            }
            bend -= off / slope;
            if (off / slope).abs() <= CONVERGED {
                return Some(bend);
            }
        }
        None
    }

    fn height(&self, bend: f64) -> f64 {
        let [first, second, third] = self.height;
        let square = bend * bend;
        1.0 + square * (first + square * (second + square * third))
    }
}

/// A tube at its place in the section, m.
type Placed = ([f64; 2], Tangent);

/// Strains of a bundle: stretch, bends, twist, and slides of its plates, per length at rest.
type Strain = Vector6<f64>;

/// A tube where plates slide across its lean.
struct Across {
    force_n: Option<f64>,
    by_bend_nm: f64,
    bend_nm2: f64,
}

/// Forces that a tube needs by the strains of its bundle: stretch, twist, slide along the lean, and `u . r`, by which its plates bend. N, N m, N, N.
///
/// Further the stiffness across the lean, N, unless the tube stands upright, and that force by the bend of the plates along the lean, N m.
fn wrench(tube: &Tangent, radius_m: f64, bay_m: f64, at: Vector4<f64>) -> Option<(Vector4<f64>, Across)> {
    let [stretch, twist, along, bent] = <[f64; 4]>::from(at);
    let (sin, cos) = (0.5 * twist * bay_m).sin_cos();
    let leaning = Leaning::slid(tube, radius_m, bay_m, stretch - bent * cos, twist, along)?;
    let per_m = if radius_m > 0.0 { 1.0 / radius_m } else { 0.0 };
    let turned = bent * per_m;
    // Stretch and twist of the tube beyond its free shape, and force and torque there.
    let strain = Vector2::new(
        leaning.stretch - tube.stretch,
        leaning.twist_rad_per_m + turned * leaning.bend - tube.twist_rad_per_m,
    );
    let springs = Matrix2::new(tube.axial_n, tube.coupling_nm, tube.coupling_nm, tube.torsion_nm2);
    // Sections lean by `b` in the mean and by more in the middle, where an axial force shears the wall; it also bends an S, which is not straight.
    let long_m = leaning.stretch * bay_m;
    let square = leaning.bend * leaning.bend;
    let uneven = 0.2 / tube.shear_n + long_m * long_m / (700.0 * mean_nm2(tube));
    let yields = springs.try_inverse()?;
    let strain = strain - yields * Vector2::new(leaning.pull_n, 0.0);
    let springs = (yields + Matrix2::new(uneven * square, 0.0, 0.0, 0.0)).try_inverse()?;
    // At one chord the lean by bending is such that it takes the least energy.
    let by_bend = Vector2::new(leaning.longer, turned);
    let pulled = springs * strain;
    let bent_more = -by_bend.dot(&pulled) / (leaning.bend_n + by_bend.dot(&(springs * by_bend)));
    let bend = leaning.bend + bent_more;
    // A force on the plates also works on the lean: it stretches a tube that it does not let shorten.
    let [carried_n, torque_nm] = <[f64; 2]>::from(pulled + springs * by_bend * bent_more);
    let [by_stretch, by_twist, by_slide] = [0, 1, 2].map(|strain: usize| {
        let by_bend = torque_nm * turned - carried_n * carried_n * uneven * leaning.bend;
        by_bend * leaning.bend_by[strain] + carried_n * bent_more * leaning.longer_by[strain]
    });
    let axial_n = carried_n * leaning.by_stretch + by_stretch;
    let found = Vector4::new(
        axial_n,
        torque_nm + leaning.moment_nm + carried_n * leaning.by_twist_m + by_twist + 0.5 * axial_n * bent * sin * bay_m,
        leaning.force_n + carried_n * leaning.by_slide + by_slide,
        torque_nm * bend * per_m - axial_n * cos,
    );
    let chord = leaning.slide * (at.x - bent * cos);
    let force_n = (chord.abs() > UPRIGHT).then(|| (leaning.force_n + carried_n * leaning.by_slide) / chord);
    let (by_bend_nm, bend_nm2) = (-torque_nm * leaning.bend_by[2], -torque_nm * torque_nm / leaning.bend_n);
    Some((found, Across { force_n, by_bend_nm, bend_nm2 }))
}

/// Derivatives of [`wrench`], by differences.
fn stiffness(tube: &Tangent, radius_m: f64, bay_m: f64, at: Vector4<f64>) -> Option<Matrix4<f64>> {
    let mut found = Matrix4::zeros();
    for (axis, step) in [STEPS[0], STEPS[1] / bay_m, STEPS[0], STEPS[0]].into_iter().enumerate() {
        let mut by = Vector4::zeros();
        by[axis] = step;
        let slope = wrench(tube, radius_m, bay_m, at + by)?.0 - wrench(tube, radius_m, bay_m, at - by)?.0;
        found.set_column(axis, &(slope / (2.0 * step)));
    }
    Some(0.5 * (found + found.transpose()))
}

/// Shape without load of twisting tubes at places of the section, m, with plates `bay_m` apart at rest, and the stiffness there, per length at rest.
///
/// `start` is a shape near it. One tube stands for all of its circle, whose plates neither bend nor slide. `None` where there is no stable equilibrium, or tubes
/// would lean too far.
pub(super) fn equilibrium(tubes: &[Placed], bay_m: f64, start: Option<&Strain>) -> Option<(Strain, Matrix6<f64>)> {
    let sum = |of: &dyn Fn(&Placed) -> f64| tubes.iter().map(of).sum::<f64>();
    let stretch = sum(&|(_, tube): &Placed| tube.stretch) / tubes.len() as f64;
    let held = |(place, tube): &Placed| {
        let slide = slide_n(tube, mean_nm2(tube), tube.stretch * bay_m);
        tube.torsion_nm2 + slide * (place[0] * place[0] + place[1] * place[1])
    };
    let twist = sum(&|(_, tube): &Placed| tube.torsion_nm2 * tube.twist_rad_per_m) / sum(&held);
    let mut shape = start.copied().unwrap_or(Strain::new(stretch, 0.0, 0.0, twist, 0.0, 0.0));
    let mut found = forces(tubes, bay_m, &shape)?;
    for _ in 0..ITERATIONS {
        let (force, stiffness) = found;
        let step = -stiffness.cholesky()?.solve(&force);
        // A step over the range of the series is shortened.
        let shortened = (0..8).map(|halvings| step * 0.5_f64.powi(halvings));
        let (next, at) = shortened
            .map(|step| shape + step)
            .find_map(|next| forces(tubes, bay_m, &next).map(|found| (next, found)))?;
        (shape, found) = (next, at);
        let rates = step.fixed_rows::<3>(1).amax() * bay_m;
        if step.x.abs().max(step.fixed_rows::<2>(4).amax()).max(rates) <= CONVERGED {
            break;
        }
    }
    found.1.cholesky()?;
    Some((shape, found.1))
}

/// The same of springs that have forces and slopes of the tubes at a strain of the bundle.
pub(super) fn tangent(tubes: &[Placed], bay_m: f64, strain: &Strain) -> Option<(Strain, Matrix6<f64>)> {
    let (force, stiffness) = forces(tubes, bay_m, strain)?;
    Some((strain - stiffness.cholesky()?.solve(&force), stiffness))
}

/// Forces of all tubes on the strains of their bundle, and their derivatives.
fn forces(tubes: &[Placed], bay_m: f64, shape: &Strain) -> Option<(Strain, Matrix6<f64>)> {
    let (mut force, mut all) = (Strain::zeros(), Matrix6::zeros());
    for ([x, y], tube) in tubes {
        let radius_m = x.hypot(*y);
        let [out_x, out_y] = if radius_m > 0.0 { [x / radius_m, y / radius_m] } else { [1.0, 0.0] };
        let mut by = SMatrix::<f64, 4, 6>::zeros();
        (by[(0, 0)], by[(1, 3)]) = (1.0, 1.0);
        (by[(2, 4)], by[(2, 5)]) = (-out_y, out_x);
        (by[(3, 1)], by[(3, 2)]) = (*x, *y);
        let at = by * shape;
        let (own, across) = wrench(tube, radius_m, bay_m, at)?;
        let slope = stiffness(tube, radius_m, bay_m, at)?;
        let mut more = Matrix6::from_diagonal(&Strain::new(0.0, tube.bending_nm2, tube.across_nm2, 0.0, 0.0, 0.0));
        let outwards = Strain::new(0.0, 0.0, 0.0, 0.0, out_x, out_y);
        let along = Strain::new(0.0, -out_y, out_x, 0.0, 0.0, 0.0);
        more += outwards * outwards.transpose() * across.force_n.unwrap_or(slope[(2, 2)]);
        more += (outwards * along.transpose() + along * outwards.transpose()) * across.by_bend_nm;
        more += along * along.transpose() * across.bend_nm2;
        force += by.tr_mul(&own) + more * shape;
        all += by.tr_mul(&(slope * by)) + more;
    }
    if tubes.len() == 1 {
        for axis in [1, 2, 4, 5] {
            all.row_mut(axis).fill(0.0);
            all.column_mut(axis).fill(0.0);
            (all[(axis, axis)], force[axis]) = (1.0, 0.0);
        }
    }
    Some((force, all))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tube() -> Tangent {
        Tangent {
            stretch: 1.0203,
            bend_rad_per_m: 0.0,
            twist_rad_per_m: 4.66,
            axial_n: 963.0,
            bending_nm2: 0.246,
            across_nm2: 0.246,
            torsion_nm2: 0.547,
            coupling_nm: 3.43,
            shear_n: 318.0,
            outer_radius_m: 0.0268,
        }
    }

    /// The forces are slopes of an energy: their own slopes are symmetric.
    #[test]
    fn forces_are_those_of_an_energy() {
        for at in [
            Vector4::new(1.0188, 2.57, 0.0, 0.0),
            Vector4::new(1.03, 2.4, 0.004, 0.02),
            Vector4::new(1.01, 2.6, -0.006, -0.02),
        ] {
            let mut found = Matrix4::<f64>::zeros();
            for (axis, step) in [1e-5, 1e-5 / 0.12, 1e-5, 1e-5].into_iter().enumerate() {
                let mut by = Vector4::zeros();
                by[axis] = step;
                let side = |way: f64| wrench(&tube(), 0.06, 0.12, at + by * way).expect("a wrench").0;
                found.set_column(axis, &((side(1.0) - side(-1.0)) / (2.0 * step)));
            }
            for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
                let size = (found[(a, a)] * found[(b, b)]).sqrt();
                let odd = (found[(a, b)] - found[(b, a)]).abs();
                assert!(odd < 0.01 * size, "{a} {b}: {found:.4}");
            }
        }
    }
}
