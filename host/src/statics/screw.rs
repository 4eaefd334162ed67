//! Screws: rates of rotation and translation, their brackets and exponentials.

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

/// Terms of the series of the exponential's derivative: for half a radian a step they leave 1e-9.
const TERMS: usize = 9;

/// A rotation rate and a velocity of the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Screw {
    pub(super) turn: Vector3<f64>,
    pub(super) shift: Vector3<f64>,
}

impl Screw {
    pub(super) fn zero() -> Self {
        Self { turn: Vector3::zeros(), shift: Vector3::zeros() }
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { turn: self.turn * factor, shift: self.shift * factor }
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        Self { turn: self.turn + other.turn, shift: self.shift + other.shift }
    }

    /// `[a, b]`.
    pub(super) fn bracket(&self, other: &Self) -> Self {
        Self {
            turn: self.turn.cross(&other.turn),
            shift: self.turn.cross(&other.shift) - other.turn.cross(&self.shift),
        }
    }

    /// The same screw seen from the frame that `pose` is given in.
    pub(super) fn seen(&self, rotation: &Matrix3<f64>, origin: &Vector3<f64>) -> Self {
        let turn = rotation * self.turn;
        Self { turn, shift: rotation * self.shift + origin.cross(&turn) }
    }
}

/// The exponential of a screw and its derivative: `d(exp X) exp(-X) = D dX` with `D` of two blocks.
pub(super) struct Exponential {
    pub(super) pose: Isometry3<f64>,
    block: Matrix3<f64>,
    coupling: Matrix3<f64>,
}

impl Exponential {
    pub(super) fn new(of: &Screw) -> Self {
        let (turn, shift) = (of.turn.cross_matrix(), of.shift.cross_matrix());
        // Powers of ad X: those of the block, and the sum of products with one coupling.
        let (mut power, mut mixed) = (Matrix3::identity(), Matrix3::zeros());
        let (mut block, mut coupling) = (power, mixed);
        let mut factor = 1.0;
        for k in 1..TERMS {
            mixed = turn * mixed + shift * power;
            power = turn * power;
            factor /= k as f64 + 1.0;
            block += power * factor;
            coupling += mixed * factor;
        }
        let pose =
            Isometry3::from_parts(Translation3::from(block * of.shift), UnitQuaternion::from_scaled_axis(of.turn));
        Self { pose, block, coupling }
    }

    /// The change of the exponential with a change of the screw, seen from the start.
    pub(super) fn change(&self, by: &Screw) -> Screw {
        Screw { turn: self.block * by.turn, shift: self.block * by.shift + self.coupling * by.turn }
    }
}
