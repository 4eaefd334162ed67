//! How much model a pose needs: the cheapest tier whose estimated error is within a tolerance.

use nalgebra::{DVector, Isometry3, Matrix3, Vector3};

use super::buckling::Buckling;
use super::load::LoadedLimb;
use super::plates::Plates;
use super::rod::{Rod, UNKNOWNS};
use super::solve::{Bends, EquilibriumError, LOAD_FACTOR_MAX, Shape, solve};

/// What a tier leaves of the error of the one before, at most: strains are constant along a piece and pieces are halved.
const LEFT: f64 = 0.25;

/// Pieces of the tubes ([`LoadedLimb::tubes_near`]), the fewest first; the first is to judge the second by.
const FINENESS: [usize; 3] = [2, 4, 8];
/// Compression of a tube over its load of buckling above which rods are not right, and nothing to begin at.
const BUCKLED: f64 = 0.5;

/// Models of a limb under load, the cheapest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fidelity {
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
    /// Every tube a rod of its own between rigid plates ([`by_tubes`]).
    Tubes,
}

impl Fidelity {
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
    pub tier: Fidelity,
    /// The chain it was solved on.
    pub rod: Rod,
    /// The shape; that without load for the kinematics.
    pub shape: Shape,
    /// Its error by the distance of its tip from that of the next tier, as a share of the limb's length.
    pub order_error: f64,
    /// By how much tubes between plates would have the tip elsewhere, m ([`LoadedLimb::tubes_shift_m`]); `None` where a tube buckles. Of
    /// [`Fidelity::Tubes`] how far they have it from where the finest rods do.
    pub bundle_shift_m: Option<Vector3<f64>>,
    /// The same as a share of the length; 1 where a tube buckles, 0 for [`Fidelity::Tubes`], which leaves nothing out of a bundle.
    pub bundle_error: f64,
    /// Where tubes took the place of rods: the tubes, and the error of the rods, whose shape `shape` is.
    pub tubes: Option<(Plates, f64)>,
    /// The tube that is closest to buckling.
    pub buckling: Option<Buckling>,
}

impl Answer {
    /// The larger of both errors, as a share of the limb's length.
    pub fn error(&self) -> f64 {
        self.order_error.max(self.bundle_error)
    }

    /// How far the tip gives way to a small force on it, m/N: column by direction of the force.
    pub fn compliance_m_per_n(&self) -> Option<Matrix3<f64>> {
        match &self.tubes {
            Some((plates, _)) => plates.compliance_m_per_n(),
            None => self.shape.compliance_m_per_n(&self.rod, self.tier.pieces().1),
        }
    }

    /// The share of all loads, at the same pressures, at which the limb loses its stability, from 1 to [`LOAD_FACTOR_MAX`], which stands for that and more.
    pub fn load_factor(&self) -> f64 {
        self.load_factor_to(LOAD_FACTOR_MAX)
    }

    /// The same, followed no farther than to `most` >= 1, which stands for that and more.
    pub fn load_factor_to(&self, most: f64) -> f64 {
        match &self.tubes {
            Some((plates, _)) => plates.load_factor_to(most),
            None => self.shape.load_factor_to(&self.rod, self.tier.pieces().1, most),
        }
    }

    /// Pose of the tip.
    pub fn tip(&self) -> Isometry3<f64> {
        self.tubes.as_ref().map_or_else(|| self.shape.tip(), |(plates, _)| plates.tip())
    }
}

/// By one tier of rods, [`Fidelity::Fourfold`] for [`Fidelity::Tubes`]; `start` are the unknowns of an earlier answer of it.
///
/// # Errors
/// [`EquilibriumError`] where the limb does not carry the load.
pub fn by_fidelity(rod: &Rod, tier: Fidelity, start: Option<&DVector<f64>>) -> Result<(Rod, Shape), EquilibriumError> {
    let (parts, bends) = tier.pieces();
    let rod = rod.split(parts);
    if tier == Fidelity::Kinematic {
        let q = DVector::zeros(rod.unknowns());
        let potential = rod.potential(&q, 1.0);
        return Ok((rod, Shape { q, potential, iterations: 0, steps: 0 }));
    }
    let shape = solve(&rod, bends, start)?;
    Ok((rod, shape))
}

/// The cheapest tier whose error is at most `tolerance` (a share of the limb's length at rest, `length_m`), or the finest: rods, and tubes between
/// plates where no rods do. Where tubes have no shape that the limb at rest leads to, the answer is that of the rods.
///
/// Springs are those about the strains of the linear rods ([`LoadedLimb::settle`]).
///
/// # Errors
/// [`EquilibriumError`] where the limb does not carry the load.
pub fn cheapest(limb: &LoadedLimb, tolerance: f64, length_m: f64) -> Result<Answer, EquilibriumError> {
    let limb = limb.settle(Fidelity::Linear, None)?.limb;
    let answer = of_rods(&limb, tolerance, length_m)?;
    let tubes = (answer.error() > tolerance).then(|| of_tubes(&limb, tolerance, length_m)).flatten();
    Ok(tubes.unwrap_or(answer))
}

/// The limb with every tube a rod of its own, in as few pieces as have an error of at most `tolerance` (a share of `length_m`), or in the most.
/// `None` where rods have no shape or tubes none that the limb at rest leads to.
///
/// The error is a third of the distance from half as many pieces, which have four times the error. Springs are those of [`cheapest`].
pub fn by_tubes(limb: &LoadedLimb, tolerance: f64, length_m: f64) -> Option<Answer> {
    of_tubes(&limb.settle(Fidelity::Linear, None).ok()?.limb, tolerance, length_m)
}

fn of_tubes(limb: &LoadedLimb, tolerance: f64, length_m: f64) -> Option<Answer> {
    // No distance is below that tolerance, so that the finest is taken.
    let rods = of_rods(limb, -1.0, length_m).ok()?;
    let sound = rods.buckling.is_none_or(|tube| tube.ratio() <= BUCKLED);
    let of = |fine: usize| {
        let near = sound.then(|| limb.tubes_near(&rods.rod, &rods.shape.q, fine)).flatten();
        near.or_else(|| limb.tubes_grown(fine))
    };
    let way = |from: &Isometry3<f64>, to: &Isometry3<f64>| to.translation.vector - from.translation.vector;
    let told =
        |coarse: &Plates, plates: &Plates| LEFT / (1.0 - LEFT) * way(&coarse.tip(), &plates.tip()).norm() / length_m;
    // Close to where the limb falls, few pieces may be beyond it.
    let mut finer = FINENESS.into_iter().filter_map(of);
    let (mut coarse, mut plates) = (finer.next()?, finer.next()?);
    while told(&coarse, &plates) > tolerance
        && let Some(next) = finer.next()
    {
        (coarse, plates) = (plates, next);
    }
    Some(Answer {
        tier: Fidelity::Tubes,
        order_error: told(&coarse, &plates),
        bundle_shift_m: Some(way(&rods.shape.tip(), &plates.tip())),
        bundle_error: 0.0,
        buckling: plates.buckling(limb),
        tubes: Some((plates, rods.error())),
        ..rods
    })
}

/// The cheapest tier of [`Fidelity::CHOICE`] whose error is at most `tolerance` (a share of the limb's length at rest, `length_m`), or the finest.
///
/// The error is judged by the distance from the next tier, over 3/4, since the next one leaves up to a quarter of it; that of the finest
/// is a quarter of the error of the one before. What a rod leaves out of a bundle is the same for all tiers and does not choose between them.
/// Springs are those of [`cheapest`].
///
/// # Errors
/// [`EquilibriumError`] where the limb does not carry the load.
pub fn cheapest_rod(limb: &LoadedLimb, tolerance: f64, length_m: f64) -> Result<Answer, EquilibriumError> {
    of_rods(&limb.settle(Fidelity::Linear, None)?.limb, tolerance, length_m)
}

fn of_rods(limb: &LoadedLimb, tolerance: f64, length_m: f64) -> Result<Answer, EquilibriumError> {
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
) -> Result<Answer, EquilibriumError> {
    let mut last = by_fidelity(rod, Fidelity::Kinematic, None)?;
    for pair in Fidelity::CHOICE.windows(2) {
        let start = begin(&last, pair[0], pair[1]);
        let next = by_fidelity(rod, pair[1], start.as_ref())?;
        let distance = (next.1.tip().translation.vector - last.1.tip().translation.vector).norm() / length_m;
        let estimate = distance / (1.0 - LEFT);
        let found = if estimate <= tolerance {
            let judged = judge(&next.0, &next.1, pair[1].pieces().1);
            (pair[0], last, estimate, judged)
        } else if pair[1] == Fidelity::Fourfold {
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
            tubes: None,
            buckling,
        });
    }
    // The last pair has returned.
    Err(EquilibriumError::Unstable { share: 0.0 })
}

/// Unknowns of the next tier to begin with: those of the same pieces, or the bends of a whole piece read off at the halves.
fn begin((rod, shape): &(Rod, Shape), from: Fidelity, to: Fidelity) -> Option<DVector<f64>> {
    let (own, next) = (from.pieces().0, to.pieces().0);
    if from == Fidelity::Kinematic {
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
