//! The equilibrium of stresses in the textbook form, with its own quadrature.
//!
//! Wall: `P = int (s_tt - s_rr) dr/r`, `N = pi int [2 (s_zz - s_rr) - (s_tt - s_rr)] r dr`, `M = 2 pi int s_tz r^2 dr`.
//! A sheet is a membrane with resultants `N_ij = s_ij t R/(r lambda)`: it adds `N_tt/r`, `pi r (2 N_zz - N_tt)`, `2 pi r^2 N_tz`.

use fra_model::*;

/// What the stresses of a shape balance.
pub(crate) struct Resultants {
    pub(crate) pressure_pa: f64,
    pub(crate) force_n: f64,
    pub(crate) torque_nm: f64,
}

/// Stress differences `(tt - rr, zz - rr, tz)` of the elastomer.
fn elastomer_stress(material: &Material<f64>, h: f64, lambda: f64, r_tau: f64) -> [f64; 3] {
    let radial = 1.0 / (h * lambda).powi(2);
    let i1 = radial + h * h + r_tau * r_tau + lambda * lambda;
    let modulus = match *material {
        Material::NeoHookean { shear_modulus_pa } => shear_modulus_pa,
        Material::Yeoh { c_pa: [c1, c2, c3] } => {
            2.0 * (c1 + 2.0 * c2 * (i1 - 3.0) + 3.0 * c3 * (i1 - 3.0) * (i1 - 3.0))
        }
    };
    [modulus * (h * h + r_tau * r_tau - radial), modulus * (lambda * lambda - radial), modulus * r_tau * lambda]
}

fn fiber_stress(fiber: &Fiber<f64>, h: f64, lambda: f64, r_tau: f64) -> [f64; 3] {
    let signs: &[f64] = if fiber.families == Families::Two { &[1.0, -1.0] } else { &[1.0] };
    let mut sum = [0.0; 3];
    for sign in signs {
        let (c, s) = (sign * fiber.angle_rad.cos(), fiber.angle_rad.sin());
        let (hoop, axial) = (c * h + s * r_tau, s * lambda);
        let stress = 2.0 * fiber.modulus_pa * (hoop * hoop + axial * axial - 1.0);
        sum[0] += stress * hoop * hoop;
        sum[1] += stress * axial * axial;
        sum[2] += stress * hoop * axial;
    }
    sum
}

/// Composite Simpson from `a` to `b`.
fn simpson(a: f64, b: f64, f: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
    let n = 4000;
    let step = (b - a) / f64::from(n);
    let mut sum = [0.0; 3];
    for i in 0..=n {
        let weight = if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        let value = f(a + step * f64::from(i));
        for (total, v) in sum.iter_mut().zip(value) {
            *total += v * weight * step / 3.0;
        }
    }
    sum
}

/// Resultants of the shape with an axial stretch, an inner radius and a twist.
pub(crate) fn resultants(p: &ActuatorParameters<f64>, shape: [f64; 3]) -> Resultants {
    resultants_of(p, p.fiber.as_slice(), shape)
}

/// The same of the tube with these windings.
pub(crate) fn resultants_of(
    p: &ActuatorParameters<f64>,
    windings: &[Fiber<f64>],
    [lambda, inner_deformed, twist]: [f64; 3],
) -> Resultants {
    let tau = twist / p.length_m;
    let inner = p.inner_radius_m;
    let deformed = |radius: f64| (inner_deformed.powi(2) + (radius * radius - inner * inner) / lambda).sqrt();
    let integrand = |radius: f64, stress: [f64; 3]| {
        let r = deformed(radius);
        let dr = radius / (lambda * r);
        let pi = std::f64::consts::PI;
        let [hoop, axial, shear] = stress;
        [hoop / r * dr, pi * (2.0 * axial - hoop) * r * dr, 2.0 * pi * shear * r * r * dr]
    };
    let wall = simpson(inner, p.outer_radius_m, |radius| {
        let r = deformed(radius);
        integrand(radius, elastomer_stress(&p.material, r / radius, lambda, r * tau))
    });
    let of_winding = |fiber: &Fiber<f64>| {
        let smeared = |from: f64| {
            simpson(from, p.outer_radius_m, |radius| {
                let r = deformed(radius);
                integrand(radius, fiber_stress(fiber, r / radius, lambda, r * tau))
            })
        };
        match fiber.placement {
            Placement::Smeared => smeared(inner),
            Placement::Layer => smeared(fiber.radius_m),
            Placement::Sheet => {
                let r = deformed(fiber.radius_m);
                let thickness = fiber.thickness_m * fiber.radius_m / (r * lambda);
                let [tt, zz, tz] = fiber_stress(fiber, r / fiber.radius_m, lambda, r * tau).map(|s| s * thickness);
                let pi = std::f64::consts::PI;
                [tt / r, pi * r * (2.0 * zz - tt), 2.0 * pi * r * r * tz]
            }
        }
    };
    let [pressure_pa, force_n, torque_nm] = windings
        .iter()
        .map(of_winding)
        .fold(wall, |sum, winding| std::array::from_fn(|resultant| sum[resultant] + winding[resultant]));
    Resultants { pressure_pa, force_n, torque_nm }
}
