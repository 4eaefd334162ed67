//! The seeded set: benders with two families of thread as a sheet.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Material, Motion, Placement, Status, Target};
use softlimb_numerics::Random;

const LENGTH_M: f64 = 0.18;

/// A bender and its highest pressure.
pub(super) struct Bender {
    pub(super) parameters: ActuatorParameters<f64>,
    pub(super) pressure_max_pa: f64,
    /// Radii, law, winding angle and highest pressure.
    pub(super) name: String,
}

/// The first benders of a seed, half of them neo-Hookean: walls of 0.1 to 1 inner radius, windings at 0 to 30 deg from the hoop, bends that
/// stretch the axis by up to a half. A bender does not depend on how many follow it.
pub(super) fn benders(seed: u64, count: usize) -> Result<Vec<Bender>, String> {
    (0..count).map(|index| drawn(&mut Random::new(seed, index as u64), index % 2 == 0)).collect()
}

fn drawn(random: &mut Random, is_neo_hookean: bool) -> Result<Bender, String> {
    let mut uniform = |low: f64, high: f64| low + (high - low) * random.uniform();
    let inner_radius_m = rounded(uniform(3e-3, 15e-3), 1e-5);
    let outer_radius_m = rounded(inner_radius_m * (1.0 + uniform(0.1, 1.0)), 1e-5);
    let c1_pa = rounded(10_f64.powf(uniform(4.2, 5.5)), 100.0);
    let shape = [uniform(0.0, 0.2), uniform(-0.005, 0.0)];
    let angle_deg = rounded(uniform(0.0, 30.0), 0.1);
    let (law, material) = match is_neo_hookean {
        true => ("neo-Hookean", Material::NeoHookean { shear_modulus_pa: 2.0 * c1_pa }),
        false => ("Yeoh", Material::Yeoh { c_pa: [c1_pa, shape[0] * c1_pa, shape[1] * c1_pa] }),
    };
    let fiber = Fiber {
        angle_rad: angle_deg.to_radians(),
        families: Families::Two,
        modulus_pa: 361e6,
        placement: Placement::Sheet,
        thickness_m: 0.178e-3,
        radius_m: outer_radius_m,
    };
    let parameters = ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m,
        outer_radius_m,
        length_m: LENGTH_M,
        material,
        fiber: Some(fiber),
    };
    // Beyond a stretch of 1/(sqrt(3) sin a) of its axis a tube under pressure would lose volume: it bends less.
    let most = 0.7 * ((3.0_f64.sqrt() * fiber.angle_rad.sin()).recip() - 1.0);
    let strain = uniform(0.01, most.min(0.5));
    let radii = format!("{:.2}/{:.2} mm", inner_radius_m * 1e3, outer_radius_m * 1e3);
    let name = format!("{radii}, {law} {:.1} kPa, {angle_deg:.1} deg", c1_pa * 1e-3);
    let actuator = Actuator::new(&parameters).map_err(|error| format!("{name}: {error}"))?;
    let found = actuator.inverse(Target::BendAngle(strain * LENGTH_M / outer_radius_m), &Load::none());
    let found = found.map_err(|error| format!("{name}: {error}"))?;
    if found.status != Status::Solved {
        return Err(format!("{name}: no pressure stretches the axis by {strain}"));
    }
    let pressure_max_pa = rounded(found.state.pressure_pa, 10.0);
    Ok(Bender { parameters, pressure_max_pa, name: format!("{name}, {:.2} kPa", pressure_max_pa * 1e-3) })
}

/// To a multiple of a step, so that the name has all digits.
fn rounded(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}
