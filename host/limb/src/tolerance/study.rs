//! A limb in its poses, with what may be off.

use fra_model::{Actuator, Load, State, Status};
use nalgebra::Vector3;
use thiserror::Error;

use super::input::Place;
use super::made::made;
use super::shape::{arc, shape, tip};
use crate::arc::Arc;
use crate::fabricate::Tolerances;
use crate::statics::{Spring, Tangent};
use crate::{Limb, LimbModule};
use softlimb_files::range::{OutOfRange, require};

/// The limb at the end of a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Name of the phase.
    pub name: String,
    /// Gauge pressure of each module, Pa; >= 0.
    pub pressures_pa: Vec<f64>,
}

/// What is assumed of the parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Half-widths. Each parameter is uniform within them: nothing but the limits is known, and no distribution with one peak has a larger
    /// variance.
    pub tolerances: Tolerances,
    /// Whether all actuators of equal elastomer have one modulus, as if cast from one batch.
    pub shared_modulus: bool,
}

/// Why a question has no answer.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ToleranceError {
    /// A tolerance out of its range.
    #[error(transparent)]
    Range(#[from] OutOfRange),
    /// The nominal limb itself has no equilibrium.
    #[error("phase `{phase}`: the nominal `{module}` has no equilibrium at {:.2} kPa", 1e-3 * pressure_pa)]
    Nominal {
        /// The phase.
        phase: String,
        /// The module.
        module: String,
        /// Its gauge pressure, Pa.
        pressure_pa: f64,
    },
    /// The nominal limb is where derivatives end.
    #[error("phase `{phase}`: `{module}` at {:.2} kPa has no derivatives: {reason}", 1e-3 * pressure_pa)]
    Derivative {
        /// The phase.
        phase: String,
        /// The module.
        module: String,
        /// Its gauge pressure, Pa.
        pressure_pa: f64,
        /// What the model says.
        reason: String,
    },
}

/// One module in one pose, nominal.
#[derive(Clone, Debug)]
pub(super) struct Nominal {
    pub(super) state: State<f64>,
    pub(super) tangent: Tangent,
    pub(super) arc: Arc,
}

/// A limb whose nominal poses are known to exist.
#[derive(Clone, Debug)]
pub struct Study<'a> {
    pub(super) limb: &'a Limb,
    pub(super) poses: &'a [Pose],
    pub(super) settings: Settings,
    /// By pose and module.
    pub(super) nominal: Vec<Vec<Nominal>>,
    /// By module: places of its actuators, m.
    pub(super) places_m: Vec<Vec<[f64; 2]>>,
    /// For each channel the one whose draw of the modulus it has.
    pub(super) batch: Vec<usize>,
}

impl<'a> Study<'a> {
    /// Checks tolerances and nominal poses.
    ///
    /// # Errors
    /// [`ToleranceError::Range`] for a tolerance out of the range of [`Tolerances`] or as large as a wall, [`ToleranceError::Nominal`] for a
    /// pose without equilibrium.
    pub fn new(limb: &'a Limb, poses: &'a [Pose], settings: Settings) -> Result<Self, ToleranceError> {
        settings.tolerances.check()?;
        for module in limb.modules() {
            let parameters = module.actuator.parameters();
            let (wall_m, off_m) = (parameters.outer_radius_m - parameters.inner_radius_m, settings.tolerances.wall_m);
            let allowed = format!("less than the wall of `{}`, {wall_m:.6}", module.name);
            require(off_m < wall_m, "wall_m", off_m, allowed)?;
        }
        let places_m: Vec<_> = limb.modules().iter().map(LimbModule::positions_m).collect();
        let pose = |pose: &Pose| {
            let modules = limb.modules().iter().zip(&places_m).zip(&pose.pressures_pa);
            let nominal = |((module, places), pressure): ((&LimbModule, &Vec<[f64; 2]>), &f64)| {
                nominal(module, places, *pressure).ok_or_else(|| ToleranceError::Nominal {
                    phase: pose.name.clone(),
                    module: module.name.clone(),
                    pressure_pa: *pressure,
                })
            };
            modules.map(nominal).collect::<Result<Vec<_>, _>>()
        };
        let nominal = poses.iter().map(pose).collect::<Result<_, _>>()?;
        Ok(Self { limb, poses, settings, nominal, places_m, batch: batches(limb, settings.shared_modulus) })
    }

    /// Names of the modules.
    pub fn modules(&self) -> impl Iterator<Item = &str> {
        self.limb.modules().iter().map(|module| module.name.as_str())
    }

    /// The poses.
    pub fn poses(&self) -> &[Pose] {
        self.poses
    }

    /// The tip of the nominal limb in a pose, m.
    pub fn nominal_tip_m(&self, pose: usize) -> Vector3<f64> {
        tip(self.limb, self.nominal[pose].iter().map(|module| &module.arc))
    }

    /// The actuator of a channel as it was made.
    pub(super) fn made(&self, module: &LimbModule, place: &Place) -> Option<Actuator<f64>> {
        Actuator::new(&made(module.actuator.parameters(), &self.settings.tolerances, place)).ok()
    }
}

fn nominal(module: &LimbModule, places_m: &[[f64; 2]], pressure_pa: f64) -> Option<Nominal> {
    let solution = module.actuator.forward(pressure_pa, &Load::none()).ok()?;
    let tube = (solution.status == Status::Solved).then(|| Spring::new(&module.actuator, pressure_pa))??;
    let shape = shape(module, places_m.iter().map(|place| (*place, tube.clone())).collect())?;
    Some(Nominal { state: solution.state, tangent: tube.tangent(), arc: arc(module, &shape) })
}

fn batches(limb: &Limb, shared: bool) -> Vec<usize> {
    let of_channel: Vec<&LimbModule> =
        limb.modules().iter().flat_map(|module| module.channels.clone().map(move |_| module)).collect();
    let elastomer = |channel: usize| of_channel[channel].actuator.parameters().material;
    let first = |channel: usize| (0..channel).find(|other| elastomer(*other) == elastomer(channel)).unwrap_or(channel);
    (0..of_channel.len()).map(|channel| if shared { first(channel) } else { channel }).collect()
}
