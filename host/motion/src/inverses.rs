//! How the controller finds the pressures of each module: in verified tables, or by its model.

use std::fmt;

use fra_model::{Argument, StateQuantity};
use softlimb_protocol::{ConfigInverse, ConfigVolume, List, TableArgument};

use super::diagnostics::in_units;
use super::follow::{NotFollowed, follow, has_model};
use super::plan::Plan;
use super::sent::Sent;
use crate::inverse_table::{DeviceTables, InverseFit, NoTable, Subject, VolumeFit, device_tables};
use softlimb_fea::cross_section::{CALIBRATED_FROM, Calibration, Options, Section, SectionError};
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::{BendingModel, Goal, InverseChoice, Scene, SceneError};

/// How the channels of one module find their pressures.
#[derive(Clone, Debug, PartialEq)]
pub enum ModuleInverse {
    /// In these tables.
    Table(DeviceTables),
    /// In these tables, the inverse one built from a cubic of the section's finite elements.
    Section(DeviceTables, Calibration),
    /// By solving the model, which the device does for straight tubes with closed forms: there are no tables for a reason, or the scene
    /// does not want any.
    Model(Option<NoTable>),
}

impl ModuleInverse {
    /// The tables, where they are used.
    pub fn tables(&self) -> Option<&DeviceTables> {
        match self {
            Self::Table(tables) | Self::Section(tables, _) => Some(tables),
            Self::Model(_) => None,
        }
    }

    /// The verified error of the inverse table, as a share of the module's highest pressure; none where there is no such table.
    pub fn error(&self) -> Option<f64> {
        self.tables()?.inverse.as_ref().map(|inverse| inverse.error)
    }

    /// Why there are no tables, where the scene would take some.
    pub fn reason(&self) -> Option<NoTable> {
        match self {
            Self::Table(_) | Self::Section(..) => None,
            Self::Model(reason) => *reason,
        }
    }

    /// The tables as they are sent, for channel 0; none where there are none.
    pub fn messages(&self) -> Option<(ConfigVolume, Option<ConfigInverse>)> {
        let tables = self.tables()?;
        let inverse = match &tables.inverse {
            Some(fit) => Some(inverse_message(fit)?),
            None => None,
        };
        Some((volume_message(&tables.volume)?, inverse))
    }
}

impl fmt::Display for ModuleInverse {
    /// Behind "by", as in "by table within 3.5e-5 of full scale".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self, self.error()) {
            (Self::Table(_), Some(error)) => write!(f, "table within {error:.1e} of full scale"),
            (Self::Section(_, calibration), Some(error)) => {
                let cubic = 100.0 * calibration.verified_error;
                write!(
                    f,
                    "table within {error:.1e} of full scale, from finite elements within {cubic:.2} % of the bend"
                )
            }
            (Self::Table(_) | Self::Section(..), None) => f.write_str("pressure"),
            (Self::Model(Some(reason)), _) => write!(f, "model: {reason}"),
            (Self::Model(None), _) => f.write_str("model"),
        }
    }
}

/// Builds and verifies the tables that a scene wants.
///
/// # Errors
/// A diagnostic at a module whose tables do not keep the error that the scene allows, where it wants tables and nothing else or the
/// device does not solve the module's model.
pub fn inverses(scene: &Scene, limb: &Limb) -> Result<Vec<ModuleInverse>, SceneError> {
    let (controller, ambient) = (scene.controller(), &scene.plant().ambient);
    let of_module = |(index, module): (usize, &LimbModule)| {
        if controller.inverse == InverseChoice::Model {
            return by_model(scene, module, index, None);
        }
        let bends = module.kind == StateQuantity::BendAngle && !module.is_by_section();
        let wanted = bends && controller.bending == BendingModel::SectionFe;
        if wanted && module.is_series() {
            return Err(no_cubic(scene, index, "each of its segments has a separate bending model"));
        }
        let calibration = wanted.then(|| cubic(scene, index, module)).transpose()?;
        let bend = calibration.map(|calibration| calibration.polynomial);
        let subject = Subject { bend, ..Subject::of(module) };
        match (device_tables(&subject, controller.inverse_error, ambient.pressure_pa), calibration) {
            (Ok(tables), None) => Ok(ModuleInverse::Table(tables)),
            (Ok(tables), Some(calibration)) => Ok(ModuleInverse::Section(tables, calibration)),
            (Err(reason), calibration) if controller.inverse == InverseChoice::Table || calibration.is_some() => {
                Err(refused(scene, index, &reason, has_model(module).is_ok()))
            }
            (Err(reason), _) => by_model(scene, module, index, Some(reason)),
        }
    };
    limb.modules().iter().enumerate().map(of_module).collect()
}

/// Goes through what is sent as the device does where it solves the model, and holds every goal to the bends that the cubics reach: the plan
/// itself knows the analytic model alone, and a device would stop at the end of its table without a word.
///
/// # Errors
/// A diagnostic at a module whose model the device does not follow, or at the first target or way-point that bends a module further than
/// its cubic does at the highest pressure the device follows.
pub fn check_goals(
    scene: &Scene,
    limb: &Limb,
    plan: &Plan,
    sent: &Sent,
    inverses: &[ModuleInverse],
) -> Result<(), SceneError> {
    for (index, (module, inverse)) in limb.modules().iter().zip(inverses).enumerate() {
        let ModuleInverse::Model(reason) = inverse else { continue };
        for channel in module.channels.clone() {
            let as_before = |row: &Vec<i32>| row[channel] == row[channel - 1];
            if channel > module.channels.start && sent.knots().iter().all(as_before) {
                continue;
            }
            follow(module, channel, sent, u64::from(scene.controller().control_period_us))
                .map_err(|why| not_followed(scene, index, why, *reason))?;
        }
    }
    for (phase, planned) in scene.phases().iter().zip(&plan.phases) {
        for (index, (module, inverse)) in limb.modules().iter().zip(inverses).enumerate() {
            let ModuleInverse::Section(_, calibration) = inverse else { continue };
            let (value, highest_pa) = (planned.values[limb.drives_of(index).start], module.curve.pressure_max_pa());
            let length_m = module.actuator.parameters().length_m;
            let most = calibration.polynomial.bend_rate_rad_per_m(highest_pa) * length_m;
            if value <= most * (1.0 + GOAL_ROUNDING) {
                continue;
            }
            let span = match &phase.goal {
                Goal::Targets(targets) => targets.iter().find(|target| target.module == index).map(|t| t.value.span),
                Goal::Tip(tip) => Some(tip.span),
                Goal::Inside(region) => Some(region.span),
                Goal::Series(span) => Some(*span),
            };
            let (asked, most) = (in_units(module.kind, value), in_units(module.kind, most));
            let label = format!(
                "`{}` is to bend by {asked}; by finite elements it bends by {most} at {:.2} kPa",
                module.name,
                1e-3 * highest_pa
            );
            let help = format!("ask for {most} at most, or raise the module's `pressure_max`");
            let title = "this goal is out of the reach that finite elements give the module";
            return Err(scene.diagnostic(span.unwrap_or(phase.span), title, &label, Some(&help)));
        }
    }
    Ok(())
}

/// Share by which a goal at the very end of a table may be beyond it.
const GOAL_ROUNDING: f64 = 1e-9;

/// The model of the device in place of tables, where it has one.
fn by_model(
    scene: &Scene,
    module: &LimbModule,
    index: usize,
    reason: Option<NoTable>,
) -> Result<ModuleInverse, SceneError> {
    match has_model(module) {
        Ok(()) => Ok(ModuleInverse::Model(reason)),
        Err(why) => Err(not_followed(scene, index, why, reason)),
    }
}

fn not_followed(scene: &Scene, module: usize, why: NotFollowed, reason: Option<NoTable>) -> SceneError {
    let module = &scene.modules()[module];
    let title = format!("the device needs tables for the module `{}`", *module.name);
    let (label, help) = match reason {
        Some(reason) => (format!("{reason}; and without tables {why}"), help(&reason)),
        None => {
            (why.to_string(), "leave out `inverse = \"model\"` in [controller]: the device is then sent tables".into())
        }
    };
    scene.diagnostic(module.span, &title, &label, Some(&help))
}

/// What makes a table possible.
fn help(reason: &NoTable) -> String {
    match reason {
        NoTable::Inverse { least: Some(least), .. } => {
            format!("set `inverse_error` in [controller] to \"{:.4} %\" or more", (least * 1e6).ceil() * 1e-4)
        }
        _ => "lower the module's `pressure_max`".into(),
    }
}

/// Largest error of a cubic that a device carries, as a share of the bend.
const CUBIC_ERROR_MAX: f64 = 0.01;

/// The cubic of a bending module's section.
fn calibration(module: &LimbModule) -> Result<Calibration, SectionError> {
    let highest_pa = module.curve.pressure_max_pa();
    Section::new(module.actuator.parameters(), &Options::default())?
        .calibrate([CALIBRATED_FROM * highest_pa, highest_pa])
}

/// The cubic of a module, if it is good enough for a device.
fn cubic(scene: &Scene, index: usize, module: &LimbModule) -> Result<Calibration, SceneError> {
    let found = calibration(module).map_err(|error| no_cubic(scene, index, &error.to_string()))?;
    let error = found.verified_error.max(found.mesh_error);
    if error <= CUBIC_ERROR_MAX {
        return Ok(found);
    }
    let (found, most) = (100.0 * error, 100.0 * CUBIC_ERROR_MAX);
    Err(no_cubic(scene, index, &format!("the cubic errs by {found:.1} % of the bend, more than {most} %")))
}

fn no_cubic(scene: &Scene, module: usize, reason: &str) -> SceneError {
    let module = &scene.modules()[module];
    let title = format!("the finite elements give no bending table for the module `{}`", *module.name);
    scene.diagnostic(module.span, &title, reason, Some("leave out `bending = \"section-fe\"` in [controller]"))
}

fn refused(scene: &Scene, module: usize, reason: &NoTable, has_model: bool) -> SceneError {
    let module = &scene.modules()[module];
    let or = if has_model { ", or `inverse = \"auto\"` to let the device solve its model" } else { "" };
    let help = format!("{}{or}", help(reason));
    let title = format!("there is no inverse table for the module `{}`", *module.name);
    scene.diagnostic(module.span, &title, &reason.to_string(), Some(&help))
}

fn volume_message(fit: &VolumeFit) -> Option<ConfigVolume> {
    Some(ConfigVolume {
        session: 0,
        channel: 0,
        pressure_max_pa: fit.pressure_max_pa,
        coefficients_m3: List::from_slice(&fit.coefficients_m3).ok()?,
    })
}

fn inverse_message(fit: &InverseFit) -> Option<ConfigInverse> {
    let argument = match fit.argument {
        Argument::Linear => TableArgument::Linear,
        Argument::Root => TableArgument::Root,
    };
    Some(ConfigInverse {
        session: 0,
        channel: 0,
        argument: argument.into(),
        steps: fit.steps,
        setpoint_from: fit.from,
        setpoint_to: fit.to,
        pressure_max_pa: fit.pressure_max_pa,
        coefficients_pa: List::from_slice(&fit.coefficients_pa).ok()?,
    })
}
