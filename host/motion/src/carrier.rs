//! Where the limb is at pressures of its drives: without load, or in equilibrium under its weight and what it carries.

use std::cell::{Cell, RefCell};

use fra_model::State;
use nalgebra::{Isometry3, Vector3};

use super::jacobian::Differential;
use super::payload::Carrying;
use super::weight::{Nominal, PoseError, pressures_pa, step_pa};
use softlimb_limb::statics::Fidelity;
use softlimb_limb::{Drive, Limb};
use softlimb_scene::collision::{Body, Clearance};
use softlimb_scene::{Object, Scene};

/// A limb with what it carries.
#[derive(Debug)]
pub(super) struct Carrier<'a> {
    limb: &'a Limb,
    object: Option<&'a Object>,
    loaded: Option<Loaded<'a>>,
}

/// What makes it sag.
#[derive(Debug)]
struct Loaded<'a> {
    /// Each pose begins from the one before.
    nominal: RefCell<Nominal<'a>>,
    payload_kg: Cell<f64>,
    pressure_share: f64,
}

/// A limb at given pressures, ready for derivatives by them.
pub(super) enum Posture<'a> {
    /// Without load.
    Free(Differential<'a>, Body),
    /// Under load, or with a steering module: the body, and the same with the pressure of each drive moved by a step, Pa.
    Moved(Body, Vec<(f64, Body)>),
}

impl<'a> Carrier<'a> {
    /// A limb without load that carries nothing.
    pub(super) fn free(limb: &'a Limb) -> Self {
        Self { limb, object: None, loaded: None }
    }

    /// The limb of a scene with what it carries, by the statics of a tier; without a tier its weight and that of what it carries are left out.
    pub(super) fn new(scene: &'a Scene, limb: &'a Limb, tier: Option<Fidelity>, carrying: Carrying) -> Self {
        let loaded = tier.map(|tier| Loaded {
            nominal: RefCell::new(Nominal::new(scene, limb, tier)),
            payload_kg: Cell::new(carrying.payload_kg),
            pressure_share: scene.limits().standing.pressure_share,
        });
        Self { limb, object: carrying.object.map(|index| &scene.objects()[index]), loaded }
    }

    /// The limb.
    pub(super) fn limb(&self) -> &'a Limb {
        self.limb
    }

    /// Changes the mass at the tip, kg; without effect on a limb without load.
    pub(super) fn load(&self, payload_kg: f64) {
        self.loaded.iter().for_each(|loaded| loaded.payload_kg.set(payload_kg));
    }

    /// Highest pressure that keeps the margin of a limb under load, over the lower of its limit and limit point; 1 without load.
    pub(super) fn pressure_share(&self) -> f64 {
        self.loaded.as_ref().map_or(1.0, |loaded| loaded.pressure_share)
    }

    /// Whether it is under load.
    pub(super) fn is_loaded(&self) -> bool {
        self.loaded.is_some()
    }

    /// By how much tubes between plates have the tip elsewhere at gauge pressures, Pa; 0 without load.
    pub(super) fn tubes_shift_m(&self, pressures_pa: &[f64]) -> Vector3<f64> {
        let shift =
            |loaded: &Loaded<'_>| loaded.nominal.borrow_mut().tubes_shift_m(pressures_pa, loaded.payload_kg.get());
        self.loaded.as_ref().and_then(shift).unwrap_or_else(Vector3::zeros)
    }

    /// Why the limb does not stand at gauge pressures, Pa; `None` where it does.
    pub(super) fn falls(&self, pressures_pa: &[f64]) -> Option<PoseError> {
        let loaded = self.loaded.as_ref()?;
        loaded.nominal.borrow_mut().at(pressures_pa, loaded.payload_kg.get()).err()
    }

    /// Finer statics than the present ones where the shape at gauge pressures, Pa, needs them for an error, as a share of the limb's length.
    pub(super) fn finer_tier(&self, pressures_pa: &[f64], error: f64) -> Option<Fidelity> {
        let loaded = self.loaded.as_ref()?;
        loaded.nominal.borrow_mut().finer_tier(pressures_pa, loaded.payload_kg.get(), error)
    }

    /// Checks that the limb stands at gauge pressures, Pa, with no tube that buckles; without load it does.
    ///
    /// # Errors
    /// [`PoseError`].
    pub(super) fn stands(&self, pressures_pa: &[f64]) -> Result<(), PoseError> {
        let Some(loaded) = &self.loaded else { return Ok(()) };
        loaded.nominal.borrow_mut().at(pressures_pa, loaded.payload_kg.get())?.unbuckled().map(|_| ())
    }

    /// The body at gauge pressures, Pa, with the pose of the tip at its end; `None` where the limb does not stand.
    pub(super) fn body(&self, pressures_pa: &[f64]) -> Option<Body> {
        self.body_in(&self.states(pressures_pa))
    }

    /// The same at the pressures of states.
    pub(super) fn body_in(&self, states: &[State<f64>]) -> Option<Body> {
        let mut body = Body::new(self.limb.base());
        match &self.loaded {
            None => self.limb.shape(states, &mut body),
            Some(loaded) => {
                let pose = loaded.nominal.borrow_mut().at(&pressures_pa(states), loaded.payload_kg.get()).ok()?;
                self.limb.loaded_shape(&pose.rod, &pose.shape.q, states, &mut body);
            }
        }
        self.hang(&mut body);
        Some(body)
    }

    /// The limb with its derivatives; `None` where it does not stand.
    pub(super) fn posture(&self, pressures_pa: &[f64]) -> Option<Posture<'a>> {
        let Some(loaded) = &self.loaded else {
            if self.limb.is_steering() {
                return self.moved(pressures_pa);
            }
            let at = Differential::new(self.limb, pressures_pa);
            let mut body = self.limb.body(at.states());
            self.hang(&mut body);
            return Some(Posture::Free(at, body));
        };
        let mut nominal = loaded.nominal.borrow_mut();
        let pose = nominal.at(pressures_pa, loaded.payload_kg.get()).ok()?;
        let states = self.states(pressures_pa);
        let shape = |rod: &_, q: &_, states: &[State<f64>]| {
            let mut body = Body::new(self.limb.base());
            self.limb.loaded_shape(rod, q, states, &mut body);
            self.hang(&mut body);
            body
        };
        let moved = nominal.moved(&pose, pressures_pa)?;
        let moved = moved.into_iter().enumerate().map(|(index, moved)| {
            let mut states = states.clone();
            states[index] = self.limb.drive(index).curve.at(pressures_pa[index] + moved.step_pa);
            (moved.step_pa, shape(&moved.rod, &moved.q, &states))
        });
        Some(Posture::Moved(shape(&pose.rod, &pose.shape.q, &states), moved.collect()))
    }

    /// A limb without load with the pressure of each drive moved by a step.
    fn moved(&self, pressures_pa: &[f64]) -> Option<Posture<'a>> {
        let of_drive = |(index, drive): (usize, Drive<'_>)| {
            let step_pa = step_pa(&drive, pressures_pa[index]);
            let mut moved_pa = pressures_pa.to_vec();
            moved_pa[index] += step_pa;
            Some((step_pa, self.body(&moved_pa)?))
        };
        let moved = self.limb.drives().enumerate().map(of_drive).collect::<Option<_>>()?;
        Some(Posture::Moved(self.body(pressures_pa)?, moved))
    }

    fn states(&self, pressures_pa: &[f64]) -> Vec<State<f64>> {
        self.limb.drives().zip(pressures_pa).map(|(drive, pressure)| drive.curve.at(*pressure)).collect()
    }

    fn hang(&self, body: &mut Body) {
        if let Some(object) = self.object {
            body.hanging(object.height_m - object.grasp_m, object.grasp_m, object.radius_m);
        }
    }
}

impl Posture<'_> {
    /// The body.
    pub(super) fn body(&self) -> &Body {
        let (Self::Free(_, body) | Self::Moved(body, _)) = self;
        body
    }

    /// Pose of the tip.
    pub(super) fn tip(&self) -> &Isometry3<f64> {
        match self {
            Self::Free(at, _) => at.tip(),
            Self::Moved(body, _) => body.end(),
        }
    }

    /// Velocity of the tip by each pressure, m/Pa.
    pub(super) fn tip_velocities(&self) -> Vec<Vector3<f64>> {
        match self {
            Self::Free(at, _) => at.tip_velocities(),
            Self::Moved(body, moved) => {
                let way = |other: &Body| other.end().translation.vector - body.end().translation.vector;
                moved.iter().map(|(step_pa, other)| way(other) / *step_pa).collect()
            }
        }
    }

    /// Rotation of the tip by each pressure, rad/Pa.
    pub(super) fn tip_rotations(&self) -> Vec<Vector3<f64>> {
        match self {
            Self::Free(at, _) => at.tip_rotations().collect(),
            Self::Moved(body, moved) => {
                let turn = |other: &Body| (other.end().rotation * body.end().rotation.inverse()).scaled_axis();
                moved.iter().map(|(step_pa, other)| turn(other) / *step_pa).collect()
            }
        }
    }

    /// Velocity by each pressure, m/Pa, of a point of the body, and the growth of the body's radius there.
    pub(super) fn body_velocities(&self, at: &Clearance) -> (Vec<Vector3<f64>>, Vec<f64>) {
        match self {
            Self::Free(free, _) => free.body_velocities(at.piece, at.share, &at.point_m),
            Self::Moved(body, moved) => {
                let here = &body.pieces()[at.piece];
                let of_module = |(step_pa, other): &(f64, Body)| {
                    let there = &other.pieces()[at.piece];
                    let way = there.point_m(at.share) - here.point_m(at.share);
                    (way / *step_pa, (there.radius_m() - here.radius_m()) / step_pa)
                };
                moved.iter().map(of_module).unzip()
            }
        }
    }
}
