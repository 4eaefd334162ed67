//! A tube between two plates: its shape, and what it does to them.

use nalgebra::{
    Const, DMatrix, DVector, Dyn, Isometry3, Matrix3, Matrix6, OMatrix, SMatrix, SVector, UnitQuaternion, Vector3,
    Vector4, Vector6,
};

use crate::statics::rod::{Behind, Piece, Rod, UNKNOWNS};
use crate::statics::step::TURNS;

/// Weight of the square of what a tube's end is off by, of the tube's stiffness: so large that all that may still give way is what the plates let.
const HOLD: f64 = 1e3;

/// Points of a tube's end and directions of the plate behind, along which its place is held: the middle of the end, and two points off the axis.
const HOLDS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// Derivatives by the motion of the plates before and behind a tube: shift and turn about the plate's origin, of each.
type ByPlates<const R: usize> = SMatrix<f64, R, 12>;

/// A tube between two plates.
#[derive(Clone, Debug)]
pub(super) struct Held {
    /// From the plate before to where it starts, and from the plate behind to where it ends.
    pub(super) at: Isometry3<f64>,
    pub(super) rod: Rod,
    pub(super) q: DVector<f64>,
    /// Forces that hold its end, N.
    pub(super) forces_n: Vector6<f64>,
}

/// How a tube's own unknowns follow the plates: what they change by with the plates held, and by the motion of the plates.
pub(super) struct Follows {
    pub(super) q: (DVector<f64>, OMatrix<f64, Dyn, Const<12>>),
    pub(super) forces: (Vector6<f64>, ByPlates<6>),
}

/// The potential of a tube with its own unknowns eliminated, by the motion of its plates.
pub(super) struct Condensed {
    pub(super) gradient: SVector<f64, 12>,
    pub(super) tangent: SMatrix<f64, 12, 12>,
    pub(super) follows: Follows,
}

/// Minus the second derivatives of the work of dead forces by a turn of what they act on, of `sum r f^T`.
pub(super) fn turned(moment: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(moment.trace()) - 0.5 * (moment + moment.transpose())
}

/// `sum r x f` of `sum r f^T`.
pub(super) fn torque(moment: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(moment[(1, 2)] - moment[(2, 1)], moment[(2, 0)] - moment[(0, 2)], moment[(0, 1)] - moment[(1, 0)])
}

/// Moment about another place.
pub(super) fn about(behind: &Behind, place: &Vector3<f64>) -> Matrix3<f64> {
    behind.moment - place * behind.force.transpose()
}

/// Points of a tube's end from its middle, m, as it is turned.
fn points(turn: &UnitQuaternion<f64>, reach_m: f64) -> [Vector3<f64>; 3] {
    [Vector3::zeros(), turn * Vector3::x() * reach_m, turn * Vector3::y() * reach_m]
}

impl Held {
    /// Mean strains in the terms of the stiffness, less those without load.
    pub(super) fn strain(&self) -> Vector4<f64> {
        let of_piece = |(piece, q): (&Piece, &[f64])| piece.differences(q)[0];
        let sum: Vector4<f64> = self.rod.pieces.iter().zip(self.q.as_slice().chunks(UNKNOWNS)).map(of_piece).sum();
        sum / self.rod.pieces.len() as f64
    }

    /// Mean axial force, N.
    pub(super) fn axial_n(&self) -> f64 {
        self.rod.pieces.first().map_or(0.0, |piece| (piece.stiffness * self.strain()).x)
    }

    /// How the end shifts and turns with the unknowns: a column each.
    fn end_by_unknowns(&self) -> [DMatrix<f64>; 2] {
        let count = self.q.len();
        let (mut shifts, mut turns) = (DMatrix::zeros(3, count), DMatrix::zeros(3, count));
        // The work of a unit force along z is the shift along z; its moments have the other two.
        let unit = |end: &Isometry3<f64>| {
            let mut load = Behind::none();
            load.add(&end.translation.vector, &Vector3::z());
            load
        };
        self.rod.assemble(&self.q, 0.0, unit, |index, sums| {
            let at = index * UNKNOWNS;
            turns.columns_mut(at, TURNS).copy_from(&sums.turned);
            for a in 0..UNKNOWNS {
                let arm = sums.arms.column(a);
                shifts.set_column(at + a, &Vector3::new(-arm.y, arm.x, sums.gradient[a]));
            }
        });
        [shifts, turns]
    }

    /// The potential by the motion of the plates with origins at `origins`, m, where the plate behind has the tube's end at `goal`. `None` where
    /// the tube is unstable although its end is held.
    pub(super) fn condense(&self, share: f64, origins: [Vector3<f64>; 2], goal: &Isometry3<f64>) -> Option<Condensed> {
        let count = self.q.len();
        let reach_m = self.rod.pieces.iter().map(|piece| piece.length_m).sum::<f64>();
        let directions = goal.rotation.to_rotation_matrix().into_inner();
        let holds = || HOLDS.iter().map(|(point, axis)| (*point, directions.column(*axis).into_owned())).enumerate();
        let held = |end: &Isometry3<f64>| {
            let points = points(&end.rotation, reach_m);
            let mut loads = Behind::none();
            holds().for_each(|(row, (point, direction))| {
                loads.add(&(end.translation.vector + points[point]), &(direction * self.forces_n[row]));
            });
            loads
        };
        let mut by_turn = DMatrix::zeros(3, count);
        let (potential, loads) = self.rod.assemble(&self.q, share, held, |index, sums| {
            by_turn.columns_mut(index * UNKNOWNS, UNKNOWNS).copy_from(&sums.arms);
        });

        // What the end is off by, and its derivatives.
        let end = potential.poses.last()?;
        let [shifts, turns] = self.end_by_unknowns();
        let [own, wanted] = [end, goal].map(|pose| points(&pose.rotation, reach_m));
        let (mut off, mut by_q, mut by_plates) = (Vector6::zeros(), DMatrix::zeros(6, count), ByPlates::<6>::zeros());
        let mut on_goal = Behind::none();
        for (row, (point, direction)) in holds() {
            let (here, there) = (end.translation.vector + own[point], goal.translation.vector + wanted[point]);
            off[row] = direction.dot(&(here - there));
            by_q.row_mut(row).tr_copy_from(&(shifts.tr_mul(&direction) + turns.tr_mul(&own[point].cross(&direction))));
            let before = [direction, (here - origins[0]).cross(&direction)];
            let behind = [-direction, -(there - origins[1]).cross(&direction)];
            let motions = before.iter().chain(&behind).flat_map(Vector3::iter);
            by_plates.row_mut(row).iter_mut().zip(motions).for_each(|(to, from)| *to = *from);
            on_goal.add(&there, &(direction * -self.forces_n[row]));
        }

        let (mut gradient, mut tangent) = (SVector::<f64, 12>::zeros(), SMatrix::<f64, 12, 12>::zeros());
        for (at, loads, origin) in [(0, &loads, &origins[0]), (6, &on_goal, &origins[1])] {
            let moment = about(loads, origin);
            gradient.fixed_rows_mut::<3>(at).copy_from(&-loads.force);
            gradient.fixed_rows_mut::<3>(at + 3).copy_from(&-torque(&moment));
            tangent.fixed_view_mut::<3, 3>(at + 3, at + 3).copy_from(&turned(&moment));
        }
        let mut mixed = OMatrix::<f64, Dyn, Const<12>>::zeros(count);
        mixed.fixed_columns_mut::<3>(3).copy_from(&-by_turn.transpose());

        // The unknowns, then the forces, are eliminated.
        let hold = HOLD * self.rod.pieces.first()?.stiffness[(0, 0)] / reach_m;
        let factor = (&potential.tangent + by_q.tr_mul(&by_q) * hold).cholesky()?;
        let still = factor.solve(&-(&potential.gradient + by_q.tr_mul(&off) * hold));
        let carried = factor.solve(&(&mixed + by_q.tr_mul(&by_plates) * hold));
        let pushed = factor.solve(&by_q.transpose());
        let give = Matrix6::from_iterator((&by_q * &pushed).iter().copied()).cholesky()?;
        let left = Vector6::from_iterator((&by_q * &still).iter().copied()) + off;
        let moved = ByPlates::<6>::from_iterator((&by_q * &carried).iter().copied()) - by_plates;
        let forces = (-give.solve(&left), give.solve(&moved));
        let q = (still + &pushed * forces.0, &pushed * forces.1 - carried);
        gradient += mixed.tr_mul(&q.0) - by_plates.tr_mul(&forces.0);
        tangent += mixed.tr_mul(&q.1) - by_plates.tr_mul(&forces.1);
        Some(Condensed { gradient, tangent, follows: Follows { q, forces } })
    }
}
