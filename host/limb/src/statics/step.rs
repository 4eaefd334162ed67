//! One exponential of a piece: how its screw depends on the unknowns of the piece, and what that makes of the work of the loads behind it.
//!
//! A step of length `h` about a place with the strains `k` (turn), `v` (shift) and the slope `k'` of the turn has the screw
//! `(h k + t k x k', h v - t k' x v)` with `t = h^3/12`, which is of fourth order in `h`.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::exponential::{Exponential, Work};
use super::rod::{Behind, Piece, STEPS, UNKNOWNS};

/// The unknowns that turn what lies behind; the others only shift it.
pub(super) const TURNS: usize = 5;

/// A column an unknown.
pub(super) type Turned = SMatrix<f64, 3, TURNS>;
pub(super) type Arms = SMatrix<f64, 3, UNKNOWNS>;
/// Derivatives by the unknowns of one piece.
pub(super) type Block = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// A step and where it starts.
pub(super) struct Step {
    pub(super) motion: Exponential,
    /// Turn and shift by the unknowns that turn; the latter only by those that make the bends linear.
    turn_by: Turned,
    shift_by: [Vector3<f64>; 2],
    /// Both by the three strains of a place that are theirs.
    by_strain: Matrix3<f64>,
    /// `t` times the slope of the turn's strain by its unknown.
    bent: f64,
    pub(super) rotation: Matrix3<f64>,
    pub(super) origin: Vector3<f64>,
}

/// Derivatives of the work of what lies behind a place of a piece, by the unknowns of the piece up to there from its end.
pub(super) struct Sums {
    pub(super) gradient: [f64; UNKNOWNS],
    /// Second derivatives; the upper right triangle.
    pub(super) tangent: Block,
    /// Turn of all that lies behind, in the frame of the scene.
    pub(super) turned: Turned,
    /// The work of such a turn of all before on what the steps move.
    pub(super) arms: Arms,
}

impl Sums {
    pub(super) fn none() -> Self {
        Self { gradient: [0.0; UNKNOWNS], tangent: Block::zeros(), turned: Turned::zeros(), arms: Arms::zeros() }
    }
}

impl Step {
    /// Turn and shift of a step of a piece, in its own frame.
    pub(super) fn screw(piece: &Piece, q: &[f64], index: usize) -> [Vector3<f64>; 2] {
        let h = piece.length_m / STEPS as f64;
        let [k, slope, v] = piece.strain(q, (2 * index + 1) as f64 / STEPS as f64 - 1.0);
        let t = h * h * h / 12.0;
        [k * h + k.cross(&slope) * t, v * h - slope.cross(&v) * t]
    }

    /// A step of a piece from a place on.
    pub(super) fn new(piece: &Piece, q: &[f64], index: usize, rotation: Matrix3<f64>, origin: Vector3<f64>) -> Self {
        let h = piece.length_m / STEPS as f64;
        let eta = (2 * index + 1) as f64 / STEPS as f64 - 1.0;
        let (t, per) = (h * h * h / 12.0, 2.0 / piece.length_m);
        let [k, slope, v] = piece.strain(q, eta);
        let motion = Exponential::new(k * h + k.cross(&slope) * t, v * h - slope.cross(&v) * t);
        let by_strain = Matrix3::from_diagonal_element(h) - (slope * t).cross_matrix();
        let bent = t * per;
        let (turn_slope, shift_slope) = ((k * bent).cross_matrix(), (v * bent).cross_matrix());
        let strain = |axis: usize| by_strain.column(axis).into_owned();
        let linear = |axis: usize| strain(axis) * eta + turn_slope.column(axis);
        let turn_by = Turned::from_columns(&[strain(0), linear(0), strain(1), linear(1), strain(2)]);
        let shift_by = [0, 1].map(|axis: usize| shift_slope.column(axis).into_owned());
        Self { motion, turn_by, shift_by, by_strain, bent, rotation, origin }
    }

    /// Where it ends.
    pub(super) fn end(&self) -> Vector3<f64> {
        self.origin + self.rotation * self.motion.way
    }

    /// Adds this step, with the loads behind it, to the sums of the later ones of its piece.
    pub(super) fn add_to(&self, behind: &Behind, sums: &mut Sums) {
        let Self { motion, turn_by, shift_by, by_strain, rotation, .. } = self;
        let force = rotation.tr_mul(&behind.force);
        let about_end = behind.moment - self.end() * behind.force.transpose();
        let carried = rotation.tr_mul(&about_end) * rotation;
        let Work { first: [by_turn, by_shift], second: [twice, shift_turn], arms } = motion.work(&force, &carried);
        let linear = || [1, 3].into_iter().zip(shift_by);

        let (of_turns, of_shifts) = (turn_by.tr_mul(&by_turn), by_strain.tr_mul(&by_shift));
        (0..TURNS).for_each(|a| sums.gradient[a] += of_turns[a]);
        (0..3).for_each(|a| sums.gradient[TURNS + a] += of_shifts[a]);
        linear().for_each(|(a, shift)| sums.gradient[a] += shift.dot(&by_shift));

        // What this step turns carries the later ones.
        let turned = rotation * (motion.jacobian * turn_by);
        for b in 0..UNKNOWNS {
            let arm = sums.arms.column(b);
            for a in 0..TURNS {
                let entry = turned.column(a).dot(&arm);
                sums.tangent[(a.min(b), a.max(b))] += if a == b { 2.0 * entry } else { entry };
            }
        }
        sums.turned += turned;

        let mixed = shift_turn * turn_by;
        let mut stress = twice * turn_by;
        linear().for_each(|(a, shift)| add(&mut stress, a, &shift_turn.tr_mul(shift)));
        for b in 0..TURNS {
            let (own, across) = (stress.column(b), mixed.column(b));
            (0..=b).for_each(|a| sums.tangent[(a, b)] += turn_by.column(a).dot(&own));
            linear().filter(|(a, _)| *a <= b).for_each(|(a, shift)| sums.tangent[(a, b)] += shift.dot(&across));
            let shifts = by_strain.tr_mul(&across);
            (0..3).for_each(|a| sums.tangent[(b, TURNS + a)] += shifts[a]);
        }
        self.bend(&by_turn, &by_shift, &mut sums.tangent);

        let [by_turns, by_shifts] = arms.map(|arms| rotation * arms);
        let (of_turns, of_shifts) = (by_turns * turn_by, by_shifts * by_strain);
        (0..TURNS).for_each(|a| add(&mut sums.arms, a, &of_turns.column(a).into_owned()));
        (0..3).for_each(|a| add(&mut sums.arms, TURNS + a, &of_shifts.column(a).into_owned()));
        linear().for_each(|(a, shift)| add(&mut sums.arms, a, &(by_shifts * shift)));
    }

    /// What the second derivatives of the screw itself add: those of `t k x k'` and of `-t k' x v`.
    fn bend(&self, by_turn: &Vector3<f64>, by_shift: &Vector3<f64>, tangent: &mut Block) {
        let (turn, shift) = (by_turn * self.bent, by_shift * self.bent);
        tangent[(0, 3)] += turn.z;
        tangent[(1, 2)] -= turn.z;
        tangent[(1, 4)] += turn.y;
        tangent[(3, 4)] -= turn.x;
        tangent[(1, 6)] -= shift.z;
        tangent[(1, 7)] += shift.y;
        tangent[(3, 5)] += shift.z;
        tangent[(3, 7)] -= shift.x;
    }
}

fn add<const N: usize>(columns: &mut SMatrix<f64, 3, N>, index: usize, more: &Vector3<f64>) {
    (0..3).for_each(|row| columns[(row, index)] += more[row]);
}
