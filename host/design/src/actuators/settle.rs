//! The augmented Lagrangian of a limb on one supply line: solves and updates of the multipliers in turn.

use super::shared::{Line, STIFFNESS, Shared};
use softlimb_numerics::least_squares::{LeastSquares, Minimum, StoppingCriteria, minimise, sum_of_squares};

/// Largest violation of a margin at the end, as a share of the highest pressure.
const VIOLATION: f64 = 1e-9;
/// Most updates of the multipliers.
const UPDATES: usize = 10;
/// Where an update leaves more than this share of the violation before it, `rho` grows ...
const SLOW: f64 = 0.1;
/// ... by this factor.
const STIFFER: f64 = 10.0;
/// A descent whose rough minimum is as many times the least objective found is not gone on with.
const HOPELESS: f64 = 1.3;
/// Least relative gain of a step in the solve after the rough one.
const MIDDLE: f64 = 1e-4;
/// A descent whose minimum after that solve is as many times the least is not gone on with.
const WORSE: f64 = 1.03;

/// The least squares of a limb, in whatever variables.
pub(super) trait OnLine<'a>: LeastSquares<Evaluation = Line<'a>> {
    fn limb(&mut self) -> &mut Shared<'a>;
}

impl<'a> OnLine<'a> for Shared<'a> {
    fn limb(&mut self) -> &mut Self {
        self
    }
}

/// Goes on from a rough minimum until the margins are kept, and then takes back what is left above them.
pub(super) fn settle<'a, P: OnLine<'a>>(
    problem: &mut P,
    rough: Minimum<Line<'a>>,
    criteria: StoppingCriteria,
) -> Minimum<Line<'a>> {
    let (mut best, mut stiffness, mut before) = (rough, STIFFNESS, f64::INFINITY);
    problem.limb().update(&best.evaluation);
    for update in 0..UPDATES {
        let limb = problem.limb();
        let objective = sum_of_squares(&limb.differences(&best.evaluation));
        let (most, least_gain) = if update == 0 { (HOPELESS, MIDDLE) } else { (WORSE, criteria.least_gain) };
        if objective > most * limb.least {
            break;
        }
        limb.stiffen(stiffness * objective.max(criteria.zero));
        let Some(next) = minimise(problem, &best.point, StoppingCriteria { least_gain, ..criteria }) else { break };
        best = next;
        let violation = problem.limb().update(&best.evaluation);
        if violation <= VIOLATION && update > 0 {
            break;
        }
        if violation > SLOW * before {
            stiffness *= STIFFER;
        }
        before = violation;
    }
    let limb = problem.limb();
    let allowed = limb.allowed(&best.evaluation);
    let (objective, evaluation) = allowed.unwrap_or((f64::INFINITY, best.evaluation));
    limb.least = limb.least.min(objective);
    Minimum { objective, evaluation, ..best }
}
