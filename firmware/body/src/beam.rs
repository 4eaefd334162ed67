//! A piece of tube between two nodes: a corotational beam with cubic deflections, shear, and the bow's part in the stretch.
//!
//! The chord is the frame. Slopes of the ends against the chord, the chord's length and the turn of one end against the other are all that
//! the energy knows, so that rigid motions cost nothing. Forces on the nodes are the exact derivatives of that energy.

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
        Self { place: self.place + step.fixed_rows::<3>(0), turn: turn.matrix() * self.turn }
    }
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
    /// The main strain of a law.
    pub(crate) fn main(&self, main: Main) -> f64 {
        match main {
            Main::Stretch => self.stretch - 1.0,
            Main::Bend => self.bend_rad_per_m[0],
            Main::Twist => self.twist_rad_per_m,
        }
    }
}

/// Chord and slopes of a piece of tube.
struct Shape {
    chord_m: f64,
    along: Vector3<f64>,
    /// Slope of the chord against both ends, towards `x` and `y` of a frame turned halfway between theirs.
    slopes: [Vector2<f64>; 2],
    /// The same in the frames of the ends, and what they change with: `[end][axis]`, in space.
    own: [Vector2<f64>; 2],
    normals: [[Vector3<f64>; 2]; 2],
    twist_rad: f64,
    /// Change of the twist by a turn of the second end, in space.
    twists: Vector3<f64>,
}

/// Steps of the differences that give stiffnesses, m and rad.
const STEP: f64 = 1e-7;
/// Bow of a cubic deflection: `(2 a^2 - a b + 2 b^2)/30`, with the slopes of the ends.
const BOW: f64 = 1.0 / 30.0;

impl Beam<'_> {
    pub(crate) fn strain(&self, ends: [&Node; 2]) -> Strain {
        let shape = Shape::of(ends);
        self.strain_of(&shape)
    }

    fn strain_of(&self, shape: &Shape) -> Strain {
        let [a, b] = &shape.slopes;
        let bend = (a - b) / self.length_m;
        Strain {
            stretch: shape.chord_m * (1.0 + bow(a, b)) / self.length_m,
            bend_rad_per_m: [bend.x, bend.y],
            twist_rad_per_m: shape.twist_rad / self.length_m,
        }
    }

    /// Forces and moments that hold the ends in place, N and N m: of the first end, then of the second. `excess_pa` is the pressure that the
    /// memory takes at a deformation.
    pub(crate) fn forces(&self, ends: [&Node; 2], excess_pa: &impl Fn(f64) -> f64) -> SVector<f64, 12> {
        let shape = Shape::of(ends);
        let strain = self.strain_of(&shape);
        let Law { main, ref potential, ref stiffness, .. } = *self.law;
        let deformation = self.law.deformation(strain.main(main));
        let left_pa = self.pressure_pa - excess_pa(deformation);
        let [towards, across, torsion] = self.springs;
        let [a, b] = &shape.slopes;
        // Loads of the mean strains: axial force, bending moments, torque.
        let straight = |axis: usize| [towards, across][axis] * strain.bend_rad_per_m[axis];
        let (axial_n, moments, torque_nm) = match main {
            Main::Stretch => {
                let [force, _] = potential.loads([strain.stretch - 1.0, 0.0], left_pa);
                (force, [straight(0), straight(1)], torsion * strain.twist_rad_per_m)
            }
            Main::Bend => {
                let [moment, _] = potential.loads([strain.bend_rad_per_m[0], 0.0], left_pa);
                (stiffness.strip_n * (strain.stretch - 1.0), [moment, straight(1)], torsion * strain.twist_rad_per_m)
            }
            Main::Twist => {
                let [force, torque] = potential.loads([strain.stretch - 1.0, strain.twist_rad_per_m], left_pa);
                (force, [straight(0), straight(1)], torque)
            }
        };
        // Change of the energy by chord, slopes and twist.
        let by_bow = axial_n * shape.chord_m * BOW;
        let mut by_slopes = [by_bow * (4.0 * a - b), by_bow * (4.0 * b - a)];
        let mut by_chord = axial_n * (1.0 + bow(a, b));
        for (axis, moment) in moments.into_iter().enumerate() {
            let bending = [towards, across][axis];
            // A stretched piece has the longer lever.
            let shear = 12.0 * bending / (stiffness.shear_n * shape.chord_m * shape.chord_m);
            let uneven = 3.0 * bending / ((1.0 + shear) * self.length_m) * (a[axis] + b[axis]);
            by_slopes[0][axis] += uneven + moment;
            by_slopes[1][axis] += uneven - moment;
            by_chord += uneven * (a[axis] + b[axis]) * shear / ((1.0 + shear) * shape.chord_m);
        }
        shape.forces(by_chord, by_slopes, torque_nm)
    }

    /// Forces and their change by steps of the ends.
    pub(crate) fn stiffness(
        &self,
        ends: [&Node; 2],
        excess_pa: &impl Fn(f64) -> f64,
    ) -> (SVector<f64, 12>, SMatrix<f64, 12, 12>) {
        let forces = self.forces(ends, excess_pa);
        let mut matrix = SMatrix::<f64, 12, 12>::zeros();
        for column in 0..12 {
            let mut step = SVector::<f64, 6>::zeros();
            step[column % 6] = STEP;
            let moved = ends[column / 6].moved(&step);
            let ends = if column < 6 { [&moved, ends[1]] } else { [ends[0], &moved] };
            matrix.set_column(column, &((self.forces(ends, excess_pa) - forces) / STEP));
        }
        (forces, matrix)
    }
}

fn bow(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    BOW * (2.0 * a.norm_squared() - a.dot(b) + 2.0 * b.norm_squared())
}

impl Shape {
    fn of(ends: [&Node; 2]) -> Self {
        let between = ends[1].place - ends[0].place;
        let chord_m = between.norm();
        let along = between / chord_m;
        let mut own = [Vector2::zeros(); 2];
        let mut normals = [[Vector3::zeros(); 2]; 2];
        for (end, node) in ends.iter().enumerate() {
            let c = node.turn.tr_mul(&along);
            for axis in 0..2 {
                let square = c[axis] * c[axis] + c.z * c.z;
                own[end][axis] = RealField::atan2(c[axis], c.z);
                let mut gradient = Vector3::zeros();
                (gradient[axis], gradient.z) = (c.z / square, -c[axis] / square);
                normals[end][axis] = node.turn * gradient;
            }
        }
        let turn = turn_vector(&ends[0].turn.tr_mul(&ends[1].turn));
        let twists = ends[0].turn * twist_by_spin(&turn);
        let slopes = [turned(&own[0], -0.5 * turn.z), turned(&own[1], 0.5 * turn.z)];
        Self { chord_m, along, slopes, own, normals, twist_rad: turn.z, twists }
    }

    /// Forces on the nodes by the derivatives of an energy.
    fn forces(&self, by_chord: f64, by_slopes: [Vector2<f64>; 2], by_twist: f64) -> SVector<f64, 12> {
        let half = 0.5 * self.twist_rad;
        let mut by_twist = by_twist;
        let mut push = self.along * by_chord;
        let mut moments = [Vector3::zeros(); 2];
        for (end, sign) in [(0, -1.0), (1, 1.0)] {
            let angle = sign * half;
            // Slopes turn with half of the twist.
            let quarter = turned(&self.own[end], angle + std::f64::consts::FRAC_PI_2);
            by_twist += 0.5 * sign * by_slopes[end].dot(&quarter);
            let own = turned(&by_slopes[end], -angle);
            for axis in 0..2 {
                let normal = self.normals[end][axis] * own[axis];
                push += (normal - self.along * self.along.dot(&normal)) / self.chord_m;
                moments[end] -= self.along.cross(&normal);
            }
        }
        moments[0] -= self.twists * by_twist;
        moments[1] += self.twists * by_twist;
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
fn turn_vector(turn: &Matrix3<f64>) -> Vector3<f64> {
    Rotation3::from_matrix_unchecked(*turn).scaled_axis()
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
