//! The linear route: exact derivatives of the tip by every wall, angle and modulus.
//!
//! The stiffnesses of a bundle change with walls and moduli. That moves the shape of twisting actuators, which plates hold back, and of actuators
//! at unequal pressures: the shapes of such bundles are differenced.

use std::collections::BTreeMap;

use nalgebra::{Vector3, Vector4};

use super::input::{Kind, Place, Varied};
use super::made::change;
use super::section::tangents;
use super::shape::{Tube, arc, chain, mount, shape};
use super::study::{Nominal, Study, ToleranceError, actuator};
use crate::LimbModule;
use crate::fabricate::Tolerances;
use crate::statics::{Spring, responses, shape_change};

/// Steps of differences of shapes: of a fiber angle, rad, a wall, m, and a modulus, of itself.
const STEPS: [(Kind, f64); 3] = [(Kind::Angle, 1e-4), (Kind::Wall, 1e-6), (Kind::Modulus, 1e-4)];
/// Variance of a number that is uniform in -1 to 1.
const VARIANCE: f64 = 1.0 / 3.0;

/// Derivatives of the tip in one pose.
#[derive(Clone, Debug)]
pub struct Linear {
    /// By channel and kind: how far the tip goes from the middle of a tolerance to its end, m.
    gradients: Vec<[Vector3<f64>; 3]>,
    module_of: Vec<usize>,
    batch: Vec<usize>,
}

/// The derivatives in every pose.
///
/// # Errors
/// [`ToleranceError::Derivative`] where a nominal actuator is at its limit point.
pub fn linear(study: &Study<'_>) -> Result<Vec<Linear>, ToleranceError> {
    (0..study.poses.len()).map(|pose| Linear::new(study, pose)).collect()
}

impl Linear {
    fn new(study: &Study<'_>, pose: usize) -> Result<Self, ToleranceError> {
        let modules = study.limb.modules();
        let nominal = &study.nominal[pose];
        let starts = chain(study.limb, nominal.iter().map(|module| &module.arc));
        let tip_m = study.nominal_tip_m(pose);
        let (mut gradients, mut module_of) = (Vec::new(), Vec::new());
        for (index, (module, nominal)) in modules.iter().zip(nominal).enumerate() {
            let fail = |reason: String| ToleranceError::Derivative {
                phase: study.poses[pose].name.clone(),
                module: module.name.clone(),
                pressure_pa: nominal.tubes.iter().map(|(state, _)| state.pressure_pa).fold(0.0, f64::max),
                reason,
            };
            let turn = starts[index].rotation * mount(module);
            let end_m = starts[index].translation.vector + turn * nominal.arc.pose().translation.vector;
            for by in shapes(study, index, module, nominal).map_err(fail)? {
                gradients.push(by.map(|shape| {
                    let twist = nominal.arc.change(&arc(module, &shape));
                    turn * twist.velocity + (turn * twist.rotation).cross(&(tip_m - end_m))
                }));
                module_of.push(index);
            }
        }
        Ok(Self { gradients, module_of, batch: study.batch.clone() })
    }

    /// Displacement of the tip, m, of a limb whose actuators are at places within their tolerances.
    pub(super) fn displacement_m(&self, places: &[Place]) -> Vector3<f64> {
        let channels = self.gradients.iter().zip(places);
        channels.map(|(by, place)| by[0] * place[0] + by[1] * place[1] + by[2] * place[2]).sum()
    }

    /// Mean square of the displacement, m2.
    pub fn mean_square_m2(&self) -> f64 {
        self.where_only(|_, _| true)
    }

    /// Mean square of the displacement, m2, with only some parameters off.
    pub fn mean_square_of_m2(&self, varied: Varied) -> f64 {
        match varied {
            Varied::Kind(kind) => self.where_only(|_, other| other == kind),
            Varied::Module(index) => self.where_only(|module, _| module == index),
        }
    }

    fn where_only(&self, counts: impl Fn(usize, Kind) -> bool) -> f64 {
        // What has one draw moves the tip together.
        let mut draws: BTreeMap<(usize, usize), Vector3<f64>> = BTreeMap::new();
        for (channel, by) in self.gradients.iter().enumerate() {
            for kind in Kind::ALL.into_iter().filter(|kind| counts(self.module_of[channel], *kind)) {
                let source = if kind == Kind::Modulus { self.batch[channel] } else { channel };
                *draws.entry((source, kind.index())).or_insert_with(Vector3::zeros) += by[kind.index()];
            }
        }
        VARIANCE * draws.values().map(Vector3::norm_squared).sum::<f64>()
    }
}

/// By actuator and kind: change of the module's free shape.
fn shapes(
    study: &Study<'_>,
    index: usize,
    module: &LimbModule,
    nominal: &Nominal,
) -> Result<Vec<[Vector4<f64>; 3]>, String> {
    if module.is_restrained() || module.is_steering() {
        return differences(study, module, &study.places_m[index], nominal)
            .ok_or_else(|| "a bundle next to it has no equilibrium".to_owned());
    }
    let (state, tube) = &nominal.tubes[0];
    let mut changes = [Vector4::zeros(); 3];
    for kind in Kind::ALL {
        changes[kind.index()] = if module.is_by_section() {
            section_change(module, state.pressure_pa, kind, &study.settings.tolerances)
                .ok_or_else(|| "an actuator next to it has no equilibrium".to_owned())?
        } else {
            let by = change(&module.actuator, state, kind, &study.settings.tolerances);
            shape_change(module.motion, by.map_err(|reason| reason.to_string())?)
        };
    }
    let each = responses(module.motion, &study.places_m[index], &tube.tangent())
        .ok_or_else(|| "its bundle has no stiffness".to_owned())?;
    Ok(each.into_iter().map(|response| changes.map(|by| response * by)).collect())
}

/// Change of the free shape of a bender by finite elements of its section, from the middle to the end of a tolerance.
fn section_change(module: &LimbModule, pressure_pa: f64, kind: Kind, tolerances: &Tolerances) -> Option<Vector4<f64>> {
    let at = |side: f64| {
        let tube = tangents(module, &steps(), &only(kind, side), &[pressure_pa]).pop()??;
        Some(Vector4::new(tube.stretch, tube.bend_rad_per_m, 0.0, tube.twist_rad_per_m))
    };
    Some((at(1.0)? - at(-1.0)?) * (kind.of(tolerances) / (2.0 * kind.of(&steps()))))
}

/// The same steps whatever the tolerances, so that the derivatives are.
fn steps() -> Tolerances {
    Tolerances { angle_rad: STEPS[0].1, wall_m: STEPS[1].1, modulus: STEPS[2].1 }
}

/// The place of an actuator with one kind off.
pub(super) fn only(kind: Kind, off: f64) -> Place {
    let mut place = [0.0; 3];
    place[kind.index()] = off;
    place
}

/// The same by central differences; `None` where a bundle next to the nominal one has no equilibrium.
fn differences(
    study: &Study<'_>,
    module: &LimbModule,
    places_m: &[[f64; 2]],
    nominal: &Nominal,
) -> Option<Vec<[Vector4<f64>; 3]>> {
    let of = |index: usize, kind: Kind, side: f64| {
        let pressure_pa = nominal.tubes[index].0.pressure_pa;
        let off = Spring::new(&actuator(module, &steps(), &only(kind, side))?, pressure_pa)?;
        let mut tubes: Vec<_> =
            places_m.iter().zip(&nominal.tubes).map(|(place, (_, tube))| (*place, tube.clone())).collect();
        tubes[index].1 = Tube::Model(Box::new(off));
        shape(module, &tubes)
    };
    let by = |actuator: usize, kind: Kind, step: f64| {
        let slope = (of(actuator, kind, 1.0)? - of(actuator, kind, -1.0)?) / (2.0 * step);
        Some(slope * kind.of(&study.settings.tolerances))
    };
    (0..places_m.len())
        .map(|actuator| {
            let mut each = [Vector4::zeros(); 3];
            for (kind, step) in STEPS {
                each[kind.index()] = by(actuator, kind, step)?;
            }
            Some(each)
        })
        .collect()
}
