//! Margins of the loaded limb.

use serde::Serialize;

use softlimb_limb::Limb;
use softlimb_motion::{Margins, Plan};
use softlimb_scene::Scene;

/// Margins of a phase in `--json`; the worst of the tip empty, half and fully loaded.
#[derive(Serialize)]
pub(crate) struct PrintedMargins<'a> {
    payload_kg: f64,
    load_factor: f64,
    stiffness_n_per_m: f64,
    sag_m: f64,
    buckling_margin: f64,
    weakest_module: Option<&'a str>,
    pressure_share: f64,
    error: f64,
    second_tip_m: Option<[f64; 3]>,
}

impl<'a> PrintedMargins<'a> {
    pub(crate) fn new(limb: &'a Limb, margins: &Margins) -> Self {
        Self {
            payload_kg: margins.payload_kg,
            load_factor: margins.load_factor,
            stiffness_n_per_m: margins.stiffness_n_per_m,
            sag_m: margins.sag_m,
            buckling_margin: margins.buckling_margin,
            weakest_module: margins.weakest_module.map(|module| limb.modules()[module].name.as_str()),
            pressure_share: margins.pressure_share,
            error: margins.error,
            second_tip_m: margins.second_tip_m,
        }
    }
}

/// A warning for each margin that is too small, with a change that helps.
pub(crate) fn warnings(scene: &Scene, limb: &Limb, plan: &Plan, margins: &[Margins]) -> Vec<String> {
    plan.phases.iter().zip(margins).flat_map(|(phase, margins)| of_phase(scene, limb, &phase.name, margins)).collect()
}

fn of_phase(scene: &Scene, limb: &Limb, phase: &str, margins: &Margins) -> Vec<String> {
    let module = |index: usize| limb.modules()[index].name.as_str();
    let limits = scene.limits().standing;
    let mut warnings = Vec::new();
    let mut warn = |text: String| warnings.push(format!("phase `{phase}`: {text}"));
    if margins.load_factor < limits.load_factor {
        warn(format!(
            "the load factor is {:.2}, below {}: tubes further apart, wider tubes or a pose that hangs more help",
            margins.load_factor, limits.load_factor
        ));
    }
    if margins.buckling_margin < limits.buckling_margin {
        let name = margins.weakest_module.map_or("", module);
        let helps = margins.spacers_enough.map_or_else(
            || "wider tubes or a pose that hangs more help".to_owned(),
            |spacers| format!("`spacers = {spacers}` would be enough"),
        );
        warn(format!(
            "the buckling margin of a tube of `{name}` is {:.2}, below {}: {helps}",
            margins.buckling_margin, limits.buckling_margin
        ));
    }
    let sag_share = margins.sag_m / scene.rest_length_m();
    if sag_share > limits.sag_share {
        let [percent, allowed] = [sag_share, limits.sag_share].map(|share| 100.0 * share);
        warn(format!(
            "the sag is {percent:.0} % of the length, above {allowed:.0} %: tubes further apart, a stiffer elastomer or a pose that hangs more help"
        ));
    }
    if margins.stiffness_n_per_m < limits.stiffness_n_per_m {
        warn(format!(
            "the vertical stiffness of the tip is {:.1} N/m, below {} N/m: tubes further apart, wider tubes or a shorter limb help",
            margins.stiffness_n_per_m, limits.stiffness_n_per_m
        ));
    }
    if margins.pressure_share > limits.pressure_share {
        let [percent, allowed] = [margins.pressure_share, limits.pressure_share].map(|share| 100.0 * share);
        let name = module(margins.fullest_module);
        warn(format!(
            "the pressure of `{name}` is {percent:.0} % of its limit or limit point, above {allowed:.0} %: a thicker wall, a stiffer elastomer or a smaller target helps"
        ));
    }
    if let Some([x, y, z]) = margins.second_tip_m {
        warn(format!("the limb has a second stable shape, with its tip at ({x:.3}, {y:.3}, {z:.3}) m"));
    }
    warnings
}
