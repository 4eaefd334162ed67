//! How much model a pose needs: the cheapest tier whose estimated error is within a tolerance.

use nalgebra::{DVector, Vector3};

use super::buckling::Buckling;
use super::load::LoadedLimb;
use super::rod::{Rod, UNKNOWNS};
use super::solve::{Bends, Lost, Shape, solve};

/// What a tier leaves of the error of the one before, at most: strains are constant along a piece and pieces are halved.
const LEFT: f64 = 0.25;

/// What tubes between plates leave of the error of rods, about; see `what_tubes_between_plates_leave_is_told` in `host/tests/statics/bundles.rs`.
const LEFT_BY_TUBES: f64 = 1.0 / 6.0;
/// Compression of a tube over its load of buckling above which no tier is right.
const BUCKLED: f64 = 0.5;

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
    /// The same with the tubes of each bundle as beams between their plates ([`LoadedLimb::with_tubes`]).
    Tubes,
}

impl Tier {
    /// All of them, the cheapest first.
    pub const ALL: [Self; 6] =
        [Self::Kinematic, Self::Constant, Self::Linear, Self::Double, Self::Fourfold, Self::Tubes];

    /// The rods that a tolerance chooses from. The distance of the constant tier from the linear one is no estimate of its error where the
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
            Self::Tubes => "tubes between plates",
        }
    }

    /// Pieces a module, and how they bend.
    pub fn pieces(self) -> (usize, Bends) {
        match self {
            Self::Kinematic | Self::Constant => (1, Bends::Constant),
            Self::Linear => (1, Bends::Linear),
            Self::Double => (2, Bends::Linear),
            Self::Fourfold | Self::Tubes => (4, Bends::Linear),
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
    /// By how much tubes between plates would have the tip elsewhere, m ([`LoadedLimb::tubes_shift_m`]); `None` where a tube buckles. Of
    /// [`Tier::Tubes`] how far they have it from where the finest rods do.
    pub bundle_shift_m: Option<Vector3<f64>>,
    /// The same as a share of the length; 1 where a tube buckles. A sixth of it for [`Tier::Tubes`].
    pub bundle_error: f64,
    /// The error of the rods that did not do, where tubes took their place.
    pub rods_error: Option<f64>,
    /// The tube that is closest to buckling.
    pub buckling: Option<Buckling>,
}

impl Answer {
    /// The larger of both errors, as a share of the limb's length.
    pub fn error(&self) -> f64 {
        self.order_error.max(self.bundle_error)
    }
}

/// By one tier of rods, [`Tier::Fourfold`] for [`Tier::Tubes`]; `start` are the unknowns of an earlier answer of it.
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

/// The cheapest tier whose error is at most `tolerance` (a share of the limb's length at rest, `length_m`), or the finest: rods, and tubes between
/// plates where rods do in all but that they are no tubes.
///
/// Where a tube carries more than half of its load of buckling, or tubes have no equilibrium, the answer is that of the rods.
///
/// # Errors
/// [`Lost`] where the limb does not carry the load.
pub fn cheapest(limb: &LoadedLimb, tolerance: f64, length_m: f64) -> Result<Answer, Lost> {
    let answer = cheapest_rod(limb, tolerance, length_m)?;
    let tubes = if answer.order_error <= tolerance && answer.bundle_error > tolerance {
        by_tubes(limb, length_m)
    } else {
        None
    };
    Ok(tubes.map_or_else(|| answer.clone(), |tubes| Answer { rods_error: Some(answer.error()), ..tubes }))
}

/// The limb with its tubes between plates, from the finest rods; `None` where they have no equilibrium or one is beyond half of its load of buckling.
pub fn by_tubes(limb: &LoadedLimb, length_m: f64) -> Option<Answer> {
    // No distance is below that tolerance, so that the finest is taken.
    let rods = cheapest_rod(limb, -1.0, length_m).ok()?;
    let sound = |rod: &Rod, shape: &Shape| limb.buckling(rod, shape).is_none_or(|tube| tube.ratio() <= BUCKLED);
    let shape = sound(&rods.rod, &rods.shape).then(|| limb.with_tubes(&rods.rod, &rods.shape)).flatten()?;
    let way = shape.tip().translation.vector - rods.shape.tip().translation.vector;
    sound(&rods.rod, &shape).then(|| Answer {
        tier: Tier::Tubes,
        bundle_shift_m: Some(way),
        bundle_error: LEFT_BY_TUBES * way.norm() / length_m,
        rods_error: Some(rods.error()),
        buckling: limb.buckling(&rods.rod, &shape),
        shape,
        ..rods
    })
}

/// The cheapest tier of [`Tier::CHOICE`] whose error is at most `tolerance` (a share of the limb's length at rest, `length_m`), or the finest.
///
/// The error is judged by the distance from the next tier, over 3/4, since the next one leaves up to a quarter of it; that of the finest
/// is a quarter of the error of the one before. What a rod leaves out of a bundle is the same for all tiers and does not choose between them.
///
/// # Errors
/// [`Lost`] where the limb does not carry the load.
pub fn cheapest_rod(limb: &LoadedLimb, tolerance: f64, length_m: f64) -> Result<Answer, Lost> {
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

/// [`cheapest_rod`] of a rod; `judge` says what its tubes make of a shape.
///
/// # Errors
/// As [`cheapest_rod`].
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
        return Ok(Answer {
            tier,
            rod,
            shape,
            order_error,
            bundle_shift_m: shift_m,
            bundle_error,
            rods_error: None,
            buckling,
        });
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
