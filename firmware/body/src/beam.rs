//! A piece of tube between two nodes: a corotational beam with cubic deflections, shear, and the bow's part in the stretch.
//!
//! The chord is the frame. The energy depends on the chord's length, on the slopes of both ends against the chord and on the twist only, so that
//! rigid motions do not change it. Forces on the nodes are its exact derivatives.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{ComplexField, Matrix3, RealField, Rotation3, SMatrix, SVector, Vector2, Vector3};

use crate::law::{Law, Main};

/// A point of a tube's axis with the frame of its section, `z` along the tube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) place: Vector3<f64>,
    pub(crate) turn: Matrix3<f64>,
}

impl Node {
    /// Moved by a shift and a turn vector, both in space.
    pub(crate) fn moved(&self, step: &SVector<f64, 6>) -> Self {
        let turn = Rotation3::new(Vector3::new(step[3], step[4], step[5]));
        Self { place: self.place + step.fixed_rows::<3>(0), turn: rotation(turn.matrix() * self.turn) }
    }

    /// As far beyond `middle` as that is from here.
    pub(crate) fn beyond(&self, middle: &Self) -> Self {
        let turn = middle.turn * self.turn.transpose() * middle.turn;
        Self { place: middle.place * 2.0 - self.place, turn: rotation(turn) }
    }
}

/// A product of rotations without the rounding that makes thousands of them drift away from one.
fn rotation(turn: Matrix3<f64>) -> Matrix3<f64> {
    turn * (Matrix3::identity() * 1.5 - turn.tr_mul(&turn) * 0.5)
}

/// Tube between two nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam<'a> {
    pub(crate) law: &'a Law,
    /// Length at rest, m.
    pub(crate) length_m: f64,
    pub(crate) pressure_pa: f64,
    /// Springs at the pressure, by [`Law::springs`].
    pub(crate) springs: [f64; 3],
}

/// Strains of a piece of tube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strain {
    pub(crate) stretch: f64,
    /// Mean rates of bend towards `x` and `y`, rad/m.
    pub(crate) bend_rad_per_m: [f64; 2],
    pub(crate) twist_rad_per_m: f64,
}

impl Strain {
    /// The strains of a law's potential.
    pub(crate) fn of(&self, main: Main) -> [f64; 2] {
        match main {
            Main::Stretch => [self.stretch - 1.0, 0.0],
            Main::Bend => [self.bend_rad_per_m[0], 0.0],
            Main::Twist => [self.stretch - 1.0, self.twist_rad_per_m],
        }
    }
}

/// Six numbers that do not change in a rigid motion: the chord's length, its slopes towards `x` and `y` against the first end, then
/// against the second, and the twist; or the derivatives of the energy by them.
type Local = SVector<f64, 6>;

/// Chord and slopes of a piece of tube in space.
struct Shape {
    local: Local,
    along: Vector3<f64>,
    /// Change of the slopes by a shift of the chord over its length, by end and axis.
    normals: [[Vector3<f64>; 2]; 2],
    /// Change of the twist by a turn of the second end.
    twists: Vector3<f64>,
}

/// Steps of the differences that give stiffnesses: m, rad, and strains.
const STEP: f64 = 1e-7;
/// Bow of a cubic deflection: `(2 a^2 - a b + 2 b^2)/30`, with the slopes of the ends.
const BOW: f64 = 1.0 / 30.0;

impl Beam<'_> {
    pub(crate) fn strain(&self, ends: [&Node; 2]) -> Strain {
        self.strain_of(&Shape::of(ends).local)
    }

    fn strain_of(&self, local: &Local) -> Strain {
        let [a, b] = slopes(local);
        let bend = (a - b) / self.length_m;
        Strain {
            stretch: local[0] * (1.0 + bow(&a, &b)) / self.length_m,
            bend_rad_per_m: [bend.x, bend.y],
            twist_rad_per_m: local[5] / self.length_m,
        }
    }

    /// Derivatives of the energy. `excess_pa` is the pressure that the memory takes at a deformation.
    fn gradient(&self, local: &Local, excess_pa: &impl Fn(f64) -> f64) -> Local {
        let strain = self.strain_of(local);
        let (chord_m, twist_rad) = (local[0], local[5]);
        let Law { main, ref potential, ref stiffness, .. } = *self.law;
        let left_pa = self.pressure_pa - excess_pa(self.law.deformation(strain.of(main), self.pressure_pa));
        let [towards, across, torsion] = self.springs;
        let [a, b] = slopes(local);
        // Loads of the mean strains: axial force, bending moments, torque.
        let straight = |axis: usize| [towards, across][axis] * strain.bend_rad_per_m[axis];
        let (axial_n, moments, torque_nm) = match main {
            Main::Stretch => {
                let [force, _] = potential.loads(strain.of(main), left_pa);
                (force, [straight(0), straight(1)], torsion * strain.twist_rad_per_m)
            }
            Main::Bend => {
                let [moment, _] = potential.loads(strain.of(main), left_pa);
                (stiffness.strip_n * (strain.stretch - 1.0), [moment, straight(1)], torsion * strain.twist_rad_per_m)
            }
            Main::Twist => {
                let [force, torque] = potential.loads(strain.of(main), left_pa);
                (force, [straight(0), straight(1)], torque)
            }
        };
        let by_bow = axial_n * chord_m * BOW;
        let mut by_slopes = [by_bow * (4.0 * a - b), by_bow * (4.0 * b - a)];
        let mut by_chord = axial_n * (1.0 + bow(&a, &b));
        for (axis, moment) in moments.into_iter().enumerate() {
            let bending = [towards, across][axis];
            // A stretched piece has the longer lever.
            let shear = 12.0 * bending / (stiffness.shear_n * chord_m * chord_m);
            let uneven = 3.0 * bending / ((1.0 + shear) * self.length_m) * (a[axis] + b[axis]);
            by_slopes[0][axis] += uneven + moment;
            by_slopes[1][axis] += uneven - moment;
            by_chord += uneven * (a[axis] + b[axis]) * shear / ((1.0 + shear) * chord_m);
        }
        // From the frame between the ends to those of the ends, which turn with half of the twist.
        let mut by_twist = torque_nm;
        let own = [(0, -0.5), (1, 0.5)].map(|(end, share)| {
            let slope = Vector2::new(local[1 + 2 * end], local[2 + 2 * end]);
            by_twist += share * by_slopes[end].dot(&turned(&slope, share * twist_rad + FRAC_PI_2));
            turned(&by_slopes[end], -share * twist_rad)
        });
        Local::new(by_chord, own[0].x, own[0].y, own[1].x, own[1].y, by_twist)
    }

    /// Forces and moments that hold the ends in place, N and N m, of the first end, then of the second, and their change by steps of the ends.
    ///
    /// The differences are of numbers that do not change in a rigid motion, so that their errors do not resist one.
    pub(crate) fn stiffness(
        &self,
        ends: [&Node; 2],
        excess_pa: &impl Fn(f64) -> f64,
    ) -> (SVector<f64, 12>, SMatrix<f64, 12, 12>) {
        let shape = Shape::of(ends);
        let gradient = self.gradient(&shape.local, excess_pa);
        let forces = shape.forces(&gradient);
        let mut own = SMatrix::<f64, 6, 6>::zeros();
        let mut by_ends = SMatrix::<f64, 12, 6>::zeros();
        for axis in 0..6 {
            let step = if axis == 0 { STEP * self.length_m } else { STEP };
            let mut moved = shape.local;
            moved[axis] += step;
            own.set_column(axis, &((self.gradient(&moved, excess_pa) - gradient) / step));
            let mut unit = Local::zeros();
            unit[axis] = 1.0;
            by_ends.set_column(axis, &shape.forces(&unit));
        }
        let mut turning = SMatrix::<f64, 12, 12>::zeros();
        for column in (3..6).chain(6..12) {
            let mut step = SVector::<f64, 6>::zeros();
            step[column % 6] = STEP;
            let moved = ends[column / 6].moved(&step);
            let ends = if column < 6 { [&moved, ends[1]] } else { [ends[0], &moved] };
            turning.set_column(column, &((Shape::of(ends).forces(&gradient) - forces) / STEP));
        }
        // Only the difference of the places counts.
        for axis in 0..3 {
            let opposite = -turning.column(6 + axis);
            turning.set_column(axis, &opposite);
        }
        (forces, by_ends * own * by_ends.transpose() + turning)
    }
}

/// Slopes of the chord against both ends, in a frame turned halfway between theirs.
fn slopes(local: &Local) -> [Vector2<f64>; 2] {
    let half = 0.5 * local[5];
    [turned(&Vector2::new(local[1], local[2]), -half), turned(&Vector2::new(local[3], local[4]), half)]
}

fn bow(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    BOW * (2.0 * a.norm_squared() - a.dot(b) + 2.0 * b.norm_squared())
}

impl Shape {
    fn of(ends: [&Node; 2]) -> Self {
        let between = ends[1].place - ends[0].place;
        let chord_m = between.norm();
        let along = between / chord_m;
        let mut local = Local::zeros();
        let mut normals = [[Vector3::zeros(); 2]; 2];
        for (end, node) in ends.iter().enumerate() {
            let c = node.turn.tr_mul(&along);
            for axis in 0..2 {
                let square = c[axis] * c[axis] + c.z * c.z;
                local[1 + 2 * end + axis] = RealField::atan2(c[axis], c.z);
                let mut gradient = Vector3::zeros();
                (gradient[axis], gradient.z) = (c.z / square, -c[axis] / square);
                normals[end][axis] = node.turn * gradient;
            }
        }
        let turn = turn_vector(&ends[0].turn.tr_mul(&ends[1].turn));
        (local[0], local[5]) = (chord_m, turn.z);
        Self { local, along, normals, twists: ends[0].turn * twist_by_spin(&turn) }
    }

    /// Forces and moments on the ends by the derivatives of an energy.
    fn forces(&self, gradient: &Local) -> SVector<f64, 12> {
        let mut push = self.along * gradient[0];
        let mut moments = [-self.twists * gradient[5], self.twists * gradient[5]];
        for (end, moment) in moments.iter_mut().enumerate() {
            let [x, y] = &self.normals[end];
            let normal = x * gradient[1 + 2 * end] + y * gradient[2 + 2 * end];
            push += (normal - self.along * self.along.dot(&normal)) / self.local[0];
            *moment -= self.along.cross(&normal);
        }
        let mut forces = SVector::<f64, 12>::zeros();
        forces.fixed_rows_mut::<3>(0).copy_from(&-push);
        forces.fixed_rows_mut::<3>(3).copy_from(&moments[0]);
        forces.fixed_rows_mut::<3>(6).copy_from(&push);
        forces.fixed_rows_mut::<3>(9).copy_from(&moments[1]);
        forces
    }
}

/// A slope in a frame turned by `-angle_rad` about the tube.
fn turned(slope: &Vector2<f64>, angle_rad: f64) -> Vector2<f64> {
    let (sine, cosine) = ComplexField::sin_cos(angle_rad);
    Vector2::new(cosine * slope.x - sine * slope.y, sine * slope.x + cosine * slope.y)
}

/// The vector of a turn of less than half a turn.
pub(crate) fn turn_vector(turn: &Matrix3<f64>) -> Vector3<f64> {
    let sine = Vector3::new(turn.m32 - turn.m23, turn.m13 - turn.m31, turn.m21 - turn.m12) * 0.5;
    let size = sine.norm();
    // The arc sine's series, whose next term is below 1e-17.
    let ratio =
        if size < 1e-4 { 1.0 + size * size / 6.0 } else { RealField::atan2(size, 0.5 * (turn.trace() - 1.0)) / size };
    sine * ratio
}

/// Change of the `z` of a turn's vector by a spin of the turned frame, in the frame that it turns from.
fn twist_by_spin(turn: &Vector3<f64>) -> Vector3<f64> {
    let angle = turn.norm();
    let square = if angle < 1e-3 {
        // The series, whose next term is below 1e-15.
        (1.0 + angle * angle / 60.0) / 12.0
    } else {
        let (sine, cosine) = ComplexField::sin_cos(angle);
        1.0 / (angle * angle) - (1.0 + cosine) / (2.0 * angle * sine)
    };
    let once = turn.cross(&Vector3::z());
    Vector3::z() + 0.5 * once + square * turn.cross(&once)
}
