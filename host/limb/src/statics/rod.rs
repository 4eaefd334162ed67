//! A limb as a chain of geometrically exact rods with rigid parts, and its potential.
//!
//! Each piece has eight unknowns: bends about both axes, linear along the piece, and a constant twist rate, two shears and a stretch, all as
//! differences from the shape without load. Strains are rates per length at rest in the frame of the section, so that rigid motions cost nothing and a piece without load is
//! the arc of the kinematics exactly. Poses come from exponentials of screws (four steps a piece, of fourth order in the step), weights
//! act at their nodes by Simpson's rule.
//!
//! The potential is the energy of the bundles less the work of dead forces. First and second derivatives are those of the very chain: with
//! `S_a` the screw by which an unknown moves all that lies behind it, a force `f` at `x` has the derivative `f . S_a(x)`, and the second one
//! `f . S_a S_b(x)` with the earlier of two unknowns first: the turn of `S_a` by the sum of `S_b(x)` cross `f`. That sum is wanted of a whole
//! piece where the unknowns are of two.

use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix2, Matrix3, Matrix4, Matrix4x2, Rotation3, Translation3, UnitQuaternion,
    Vector2, Vector3, Vector4,
};

use super::step::{Arms, Step, Sums, TURNS};

/// Unknowns of a piece.
pub const UNKNOWNS: usize = 8;
/// Those that make the bends linear.
pub(super) const SLOPES: [usize; 2] = [1, 3];
/// Steps of a piece; even, for Simpson's rule.
pub(super) const STEPS: usize = 4;

/// One rod and the rigid part behind it.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Stretch, bends towards `x` and `y` (rad/m) and twist rate (rad/m) without load.
    pub free: [f64; 4],
    /// Shears without load towards `x` and `y`: those of a tube that is wound about the axis of its bundle, else 0.
    pub free_shear: [f64; 2],
    /// Second derivatives of the energy per length by these four.
    pub stiffness: Matrix4<f64>,
    /// Second derivatives by these four and by the shears towards `x` and `y`: not 0 where tubes lean in their bundle.
    pub coupled: Matrix4x2<f64>,
    /// Shear stiffness, N.
    pub shear_n: f64,
    /// What it shortens by when it slides, over the square of the slide and the stretch ([`super::Bundle::sway`]).
    pub sway: f64,
    /// Length at rest, m; > 0.
    pub length_m: f64,
    /// Direction of `x` about the limb's axis, rad.
    pub mount_angle_rad: f64,
    /// Mass per length at rest, kg/m.
    pub kg_per_m: f64,
    /// Length of the rigid part, m.
    pub rigid_m: f64,
    /// Masses on the rigid part: distance behind the rod, m, and kg.
    pub masses: Vec<(f64, f64)>,
}

/// A chain of pieces with its loads.
#[derive(Clone, Debug)]
pub struct Rod {
    /// Where it starts.
    pub base: Isometry3<f64>,
    /// Pieces from the base outwards.
    pub pieces: Vec<Piece>,
    /// Acceleration of gravity, m/s2.
    pub gravity_m_per_s2: Vector3<f64>,
    /// A dead force at the tip, N.
    pub tip_force_n: Vector3<f64>,
}

/// The potential of a shape with its derivatives.
#[derive(Clone, Debug)]
pub struct Potential {
    /// Energy less work, J.
    pub value_j: f64,
    /// First derivatives by the unknowns.
    pub gradient: DVector<f64>,
    /// Second derivatives.
    pub tangent: DMatrix<f64>,
    /// Pose behind each piece, its rigid part included.
    pub poses: Vec<Isometry3<f64>>,
}

/// Force and first moment of the loads behind a place: `sum f` and `sum x f^T`.
#[derive(Clone, Copy)]
pub(super) struct Behind {
    pub(super) force: Vector3<f64>,
    pub(super) moment: Matrix3<f64>,
}

impl Behind {
    pub(super) fn none() -> Self {
        Self { force: Vector3::zeros(), moment: Matrix3::zeros() }
    }

    pub(super) fn add(&mut self, at: &Vector3<f64>, force: &Vector3<f64>) {
        self.force += force;
        self.moment += at * force.transpose();
    }
}

impl Piece {
    /// Strains at `eta`, -1 to 1 along the piece: turn, its slope by length, and shift.
    pub(super) fn strain(&self, q: &[f64], eta: f64) -> [Vector3<f64>; 3] {
        let [stretch, x, y, twist] = self.free;
        let turn = Vector3::new(q[0] + q[1] * eta - y, q[2] + q[3] * eta + x, q[4] + twist);
        let slope = Vector3::new(q[1], q[3], 0.0) * (2.0 / self.length_m);
        [turn, slope, Vector3::new(q[5] + self.free_shear[0], q[6] + self.free_shear[1], q[7] + stretch)]
    }

    /// Strains in the terms of the stiffness, less those without load: mean, and amplitude of the linear part.
    ///
    /// Where a bend changes along the piece, the axis stretches as costs least: a bender's strip keeps its length everywhere.
    pub(super) fn differences(&self, q: &[f64]) -> [Vector4<f64>; 2] {
        let sway = self.sway * (q[5] * q[5] + q[6] * q[6]) / self.free[0];
        let stretch = -(self.stiffness[(0, 1)] * q[3] - self.stiffness[(0, 2)] * q[1]) / self.stiffness[(0, 0)];
        [Vector4::new(q[7] + sway, q[2], -q[0], q[4]), Vector4::new(stretch, q[3], -q[1], 0.0)]
    }

    /// Energy, with its derivatives by the unknowns added to those of the piece.
    fn energy(&self, q: &[f64], sums: &mut Sums) -> f64 {
        let length = self.length_m;
        let [mean, linear] = self.differences(q);
        let slides = Vector2::new(q[5], q[6]);
        let (own, yielding) = (self.stiffness * mean, self.yielding());
        let stress = own + self.coupled * slides;
        let sway = 2.0 * self.sway / self.free[0];
        // The strain that each unknown is, and by what factor: of the mean, and of the amplitude.
        let of_mean = [(0, 2, -1.0), (2, 1, 1.0), (4, 3, 1.0), (5, 0, sway * q[5]), (6, 0, sway * q[6]), (7, 0, 1.0)];
        let of_linear = [(1, 2, -1.0), (3, 1, 1.0)];
        spring(&self.stiffness, &of_mean, &stress, length, sums);
        let bent = yielding * linear;
        spring(&yielding, &of_linear, &bent, length / 3.0, sums);
        let Sums { gradient, tangent, .. } = sums;
        let pushed = self.coupled.tr_mul(&mean);
        for a in [5, 6] {
            gradient[a] += length * (self.shear_n * q[a] + pushed[a - 5]);
            for (b, row, by) in of_mean {
                let entry = length * by * self.coupled[(row, a - 5)];
                tangent[(a.min(b), a.max(b))] += if a == b { 2.0 * entry } else { entry };
            }
            tangent[(a, a)] += length * (self.shear_n + stress.x * sway);
        }
        let shear = 0.5 * self.shear_n * (q[5] * q[5] + q[6] * q[6]);
        length * (0.5 * mean.dot(&own) + mean.dot(&(self.coupled * slides)) + linear.dot(&bent) / 6.0 + shear)
    }

    /// Stiffness against bends that change along the piece, to which the axis stretches and shears as costs least.
    fn yielding(&self) -> Matrix4<f64> {
        let across = self.stiffness.column(0);
        let stretching = self.stiffness - across * across.transpose() / across[0];
        if self.coupled == Matrix4x2::zeros() {
            return stretching;
        }
        let pulled = self.coupled.row(0) / across[0];
        let coupled = self.coupled - across * pulled;
        let shear = Matrix2::from_diagonal_element(self.shear_n) - pulled.tr_mul(&self.coupled.row(0));
        shear.try_inverse().map_or(stretching, |inverse| stretching - coupled * inverse * coupled.transpose())
    }

    /// Mass at a node of the rod by Simpson's rule, kg.
    pub(super) fn node_kg(&self, node: usize) -> f64 {
        let factor = match node {
            0 | STEPS => 1.0,
            odd if odd % 2 == 1 => 4.0,
            _ => 2.0,
        };
        self.kg_per_m * self.length_m * factor / (3 * STEPS) as f64
    }

    /// Directions of its `x` and `y` and back.
    fn mount(&self) -> Matrix3<f64> {
        let (sin, cos) = self.mount_angle_rad.sin_cos();
        Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
    }
}

/// Adds the derivatives of a square form by unknowns, each of which is a strain times a factor.
fn spring(
    stiffness: &Matrix4<f64>,
    unknowns: &[(usize, usize, f64)],
    stress: &Vector4<f64>,
    weight: f64,
    sums: &mut Sums,
) {
    for (index, (a, row, by)) in unknowns.iter().enumerate() {
        sums.gradient[*a] += weight * by * stress[*row];
        for (b, column, other) in &unknowns[index..] {
            sums.tangent[(*a, *b)] += weight * by * other * stiffness[(*row, *column)];
        }
    }
}

impl Rod {
    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        UNKNOWNS * self.pieces.len()
    }

    /// Mass of all pieces, kg.
    pub fn mass_kg(&self) -> f64 {
        let of = |piece: &Piece| piece.kg_per_m * piece.length_m + piece.masses.iter().map(|(_, kg)| kg).sum::<f64>();
        self.pieces.iter().map(of).sum()
    }

    /// The rod while its pressures and loads grow: up to a share of 1 its strains without load lie between those of rest and its own, beyond that the
    /// loads alone are larger.
    pub fn grown(&self, share: f64) -> Self {
        let mut grown = self.bearing(share);
        let pressure = share.min(1.0);
        for piece in &mut grown.pieces {
            let rest = [1.0, 0.0, 0.0, 0.0];
            piece.free = [0, 1, 2, 3].map(|a: usize| rest[a] + pressure * (piece.free[a] - rest[a]));
            piece.free_shear = piece.free_shear.map(|shear| pressure * shear);
        }
        grown
    }

    /// The rod under a share of its loads.
    pub(super) fn bearing(&self, share: f64) -> Self {
        let mut bearing = self.clone();
        bearing.gravity_m_per_s2 *= share;
        bearing.tip_force_n *= share;
        bearing
    }

    /// The potential of a shape under a share of the loads, with its derivatives.
    ///
    /// # Panics
    /// When there are not as many unknowns as the rod has.
    pub fn potential(&self, q: &DVector<f64>, share: f64) -> Potential {
        let pushed = |tip: &Isometry3<f64>| {
            let mut loads = Behind::none();
            loads.add(&tip.translation.vector, &(self.tip_force_n * share));
            loads
        };
        self.assemble(q, share, pushed, |_, _| ()).0
    }

    /// The same under a share of the weights and under given dead loads on what is fixed to the tip. `seen` gets the index and the sums of
    /// each piece, the last one first: derivatives of the work of the loads. All loads come last.
    pub(super) fn assemble(
        &self,
        q: &DVector<f64>,
        share: f64,
        on_tip: impl FnOnce(&Isometry3<f64>) -> Behind,
        mut seen: impl FnMut(usize, &Sums),
    ) -> (Potential, Behind) {
        assert_eq!(q.len(), self.unknowns(), "eight unknowns a piece");
        let count = q.len();
        let (steps, poses) = self.chain(q.as_slice());
        let mut behind = on_tip(poses.last().unwrap_or(&self.base));
        let mut total =
            Potential { value_j: 0.0, gradient: DVector::zeros(count), tangent: DMatrix::zeros(count, count), poses };
        let gravity = self.gravity_m_per_s2 * share;
        let mut later: Vec<Arms> = Vec::with_capacity(self.pieces.len());
        for (index, piece) in self.pieces.iter().enumerate().rev() {
            let end = &total.poses[index];
            let axis = end.rotation * Vector3::z();
            for (distance, kg) in &piece.masses {
                behind.add(&(end.translation.vector + axis * (distance - piece.rigid_m)), &(gravity * *kg));
            }
            let own = &steps[index * STEPS..][..STEPS];
            let mut sums = Sums::none();
            for (node, step) in own.iter().enumerate().rev() {
                behind.add(&step.end(), &(gravity * piece.node_kg(node + 1)));
                step.add_to(&behind, &mut sums);
            }
            behind.add(&own[0].origin, &(gravity * piece.node_kg(0)));
            seen(index, &sums);
            sums.gradient.iter_mut().for_each(|entry| *entry = -*entry);
            sums.tangent.neg_mut();
            let at = index * UNKNOWNS;
            total.value_j += piece.energy(&q.as_slice()[at..][..UNKNOWNS], &mut sums);
            total.write(at, &sums, &later);
            later.push(sums.arms);
        }
        total.value_j -= behind.moment.trace();
        (total, behind)
    }

    /// The steps of a shape, and the poses behind the pieces.
    pub(super) fn chain(&self, q: &[f64]) -> (Vec<Step>, Vec<Isometry3<f64>>) {
        let mut steps = Vec::with_capacity(STEPS * self.pieces.len());
        let mut poses = Vec::with_capacity(self.pieces.len());
        let mut rotation = self.base.rotation.to_rotation_matrix().into_inner();
        let mut origin = self.base.translation.vector;
        for (piece, own) in self.pieces.iter().zip(q.chunks(UNKNOWNS)) {
            let mount = piece.mount();
            rotation *= mount;
            for index in 0..STEPS {
                let step = Step::new(piece, own, index, rotation, origin);
                origin = step.end();
                rotation *= step.motion.rotation;
                steps.push(step);
            }
            rotation *= mount.transpose();
            origin += rotation.column(2) * piece.rigid_m;
            let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
            poses.push(Isometry3::from_parts(Translation3::from(origin), turn));
        }
        (steps, poses)
    }

    /// Points along the centre line of a shape from the base to the tip, m: the ends of its steps and of its rigid parts.
    pub(super) fn points_m(&self, q: &[f64]) -> Vec<[f64; 3]> {
        let (steps, poses) = self.chain(q);
        let mut points = vec![self.base.translation.vector.into()];
        for ((piece, steps), pose) in self.pieces.iter().zip(steps.chunks(STEPS)).zip(poses) {
            points.extend(steps.iter().map(|step| <[f64; 3]>::from(step.end())));
            if piece.rigid_m > 0.0 {
                points.push(pose.translation.vector.into());
            }
        }
        points
    }
}

impl Potential {
    /// Writes the derivatives of a piece to their place; `later` are the arms of all that follow, the last piece first.
    fn write(&mut self, at: usize, sums: &Sums, later: &[Arms]) {
        self.gradient.as_mut_slice()[at..][..UNKNOWNS].copy_from_slice(&sums.gradient);
        for b in 0..UNKNOWNS {
            for a in 0..=b {
                self.tangent[(at + a, at + b)] = sums.tangent[(a, b)];
                self.tangent[(at + b, at + a)] = sums.tangent[(a, b)];
            }
        }
        for (arms, place) in later.iter().rev().zip((at + UNKNOWNS..).step_by(UNKNOWNS)) {
            for b in 0..UNKNOWNS {
                let arm = arms.column(b);
                for a in 0..TURNS {
                    let entry = -sums.turned.column(a).dot(&arm);
                    self.tangent[(at + a, place + b)] = entry;
                    self.tangent[(place + b, at + a)] = entry;
                }
            }
        }
    }
}
