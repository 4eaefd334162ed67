//! How a limb stands under its load: one answer for every command.

use nalgebra::Vector3;

use super::fidelity::{Answer, cheapest};
use super::load::LoadedLimb;
use super::rod::Rod;
use super::solve::{EquilibriumError, solve_pressurized};

/// The largest buckling margin that is stated; larger ones, and tubes that are all pulled, have it.
pub const BUCKLING_MARGIN_MAX: f64 = 100.0;
/// Distance of two tips over the limb's length from which they are those of two shapes.
const APART: f64 = 0.01;

/// A limb in equilibrium under its load, with its margins.
#[derive(Clone, Debug)]
pub struct Standing {
    /// The shape and the model that it was solved with.
    pub answer: Answer,
    /// Position of the tip, m.
    pub tip_m: [f64; 3],
    /// Distance of the tip from that without load at the same pressures, m.
    pub sag_m: f64,
    /// Stiffness of the tip along the scene's axes, N/m; `None` where the tangent is singular.
    pub stiffness_n_per_m: Option<[f64; 3]>,
    /// Share of all loads at which the limb loses its stability, 1 to [`LOAD_FACTOR_MAX`], which stands for that and more.
    ///
    /// [`LOAD_FACTOR_MAX`]: super::LOAD_FACTOR_MAX
    pub load_factor: f64,
    /// Least load of buckling of a tube between two plates over its compression, up to [`BUCKLING_MARGIN_MAX`].
    pub buckling_margin: f64,
    /// Module of that tube.
    pub weakest_module: Option<usize>,
    /// A bending module that the load bends backwards, where its lines would have to shorten.
    pub bent_back: Option<usize>,
    /// The tip of a second stable shape, m: the one that the load leads to when it grows at full pressure.
    pub second_tip_m: Option<[f64; 3]>,
}

impl LoadedLimb {
    /// The limb in the shape that growing pressures and loads lead to, by the cheapest model whose error is at most `tolerance`, a share of
    /// the length at rest `length_m`.
    ///
    /// # Errors
    /// [`EquilibriumError`] where the limb does not carry the load.
    pub fn stand(&self, tolerance: f64, length_m: f64) -> Result<Standing, EquilibriumError> {
        let answer = cheapest(self, tolerance, length_m)?;
        let tip = answer.tip().translation.vector;
        let compliance = answer.compliance_m_per_n();
        let ratio = answer.buckling.map_or(0.0, |tube| tube.ratio());
        Ok(Standing {
            tip_m: tip.into(),
            sag_m: (tip - self.free_tip().translation.vector).norm(),
            stiffness_n_per_m: compliance.map(|by| [0, 1, 2].map(|axis| 1.0 / by[(axis, axis)])),
            load_factor: answer.load_factor(),
            buckling_margin: f64::min(1.0 / ratio, BUCKLING_MARGIN_MAX),
            weakest_module: answer.buckling.map(|tube| tube.module),
            bent_back: self.bent_back(&answer.rod, &answer.shape, 1e-9),
            second_tip_m: second_tip_m(&answer, length_m).map(Into::into),
            answer,
        })
    }
}

/// The tip of the second shape of the same rods, where there is one.
fn second_tip_m(answer: &Answer, length_m: f64) -> Option<Vector3<f64>> {
    let rod: &Rod = &answer.rod;
    let other = solve_pressurized(rod, answer.tier.pieces().1).ok()?.tip().translation.vector;
    let apart = (other - answer.shape.tip().translation.vector).norm();
    (apart > f64::max(APART, 2.5 * answer.order_error) * length_m).then_some(other)
}
