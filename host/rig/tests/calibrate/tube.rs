//! A closed tube with two wound families as a sheet, by integrals of its stresses: nothing here is the energy that the model is made of.

use std::f64::consts::PI;

use fra_model::{ActuatorParameters, Families, Fiber, Material, Motion, Placement, StateQuantity};
use softlimb_rig::calibrate::{Body, Branch, Observation};

/// Wall and winding.
#[derive(Clone, Copy)]
pub(crate) struct Tube {
    pub(crate) inner: f64,
    pub(crate) outer: f64,
    pub(crate) length: f64,
    pub(crate) c: [f64; 3],
    pub(crate) angle: f64,
    pub(crate) fiber_modulus: f64,
    pub(crate) thickness: f64,
}

/// One equilibrium.
#[derive(Clone, Copy)]
pub(crate) struct Held {
    pub(crate) pressure: f64,
    pub(crate) stretch: f64,
    pub(crate) outer: f64,
}

impl Tube {
    pub(crate) fn soft() -> Self {
        Self {
            inner: 9e-3,
            outer: 13e-3,
            length: 0.2,
            c: [1e5, 0.0, 0.0],
            angle: 0.35,
            fiber_modulus: 4e6,
            thickness: 2e-4,
        }
    }

    /// Pressure and axial force at a stretch and an inner radius.
    fn stresses(&self, stretch: f64, inner: f64) -> (f64, f64) {
        let radius = |at: f64| (inner * inner + (at * at - self.inner * self.inner) / stretch).sqrt();
        let [c1, c2, c3] = self.c;
        // Per undeformed radius: what the hoop adds to the pressure, and what the wall adds to the force.
        let per_radius = |at: f64| {
            let r = radius(at);
            let (hoop, across) = (r / at, at / (r * stretch));
            let x = hoop * hoop + across * across + stretch * stretch - 3.0;
            let twice_slope = 2.0 * (c1 + x * (2.0 * c2 + 3.0 * c3 * x));
            let width = at / (stretch * r);
            let difference = twice_slope * (hoop * hoop - across * across);
            let axial = twice_slope * (stretch * stretch - across * across);
            (difference / r * width, (2.0 * axial - difference) * PI * r * width)
        };
        let steps = 400;
        let width = (self.outer - self.inner) / f64::from(steps);
        let (mut pressure, mut force) = (0.0, 0.0);
        for index in 0..=steps {
            let weight = match index {
                0 => 1.0,
                _ if index == steps => 1.0,
                _ if index % 2 == 1 => 4.0,
                _ => 2.0,
            } * width
                / 3.0;
            let (p, n) = per_radius(self.inner + width * f64::from(index));
            (pressure, force) = (pressure + weight * p, force + weight * n);
        }
        let (sine, cosine) = self.angle.sin_cos();
        let hoop = radius(self.outer) / self.outer;
        let strain = stretch * stretch * sine * sine + hoop * hoop * cosine * cosine - 1.0;
        let tension = 2.0 * 2.0 * self.thickness * self.fiber_modulus * strain;
        let squeeze = tension * cosine * cosine / (self.outer * stretch);
        force += 2.0 * PI * self.outer * tension * stretch * sine * sine - squeeze * PI * radius(self.outer).powi(2);
        (pressure + squeeze, force)
    }

    /// The equilibrium at a stretch, without force on its closed ends.
    pub(crate) fn at_stretch(&self, stretch: f64) -> Held {
        // The force falls with the radius: the cap's push is in it.
        let (mut low, mut high) = (0.7 * self.inner, 1.6 * self.inner);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if self.stresses(stretch, middle).1 > 0.0 { low = middle } else { high = middle }
        }
        let inner = 0.5 * (low + high);
        let outer = (inner * inner + (self.outer * self.outer - self.inner * self.inner) / stretch).sqrt();
        Held { pressure: self.stresses(stretch, inner).0, stretch, outer }
    }

    /// The equilibrium at an inner radius, for windings that hold the length.
    pub(crate) fn at_inner_radius(&self, inner: f64) -> Held {
        let (mut low, mut high) = (0.8, 1.3);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if self.stresses(middle, inner).1 < 0.0 { low = middle } else { high = middle }
        }
        let stretch = 0.5 * (low + high);
        let outer = (inner * inner + (self.outer * self.outer - self.inner * self.inner) / stretch).sqrt();
        Held { pressure: self.stresses(stretch, inner).0, stretch, outer }
    }

    /// The same tube for the model.
    pub(crate) fn body(&self, name: &str) -> Body {
        let [c1, c2, c3] = self.c;
        let neo_hookean = c2 == 0.0 && c3 == 0.0;
        Body::new(
            name,
            ActuatorParameters {
                motion: Motion::Extension,
                inner_radius_m: self.inner,
                outer_radius_m: self.outer,
                length_m: self.length,
                material: if neo_hookean {
                    Material::NeoHookean { shear_modulus_pa: 2.0 * c1 }
                } else {
                    Material::Yeoh { c_pa: self.c }
                },
                fiber: Some(Fiber {
                    angle_rad: self.angle,
                    families: Families::Two,
                    modulus_pa: self.fiber_modulus,
                    placement: Placement::Sheet,
                    thickness_m: self.thickness,
                    radius_m: self.outer,
                }),
            },
        )
    }

    /// Stretches and outer radii of the tube, of equal accuracy relative to their change.
    pub(crate) fn observed(&self, body: usize, stretches: &[f64], accuracy: f64) -> Vec<Observation> {
        self.seen(body, stretches.iter().map(|stretch| self.at_stretch(*stretch)), accuracy)
    }

    /// The same of any equilibria.
    pub(crate) fn seen(&self, body: usize, held: impl Iterator<Item = Held>, accuracy: f64) -> Vec<Observation> {
        let both = |held: Held| {
            let seen = |quantity, value, accuracy| Observation {
                body,
                reading_pa: held.pressure,
                branch: Branch::Loading,
                quantity,
                value,
                accuracy,
            };
            [
                seen(StateQuantity::AxialStretch, held.stretch, accuracy),
                seen(StateQuantity::OuterRadius, held.outer, accuracy * self.outer),
            ]
        };
        held.flat_map(both).collect()
    }
}

/// Equidistant numbers.
pub(crate) fn grid(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..count).map(|index| from + (to - from) * index as f64 / (count - 1) as f64).collect()
}
