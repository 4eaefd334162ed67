//! Margins of the loaded limb at the end of each phase.

use fra_model::State;

use softlimb_limb::statics::{BUCKLING_MARGIN_MAX, Fidelity, LOAD_FACTOR_MAX, Settled, Standing};
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::Scene;

use super::nominal::{Nominal, PoseError, pressures_pa, stands};
use crate::payload::carried;
use crate::plan::Plan;
use crate::sent::Sent;
use crate::unreachable::Unreachable;

/// Most spacers that are tried where a module has too few.
const SPACERS_MAX: usize = 20;

/// Margins at the end of a phase: the worst of the tip empty, with half and with all of the phase's payload.
#[derive(Clone, Debug, PartialEq)]
pub struct Margins {
    /// The whole payload, kg.
    pub payload_kg: f64,
    /// Share of all loads at which the limb loses its stability: [`Standing::load_factor`].
    pub load_factor: f64,
    /// Vertical stiffness of the tip, N/m; 0 where the tangent is singular.
    pub stiffness_n_per_m: f64,
    /// Distance of the tip from that without load at the same pressures, m.
    pub sag_m: f64,
    /// [`Standing::buckling_margin`].
    pub buckling_margin: f64,
    /// Module of the tube that is closest to buckling.
    pub weakest_module: Option<usize>,
    /// Spacers of that module with which the margin is that of the scene, where it is less now and some number up to 20 is enough.
    pub spacers_enough: Option<usize>,
    /// Highest pressure of a module over the lower of the scene's limit and its limit point.
    pub pressure_share: f64,
    /// The module with that pressure.
    pub fullest_module: usize,
    /// Error of the tip that the statics state, over the length.
    pub error: f64,
    /// The tip of a second stable shape, m.
    pub second_tip_m: Option<[f64; 3]>,
}

/// Margins at the end of each phase of a plan; none of a limb without weight. Corrections count by the mean of a module's actuators, and in its
/// highest pressure.
///
/// # Errors
/// [`Unreachable::NotCarried`] where the limb falls or a tube buckles, empty or loaded.
pub(crate) fn margins(scene: &Scene, limb: &Limb, plan: &Plan, sent: &Sent) -> Result<Vec<Margins>, Unreachable> {
    let Some(weight) = scene.weight().filter(|weight| weight.simulated) else { return Ok(Vec::new()) };
    let averaged = sent.averaged(limb, plan);
    let of_phase = |(index, (phase, carried)): (usize, (&crate::PlannedPhase, crate::Carried))| {
        let end_us = phase.start_us + phase.move_us + phase.hold_us;
        let [sent, averaged] = [sent.states_at(end_us as f64), averaged.states_at(end_us as f64)];
        let (pressure_share, fullest_module) = fullest(limb, &sent);
        let pressures_pa = pressures_pa(&averaged);
        let payload_kg = carried.payload_kg();
        let mut margins = Margins {
            payload_kg,
            load_factor: LOAD_FACTOR_MAX,
            stiffness_n_per_m: f64::INFINITY,
            sag_m: 0.0,
            buckling_margin: BUCKLING_MARGIN_MAX,
            weakest_module: None,
            spacers_enough: None,
            pressure_share,
            fullest_module,
            error: 0.0,
            second_tip_m: None,
        };
        let loads: &[f64] = if payload_kg > 0.0 { &[0.0, 0.5, 1.0] } else { &[0.0] };
        for share in loads {
            let standing = standing(scene, limb, &pressures_pa, share * payload_kg, weight.error)
                .map_err(|cause| Unreachable::NotCarried { phase: index, time_us: end_us, cause })?;
            margins.worsen(&standing);
        }
        let is_low = margins.buckling_margin < scene.limits().standing.buckling_margin;
        let weakest = margins.weakest_module.filter(|module| is_low && !limb.modules()[*module].is_series());
        if let Some(module) = weakest {
            margins.spacers_enough = spacers_enough(scene, limb, &pressures_pa, payload_kg, module);
        }
        Ok(margins)
    };
    plan.phases.iter().zip(carried(scene.phases())).enumerate().map(of_phase).collect()
}

fn standing(
    scene: &Scene,
    limb: &Limb,
    pressures_pa: &[f64],
    payload_kg: f64,
    error: f64,
) -> Result<Standing, PoseError> {
    let loaded = Nominal::at_pressures(scene, limb, pressures_pa, payload_kg)?;
    let standing = loaded.stand(error, scene.rest_length_m()).map_err(PoseError::EquilibriumError)?;
    stands(standing.answer.buckling)?;
    Ok(standing)
}

impl Margins {
    fn worsen(&mut self, standing: &Standing) {
        self.load_factor = self.load_factor.min(standing.load_factor);
        let vertical = standing.stiffness_n_per_m.map_or(0.0, |stiffness| stiffness[2]);
        self.stiffness_n_per_m = self.stiffness_n_per_m.min(vertical);
        self.sag_m = self.sag_m.max(standing.sag_m);
        if standing.buckling_margin < self.buckling_margin {
            (self.buckling_margin, self.weakest_module) = (standing.buckling_margin, standing.weakest_module);
        }
        self.error = self.error.max(standing.answer.error());
        self.second_tip_m = self.second_tip_m.or(standing.second_tip_m);
    }
}

/// The fewest spacers of a module, more than it has, with which no tube is closer to buckling than it should be.
fn spacers_enough(scene: &Scene, limb: &Limb, pressures_pa: &[f64], payload_kg: f64, module: usize) -> Option<usize> {
    let margin = scene.limits().standing.buckling_margin;
    let first = usize::from(scene.modules()[module].spacers) + 1;
    (first..=SPACERS_MAX).find(|spacers| {
        let nominal = Nominal::new(scene, limb, Fidelity::Double).with_spacers(module, *spacers);
        let ratio = |payload_kg: f64| {
            let loaded = nominal.loaded(pressures_pa, payload_kg)?;
            let Settled { limb, rod, shape } = loaded.settle(nominal.tier(), None).ok()?;
            let of_module = limb.buckling(&rod, &shape);
            Some(of_module.map_or(0.0, |tube| tube.ratio()))
        };
        [0.0, 0.5, 1.0].iter().all(|share| ratio(share * payload_kg).is_some_and(|ratio| ratio * margin <= 1.0))
    })
}

/// The highest pressure of an actuator over its limit, with its module.
fn fullest(limb: &Limb, channels: &[State<f64>]) -> (f64, usize) {
    let of_module = |module: &LimbModule| {
        let highest_pa = channels[module.channels.clone()].iter().map(|state| state.pressure_pa).fold(0.0, f64::max);
        highest_pa / module.ceiling_pa()
    };
    let shares = limb.modules().iter().map(of_module);
    shares.zip(0..).fold((0.0, 0), |worst, next| if next.0 > worst.0 { next } else { worst })
}
