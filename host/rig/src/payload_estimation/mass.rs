//! The mass by least squares, with its interval.

use nalgebra::Vector3;

use super::creep::at_ends_m3;
use super::limb::{Posed, Tip};
use super::{EstimationError, Observation};
use softlimb_limb::Limb;
use softlimb_motion::Plan;
use softlimb_numerics::statistics::student_quantile;
use softlimb_scene::Scene;

/// Probability of the interval.
const CONFIDENCE: f64 = 0.95;
/// Most steps of the search, the least fraction of one, and the size of one at which it ends, kg.
const STEPS: usize = 40;
const LEAST_FRACTION: f64 = 1e-3;
const CONVERGED_KG: f64 = 1e-6;
/// Relative growth of the sum of squares that a step may have: its last digits are those of the solver.
const ROUNDING: f64 = 1e-6;
/// Least displacement that a camera resolves, m/kg.
const LEAST_M_PER_KG: f64 = 1e-6;
/// A displacement has three coordinates.
const COORDINATES: usize = 3;

/// An estimated mass.
#[derive(Clone, Debug, PartialEq)]
pub struct Mass {
    /// The mass, kg. Below zero only where errors are larger than it.
    pub kg: f64,
    /// Half width of the interval by the scatter of the phases, kg.
    pub scatter_kg: f64,
    /// Change of the mass with a limb that is stiffer by the stated error, kg.
    pub stiffness_kg: f64,
    /// Both together: the ends of the interval of 95 %, kg.
    pub interval_kg: [f64; 2],
    /// Degrees of freedom of the scatter.
    pub freedom: usize,
    /// Root mean square residual of a coordinate of the displacements, with the degrees of freedom in the mean, m.
    pub left_m: f64,
    /// The displacement in each phase, in their order.
    pub displacements: Vec<Displacement>,
    /// Residual of each observation against the mean of those of its phase without the load, m.
    pub residuals_m: Vec<Vector3<f64>>,
}

/// Displacement of the tip under the load in a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement {
    /// Index of the phase.
    pub phase: usize,
    /// Observed displacement, m.
    pub observed_m: Vector3<f64>,
    /// Displacement by the model under the estimated mass, m.
    pub modelled_m: Vector3<f64>,
}

/// Estimates the mass on the tip from observations at the ends of phases of a plan, with the creep of the walls up to then.
///
/// `stiffness_error` is the relative error of the limb's stiffness, the same everywhere, at the confidence of the interval.
///
/// # Errors
/// [`EstimationError`] where the observations give no mass.
pub fn mass(
    scene: &Scene,
    limb: &Limb,
    plan: &Plan,
    observations: &[Observation],
    stiffness_error: f64,
) -> Result<Mass, EstimationError> {
    let mut phases: Vec<usize> = observations.iter().map(|one| one.phase).collect();
    phases.sort_unstable();
    phases.dedup();
    let has = |phase: usize, loaded: bool| observations.iter().any(|one| (one.phase, one.loaded) == (phase, loaded));
    phases.retain(|phase| has(*phase, false) && has(*phase, true));
    if phases.len() < 2 {
        return Err(EstimationError::TooFewPhases { phases: phases.len() });
    }
    let crept_m3 = at_ends_m3(scene, limb, plan);
    let search = |stiffer: f64| {
        let posed = |one| Posed::new(scene, limb, one, &crept_m3[one.phase], stiffer);
        let limbs = observations.iter().map(posed).collect::<Result<_, _>>()?;
        Search { observations, phases: &phases, limbs }.run()
    };
    let found = search(1.0)?;
    let stiffer = search(1.0 + stiffness_error)?;
    let freedom = COORDINATES * phases.len() - 1;
    let scatter = found.squares / freedom as f64;
    let scatter_kg = student_quantile(CONFIDENCE, freedom) * (scatter / found.slopes).sqrt();
    let stiffness_kg = (stiffer.kg - found.kg).abs();
    let half_kg = scatter_kg.hypot(stiffness_kg);
    let unweighted: f64 = found.displacements.iter().map(|one| (one.observed_m - one.modelled_m).norm_squared()).sum();
    Ok(Mass {
        kg: found.kg,
        scatter_kg,
        stiffness_kg,
        interval_kg: [found.kg - half_kg, found.kg + half_kg],
        freedom,
        left_m: (unweighted / freedom as f64).sqrt(),
        displacements: found.displacements,
        residuals_m: found.residuals_m,
    })
}

struct Search<'a> {
    observations: &'a [Observation],
    phases: &'a [usize],
    limbs: Vec<Posed>,
}

/// Residuals under a trial mass.
struct Trial {
    kg: f64,
    /// Sum of the squared residuals of the displacements, in units of their accuracy, and half of its negative slope by the mass, 1/kg.
    squares: f64,
    downhill: f64,
    /// Sum of the squares of the slopes of the displacements by the mass in these units, 1/kg2.
    slopes: f64,
    /// The largest slope, m/kg.
    most_m_per_kg: f64,
    displacements: Vec<Displacement>,
    residuals_m: Vec<Vector3<f64>>,
}

impl Search<'_> {
    /// Gauss-Newton for one unknown without bounds, each step as long as the limb stands and the sum of squares does not rise. Unlike the
    /// bounded solver of `softlimb-numerics`, it tells a limb that falls under a trial mass from a solve that does not converge.
    fn run(mut self) -> Result<Trial, EstimationError> {
        let mut here = self.under(0.0)?;
        if here.most_m_per_kg < LEAST_M_PER_KG {
            return Err(EstimationError::NotMoved { most_m_per_kg: here.most_m_per_kg });
        }
        for _ in 0..STEPS {
            let step = here.downhill / here.slopes;
            if step.abs() <= CONVERGED_KG {
                return Ok(here);
            }
            let mut fraction = 1.0;
            here = loop {
                let fallen = match self.under(here.kg + fraction * step) {
                    Ok(there) if there.squares <= here.squares * (1.0 + ROUNDING) => break there,
                    Ok(_) => None,
                    Err(EstimationError::Falls { line }) => Some(line),
                    Err(other) => return Err(other),
                };
                fraction *= 0.5;
                if fraction < LEAST_FRACTION {
                    return Err(match fallen {
                        Some(line) => EstimationError::TooFar { line, carried_kg: here.kg },
                        None => EstimationError::NotSettled { steps: STEPS, kg: here.kg },
                    });
                }
            };
        }
        Err(EstimationError::NotSettled { steps: STEPS, kg: here.kg })
    }

    fn under(&mut self, kg: f64) -> Result<Trial, EstimationError> {
        let limbs = self.limbs.iter_mut().zip(self.observations);
        let tips: Vec<Tip> =
            limbs.map(|(limb, one)| limb.under(if one.loaded { kg } else { 0.0 })).collect::<Result<_, _>>()?;
        let mut trial = Trial {
            kg,
            squares: 0.0,
            downhill: 0.0,
            slopes: 0.0,
            most_m_per_kg: 0.0,
            displacements: Vec::with_capacity(self.phases.len()),
            residuals_m: vec![Vector3::zeros(); self.observations.len()],
        };
        for phase in self.phases {
            let bare = self.mean(&tips, *phase, false);
            let loaded = self.mean(&tips, *phase, true);
            let weight = 1.0 / (1.0 / bare.weight + 1.0 / loaded.weight);
            let (observed_m, modelled_m) = (loaded.observed_m - bare.observed_m, loaded.modelled_m - bare.modelled_m);
            let (left, slope) = (observed_m - modelled_m, loaded.slope_m_per_kg);
            trial.squares += weight * left.norm_squared();
            trial.downhill += weight * left.dot(&slope);
            trial.slopes += weight * slope.norm_squared();
            trial.most_m_per_kg = trial.most_m_per_kg.max(slope.norm());
            trial.displacements.push(Displacement { phase: *phase, observed_m, modelled_m });
            for (index, one) in self.observations.iter().enumerate().filter(|(_, one)| one.phase == *phase) {
                trial.residuals_m[index] = (one.tip_m - bare.observed_m) - (tips[index].at_m - bare.modelled_m);
            }
        }
        Ok(trial)
    }

    /// Weighted means over the observations of a phase with or without the load.
    fn mean(&self, tips: &[Tip], phase: usize, loaded: bool) -> Mean {
        let mut sum = Mean::default();
        for (one, tip) in
            self.observations.iter().zip(tips).filter(|(one, _)| (one.phase, one.loaded) == (phase, loaded))
        {
            let weight = one.accuracy_m.powi(-2);
            sum.weight += weight;
            sum.observed_m += one.tip_m * weight;
            sum.modelled_m += tip.at_m * weight;
            sum.slope_m_per_kg += tip.slope_m_per_kg * weight;
        }
        let by = 1.0 / sum.weight;
        Mean {
            weight: sum.weight,
            observed_m: sum.observed_m * by,
            modelled_m: sum.modelled_m * by,
            slope_m_per_kg: sum.slope_m_per_kg * by,
        }
    }
}

#[derive(Default)]
struct Mean {
    weight: f64,
    observed_m: Vector3<f64>,
    modelled_m: Vector3<f64>,
    slope_m_per_kg: Vector3<f64>,
}
