//! The mass by least squares, with its interval.

use nalgebra::Vector3;

use super::creep::at_ends_m3;
use super::limb::{Posed, Tip};
use super::{Refusal, Sighting};
use softlimb_limb::Limb;
use softlimb_motion::Plan;
use softlimb_numerics::statistics::student_quantile;
use softlimb_scene::Scene;

/// Share of the distribution in the interval.
const CONFIDENCE: f64 = 0.95;
/// Steps of the search, the least share of one that is tried, and the size of one at which it ends, kg.
const STEPS: usize = 40;
const LEAST_SHARE: f64 = 1e-3;
const CONVERGED_KG: f64 = 1e-6;
/// By this share a step may make the sum of squares larger: its last digits are those of the solver.
const ROUNDING: f64 = 1e-6;
/// A tip that moves by less than this is not seen to move, m/kg.
const LEAST_WAY_M_PER_KG: f64 = 1e-6;
/// A displacement has three coordinates.
const COORDINATES: usize = 3;

/// What hangs on the tip.
#[derive(Clone, Debug, PartialEq)]
pub struct Mass {
    /// The mass, kg. Below zero only where errors are larger than it.
    pub kg: f64,
    /// Half width of the interval by how much the phases disagree, kg.
    pub scatter_kg: f64,
    /// By how much the mass is another one where the limb is stiffer by the stated error, kg.
    pub stiffness_kg: f64,
    /// Both together: the ends of the interval of 95 %, kg.
    pub interval_kg: [f64; 2],
    /// Degrees of freedom of the scatter.
    pub freedom: usize,
    /// Root mean square of a coordinate of the displacements that is left over, with the degrees of freedom in the mean, m.
    pub left_m: f64,
    /// The displacement in each phase, in their order.
    pub ways: Vec<Way>,
    /// What is left over of each sighting against the mean of those of its phase without the load, m.
    pub residuals_m: Vec<Vector3<f64>>,
}

/// What the load did to the tip in a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// Index of the phase.
    pub phase: usize,
    /// By how much the tip was seen elsewhere with the load, m.
    pub seen_m: Vector3<f64>,
    /// The same by the model under the mass found, m.
    pub modelled_m: Vector3<f64>,
}

/// Finds the mass on the tip of a limb seen at the ends of phases of a plan, whose walls have crept by then. `stiffness_error` is the share by which the stiffness of the limb may be another one than the
/// model's, all over, at the confidence of the interval.
///
/// # Errors
/// [`Refusal`] where the sightings do not tell one.
pub fn mass(scene: &Scene, limb: &Limb, plan: &Plan, seen: &[Sighting], stiffness_error: f64) -> Result<Mass, Refusal> {
    let mut phases: Vec<usize> = seen.iter().map(|one| one.phase).collect();
    phases.sort_unstable();
    phases.dedup();
    let has = |phase: usize, loaded: bool| seen.iter().any(|one| (one.phase, one.loaded) == (phase, loaded));
    phases.retain(|phase| has(*phase, false) && has(*phase, true));
    if phases.len() < 2 {
        return Err(Refusal::TooFewPhases { phases: phases.len() });
    }
    let crept_m3 = at_ends_m3(scene, limb, plan);
    let search = |stiffer: f64| {
        let posed = |one| Posed::new(scene, limb, one, &crept_m3[one.phase], stiffer);
        let limbs = seen.iter().map(posed).collect::<Result<_, _>>()?;
        Search { seen, phases: &phases, limbs }.run()
    };
    let found = search(1.0)?;
    let stiffer = search(1.0 + stiffness_error)?;
    let freedom = COORDINATES * phases.len() - 1;
    let scatter = found.squares / freedom as f64;
    let scatter_kg = student_quantile(CONFIDENCE, freedom) * (scatter / found.slopes).sqrt();
    let stiffness_kg = (stiffer.kg - found.kg).abs();
    let half_kg = scatter_kg.hypot(stiffness_kg);
    let unweighted: f64 = found.ways.iter().map(|way| (way.seen_m - way.modelled_m).norm_squared()).sum();
    Ok(Mass {
        kg: found.kg,
        scatter_kg,
        stiffness_kg,
        interval_kg: [found.kg - half_kg, found.kg + half_kg],
        freedom,
        left_m: (unweighted / freedom as f64).sqrt(),
        ways: found.ways,
        residuals_m: found.residuals_m,
    })
}

struct Search<'a> {
    seen: &'a [Sighting],
    phases: &'a [usize],
    limbs: Vec<Posed>,
}

/// What a mass leaves over.
struct Tried {
    kg: f64,
    /// Sum of the squares of what is left over of the displacements, in units of their accuracy, and half of its negative slope by the mass, 1/kg.
    squares: f64,
    downhill: f64,
    /// Sum of the squares of the slopes of the displacements by the mass in these units, 1/kg2.
    slopes: f64,
    /// The largest slope, m/kg.
    most_m_per_kg: f64,
    ways: Vec<Way>,
    residuals_m: Vec<Vector3<f64>>,
}

impl Search<'_> {
    /// Gauss-Newton for one unknown without bounds, each step as long as the limb stands and the sum of squares does not rise. Unlike the
    /// bounded solver of `softlimb-numerics`, it tells a limb that falls under a trial mass from a solve that does not converge.
    fn run(mut self) -> Result<Tried, Refusal> {
        let mut here = self.under(0.0)?;
        if here.most_m_per_kg < LEAST_WAY_M_PER_KG {
            return Err(Refusal::NotMoved { most_m_per_kg: here.most_m_per_kg });
        }
        for _ in 0..STEPS {
            let step = here.downhill / here.slopes;
            if step.abs() <= CONVERGED_KG {
                return Ok(here);
            }
            let mut share = 1.0;
            here = loop {
                let fallen = match self.under(here.kg + share * step) {
                    Ok(there) if there.squares <= here.squares * (1.0 + ROUNDING) => break there,
                    Ok(_) => None,
                    Err(Refusal::Falls { line }) => Some(line),
                    Err(other) => return Err(other),
                };
                share *= 0.5;
                if share < LEAST_SHARE {
                    return Err(match fallen {
                        Some(line) => Refusal::TooFar { line, carried_kg: here.kg },
                        None => Refusal::NotSettled { steps: STEPS, kg: here.kg },
                    });
                }
            };
        }
        Err(Refusal::NotSettled { steps: STEPS, kg: here.kg })
    }

    fn under(&mut self, kg: f64) -> Result<Tried, Refusal> {
        let limbs = self.limbs.iter_mut().zip(self.seen);
        let tips: Vec<Tip> =
            limbs.map(|(limb, one)| limb.under(if one.loaded { kg } else { 0.0 })).collect::<Result<_, _>>()?;
        let mut tried = Tried {
            kg,
            squares: 0.0,
            downhill: 0.0,
            slopes: 0.0,
            most_m_per_kg: 0.0,
            ways: Vec::with_capacity(self.phases.len()),
            residuals_m: vec![Vector3::zeros(); self.seen.len()],
        };
        for phase in self.phases {
            let bare = self.mean(&tips, *phase, false);
            let loaded = self.mean(&tips, *phase, true);
            let weight = 1.0 / (1.0 / bare.weight + 1.0 / loaded.weight);
            let (seen_m, modelled_m) = (loaded.seen_m - bare.seen_m, loaded.modelled_m - bare.modelled_m);
            let (left, slope) = (seen_m - modelled_m, loaded.slope_m_per_kg);
            tried.squares += weight * left.norm_squared();
            tried.downhill += weight * left.dot(&slope);
            tried.slopes += weight * slope.norm_squared();
            tried.most_m_per_kg = tried.most_m_per_kg.max(slope.norm());
            tried.ways.push(Way { phase: *phase, seen_m, modelled_m });
            for (index, one) in self.seen.iter().enumerate().filter(|(_, one)| one.phase == *phase) {
                tried.residuals_m[index] = (one.tip_m - bare.seen_m) - (tips[index].at_m - bare.modelled_m);
            }
        }
        Ok(tried)
    }

    /// Weighted means over the sightings of a phase with or without the load.
    fn mean(&self, tips: &[Tip], phase: usize, loaded: bool) -> Mean {
        let mut sum = Mean::default();
        for (one, tip) in self.seen.iter().zip(tips).filter(|(one, _)| (one.phase, one.loaded) == (phase, loaded)) {
            let weight = one.accuracy_m.powi(-2);
            sum.weight += weight;
            sum.seen_m += one.tip_m * weight;
            sum.modelled_m += tip.at_m * weight;
            sum.slope_m_per_kg += tip.slope_m_per_kg * weight;
        }
        let by = 1.0 / sum.weight;
        Mean {
            weight: sum.weight,
            seen_m: sum.seen_m * by,
            modelled_m: sum.modelled_m * by,
            slope_m_per_kg: sum.slope_m_per_kg * by,
        }
    }
}

#[derive(Default)]
struct Mean {
    weight: f64,
    seen_m: Vector3<f64>,
    modelled_m: Vector3<f64>,
    slope_m_per_kg: Vector3<f64>,
}
