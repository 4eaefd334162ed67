//! Valves that are too coarse for a chamber: the step of pressure that the shortest pulse makes.

use super::air::Air;
use softlimb_limb::{Limb, LimbModule};
use softlimb_scene::{Scene, Valve};

/// Time beyond the closing delay for which the shortest pulse keeps a valve open, s: what the controller allows for valves that scatter.
const MARGIN_S: f64 = 0.5e-3;
/// Share of the shortest pulse's step within which the controller leaves an error alone.
const DEADBAND: f64 = 0.55;
/// Largest error left alone without a warning, as a share of the highest pressure that the module reaches.
const LEFT_MAX: f64 = 0.01;
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

/// A warning for each module whose valves leave more than 1 % of the highest pressure it reaches, with the conductance that would do.
pub fn valve_warnings(scene: &Scene, limb: &Limb) -> Vec<String> {
    let of_module = |module: &LimbModule| {
        let highest_pa = module.curve.pressure_max_pa();
        let step_pa = valve_step_pa(scene, limb, module, highest_pa);
        (DEADBAND * step_pa > LEFT_MAX * highest_pa).then(|| warning(scene, limb, module, [step_pa, highest_pa]))
    };
    limb.modules().iter().filter_map(of_module).collect()
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
