//! The limb in motion: inertia of its masses, by the implicit midpoint rule.
//!
//! A step finds the equilibrium of its middle, where forces of inertia act on the masses beside all others, and goes on as far again. The rule
//! is of second order and keeps the energy of vibrations; what damps them is the tubes' memory. Masses are points on plates: a plate turns
//! against its inertia only where it has masses beside its origin.

use nalgebra::{Matrix3, Vector3};

use crate::beam::{Node, turn_vector};
use crate::body::{Body, Fallen, Load};
use crate::contact::{BRAKING_S, Hanging};
use crate::tridiagonal::Part;

/// Halvings of a step that finds no equilibrium.
const HALVINGS: u32 = 6;

/// Inertia of a half step: where the plates were, and how they moved.
pub(crate) struct Inertia {
    start: Vec<Node>,
    velocities: Vec<Part>,
    half_s: f64,
}

impl Inertia {
    /// Force of inertia on a mass at a place of a plate, which is at `middle` now, N; its slope against a shift, N/m; and how a turn of the plate
    /// shifts the mass.
    ///
    /// `-m (dv/dt + dw/dt x r + w x (w x r))` with the mean velocity `v` and spin `w` of the step, and the arm `r` of its middle. The scheme is
    /// reversible, so that energy does not drift.
    pub(crate) fn force(
        &self,
        plate: usize,
        place_m: &Vector3<f64>,
        middle: &Node,
        kg: f64,
    ) -> (Vector3<f64>, f64, Matrix3<f64>) {
        let (start, velocity) = (&self.start[plate], &self.velocities[plate]);
        let arm = middle.turn * place_m;
        let turn = turn_vector(&(middle.turn * start.turn.transpose()));
        let went = middle.place - start.place + turn.cross(&arm);
        let drifts = velocity_at(velocity, &arm) * self.half_s;
        let per_n_per_m = kg / (self.half_s * self.half_s);
        let outwards = -turn.cross(&turn.cross(&arm));
        ((drifts - went + outwards) * per_n_per_m, per_n_per_m, -arm.cross_matrix())
    }

    /// Shift of a point of a plate over the rest of the step, m, and its velocity at the end, m/s. `arm_m` leads from the plate's origin to the point; the
    /// plate is at `middle` now.
    pub(crate) fn ahead(&self, plate: usize, arm_m: &Vector3<f64>, middle: &Node) -> [Vector3<f64>; 2] {
        let start = &self.start[plate];
        let was_m = start.turn * middle.turn.tr_mul(arm_m);
        let went_m = middle.place + arm_m - start.place - was_m;
        [went_m, went_m * (2.0 / self.half_s) - velocity_at(&self.velocities[plate], &was_m)]
    }

    /// Change of place and velocity at the end by a shift in the middle.
    pub(crate) fn ahead_by_shift(&self) -> [f64; 2] {
        [2.0, 2.0 / self.half_s]
    }
}

/// Velocity of a point at an arm from the origin of a plate.
fn velocity_at(velocity: &Part, arm: &Vector3<f64>) -> Vector3<f64> {
    let [shift, turn] = [0, 3].map(|row: usize| Vector3::from(velocity.fixed_rows::<3>(row)));
    shift + turn.cross(arm)
}

/// A limb that moves. It begins at rest.
#[derive(Clone, Debug)]
pub struct Moving {
    body: Body,
    /// Velocity and spin of each plate, in space.
    velocities: Vec<Part>,
}

impl Moving {
    /// A limb at rest in the shape of a body.
    pub fn new(mut body: Body) -> Self {
        // A body that was never settled bears no weight yet.
        body.load.weight = 1.0;
        let velocities = vec![Part::zeros(); body.nodes.len()];
        Self { body, velocities }
    }

    /// Takes the limb to rest in its equilibrium, as [`Body::settle`] does.
    ///
    /// # Errors
    /// [`Fallen`] as there.
    pub fn settle(&mut self, pressures_pa: &[f64], payload_kg: f64, span_s: f64) -> Result<(), Fallen> {
        self.velocities.fill(Part::zeros());
        self.body.settle(pressures_pa, payload_kg, span_s)
    }

    /// Hangs an object at the tip, as [`Body::carry`] does.
    pub fn carry(&mut self, object: Option<Hanging>) {
        self.body.carry(object);
    }

    /// Goes on by `span_s` as [`advance`](Self::advance) does, in even steps of at most `step_s`, and shorter ones near a solid.
    ///
    /// # Errors
    /// [`Fallen`] as there.
    pub fn advance_by(
        &mut self,
        pressures_pa: &[f64],
        payload_kg: f64,
        span_s: f64,
        step_s: f64,
    ) -> Result<(), Fallen> {
        // Twice this time is the step in which an impact leaves no velocity.
        let is_near = self.body.is_near_solid(2.0 * span_s * self.fastest_m_per_s());
        let step_s = if is_near { step_s.min(2.0 * BRAKING_S) } else { step_s };
        let steps = (span_s / step_s).ceil().max(1.0) as u32;
        let from = (self.body.pressures_pa.clone(), self.body.load.payload_kg);
        (1..=steps).try_for_each(|step| {
            let share = f64::from(step) / f64::from(steps);
            let mix = |a: f64, b: f64| a + (b - a) * share;
            let between: Vec<f64> = from.0.iter().zip(pressures_pa).map(|(a, b)| mix(*a, *b)).collect();
            self.advance(&between, mix(from.1, payload_kg), span_s / f64::from(steps))
        })
    }

    /// Speed of the fastest plate's origin, and of the tip, m/s.
    fn fastest_m_per_s(&self) -> f64 {
        let plates = self.velocities.iter().map(|velocity| velocity_at(velocity, &Vector3::zeros()));
        let (plate, place_m) = self.body.tip();
        let tip = velocity_at(&self.velocities[plate], &(self.body.nodes[plate].turn * place_m));
        plates.chain([tip]).map(|velocity| velocity.norm()).fold(0.0, f64::max)
    }

    /// The limb as it is.
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The limb, stopped where it is.
    pub fn stopped(self) -> Body {
        self.body
    }

    /// Gives every plate a velocity, m/s, and a spin about its origin, rad/s, in space.
    pub fn push(&mut self, velocity_m_per_s: [f64; 3], spin_rad_per_s: [f64; 3]) {
        for plate in &mut self.velocities {
            plate.fixed_rows_mut::<3>(0).copy_from(&Vector3::from(velocity_m_per_s));
            plate.fixed_rows_mut::<3>(3).copy_from(&Vector3::from(spin_rad_per_s));
        }
    }

    /// Kinetic energy of the limb with a mass at its tip, J.
    pub fn kinetic_j(&self, payload_kg: f64) -> f64 {
        let of = |plate: usize, place_m: Vector3<f64>, kg: f64| {
            let arm = self.body.nodes[plate].turn * place_m;
            0.5 * kg * velocity_at(&self.velocities[plate], &arm).norm_squared()
        };
        let plates = self.body.plates.iter().enumerate();
        let masses = plates
            .flat_map(|(plate, own)| own.masses.iter().map(move |mass| (plate, Vector3::from(mass.place_m), mass.kg)));
        let tip = self.body.nodes.len() - 1;
        masses.map(|(plate, place_m, kg)| of(plate, place_m, kg)).sum::<f64>() + of(tip, self.body.tip_m, payload_kg)
    }

    /// Velocity of the tip, m/s.
    pub fn tip_m_per_s(&self) -> [f64; 3] {
        let last = self.body.nodes.len() - 1;
        velocity_at(&self.velocities[last], &(self.body.nodes[last].turn * self.body.tip_m)).into()
    }

    /// Goes on by `span_s` > 0, while the pressures, one a channel, and the mass at the tip go evenly to new values.
    ///
    /// # Errors
    /// [`Fallen`] where even a short step finds no next shape; the limb must not be used afterwards.
    pub fn advance(&mut self, pressures_pa: &[f64], payload_kg: f64, span_s: f64) -> Result<(), Fallen> {
        let load = Load { weight: 1.0, payload_kg, tip_force_n: Vector3::zeros() };
        self.approach(pressures_pa, &load, span_s, HALVINGS)
    }

    fn approach(&mut self, pressures_pa: &[f64], load: &Load, span_s: f64, halvings: u32) -> Result<(), Fallen> {
        let before = self.clone();
        if self.step(pressures_pa, load, span_s) {
            return Ok(());
        }
        *self = before;
        let halvings = halvings.checked_sub(1).ok_or(Fallen)?;
        let half = self.body.halfway(pressures_pa);
        let halfway = self.body.load.between(load, 0.5);
        self.approach(&half, &halfway, 0.5 * span_s, halvings)?;
        self.approach(pressures_pa, load, 0.5 * span_s, halvings)
    }

    /// One step of the midpoint rule; whether its middle has a shape.
    fn step(&mut self, pressures_pa: &[f64], load: &Load, span_s: f64) -> bool {
        let half_s = 0.5 * span_s;
        let start = self.body.clone();
        let inertia = Inertia { start: start.nodes.clone(), velocities: self.velocities.clone(), half_s };
        let middle = start.halfway(pressures_pa);
        if !self.body.iterate(&middle, &start.load.between(load, 0.5), half_s, Some(&inertia)) {
            return false;
        }
        for (velocity, (was, is)) in self.velocities.iter_mut().zip(start.nodes.iter().zip(&self.body.nodes)) {
            let (shift, turn) = (is.place - was.place, turn_vector(&(is.turn * was.turn.transpose())));
            let mean = Part::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z) / half_s;
            *velocity = mean * 2.0 - *velocity;
        }
        self.body.go_on(&start);
        (self.body.pressures_pa, self.body.load) = (pressures_pa.to_vec(), *load);
        self.body.remember(span_s);
        true
    }
}
