//! Pressure against deformation of the actuators of a scene.

use fra_model::{Load, Motion, Solution, State, Status};
use serde::Serialize;

use softlimb_limb::{Limb, LimbModule};

/// One point of a curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Gauge pressure, Pa.
    pub pressure_pa: f64,
    /// Axial stretch; of the axis for a bending actuator.
    pub axial_stretch: f64,
    /// Deformed outer radius, m.
    pub outer_radius_m: f64,
    /// Twist, rad.
    pub twist_rad: f64,
    /// Bend angle, rad.
    pub bend_angle_rad: f64,
    /// Lumen volume, m3.
    pub volume_m3: f64,
}

/// The curve of one module's actuator, or of its bundle where plates hold its actuators back.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Name of the module.
    pub module: String,
    /// Its motion, in words.
    pub motion: &'static str,
    /// Solved equations.
    pub equations: &'static str,
    /// The points from rest upwards.
    pub points: Vec<CurvePoint>,
    /// Limit pressure of a branch that ends below the requested pressure, Pa.
    pub limit_pressure_pa: Option<f64>,
}

/// Curves of all modules in `steps` equal steps up to each module's highest pressure.
pub fn curves(limb: &Limb, steps: usize) -> Vec<Curve> {
    limb.modules().iter().map(|module| curve(module, steps.max(1))).collect()
}

fn curve(module: &LimbModule, steps: usize) -> Curve {
    if module.is_by_curve() {
        return by_curve(module, steps);
    }
    let mut points = vec![point(&module.actuator.rest())];
    let mut limit_pressure_pa = None;
    for step in 1..=steps {
        let pressure_pa = module.pressure_max_pa * step as f64 / steps as f64;
        match module.actuator.forward(pressure_pa, &Load::none()) {
            Ok(Solution { status: Status::Solved, state, .. }) => points.push(point(&state)),
            Ok(solution) => {
                limit_pressure_pa = solution.limit_pressure_pa;
                break;
            }
            Err(_) => break,
        }
    }
    let (motion, equations) = (module.motion.name(), equations(module.motion));
    Curve { module: module.name.clone(), motion, equations, points, limit_pressure_pa }
}

/// The same of a module whose curve is its model, up to the end of the curve.
fn by_curve(module: &LimbModule, steps: usize) -> Curve {
    let pressures_pa = (0..=steps).map(|step| module.pressure_max_pa * step as f64 / steps as f64);
    let followed = pressures_pa.take_while(|pressure_pa| *pressure_pa <= module.curve.pressure_max_pa());
    Curve {
        module: module.name.clone(),
        motion: module.motion.name(),
        equations: if module.is_series() {
            "segments in series at one pressure"
        } else if module.is_by_section() {
            "finite elements of the section"
        } else {
            "tubes between plates, each from one strain energy"
        },
        points: followed.map(|pressure_pa| point(&module.curve.at(pressure_pa))).collect(),
        limit_pressure_pa: module.curve.limit_point_pa(),
    }
}

/// The model's equations for a motion.
fn equations(motion: Motion) -> &'static str {
    match motion {
        Motion::Extension | Motion::Expansion | Motion::Twisting => {
            "thick-walled tube, eqs. (7)-(9) from one strain energy"
        }
        Motion::Bending => "isochoric section about an inextensible line, in place of eqs. (10)-(13)",
    }
}

fn point(state: &State<f64>) -> CurvePoint {
    CurvePoint {
        pressure_pa: state.pressure_pa,
        axial_stretch: state.axial_stretch,
        outer_radius_m: state.outer_radius_m,
        twist_rad: state.twist_rad,
        bend_angle_rad: state.bend_angle_rad,
        volume_m3: state.volume_m3,
    }
}
