//! Bodies as the actuators of a limb that hangs under its weight and what it carries.
//!
//! A value is that of the limb's equilibrium at the pressures and with the mass of a hold, by the statics that a simulated run has.

use std::cell::RefCell;
use std::sync::Arc;

use fra_model::{Actuator, InvalidParameter};
use nalgebra::{DMatrix, DVector, Vector4};
use softlimb_fea::cross_section::BendingLaw;
use softlimb_limb::statics::{EquilibriumError, Fidelity, Load, LoadedLimb, Settled, Spring};
use softlimb_limb::{Limb, bending_law};
use softlimb_scene::Scene;

use super::body::NoAnswer;
use super::fit::{fit_model, fit_settled};
use super::free::{check, refused};
use super::problem::{Measured, Model, Refused};
use super::{Body, BodyModel, Branch, CalibrationError, Fit, LimbHold, Observation, Property, Settings, Unknown};

/// The finest tier of rods, which simulated runs have too.
const TIER: Fidelity = Fidelity::Fourfold;
/// Step of an unknown for a derivative, over the largest half width that is useful.
const STEP: f64 = 1e-4;
/// Most turns of springs, and the change of a strain, 1 or rad/m, that ends them.
const TURNS: usize = 40;
const CONVERGED: f64 = 1e-9;

/// A limb at the ends of some holds.
#[derive(Clone, Copy, Debug)]
pub struct Loaded<'a> {
    /// The scene: plates, masses and places of the actuators.
    pub scene: &'a Scene,
    /// Its limb.
    pub limb: &'a Limb,
    /// The body of each channel.
    pub bodies: &'a [usize],
    /// The holds.
    pub holds: &'a [LimbHold],
    /// Accuracy of each coordinate of the tip, m; > 0.
    pub tip_accuracy_m: f64,
}

/// An equilibrium: what is measured in it, and where the next one begins.
struct Shape {
    drives: Vec<f64>,
    tip_m: [f64; 3],
    strains: Vec<Vector4<f64>>,
    q: DVector<f64>,
}

/// Finds the unknowns by least squares of the deformations and of the tip's positions in the holds of a loaded limb.
///
/// `observations` are the deformations that were seen ([`Loaded::seen`]), in that order. The values of a [`Fit`] are those of the observations, and
/// behind them three coordinates of the tip for each hold in which it was seen.
///
/// # Errors
/// [`CalibrationError`], as its variants say.
pub fn fit_loaded(
    loaded: &Loaded<'_>,
    bodies: &[Body],
    observations: &[Observation],
    unknowns: &[Unknown],
    settings: &Settings,
) -> Result<Fit, CalibrationError> {
    check(bodies, observations)?;
    let without = |property: &Property| {
        matches!(
            property,
            Property::Length | Property::SeatingPressure | Property::LoopWidth | Property::PressureOffset
        )
    };
    if let Some(property) = unknowns.iter().map(|unknown| unknown.property).find(without) {
        return Err(CalibrationError::NotUnderWeight { property });
    }
    let readings = loaded.holds.iter().flat_map(|hold| &hold.readings_pa);
    let most_pa = readings.map(|reading| reading.abs()).fold(0.0, f64::max);
    let readings_pa = |index: usize| {
        let channels = loaded.bodies.iter().enumerate().filter(move |(_, of)| **of == index);
        let of_channel =
            |channel: usize| loaded.holds.iter().map(move |hold| (hold.readings_pa[channel], Branch::Loading));
        channels.flat_map(|(channel, _)| of_channel(channel)).collect()
    };
    let models = |bodies: &[Body]| BodyModel::of_all(bodies, unknowns, readings_pa);
    let laws = Laws { most_pa, known: RefCell::default() };
    fit_settled(bodies, models, |models| {
        let tubes = Tubes { models, laws: &laws };
        let model = Hanging { loaded, observations, most_pa, tubes, last: RefCell::default() };
        fit_model(&model, bodies, unknowns, (settings, most_pa))
    })
}

impl Loaded<'_> {
    /// Hold and drive of each deformation that was seen.
    pub fn seen(&self) -> Vec<(usize, usize)> {
        let holds = self.holds.iter().enumerate();
        let of_hold = |(hold, of): (usize, &LimbHold)| {
            let drives = of.values.iter().enumerate().filter(|(_, value)| value.is_some());
            drives.map(|(drive, _)| (hold, drive)).collect::<Vec<_>>()
        };
        holds.flat_map(of_hold).collect()
    }

    /// The limb of the bodies in a hold, from an equilibrium nearby where there is one.
    fn shape(&self, bodies: &[Body], of: &Tubes<'_>, hold: &LimbHold, near: Option<&Shape>) -> Result<Shape, Refused> {
        let mut tubes = Vec::with_capacity(self.bodies.len());
        for (index, reading_pa) in self.bodies.iter().zip(&hold.readings_pa) {
            let body = &bodies[*index];
            // Below ambient pressure as at rest, as the plant has it.
            let tube = of.tube(*index, body, body.pressure_pa(*reading_pa).max(0.0));
            tubes.push(tube.map_err(|(why, too_soft)| Refused { error: refused(body, *reading_pa, why), too_soft })?);
        }
        let load = Load { payload_kg: hold.payload_kg, ..Load::default() };
        let falls = |cause: String| Refused {
            error: CalibrationError::Falls { phase: hold.phase.clone(), cause },
            too_soft: true,
        };
        let limb = LoadedLimb::of_springs(self.scene, self.limb, &tubes, &load)
            .ok_or_else(|| falls("a module has no shape without load".into()))?;
        let limb = near.and_then(|near| limb.at_strains(&near.strains).ok()).unwrap_or(limb);
        let (settled, strains) = settled(&limb, near.map(|near| &near.q)).map_err(|why| falls(why.to_string()))?;
        let deformed = settled.limb.deformed(&settled.rod, &settled.shape);
        let drives = self.limb.drives().map(|drive| drive.deformed_value(&deformed[drive.index]).unwrap_or(f64::NAN));
        Ok(Shape {
            drives: drives.collect(),
            tip_m: settled.shape.tip().translation.vector.into(),
            strains,
            q: settled.shape.q,
        })
    }

    fn shapes(&self, bodies: &[Body], of: &Tubes<'_>, near: Option<&[Shape]>) -> Result<Vec<Shape>, Refused> {
        let holds = self.holds.iter().enumerate();
        holds.map(|(index, hold)| self.shape(bodies, of, hold, near.map(|near| &near[index]))).collect()
    }

    /// The values of the observations, and behind them those of the tips.
    fn row(&self, shapes: &[Shape]) -> Vec<f64> {
        let deformations = self.seen().into_iter().map(|(hold, drive)| shapes[hold].drives[drive]);
        let seen = self.holds.iter().zip(shapes).filter(|(hold, _)| hold.tip_m.is_some());
        deformations.chain(seen.flat_map(|(_, shape)| shape.tip_m)).collect()
    }
}

/// An equilibrium with its springs about its own strains: the difference of two that are less exact is no derivative.
fn settled(limb: &LoadedLimb, near: Option<&DVector<f64>>) -> Result<(Settled, Vec<Vector4<f64>>), EquilibriumError> {
    let mut settled = limb.settle(TIER, near)?;
    let mut strains = settled.limb.strains(&settled.rod, &settled.shape.q);
    for _ in 0..TURNS {
        settled = settled.limb.at_strains(&strains)?.settle(TIER, Some(&settled.shape.q))?;
        let next = settled.limb.strains(&settled.rod, &settled.shape.q);
        let change = next.iter().zip(&strains).map(|(next, before)| (next - before).amax()).fold(0.0, f64::max);
        strains = next;
        if change <= CONVERGED {
            return Ok((settled, strains));
        }
    }
    Err(EquilibriumError::Unsettled)
}

/// The tubes of the bodies, each by its model.
#[derive(Clone, Copy)]
struct Tubes<'a> {
    models: &'a [BodyModel],
    laws: &'a Laws,
}

/// Laws of bending bodies that were found so far: each takes finite elements.
struct Laws {
    /// The highest pressure of the data, Pa.
    most_pa: f64,
    known: RefCell<Vec<(Body, Option<Arc<BendingLaw>>)>>,
}

impl Tubes<'_> {
    /// The tube of a body at a pressure, Pa, or why there is none, and whether a stiffer one would have an equilibrium.
    fn tube(&self, index: usize, body: &Body, pressure_pa: f64) -> Result<Spring, (NoAnswer, bool)> {
        let invalid = |error: InvalidParameter<f64>| (NoAnswer::from(error), false);
        let tube = if self.models[index].is_by_section() {
            let actuator = Actuator::new(&body.parameters).map_err(invalid)?;
            self.laws.of(body).and_then(|law| Spring::by_section(&actuator, &law, pressure_pa))
        } else {
            Spring::new(&body.actuator().map_err(invalid)?, pressure_pa)
        };
        tube.ok_or((NoAnswer::BeyondLimit(None), true))
    }
}

impl Laws {
    fn of(&self, body: &Body) -> Option<Arc<BendingLaw>> {
        let is_like =
            |known: &&(Body, _)| (&known.0.parameters, known.0.second_fiber) == (&body.parameters, body.second_fiber);
        if let Some((_, law)) = self.known.borrow().iter().find(is_like) {
            return law.clone();
        }
        let law = bending_law(&body.parameters, body.second_fiber.as_ref(), self.most_pa);
        self.known.borrow_mut().push((body.clone(), law.clone()));
        law
    }
}

struct Hanging<'a> {
    loaded: &'a Loaded<'a>,
    observations: &'a [Observation],
    most_pa: f64,
    tubes: Tubes<'a>,
    /// Equilibria of the last place, where those of the next begin.
    last: RefCell<Option<Vec<Shape>>>,
}

impl Model for Hanging<'_> {
    fn measured(&self) -> Vec<Measured> {
        let of = |seen: &Observation| Measured { value: seen.value, accuracy: seen.accuracy };
        let tips = self.loaded.holds.iter().filter_map(|hold| hold.tip_m).flatten();
        let of_tip = |value| Measured { value, accuracy: self.loaded.tip_accuracy_m };
        self.observations.iter().map(of).chain(tips.map(of_tip)).collect()
    }

    fn values(&self, bodies: &[Body]) -> Vec<Option<f64>> {
        match self.loaded.shapes(bodies, &self.tubes, None) {
            Ok(shapes) => self.loaded.row(&shapes).into_iter().map(Some).collect(),
            Err(_) => vec![None; self.measured().len()],
        }
    }

    fn linearized(&self, bodies: &[Body], unknowns: &[Unknown]) -> Result<(Vec<f64>, DMatrix<f64>), Refused> {
        let shapes = self.loaded.shapes(bodies, &self.tubes, self.last.borrow().as_deref())?;
        let values = self.loaded.row(&shapes);
        let mut slopes = DMatrix::zeros(values.len(), unknowns.len());
        for (column, unknown) in unknowns.iter().enumerate() {
            let value = unknown.property.value(&bodies[unknown.bodies[0]]).unwrap_or(0.0);
            let step = STEP * unknown.scale(bodies, self.most_pa);
            let mut moved = bodies.to_vec();
            unknown.place(&mut moved, value + step);
            let there = self.loaded.row(&self.loaded.shapes(&moved, &self.tubes, Some(&shapes))?);
            for (row, (there, here)) in there.iter().zip(&values).enumerate() {
                slopes[(row, column)] = (there - here) / step;
            }
        }
        self.last.replace(Some(shapes));
        Ok((values, slopes))
    }
}
