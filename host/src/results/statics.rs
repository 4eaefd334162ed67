//! The limb under its weight and a payload.

use nalgebra::Vector3;
use serde::Serialize;

use super::ResultError;
use super::bend::{PrintedBend, of_limb};
use softlimb_limb::Limb;
use softlimb_limb::statics::{EquilibriumError, Load, LoadedLimb, Standing};
use softlimb_motion as motion;
use softlimb_scene::Scene;

/// Ratio of a tube's compression to its load of buckling above which no rod is right.
const BUCKLED: f64 = 0.5;

/// Load and accuracy of the statics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticsOptions {
    /// Mass at the tip, kg, in place of the phases' own.
    pub payload_kg: Option<f64>,
    /// Plates in each module, in place of the modules' own.
    pub spacers: Option<u8>,
    /// Largest error of the tip over the limb's length.
    pub tolerance: f64,
}

/// Result of the statics.
pub struct StaticsResult<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
    pub(crate) rows: Vec<Row>,
    /// Other models of bends than in `check`, buckling, second shapes, and others.
    pub warnings: Vec<String>,
}

/// Statics at the end of a phase.
pub(crate) struct Row {
    pub(crate) phase: String,
    pub(crate) payload_kg: f64,
    pressures_pa: Vec<f64>,
    free_tip_m: [f64; 3],
    /// Tip of the plan at the same time, which is under the phase's own load.
    planned_tip_m: [f64; 3],
    pub(crate) found: Result<Standing, EquilibriumError>,
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    scene: &'a str,
    mass_kg: f64,
    /// The model of each module's bend; `null` of straight modules and of benders with an ideal winding.
    bends: Vec<Option<PrintedBend>>,
    phases: Vec<PrintedPhase<'a>>,
}

#[derive(Serialize)]
struct PrintedPhase<'a> {
    name: &'a str,
    payload_kg: f64,
    /// One a module.
    pressures_pa: &'a [f64],
    free_tip_m: [f64; 3],
    #[serde(flatten)]
    found: Balance<'a>,
}

/// The equilibrium under the load, or the reason that there is none.
#[derive(Serialize)]
#[serde(untagged)]
enum Balance<'a> {
    Found(Box<Found<'a>>),
    EquilibriumError { lost: String },
}

#[derive(Serialize)]
struct Found<'a> {
    tip_m: [f64; 3],
    /// Distance of the tip from the plan's.
    off_target_m: f64,
    deflection_m: f64,
    tip_stiffness_n_per_m: Option<[f64; 3]>,
    load_factor: f64,
    buckling_margin: f64,
    weakest_module: Option<&'a str>,
    bent_back: Option<&'a str>,
    second_tip_m: Option<[f64; 3]>,
    tier: &'static str,
    order_error: f64,
    bundle_error: f64,
    rods_error: Option<f64>,
    bundle_shift_m: Option<[f64; 3]>,
    newton_iterations: usize,
}

impl<'a> StaticsResult<'a> {
    /// Equilibria at the end of each phase.
    ///
    /// # Errors
    /// [`ResultError`] when the scene has no plan, or an actuator no equilibrium.
    pub fn new(scene: &'a Scene, limb: &'a Limb, options: &StaticsOptions) -> Result<Self, ResultError> {
        limb.require_plane_benders(scene, "`statics`")?;
        let plan = motion::plan(scene, limb)?;
        let phases = plan.phases.iter().zip(scene.phases());
        let rows: Vec<Row> = phases
            .map(|(planned, phase)| {
                let end_us = (planned.start_us + planned.move_us + planned.hold_us) as f64;
                let pressures: Vec<f64> = plan.states_at(end_us).iter().map(|state| state.pressure_pa).collect();
                let payload_kg = options.payload_kg.unwrap_or(phase.payload_kg);
                options.row((scene, limb), &planned.name, &pressures, payload_kg, plan.tip_m(limb, end_us))
            })
            .collect::<Result<_, _>>()?;
        let warnings = rows.iter().flat_map(|row| row.warnings(limb, options.tolerance)).collect();
        Ok(Self { scene, limb, rows, warnings })
    }

    /// The result as `--json` prints it.
    pub fn printed(&self) -> impl Serialize {
        let phases = self.rows.iter().map(|row| row.printed(self.limb)).collect();
        let bends = of_limb(self.limb);
        Printed { scene: self.scene.name(), mass_kg: self.scene.mass_kg(), bends, phases }
    }
}

impl StaticsOptions {
    fn row(
        &self,
        (scene, limb): (&Scene, &Limb),
        phase: &str,
        pressures_pa: &[f64],
        payload_kg: f64,
        planned_tip_m: [f64; 3],
    ) -> Result<Row, ResultError> {
        let channels = limb.channel_values(pressures_pa);
        let bays: Vec<usize> =
            scene.modules().iter().map(|module| usize::from(self.spacers.unwrap_or(module.spacers)) + 1).collect();
        let load = Load { payload_kg, ..Load::default() };
        let loaded = LoadedLimb::new(scene, limb, &channels, &bays, &load).ok_or_else(|| {
            ResultError::NoEquilibrium(format!(
                "phase `{phase}`: an actuator has no equilibrium at its pressure, or a bundle no stiffness"
            ))
        })?;
        let free_tip_m: [f64; 3] = loaded.free_tip().translation.vector.into();
        let found = loaded.stand(self.tolerance, scene.rest_length_m());
        let (phase, pressures_pa) = (phase.to_owned(), pressures_pa.to_vec());
        Ok(Row { phase, payload_kg, pressures_pa, free_tip_m, planned_tip_m, found })
    }
}

impl Row {
    pub(crate) fn off_target_m(&self, found: &Standing) -> f64 {
        (Vector3::from(found.tip_m) - Vector3::from(self.planned_tip_m)).norm()
    }

    fn printed<'a>(&'a self, limb: &'a Limb) -> PrintedPhase<'a> {
        let name = |module: Option<usize>| module.map(|index| limb.modules()[index].name.as_str());
        let found = match &self.found {
            Err(lost) => Balance::EquilibriumError { lost: lost.to_string() },
            Ok(found) => Balance::Found(Box::new(Found {
                tip_m: found.tip_m,
                off_target_m: self.off_target_m(found),
                deflection_m: found.sag_m,
                tip_stiffness_n_per_m: found.stiffness_n_per_m,
                load_factor: found.load_factor,
                buckling_margin: found.buckling_margin,
                weakest_module: name(found.weakest_module),
                bent_back: name(found.bent_back),
                second_tip_m: found.second_tip_m,
                tier: found.answer.tier.name(),
                order_error: found.answer.order_error,
                bundle_error: found.answer.bundle_error,
                rods_error: found.answer.tubes.as_ref().map(|(_, rods)| *rods),
                bundle_shift_m: found.answer.bundle_shift_m.map(Into::into),
                newton_iterations: found.answer.shape.iterations,
            })),
        };
        let Self { phase, payload_kg, pressures_pa, free_tip_m, .. } = self;
        PrintedPhase { name: phase, payload_kg: *payload_kg, pressures_pa, free_tip_m: *free_tip_m, found }
    }

    fn warnings(&self, limb: &Limb, tolerance: f64) -> Vec<String> {
        let phase = &self.phase;
        let found = match &self.found {
            Err(lost) => return vec![format!("phase `{phase}`: {lost}")],
            Ok(found) => found,
        };
        let mut warnings = Vec::new();
        let name = |module: Option<usize>| module.map_or("", |index| limb.modules()[index].name.as_str());
        if 1.0 / found.buckling_margin > BUCKLED {
            let (ratio, module) = (100.0 / found.buckling_margin, name(found.weakest_module));
            warnings.push(format!("phase `{phase}`: buckling: a tube of `{module}` carries {ratio:.0} % of the load that it buckles at between two plates; more `spacers` help"));
        } else if found.answer.error() > tolerance {
            let error = 100.0 * found.answer.error();
            warnings.push(format!(
                "phase `{phase}`: the tip is known to {error:.1} % of the length only, by the finest model there is"
            ));
        }
        if let Some([x, y, z]) = found.second_tip_m {
            warnings.push(format!("phase `{phase}`: the limb has a second stable shape, with its tip at ({x:.3}, {y:.3}, {z:.3}) m, where a load leads to that grows at full pressure"));
        }
        if found.bent_back.is_some() {
            let module = name(found.bent_back);
            warnings.push(format!("phase `{phase}`: `{module}` is bent backwards by the load, where its lines would have to shorten: the shape is not to be trusted"));
        }
        warnings
    }
}
