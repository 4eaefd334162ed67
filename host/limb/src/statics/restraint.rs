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

use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};

use super::bundle::{mean_nm2, slide_n};
use super::tube::Tangent;

/// Slide over the distance of the plates beyond which the series are of no use.
const SLIDE_MAX: f64 = 0.6;
/// Iterations for a lean, for the stretch of a tube, and for the equilibrium of a bundle; and the change at which they end.
const ITERATIONS: usize = 60;
const CONVERGED: f64 = 1e-13;
/// Steps of differences: of a stretch, and of a turn of plates, rad.
const STEPS: [f64; 2] = [1e-5, 1e-5];

/// A tube between plates that are turned against each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leaning {
    /// Mean stretch of the tube, which leans and is longer than the distance of the plates.
    pub(crate) stretch: f64,
    /// Its derivatives by the stretch and by the twist, rad/m, of the bundle.
    by_stretch: f64,
    by_twist_m: f64,
    /// Twist along the tube, rad per length at rest.
    pub(crate) twist_rad_per_m: f64,
    /// Slide of its ends over the distance of the plates.
    pub(crate) slide: f64,
    /// Mean axial force in it that comes from the slide, N.
    pub(crate) pull_n: f64,
    /// Moment about the axis of the bundle that the slide takes, N m.
    pub(crate) moment_nm: f64,
}

impl Leaning {
    /// A tube at a radius, m, with plates `bay_m` apart at rest, where the bundle has a stretch and a twist, rad/m.
    ///
    /// `None` where it would lean too far for the series.
    pub(crate) fn of(tube: &Tangent, radius_m: f64, bay_m: f64, stretch: f64, twist_rad_per_m: f64) -> Option<Self> {
        let (sin, cos) = (0.5 * twist_rad_per_m * bay_m).sin_cos();
        let (chord_m, arm_m) = (2.0 * radius_m * sin, radius_m * cos);
        let slide = chord_m / (stretch * bay_m);
        (stretch > 0.0 && slide.abs() <= SLIDE_MAX).then_some(())?;
        // Distance of the plates over the length of the tube, with its lean and the lean by bending per force.
        let leant = |own: f64, chord_m: f64, arm_m: f64| {
            let long_m = own * bay_m;
            let bent = long_m * bay_m / (12.0 * mean_nm2(tube));
            let series = Series::new(1.0 / (tube.shear_n * own * bent), arm_m / long_m);
            let bend = series.bend(chord_m / long_m)?;
            Some((series.height(bend), bend, bent, series))
        };
        let mut own = stretch;
        for _ in 0..ITERATIONS {
            let (height, bend, bent, series) = leant(own, chord_m, arm_m)?;
            let next = stretch / height;
            if (next - own).abs() > CONVERGED {
                own = next;
                continue;
            }
            let force_n = bend / bent;
            let height_at = |own: f64, turn_rad: f64| {
                let (sin, cos) = (0.5 * turn_rad).sin_cos();
                leant(own, 2.0 * radius_m * sin, radius_m * cos).map(|(height, ..)| height)
            };
            let turn_rad = twist_rad_per_m * bay_m;
            let [step, turned] = STEPS;
            let by_own = (height_at(own + step, turn_rad)? - height_at(own - step, turn_rad)?) / (2.0 * step);
            let by_turn = (height_at(own, turn_rad + turned)? - height_at(own, turn_rad - turned)?) / (2.0 * turned);
            let yields = height + own * by_own;
            return Some(Self {
                stretch: own,
                by_stretch: 1.0 / yields,
                by_twist_m: -own * by_turn * bay_m / yields,
                twist_rad_per_m: twist_rad_per_m + 2.4 * series.arm * bend.powi(3) / bay_m,
                slide,
                pull_n: force_n * (chord_m / (own * bay_m) - series.shear * bend),
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

    /// The lean by bending at a slide; `None` where a larger lean would slide less.
    fn bend(&self, slide: f64) -> Option<f64> {
        let [first, third, fifth] = self.slide;
        let mut bend = slide / first;
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

/// Axial force, N, and moment about the axis of the bundle, N m, that a tube needs where the bundle has a stretch at its place and a twist.
fn wrench(tube: &Tangent, radius_m: f64, bay_m: f64, at: Vector2<f64>) -> Option<Vector2<f64>> {
    let leaning = Leaning::of(tube, radius_m, bay_m, at.x, at.y)?;
    let (stretch, twist) = (leaning.stretch - tube.stretch, leaning.twist_rad_per_m - tube.twist_rad_per_m);
    // A force on the plates also works on the lean: it stretches a tube that it does not let shorten.
    let carried_n = tube.axial_n * stretch + tube.coupling_nm * twist - leaning.pull_n;
    let torque_nm = tube.coupling_nm * stretch + tube.torsion_nm2 * twist + leaning.moment_nm;
    Some(Vector2::new(carried_n * leaning.by_stretch, torque_nm + carried_n * leaning.by_twist_m))
}

/// Derivatives of [`wrench`], by differences.
fn stiffness(tube: &Tangent, radius_m: f64, bay_m: f64, at: Vector2<f64>) -> Option<Matrix2<f64>> {
    let mut found = Matrix2::zeros();
    for (axis, step) in [STEPS[0], STEPS[1] / bay_m].into_iter().enumerate() {
        let mut by = Vector2::zeros();
        by[axis] = step;
        let slope = wrench(tube, radius_m, bay_m, at + by)? - wrench(tube, radius_m, bay_m, at - by)?;
        found.set_column(axis, &(slope / (2.0 * step)));
    }
    Some(0.5 * (found + found.transpose()))
}

/// Shape without load of twisting tubes at places of the section, m, with plates `bay_m` apart at rest, and the stiffness there: by stretch, bends and
/// twist, per length at rest.
///
/// `start` is a shape near it. `None` where there is no stable equilibrium, or tubes would lean too far.
pub(super) fn equilibrium(
    tubes: &[Placed],
    bay_m: f64,
    start: Option<&Vector4<f64>>,
) -> Option<(Vector4<f64>, Matrix4<f64>)> {
    let sum = |of: &dyn Fn(&Placed) -> f64| tubes.iter().map(of).sum::<f64>();
    let stretch = sum(&|(_, tube): &Placed| tube.stretch) / tubes.len() as f64;
    let held = |(place, tube): &Placed| {
        let slide = slide_n(tube, mean_nm2(tube), tube.stretch * bay_m);
        tube.torsion_nm2 + slide * (place[0] * place[0] + place[1] * place[1])
    };
    let twist = sum(&|(_, tube): &Placed| tube.torsion_nm2 * tube.twist_rad_per_m) / sum(&held);
    let mut shape = start.copied().unwrap_or(Vector4::new(stretch, 0.0, 0.0, twist));
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
        if step.x.abs() <= CONVERGED && step.fixed_rows::<3>(1).amax() * bay_m <= CONVERGED {
            break;
        }
    }
    found.1.cholesky()?;
    Some((shape, found.1))
}

/// The same of springs that have forces and slopes of the tubes at a strain of the bundle.
pub(super) fn tangent(tubes: &[Placed], bay_m: f64, strain: &Vector4<f64>) -> Option<(Vector4<f64>, Matrix4<f64>)> {
    let (force, stiffness) = forces(tubes, bay_m, strain)?;
    Some((strain - stiffness.cholesky()?.solve(&force), stiffness))
}

/// Forces of all tubes on stretch, bends and twist of their bundle, and their derivatives.
fn forces(tubes: &[Placed], bay_m: f64, shape: &Vector4<f64>) -> Option<(Vector4<f64>, Matrix4<f64>)> {
    let (mut force, mut all) = (Vector4::zeros(), Matrix4::zeros());
    for ([x, y], tube) in tubes {
        let arm = Vector4::new(1.0, -x, -y, 0.0);
        let turn = Vector4::new(0.0, 0.0, 0.0, 1.0);
        let at = Vector2::new(arm.dot(shape), shape.w);
        let radius_m = x.hypot(*y);
        let own = wrench(tube, radius_m, bay_m, at)?;
        let slope = stiffness(tube, radius_m, bay_m, at)?;
        let bends = Matrix4::from_diagonal(&Vector4::new(0.0, tube.bending_nm2, tube.across_nm2, 0.0));
        force += arm * own.x + turn * own.y + bends * shape;
        all += arm * arm.transpose() * slope[(0, 0)]
            + (arm * turn.transpose() + turn * arm.transpose()) * slope[(0, 1)]
            + turn * turn.transpose() * slope[(1, 1)]
            + bends;
    }
    Some((force, all))
}
