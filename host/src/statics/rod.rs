//! A limb as a chain of geometrically exact rods with rigid parts, and its potential.
//!
//! Each piece has eight unknowns: bends about both axes, linear along the piece, and a constant twist rate, two shears and a stretch, all as
//! differences from the shape without load. Strains are rates per length at rest in the frame of the section, so that rigid motions cost nothing and a piece without load is
//! the arc of the kinematics exactly. Poses come from exponentials of screws (four steps a piece, of fourth order in the step), weights
//! act at their nodes by Simpson's rule.
//!
//! The potential is the energy of the bundles less the work of dead forces. First and second derivatives are those of the very chain: with
//! `S_a` the screw by which an unknown moves all that lies behind it, a force `f` at `x` has the derivative `f . S_a(x)`, and the second one
//! `f . S_a S_b(x)` with the earlier of two unknowns first.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Matrix4, Point3, Translation3, UnitQuaternion, Vector3, Vector4};

use super::screw::{Exponential, Screw, Second, Wrench};

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
    /// Second derivatives of the energy per length by these four.
    pub stiffness: Matrix4<f64>,
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
struct Behind {
    force: Vector3<f64>,
    moment: Matrix3<f64>,
}

impl Behind {
    fn none() -> Self {
        Self { force: Vector3::zeros(), moment: Matrix3::zeros() }
    }

    fn add(&mut self, at: &Vector3<f64>, force: &Vector3<f64>) {
        self.force += force;
        self.moment += at * force.transpose();
    }

    /// `sum x cross f`.
    fn couple(&self) -> Vector3<f64> {
        let m = &self.moment;
        Vector3::new(m[(1, 2)] - m[(2, 1)], m[(2, 0)] - m[(0, 2)], m[(0, 1)] - m[(1, 0)])
    }

    /// `sum S(x) cross f`.
    fn turned(&self, by: &Screw) -> Vector3<f64> {
        self.moment * by.turn - by.turn * self.moment.trace() + by.shift.cross(&self.force)
    }

    /// `sum f . S(x)`.
    fn work(&self, by: &Screw) -> f64 {
        self.couple().dot(&by.turn) + self.force.dot(&by.shift)
    }
}

/// One exponential of the chain.
pub(super) struct Step {
    pub(super) screw: Screw,
    /// Derivatives of the screw by the unknowns of its piece, in its own frame.
    by: [Screw; UNKNOWNS],
    /// Strain in the middle and its slope by the unknowns, and a twelfth of the cube of the step.
    units: [(Screw, Screw); UNKNOWNS],
    third: f64,
    /// What they move all that lies behind it by, in the frame of the scene.
    moves: [Screw; UNKNOWNS],
    rotation: Matrix3<f64>,
    origin: Vector3<f64>,
    behind: Behind,
}

impl Piece {
    /// Strains at `eta`, -1 to 1 along the piece, and their slope by length.
    fn strain(&self, q: &[f64], eta: f64) -> (Screw, Vector3<f64>) {
        let [stretch, x, y, twist] = self.free;
        let turn = Vector3::new(q[0] + q[1] * eta - y, q[2] + q[3] * eta + x, q[4] + twist);
        let slope = Vector3::new(q[1], q[3], 0.0) * (2.0 / self.length_m);
        (Screw { turn, shift: Vector3::new(q[5], q[6], q[7] + stretch) }, slope)
    }

    /// Strains in the terms of the stiffness, less those without load: mean, and amplitude of the linear part.
    pub(super) fn differences(&self, q: &[f64]) -> [Vector4<f64>; 2] {
        let sway = self.sway * (q[5] * q[5] + q[6] * q[6]) / self.free[0];
        [Vector4::new(q[7] + sway, q[2], -q[0], q[4]), Vector4::new(0.0, q[3], -q[1], 0.0)]
    }

    /// Energy with its derivatives, added to those of the chain from unknown `at` on.
    fn energy(&self, q: &[f64], at: usize, total: &mut Potential) {
        let length = self.length_m;
        let [mean, linear] = self.differences(q);
        let (stress, bent) = (self.stiffness * mean, self.stiffness * linear);
        let shear = 0.5 * self.shear_n * (q[5] * q[5] + q[6] * q[6]);
        total.value_j += length * (0.5 * mean.dot(&stress) + linear.dot(&bent) / 6.0 + shear);
        // Derivatives of mean and amplitude by the unknowns.
        let mut by_mean = [Vector4::zeros(); UNKNOWNS];
        let sway = 2.0 * self.sway / self.free[0];
        by_mean[0].z = -1.0;
        by_mean[2].y = 1.0;
        by_mean[4].w = 1.0;
        by_mean[5].x = sway * q[5];
        by_mean[6].x = sway * q[6];
        by_mean[7].x = 1.0;
        let mut by_linear = [Vector4::zeros(); UNKNOWNS];
        by_linear[1].z = -1.0;
        by_linear[3].y = 1.0;
        for a in 0..UNKNOWNS {
            let own = by_mean[a].dot(&stress) + by_linear[a].dot(&bent) / 3.0;
            total.gradient[at + a] += length * own;
            let (row, row_linear) = (self.stiffness * by_mean[a], self.stiffness * by_linear[a] / 3.0);
            for b in 0..UNKNOWNS {
                total.tangent[(at + a, at + b)] += length * (by_mean[b].dot(&row) + by_linear[b].dot(&row_linear));
            }
        }
        for a in [5, 6] {
            total.gradient[at + a] += length * self.shear_n * q[a];
            total.tangent[(at + a, at + a)] += length * (self.shear_n + stress.x * sway);
        }
    }

    /// The screws of its steps with their derivatives.
    pub(super) fn step(&self, q: &[f64], index: usize) -> Step {
        let h = self.length_m / STEPS as f64;
        let eta = (2 * index + 1) as f64 / STEPS as f64 - 1.0;
        let (middle, slope) = self.strain(q, eta);
        let slope = Screw { turn: slope, shift: Vector3::zeros() };
        let third = h * h * h / 12.0;
        let screw = middle.scaled(h).plus(&middle.bracket(&slope).scaled(third));
        let units: [_; UNKNOWNS] = std::array::from_fn(|a| self.unit(a, eta));
        let by = units.map(|(of_middle, of_slope)| {
            let bent = of_middle.bracket(&slope).plus(&middle.bracket(&of_slope));
            of_middle.scaled(h).plus(&bent.scaled(third))
        });
        let (rotation, origin) = (Matrix3::identity(), Vector3::zeros());
        Step { screw, by, units, third, moves: by, rotation, origin, behind: Behind::none() }
    }

    /// Derivatives of strain and slope by one unknown.
    fn unit(&self, a: usize, eta: f64) -> (Screw, Screw) {
        let mut middle = Screw::zero();
        let mut slope = Screw::zero();
        match a {
            0 => middle.turn.x = 1.0,
            1 => (middle.turn.x, slope.turn.x) = (eta, 2.0 / self.length_m),
            2 => middle.turn.y = 1.0,
            3 => (middle.turn.y, slope.turn.y) = (eta, 2.0 / self.length_m),
            4 => middle.turn.z = 1.0,
            5 => middle.shift.x = 1.0,
            6 => middle.shift.y = 1.0,
            _ => middle.shift.z = 1.0,
        }
        (middle, slope)
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

    /// The potential of a shape under a share of the loads, with its derivatives.
    ///
    /// # Panics
    /// When there are not as many unknowns as the rod has.
    pub fn potential(&self, q: &DVector<f64>, share: f64) -> Potential {
        assert_eq!(q.len(), self.unknowns(), "eight unknowns a piece");
        let count = q.len();
        let mut total = Potential {
            value_j: 0.0,
            gradient: DVector::zeros(count),
            tangent: DMatrix::zeros(count, count),
            poses: Vec::with_capacity(self.pieces.len()),
        };
        let mut steps = self.chain(q, share, &mut total);
        self.loads_behind(share, &mut steps, &total.poses);
        for (index, piece) in self.pieces.iter().enumerate() {
            piece.energy(&q.as_slice()[index * UNKNOWNS..][..UNKNOWNS], index * UNKNOWNS, &mut total);
        }
        work(&steps, &mut total);
        total
    }

    /// Tip and poses without derivatives' sums; the work of the loads goes into the value.
    fn chain(&self, q: &DVector<f64>, share: f64, total: &mut Potential) -> Vec<Step> {
        let mut steps = Vec::with_capacity(STEPS * self.pieces.len());
        let mut pose = self.base;
        for (index, piece) in self.pieces.iter().enumerate() {
            let own = &q.as_slice()[index * UNKNOWNS..][..UNKNOWNS];
            let mount = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), piece.mount_angle_rad);
            pose *= mount;
            total.value_j -= share * self.weight(piece, 0).dot(&pose.translation.vector);
            for step in 0..STEPS {
                let mut place = piece.step(own, step);
                let exponential = Exponential::new(&place.screw);
                place.rotation = pose.rotation.to_rotation_matrix().into_inner();
                place.origin = pose.translation.vector;
                place.moves = place.by.map(|by| exponential.change(&by).seen(&place.rotation, &place.origin));
                pose *= exponential.pose;
                total.value_j -= share * self.weight(piece, step + 1).dot(&pose.translation.vector);
                steps.push(place);
            }
            pose *= mount.inverse();
            for (distance, kg) in &piece.masses {
                let at = (pose * Point3::new(0.0, 0.0, *distance)).coords;
                total.value_j -= share * kg * self.gravity_m_per_s2.dot(&at);
            }
            pose *= Translation3::new(0.0, 0.0, piece.rigid_m);
            total.poses.push(pose);
        }
        total.value_j -= share * self.tip_force_n.dot(&pose.translation.vector);
        steps
    }

    /// Weight at a node of a piece by Simpson's rule, N.
    fn weight(&self, piece: &Piece, node: usize) -> Vector3<f64> {
        let factor = match node {
            0 | STEPS => 1.0,
            odd if odd % 2 == 1 => 4.0,
            _ => 2.0,
        };
        self.gravity_m_per_s2 * (piece.kg_per_m * piece.length_m * factor / (3 * STEPS) as f64)
    }

    /// Tells every step what loads lie behind it.
    fn loads_behind(&self, share: f64, steps: &mut [Step], poses: &[Isometry3<f64>]) {
        let mut behind = Behind::none();
        let tip = poses.last().map_or(self.base.translation.vector, |pose| pose.translation.vector);
        behind.add(&tip, &(self.tip_force_n * share));
        for (index, piece) in self.pieces.iter().enumerate().rev() {
            let pose = poses[index];
            for (distance, kg) in &piece.masses {
                let at = (pose * Point3::new(0.0, 0.0, distance - piece.rigid_m)).coords;
                behind.add(&at, &(self.gravity_m_per_s2 * (kg * share)));
            }
            let mut end = (pose * Point3::new(0.0, 0.0, -piece.rigid_m)).coords;
            for step in (0..STEPS).rev() {
                behind.add(&end, &(self.weight(piece, step + 1) * share));
                let place = &mut steps[index * STEPS + step];
                place.behind = behind;
                end = place.origin;
            }
            behind.add(&end, &(self.weight(piece, 0) * share));
        }
    }
}

/// First and second derivatives of the loads' work.
fn work(steps: &[Step], total: &mut Potential) {
    // What each unknown has turned all that lies behind by, up to the step that is looked at.
    let mut turned = vec![Vector3::zeros(); total.gradient.len()];
    for (index, step) in steps.iter().enumerate() {
        let at = index / STEPS * UNKNOWNS;
        for b in 0..UNKNOWNS {
            total.gradient[at + b] -= step.behind.work(&step.moves[b]);
            let arm = step.behind.turned(&step.moves[b]);
            for (a, turned) in turned[..at].iter().enumerate() {
                let entry = turned.dot(&arm);
                total.tangent[(a, at + b)] -= entry;
                total.tangent[(at + b, a)] -= entry;
            }
            for a in 0..UNKNOWNS {
                let entry = turned[at + a].dot(&arm) + 0.5 * step.moves[a].turn.dot(&arm);
                total.tangent[(at + a, at + b)] -= entry;
                total.tangent[(at + b, at + a)] -= entry;
            }
        }
        curvature(step, at, total);
        for a in 0..UNKNOWNS {
            turned[at + a] += step.moves[a].turn;
        }
    }
}

/// The second derivatives of one exponential and of its screw.
fn curvature(step: &Step, at: usize, total: &mut Potential) {
    let seen = step.rotation.transpose();
    let couple = step.behind.couple() + step.behind.force.cross(&step.origin);
    let work = Wrench { couple: seen * couple, force: seen * step.behind.force };
    let second = Second::new(&step.screw, &step.by, &work);
    for a in 0..UNKNOWNS {
        for b in a..UNKNOWNS {
            let [(middle_a, slope_a), (middle_b, slope_b)] = [&step.units[a], &step.units[b]];
            let own = middle_a.bracket(slope_b).plus(&middle_b.bracket(slope_a)).scaled(step.third);
            let entry = second.of(&step.by, a, b) + second.of_screw(&own);
            total.tangent[(at + a, at + b)] -= entry;
            if a != b {
                total.tangent[(at + b, at + a)] -= entry;
            }
        }
    }
}
