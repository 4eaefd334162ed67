//! Conditions between the parts of a scene.

use super::module::Draft;
use crate::data::{Goal, Limits, Module, Phase, Plant};
use crate::error::Problem;
use crate::reader::Log;
use crate::schema::Unit;
use crate::source::Located;
use fra_model::StateQuantity;

/// Channels of one controller.
const CHANNELS_MAX: i64 = 27;

/// Notes the module that goes beyond the channels of the controller.
pub(super) fn channels(log: &Log, drafts: &[Draft<'_>]) {
    let mut before = 0;
    for actuators in drafts.iter().filter_map(|draft| draft.actuators) {
        let total = before + *actuators;
        if total > CHANNELS_MAX {
            let title = format!("too many actuators: a controller has {CHANNELS_MAX} channels");
            let label = format!("{} here after {before} in the modules before", *actuators);
            log.note::<()>(Problem::at(actuators.span, title, label));
            return;
        }
        before = total;
    }
}

/// Notes pressures that the sensors cannot read, the supply cannot give or the module must not have.
pub(super) fn pressures(
    log: &Log,
    drafts: &[Draft<'_>],
    phases: Option<&[Phase]>,
    limits: Option<&Limits>,
    plant: Option<&Plant>,
) {
    if let (Some(limits), Some(plant)) = (limits, plant) {
        supply(log, limits, plant);
        valve_voltage(log, limits, plant);
        let mut seen: Vec<Located<f64>> = Vec::new();
        for module in drafts.iter().filter_map(|draft| draft.module.as_ref()) {
            // Modules without their own value share the place of the common one.
            if !seen.contains(&module.pressure_max_pa) {
                seen.push(module.pressure_max_pa);
                reachable(log, module.pressure_max_pa, plant);
            }
        }
    }
    for phase in phases.unwrap_or_default() {
        if let Goal::Targets(targets) = &phase.goal {
            for target in targets.iter().filter(|target| target.kind == StateQuantity::Pressure) {
                if let Some(module) = drafts.get(target.module).and_then(|draft| draft.module.as_ref()) {
                    allowed(log, target.value, module);
                }
            }
        }
    }
}

fn supply(log: &Log, limits: &Limits, plant: &Plant) {
    let pressure = plant.supply.pressure_pa();
    let shown = Unit::KPA.show_si(pressure);
    let (min, max) = (limits.supply_min_pa, limits.supply_max_pa);
    if !(min..=max).contains(&pressure) {
        let (min, max) = (Unit::KPA.show_si(min), Unit::KPA.show_si(max));
        let title = format!("the supply pressure of {shown} is outside `supply_min` to `supply_max`, {min} to {max}");
        log.note::<()>(Problem::new(title).help("change `pressure` in `[plant.supply]` or the bounds in `[limits]`"));
    }
}

fn valve_voltage(log: &Log, limits: &Limits, plant: &Plant) {
    let (Some(least), nominal) = (limits.valve_voltage_min_v, plant.valve.voltage_v) else { return };
    if *least >= nominal {
        let title =
            format!("`valve_voltage_min` is not below the `voltage` of the valves: {}", Unit::V.show_si(nominal));
        log.note::<()>(Problem::at(least.span, title, format!("this is {}", Unit::V.show_si(*least))));
    }
}

fn reachable(log: &Log, pressure_max: Located<f64>, plant: &Plant) {
    let (sensor, supply) = (plant.sensor.full_scale_pa, plant.supply.pressure_pa());
    let (limit, what) = if sensor <= supply { (sensor, "sensor reads to") } else { (supply, "supply gives") };
    if *pressure_max >= limit {
        let title = format!("`pressure_max` is not below what the {what}: {}", Unit::KPA.show_si(limit));
        log.note::<()>(Problem::at(pressure_max.span, title, format!("this is {}", Unit::KPA.show_si(*pressure_max))));
    }
}

fn allowed(log: &Log, pressure: Located<f64>, module: &Module) {
    if *pressure > *module.pressure_max_pa {
        let title = format!("the pressure is above the `pressure_max` of module `{}`", module.name.value);
        let problem = Problem::at(pressure.span, title, format!("this is {}", Unit::KPA.show_si(*pressure)));
        let limit = format!("the limit is {}", Unit::KPA.show_si(*module.pressure_max_pa));
        log.note::<()>(problem.label(module.pressure_max_pa.span, limit));
    }
}
