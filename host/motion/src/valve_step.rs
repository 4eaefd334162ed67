//! Valves that are too coarse for a chamber: the step of pressure that the shortest pulse makes.

use super::air::Air;
use super::plan::Plan;
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::{Scene, Valve};

/// Time beyond the closing delay for which the shortest pulse keeps a valve open, s: what the controller allows for valves that scatter.
const MARGIN_S: f64 = 0.5e-3;
/// Share of the shortest pulse's step within which the controller leaves an error alone.
const DEADBAND: f64 = 0.55;
/// Largest error left alone without a warning, as a share of the highest pressure of the plan: spread evenly, it is 1.2 % rms.
const LEFT_MAX: f64 = 0.02;
/// Least conductance that a scene may state, m3/(s Pa).
const LEAST_M3_PER_S_PA: f64 = 1e-11;

/// The largest step that the shortest pulse of a module's valves makes over its pressures, Pa.
pub fn valve_step_pa(scene: &Scene, limb: &Limb, module: &LimbModule, highest_pa: f64) -> f64 {
    let air = Air::new(scene, limb);
    let open_s = shortest_open_s(&scene.plant().valve);
    let states = module.curve.states().windows(2).filter(|pair| pair[1].pressure_pa <= highest_pa);
    let step = |pair: &[fra_model::State<f64>]| {
        let pressure_pa = pair[0].pressure_pa;
        let compliance = (pair[1].volume_m3 - pair[0].volume_m3) / (pair[1].pressure_pa - pressure_pa);
        air.step_pa(pressure_pa, pair[0].volume_m3, compliance, open_s)
    };
    states.map(step).fold(0.0, f64::max)
}

fn shortest_open_s(valve: &Valve) -> f64 {
    valve.off_delay_s + MARGIN_S
}

/// A warning for each module whose valves leave more than 2 % of its highest pressure in the plan, with the conductance that would do.
pub fn valve_warnings(scene: &Scene, limb: &Limb, plan: &Plan) -> Vec<String> {
    let rows = plan.knots().iter().enumerate();
    let rows: Vec<_> = rows.map(|(knot, _)| plan.states_at((knot as u64 * plan.knot_period_us) as f64)).collect();
    let of_module = |(index, module): (usize, &LimbModule)| {
        let highest_pa = rows.iter().map(|row| row[index].pressure_pa).fold(0.0, f64::max);
        let step_pa = valve_step_pa(scene, limb, module, highest_pa);
        let left = DEADBAND * step_pa / highest_pa;
        (left > LEFT_MAX).then(|| warning(scene, limb, module, [step_pa, highest_pa]))
    };
    limb.modules().iter().enumerate().filter_map(of_module).collect()
}

fn warning(scene: &Scene, limb: &Limb, module: &LimbModule, [step_pa, highest_pa]: [f64; 2]) -> String {
    let valve = &scene.plant().valve;
    let air = Air::new(scene, limb);
    let rest_ml = 1e6 * (module.curve.states()[0].volume_m3 + super::dead_volume_m3(scene));
    let left = DEADBAND * step_pa / highest_pa;
    // The flow is in proportion to the conductance of valve and line in series.
    let enough = air.valve_of(LEFT_MAX / left);
    let helps = if enough >= LEAST_M3_PER_S_PA {
        format!("a conductance of {} dm3/(s bar) would leave less", floor(1e8 * enough))
    } else {
        "no valve would leave less: a larger chamber or a lower supply".to_owned()
    };
    format!(
        "the valves are coarse for `{}`: open for {:.1} ms at least, at {:.3} dm3/(s bar), they change the pressure of its {rest_ml:.1} mL by up to {:.2} kPa, and leave {:.1} % of its {:.1} kPa; {helps}",
        module.name,
        1e3 * shortest_open_s(valve),
        1e8 * valve.conductance_m3_per_s_pa,
        1e-3 * step_pa,
        100.0 * left,
        1e-3 * highest_pa,
    )
}

/// A number rounded down to two digits.
fn floor(value: f64) -> f64 {
    let unit = 10_f64.powf(value.log10().floor() - 1.0);
    // A division by a power of ten that is a whole number prints as it is.
    (value / unit).floor() / (1.0 / unit).round().max(1.0)
}
