//! A limb in its poses, with what may be off.

use fra_model::{Actuator, Load, State, Status};
use nalgebra::Vector3;
use thiserror::Error;

use super::input::Place;
use super::made::made;
use super::section::tangents;
use super::shape::{Tube, arc, shape, tip};
use crate::arc::Arc;
use crate::fabricate::Tolerances;
use crate::statics::Spring;
use crate::{Drive, Limb, LimbModule};
use softlimb_files::range::{OutOfRange, require};

/// The limb at the end of a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Name of the phase.
    pub name: String,
    /// Gauge pressure of each drive, Pa; >= 0.
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
        /// The module, or the actuator of a steering one.
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
    /// Of each actuator, without load.
    pub(super) tubes: Vec<(State<f64>, Tube)>,
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
    /// [`ToleranceError::Range`] for a tolerance out of the range of [`Tolerances`] or as large as a wall and another number of pressures than drives, [`ToleranceError::Nominal`] for a
    /// pose without equilibrium.
    pub fn new(limb: &'a Limb, poses: &'a [Pose], settings: Settings) -> Result<Self, ToleranceError> {
        settings.tolerances.check()?;
        for module in limb.modules() {
            let parameters = module.actuator.parameters();
            let (wall_m, off_m) = (parameters.outer_radius_m - parameters.inner_radius_m, settings.tolerances.wall_m);
            let allowed = format!("less than the wall of `{}`, {wall_m:.6}", module.name);
            require(off_m < wall_m, "wall_m", off_m, allowed)?;
        }
        for pose in poses {
            let (count, drives) = (pose.pressures_pa.len(), limb.drives().len());
            require(count == drives, "pressures_pa", count as f64, format!("one for each setpoint, {drives} values"))?;
        }
        let places_m: Vec<_> = limb.modules().iter().map(LimbModule::positions_m).collect();
        let pose = |pose: &Pose| {
            let fail = |drive: &Drive<'_>, pressure_pa: f64| ToleranceError::Nominal {
                phase: pose.name.clone(),
                module: drive.name(),
                pressure_pa,
            };
            let drives = limb.drives().zip(&pose.pressures_pa);
            let tube = |(drive, pressure): (Drive<'_>, &f64)| {
                tube(&drive, &settings.tolerances, *pressure).ok_or_else(|| fail(&drive, *pressure))
            };
            let tubes = limb.channel_values(&drives.map(tube).collect::<Result<Vec<_>, _>>()?);
            let nominal = |(index, (module, places)): (usize, (&LimbModule, &Vec<[f64; 2]>))| {
                let first = limb.drives_of(index).start;
                nominal(module, places, &tubes[module.channels.clone()])
                    .ok_or_else(|| fail(&limb.drive(first), pose.pressures_pa[first]))
            };
            limb.modules().iter().zip(&places_m).enumerate().map(nominal).collect::<Result<Vec<_>, _>>()
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
}

/// An actuator of a module that a solver of its model has, at a place within tolerances.
pub(super) fn actuator(module: &LimbModule, tolerances: &Tolerances, place: &Place) -> Option<Actuator<f64>> {
    let (one, second) = made(module.actuator.parameters(), module.actuator.second_fiber(), tolerances, place);
    let one = Actuator::new(&one).ok()?;
    second.map_or(Some(one), |second| one.with_second_fiber(&second).ok())
}

/// An actuator of a drive without load.
fn tube(drive: &Drive<'_>, tolerances: &Tolerances, pressure_pa: f64) -> Option<(State<f64>, Tube)> {
    if drive.is_by_section() {
        let state = (pressure_pa <= drive.curve.pressure_max_pa()).then(|| drive.curve.at(pressure_pa))?;
        let tangent = tangents(drive, tolerances, &[0.0; 3], &[pressure_pa]).pop()??;
        return Some((state, Tube::Section(tangent.about(&state, drive.length_m()))));
    }
    let solution = drive.actuator.forward(pressure_pa, &Load::none()).ok()?;
    let tube = (solution.status == Status::Solved).then(|| Spring::new(&drive.actuator, pressure_pa))??;
    Some((solution.state, Tube::Model(Box::new(tube))))
}

fn nominal(module: &LimbModule, places_m: &[[f64; 2]], tubes: &[(State<f64>, Tube)]) -> Option<Nominal> {
    let placed: Vec<_> = places_m.iter().zip(tubes).map(|(place, (_, tube))| (*place, tube.clone())).collect();
    let shape = shape(module, &placed)?;
    Some(Nominal { tubes: tubes.to_vec(), arc: arc(module, &shape) })
}

fn batches(limb: &Limb, shared: bool) -> Vec<usize> {
    let of_channel: Vec<&LimbModule> =
        limb.modules().iter().flat_map(|module| module.channels.clone().map(move |_| module)).collect();
    let elastomer = |channel: usize| of_channel[channel].actuator.parameters().material;
    let first = |channel: usize| (0..channel).find(|other| elastomer(*other) == elastomer(channel)).unwrap_or(channel);
    (0..of_channel.len()).map(|channel| if shared { first(channel) } else { channel }).collect()
}
