//! Largest stretch in the wall of an actuator, beside that of the test behind its law.

use fra_model::{ActuatorParameters, Motion, State};
use softlimb_scene::Scene;

use super::Limb;

/// The largest principal stretch in a wall: at its inner or outer face, or at the far side of a bend.
pub fn largest_stretch(actuator: &ActuatorParameters<f64>, state: &State<f64>) -> f64 {
    if actuator.motion == Motion::Bending {
        // The strain limiter keeps its length, and the axis lies halfway to the far side.
        let hoop = state.inner_radius_m / actuator.inner_radius_m;
        return hoop.max(2.0 * state.axial_stretch - 1.0);
    }
    let face = |rest_m: f64, radius_m: f64| {
        let hoop = radius_m / rest_m;
        let shear = radius_m * state.twist_rad / actuator.length_m;
        // Eigenvalues of the right Cauchy-Green tensor in the cylinder's surface.
        let (a, b, c) = (hoop * hoop, hoop * shear, shear * shear + state.axial_stretch.powi(2));
        (0.5 * (a + c) + (0.25 * (a - c).powi(2) + b * b).sqrt()).sqrt()
    };
    let inner = face(actuator.inner_radius_m, state.inner_radius_m);
    inner.max(face(actuator.outer_radius_m, state.outer_radius_m))
}

impl Limb {
    /// Warnings of modules whose walls stretch further than the test behind their elastomer's law, at the highest gauge pressure of each, Pa.
    pub fn stretch_warnings(&self, scene: &Scene, highest_pa: &[f64]) -> Vec<String> {
        let modules = self.modules().iter().zip(scene.modules()).zip(highest_pa);
        let beyond = modules.filter_map(|((built, module), highest_pa)| {
            let most = module.stretch_max?;
            let parts = built.parts().iter();
            let each = parts.map(|part| largest_stretch(part.actuator.parameters(), &part.curve.at(*highest_pa)));
            let stretch = each.fold(1.0, f64::max);
            (stretch > most).then(|| {
                format!(
                    "`{}` stretches its wall to {stretch:.2} at {:.2} kPa, and the test behind its elastomer's law ends at {most:.2}: the \
                     law is a guess beyond it",
                    built.name,
                    1e-3 * highest_pa
                )
            })
        });
        beyond.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fra_model::{Actuator, Families, Fiber, Load, Material, Placement};

    fn tube(motion: Motion, fiber: Option<Fiber<f64>>) -> ActuatorParameters<f64> {
        let material = Material::NeoHookean { shear_modulus_pa: 2e5 };
        ActuatorParameters { motion, inner_radius_m: 8e-3, outer_radius_m: 12e-3, length_m: 0.2, material, fiber }
    }

    #[test]
    fn simple_shear_has_its_principal_stretch() {
        // A twist alone: the amount of shear g at the outer face stretches by (g + sqrt(g^2 + 4)) / 2.
        let actuator = tube(Motion::Twisting, None);
        let rest = Actuator::new(&actuator).unwrap().rest();
        let shear: f64 = 0.7;
        let state = State { twist_rad: shear * 0.2 / 12e-3, ..rest };
        let expected = 0.5 * (shear + (shear * shear + 4.0).sqrt());
        assert!((largest_stretch(&actuator, &state) - expected).abs() < 1e-12);
    }

    #[test]
    fn bend_stretches_the_far_side_twice_as_much_as_the_axis() {
        let actuator = tube(Motion::Bending, None);
        let rest = Actuator::new(&actuator).unwrap().rest();
        assert_eq!(largest_stretch(&actuator, &State { axial_stretch: 1.25, ..rest }), 1.5);
    }

    #[test]
    fn bare_tube_stretches_most_around_its_lumen() {
        let along = Fiber {
            angle_rad: std::f64::consts::FRAC_PI_2,
            families: Families::Two,
            modulus_pa: 3e8,
            placement: Placement::Sheet,
            thickness_m: 2e-4,
            radius_m: 12e-3,
        };
        let actuator = tube(Motion::Expansion, Some(along));
        let state = Actuator::new(&actuator).unwrap().forward(4e4, &Load::none()).unwrap().state;
        assert_eq!(largest_stretch(&actuator, &state), state.inner_radius_m / 8e-3);
    }
}
