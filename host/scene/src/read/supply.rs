//! Conditions between the supply, its sensor and the valves that draw from it.

use std::iter;

use super::module::Draft;
use crate::data::{Limits, Plant, Supply};
use crate::error::Problem;
use crate::reader::Reader;
use crate::schema::Unit;

/// The device refuses a bound that the sensor cannot see.
pub(super) fn sensor(root: &Reader<'_>, limits: Option<&Limits>, plant: &Plant) {
    let Some(limits) = limits else { return };
    let (max, full_scale) = (limits.supply_max_pa, plant.sensor.supply_full_scale_pa);
    if max > full_scale {
        let shown = Unit::KPA.show_si(full_scale);
        let problem = Problem::new(format!("`supply_max` is beyond the sensor of the supply, which reads to {shown}"))
            .label(root.place_of("limits", &["supply_max"]), format!("`supply_max` is {}", Unit::KPA.show_si(max)))
            .label(root.place_of("plant", &["sensor", "supply_full_scale"]), format!("the sensor reads to {shown}"));
        root.log().note::<()>(problem);
    }
}

/// The simulation holds the pressure of the reservoir over a tick, so the reservoir must be large for what flows in a tick.
pub(super) fn reservoir(root: &Reader<'_>, drafts: &[Draft<'_>], plant: &Plant) {
    let Supply::Pump { flow_m3_per_s: flow, stall_pressure_pa, reservoir_volume_m3: volume, .. } = plant.supply else {
        return;
    };
    let channels = drafts.iter().filter_map(|draft| draft.actuators).map(|actuators| *actuators).sum::<i64>();
    let conductance = plant.valve.conductance_m3_per_s_pa;
    let for_valves = least_for_valves_m3(usize::try_from(channels).unwrap_or(0), conductance);
    let for_pump = flow / (MOST_RATE * stall_pressure_pa);
    if volume >= for_valves.max(for_pump) {
        return;
    }
    let at = |path: &[&str]| root.place_of("plant", path);
    let problem = Problem::new("the reservoir is too small for the flow of a millisecond")
        .label(at(&["supply", "reservoir_volume"]), format!("the reservoir has {}", Unit::L.show_si(volume)));
    let (problem, least) = if for_valves >= for_pump {
        let label = format!("{channels} fill valves, each of {}", Unit::DM3_PER_S_BAR.show_si(conductance));
        (problem.label(at(&["valve", "conductance"]), label), for_valves)
    } else {
        let label = format!("the pump delivers {}", Unit::NL_PER_MIN.show_si(flow));
        (problem.label(at(&["supply", "flow"]), label), for_pump)
    };
    // Rounded up, so that the value that is named is accepted.
    let least = Unit::L.show_si((least * 1e6).floor() / 1e6 + 1e-6);
    root.log().note::<()>(problem.help(format!("`reservoir_volume` must be at least {least}")));
}

/// Steepest chord of an orifice in the plant, in units of its choked flow per pressure.
const STEEPEST: f64 = 25.0;
/// `1 / (2 tick rho0 R T0)` of the plant, 1/(s Pa): a flow of `C rho0 p` moves the pressure of the volume `C / MOST_RATE` by `p/2`
/// in a tick of 1 ms.
const MOST_RATE: f64 = 1.0 / (2.0 * 1e-3 * 1e5);

/// The smallest reservoir for as many fill valves, m3.
fn least_for_valves_m3(channels: usize, conductance_m3_per_s_pa: f64) -> f64 {
    STEEPEST * iter::repeat_n(conductance_m3_per_s_pa, channels).sum::<f64>() / MOST_RATE
}
