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

/// A linear function of screws, as a couple and a force that do work on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wrench {
    pub(super) couple: Vector3<f64>,
    pub(super) force: Vector3<f64>,
}

impl Wrench {
    pub(super) fn zero() -> Self {
        Self { couple: Vector3::zeros(), force: Vector3::zeros() }
    }

    /// The work on a screw.
    pub(super) fn on(&self, screw: &Screw) -> f64 {
        self.couple.dot(&screw.turn) + self.force.dot(&screw.shift)
    }

    /// Adds a multiple of another one.
    pub(super) fn add(&mut self, other: &Self, factor: f64) {
        self.couple += other.couple * factor;
        self.force += other.force * factor;
    }

    /// The function `c -> self([x, c])`.
    pub(super) fn after_bracket(&self, x: &Screw) -> Self {
        Self { couple: self.couple.cross(&x.turn) + self.force.cross(&x.shift), force: self.force.cross(&x.turn) }
    }
}

/// The second derivative of `exp X` by two directions `a`, `b`, as far as it is symmetric, in a function of screws: with `D` of
/// [`Exponential`], half of `(dD/db) a + (dD/da) b`. As `ad X` is put on the function's side once for all pairs, a pair costs one
/// product: `(a . second[b] + b . second[a])/2`.
pub(super) struct Second<const N: usize> {
    /// For each direction the wrench that does the work on the other one.
    wrenches: [Wrench; N],
    /// The function of `D` of a screw.
    of_change: Wrench,
}

impl<const N: usize> Second<N> {
    pub(super) fn new(screw: &Screw, directions: &[Screw; N], function: &Wrench) -> Self {
        // functions[j](c) = function((ad X)^j c).
        let mut functions = [*function; TERMS];
        for j in 1..TERMS {
            functions[j] = functions[j - 1].after_bracket(screw);
        }
        let weighted = |from: usize| {
            let mut sum = Wrench::zero();
            let mut factor = (1..=from).fold(1.0, |product, k| product / k as f64);
            for (j, function) in functions[..TERMS - from.min(TERMS)].iter().enumerate() {
                sum.add(function, factor);
                factor /= (from + j + 1) as f64;
            }
            sum
        };
        let of_change = weighted(1);
        let mut wrenches = [Wrench::zero(); N];
        let mut powers = *directions;
        for m in 0..TERMS - 2 {
            let function = weighted(m + 2);
            for (power, wrench) in powers.iter_mut().zip(&mut wrenches) {
                // function([b, c]) = -function([c, b]).
                wrench.add(&function.after_bracket(power), -1.0);
                *power = screw.bracket(power);
            }
        }
        Self { wrenches, of_change }
    }

    /// The derivative by two of the directions.
    pub(super) fn of(&self, directions: &[Screw; N], a: usize, b: usize) -> f64 {
        0.5 * (self.wrenches[b].on(&directions[a]) + self.wrenches[a].on(&directions[b]))
    }

    /// What a second derivative of the screw itself adds.
    pub(super) fn of_screw(&self, second: &Screw) -> f64 {
        self.of_change.on(second)
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
