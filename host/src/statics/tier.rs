//! How much model a pose needs: the cheapest tier whose estimated error is within a tolerance.

use nalgebra::{DVector, Vector3};

use super::buckling::Buckling;
use super::load::LoadedLimb;
use super::rod::{Rod, UNKNOWNS};
use super::solve::{Bends, Lost, Shape, solve};

/// What a tier leaves of the error of the one before, at most: strains are constant along a piece and pieces are halved.
const LEFT: f64 = 0.25;

/// Models of a limb under load, the cheapest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tier {
    /// No load at all: the kinematics.
    Kinematic,
    /// A constant bend, twist, stretch and shear a module.
    Constant,
    /// Bends linear along each module.
    Linear,
    /// The same with two pieces a module.
    Double,
    /// The same with four pieces a module.
    Fourfold,
}

impl Tier {
    /// All of them, the cheapest first.
    pub const ALL: [Self; 5] = [Self::Kinematic, Self::Constant, Self::Linear, Self::Double, Self::Fourfold];

    /// Those that a tolerance chooses from. The distance of the constant tier from the linear one is no estimate of its error where the
    /// linear one is far off, too; each of these is much nearer to the truth than the one before.
    pub const CHOICE: [Self; 4] = [Self::Kinematic, Self::Linear, Self::Double, Self::Fourfold];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kinematic => "kinematic",
            Self::Constant => "constant",
            Self::Linear => "linear",
            Self::Double => "linear, two pieces",
            Self::Fourfold => "linear, four pieces",
        }
    }

    /// Pieces a module, and how they bend.
    pub fn pieces(self) -> (usize, Bends) {
        match self {
            Self::Kinematic | Self::Constant => (1, Bends::Constant),
            Self::Linear => (1, Bends::Linear),
            Self::Double => (2, Bends::Linear),
            Self::Fourfold => (4, Bends::Linear),
        }
    }
}

/// A shape by one tier.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The tier.
    pub tier: Tier,
    /// The chain it was solved on.
    pub rod: Rod,
    /// The shape; that without load for the kinematics.
    pub shape: Shape,
    /// Its error by the distance of its tip from that of the next tier, as a share of the limb's length.
    pub order_error: f64,
    /// By how much tubes between plates would have the tip elsewhere, m ([`LoadedLimb::tubes_shift_m`]); `None` where a tube buckles.
    pub bundle_shift_m: Option<Vector3<f64>>,
    /// The same as a share of the length; 1 where a tube buckles.
    pub bundle_error: f64,
    /// The tube that is closest to buckling.
    pub buckling: Option<Buckling>,
}

impl Answer {
    /// The larger of both errors, as a share of the limb's length.
    pub fn error(&self) -> f64 {
        self.order_error.max(self.bundle_error)
    }
}

/// By one tier; `start` are the unknowns of an earlier answer of it.
///
/// # Errors
/// [`Lost`] where the limb does not carry the load.
pub fn by_tier(rod: &Rod, tier: Tier, start: Option<&DVector<f64>>) -> Result<(Rod, Shape), Lost> {
    let (parts, bends) = tier.pieces();
    let rod = rod.split(parts);
    if tier == Tier::Kinematic {
        let q = DVector::zeros(rod.unknowns());
        let potential = rod.potential(&q, 1.0);
        return Ok((rod, Shape { q, potential, iterations: 0, steps: 0 }));
    }
    let shape = solve(&rod, bends, start)?;
    Ok((rod, shape))
}

/// The cheapest tier of [`Tier::CHOICE`] whose error is at most `tolerance` (a share of the limb's length at rest, `length_m`), or the finest.
///
/// The error is judged by the distance from the next tier, over 3/4, since the next one leaves up to a quarter of it; that of the finest
/// is a quarter of the error of the one before. What a rod leaves out of a bundle is the same for all tiers and does not choose between them.
///
/// # Errors
/// [`Lost`] where the limb does not carry the load.
pub fn cheapest(limb: &LoadedLimb, tolerance: f64, length_m: f64) -> Result<Answer, Lost> {
    let judge = |rod: &Rod, shape: &Shape, bends| Judged {
        buckling: limb.buckling(rod, shape),
        shift_m: limb.tubes_shift_m(rod, shape, bends),
    };
    choose(&limb.rod, tolerance, length_m, judge)
}

/// What tubes make of a shape of the rod.
#[derive(Clone, Copy, Debug, Default)]
pub struct Judged {
    /// The one that is closest to buckling.
    pub buckling: Option<Buckling>,
    /// By how much they would have the tip elsewhere, m; `None` where one buckles.
    pub shift_m: Option<Vector3<f64>>,
}

/// [`cheapest`] of a rod; `judge` says what its tubes make of a shape.
///
/// # Errors
/// As [`cheapest`].
pub fn choose(
    rod: &Rod,
    tolerance: f64,
    length_m: f64,
    judge: impl Fn(&Rod, &Shape, Bends) -> Judged,
) -> Result<Answer, Lost> {
    let mut last = by_tier(rod, Tier::Kinematic, None)?;
    for pair in Tier::CHOICE.windows(2) {
        let start = begin(&last, pair[0], pair[1]);
        let next = by_tier(rod, pair[1], start.as_ref())?;
        let distance = (next.1.tip().translation.vector - last.1.tip().translation.vector).norm() / length_m;
        let estimate = distance / (1.0 - LEFT);
        let found = if estimate <= tolerance {
            let judged = judge(&next.0, &next.1, pair[1].pieces().1);
            (pair[0], last, estimate, judged)
        } else if pair[1] == Tier::Fourfold {
            let judged = judge(&next.0, &next.1, pair[1].pieces().1);
            (pair[1], next, LEFT * estimate, judged)
        } else {
            last = next;
            continue;
        };
        let (tier, (rod, shape), order_error, Judged { buckling, shift_m }) = found;
        let bundle_error = shift_m.map_or(1.0, |shift| shift.norm() / length_m);
        return Ok(Answer { tier, rod, shape, order_error, bundle_shift_m: shift_m, bundle_error, buckling });
    }
    // The last pair has returned.
    Err(Lost::Unstable { share: 0.0 })
}

/// Unknowns of the next tier to begin with: those of the same pieces, or the bends of a whole piece read off at the halves.
fn begin((rod, shape): &(Rod, Shape), from: Tier, to: Tier) -> Option<DVector<f64>> {
    let (own, next) = (from.pieces().0, to.pieces().0);
    if from == Tier::Kinematic {
        return None;
    }
    if own == next {
        return Some(shape.q.clone());
    }
    let parts = next / own;
    let mut q = Vec::with_capacity(rod.unknowns() * parts);
    for piece in shape.q.as_slice().chunks(UNKNOWNS) {
        for part in 0..parts {
            let middle = (2 * part + 1) as f64 / parts as f64 - 1.0;
            let mut own: [f64; UNKNOWNS] = std::array::from_fn(|a| piece[a]);
            for slope in [1, 3] {
                own[slope - 1] += piece[slope] * middle;
                own[slope] /= parts as f64;
            }
            q.extend(own);
        }
    }
    Some(DVector::from_vec(q))
}
