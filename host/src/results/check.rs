//! A check of a scene: the reach of its limb, its margins, its air.

use serde::Serialize;

use super::bend::{PrintedBend, of_segments};
use super::margins::{self, PrintedMargins};
use super::swing::PrintedSwing;
use softlimb_limb::Limb;
use softlimb_limb::fabricate::{Settings, advice};
use softlimb_motion as motion;
use softlimb_motion::{AirDemand, Margins, ModuleInverse, Plan, Swing};
use softlimb_scene::{Scene, SceneError};

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    scene: &'a str,
    weightless: bool,
    channels: usize,
    rest_length_m: f64,
    mass_kg: f64,
    duration_s: f64,
    /// Air of one run at 100 kPa and 20 degC, m3, and the lowest supply, Pa gauge.
    air_m3: f64,
    supply_lowest_pa: f64,
    modules: Vec<PrintedModule<'a>>,
    phases: Vec<PrintedPhase<'a>>,
    weight: Option<PrintedWeight>,
    warnings: &'a [String],
}

#[derive(Serialize)]
struct PrintedModule<'a> {
    name: &'a str,
    highest_pressure_pa: f64,
    pressure_max_pa: f64,
    tables: bool,
    inverse_error: Option<f64>,
    no_tables_because: Option<String>,
    /// Only of bending modules with a stated winding.
    #[serde(skip_serializing_if = "Option::is_none")]
    bend: Option<PrintedBend>,
    /// Only of modules of segments: that of each.
    #[serde(skip_serializing_if = "Option::is_none")]
    segment_bends: Option<Vec<Option<PrintedBend>>>,
}

#[derive(Serialize)]
struct PrintedPhase<'a> {
    name: &'a str,
    start_s: f64,
    move_s: f64,
    hold_s: f64,
    via_points: usize,
    clearance_m: Option<f64>,
    nearest_obstacle: Option<&'a str>,
    /// Largest tilt of a carried object since its grasp, rad.
    tilt_rad: Option<f64>,
    /// Absent of a weightless limb.
    #[serde(flatten)]
    margins: Option<PrintedMargins<'a>>,
    /// Absent of a limb whose setpoints are not corrected for weight.
    #[serde(flatten)]
    swing: Option<PrintedSwing>,
}

/// The model that corrects for weight, and its error over the length.
#[derive(Serialize)]
struct PrintedWeight {
    model: &'static str,
    error: f64,
}

/// Result of a check.
pub struct CheckResult<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) limb: &'a Limb,
    pub(crate) plan: Plan,
    /// Highest gauge pressure of each module, Pa.
    pub(crate) highest: Vec<f64>,
    pub(crate) inverses: Vec<ModuleInverse>,
    /// One a phase, or none of a weightless limb.
    pub(crate) margins: Vec<Margins>,
    /// One a phase, or none of a limb whose setpoints are not corrected for weight.
    pub(crate) swings: Vec<Swing>,
    pub(crate) air: AirDemand,
    /// Margins that are too small, and what will not go as planned.
    pub warnings: Vec<String>,
}

impl<'a> CheckResult<'a> {
    /// Checks that the limb reaches every target, clear of obstacles, within its pressures.
    ///
    /// # Errors
    /// [`SceneError`] at the line of a target that is out of reach.
    pub fn new(scene: &'a Scene, limb: &'a Limb) -> Result<Self, SceneError> {
        let plan = motion::plan(scene, limb)?;
        let inverses = motion::inverses(scene, limb)?;
        let sent = motion::sent(scene, limb, &plan)?;
        motion::check_goals(scene, limb, &plan, &sent, &inverses)?;
        let highest = sent.highest_pa(limb);
        let margins = motion::margins(scene, limb, &plan, &sent)?;
        let swings = motion::swings(scene, limb, &plan)?;
        let warnings = [
            plan.warnings.clone(),
            limb.winding_warnings(scene),
            limb.restraint_warnings(),
            limb.stretch_warnings(scene, &highest),
            margins::warnings(scene, limb, &plan, &margins),
            advice(scene, &Settings::default()),
            motion::valve_warnings(scene, limb),
            plan.gripper_warnings(scene.gripper_time_s()),
            motion::payload_warnings(scene.phases()),
            motion::moved_warnings(scene, limb, &plan),
        ]
        .concat();
        let air = motion::air_demand(scene, limb, &sent);
        Ok(Self { scene, limb, plan, highest, inverses, margins, swings, air, warnings })
    }

    /// The result as `--json` prints it.
    pub fn printed(&self) -> impl Serialize {
        let Self { scene, limb, plan, highest, inverses, margins, swings, air, warnings } = self;
        let modules =
            limb.modules().iter().zip(highest).zip(inverses).map(|((module, pressure), inverse)| PrintedModule {
                name: &module.name,
                highest_pressure_pa: *pressure,
                pressure_max_pa: module.pressure_max_pa,
                tables: inverse.tables().is_some(),
                inverse_error: inverse.error(),
                no_tables_because: inverse.reason().map(|reason| reason.to_string()),
                bend: PrintedBend::of(module),
                segment_bends: of_segments(module),
            });
        let phases = plan.phases.iter().enumerate().map(|(index, phase)| PrintedPhase {
            name: &phase.name,
            start_s: phase.start_us as f64 * 1e-6,
            move_s: phase.move_us as f64 * 1e-6,
            hold_s: phase.hold_us as f64 * 1e-6,
            via_points: phase.via_points,
            clearance_m: phase.nearest.map(|nearest| nearest.distance_m),
            nearest_obstacle: phase.nearest.map(|nearest| scene.obstacles()[nearest.obstacle].name.value.as_str()),
            tilt_rad: phase.tilt_rad,
            margins: margins.get(index).map(|margins| PrintedMargins::new(limb, margins)),
            swing: swings.get(index).map(PrintedSwing::new),
        });
        Printed {
            scene: scene.name(),
            weightless: scene.weightless(),
            channels: scene.channels(),
            rest_length_m: scene.rest_length_m(),
            mass_kg: scene.mass_kg(),
            duration_s: plan.duration_us() as f64 * 1e-6,
            air_m3: air.volume_m3,
            supply_lowest_pa: air.supply_min_pa,
            modules: modules.collect(),
            phases: phases.collect(),
            weight: plan.weighed().map(|weighed| PrintedWeight { model: weighed.tier.name(), error: weighed.error }),
            warnings,
        }
    }
}
