//! The residuals of eq. (18) and their derivatives; behind those of the wrenches, with an effort, one for each pressure.
//!
//! `f = sum_i D_i F_i`: the loads `F_i` by geometry and pressure from the model's own derivatives, `D_i` by point and axis as written
//! here. A length `l` that the surroundings hold makes the stretch `l/L`, hence `dF/dL` also has `-(l/L) dF/dl`.

use fra_model::{Actuator, Blocked, Parameter, Status};
use nalgebra::{Vector2, Vector3, Vector6};

use super::answer::{Answer, answer};
use super::layout::{Layout, PLACED, Quantity, Slot};
use super::problem::{ForceProblem, Place, Tube};
use softlimb_limb::payload::{PayloadError, lever};
use softlimb_numerics::least_squares::LeastSquares;

/// Residuals and what they cost.
pub struct Forces<'a> {
    pub(super) problem: &'a ForceProblem,
    pub(super) layout: Layout,
    pub(super) evaluations: u64,
    pub(super) jacobians: u64,
}

/// Actuators and wrenches at a point of the unit box.
pub struct Point {
    pub(super) actuators: Vec<Placed>,
    /// Wrench of each sample.
    pub wrenches: Vec<Vector6<f64>>,
}

/// One actuator there.
pub(super) struct Placed {
    /// Values of its slots.
    pub(super) values: Vec<f64>,
    actuator: Actuator<f64>,
    /// One for each sample.
    pub(super) held: Vec<Blocked<f64>>,
    pub(super) point_m: Vector3<f64>,
    pub(super) axis: Vector3<f64>,
}

impl<'a> Forces<'a> {
    /// Counts start at zero.
    pub fn new(problem: &'a ForceProblem) -> Self {
        Self { problem, layout: Layout::new(problem), evaluations: 0, jacobians: 0 }
    }

    /// Number of variables.
    pub fn width(&self) -> usize {
        self.layout.width
    }

    /// The answer at a point of the unit box, found from one start.
    ///
    /// # Errors
    /// [`PayloadError::Solver`] where the model has no forces.
    pub fn answer(&mut self, place: &[f64]) -> Result<Answer, PayloadError> {
        answer(self, place, (1, 1))
    }

    fn weight(&self, row: usize) -> f64 {
        let weight = if row < 3 { self.problem.force_per_n } else { self.problem.torque_per_nm };
        weight / (self.problem.samples.len() as f64).sqrt()
    }

    /// The factor of an actuator's pressures in their rows of the effort.
    fn effort_per_pa(&self, actuator: usize) -> f64 {
        let pressures = (self.problem.actuators.len() * self.problem.samples.len()) as f64;
        let own_pa = self.problem.actuators[actuator].tube.pressure_max_pa;
        (self.problem.effort / pressures).sqrt() / self.problem.reference_pressure_pa.unwrap_or(own_pa)
    }

    fn placed(&self, index: usize, slots: &[Slot], place: &[f64]) -> Option<Placed> {
        let values: Vec<f64> = slots.iter().map(|slot| slot.value(place)).collect();
        let [inner, wall, length, angle, first, second, height, slope_x, slope_y, pressures @ ..] = &values[..] else {
            return None;
        };
        let attachment = &self.problem.actuators[index];
        let actuator = Actuator::new(&attachment.tube.parameters(*inner, *wall, *length, *angle)).ok()?;
        let hold = |(pressure, sample): (&f64, &super::Sample)| {
            let held_length = sample.held_length_m.unwrap_or(*length);
            actuator.blocked(*pressure, held_length / length, 0.0).ok().filter(|held| held.status == Status::Solved)
        };
        let held = pressures.iter().zip(&self.problem.samples).map(hold).collect::<Option<Vec<_>>>()?;
        let point_m = match attachment.place {
            Place::Polar { .. } => Vector3::new(first * second.cos(), first * second.sin(), *height),
            Place::Cartesian { .. } => Vector3::new(*first, *second, *height),
        };
        let axis = Vector3::new(*slope_x, *slope_y, 1.0).normalize();
        Some(Placed { actuator, held, point_m, axis, values })
    }

    /// Derivatives of force and moment on the connector by a number of the actuator in a sample; `None` where there is none.
    fn load_slope(&self, tube: &Tube, placed: &Placed, sample: usize, quantity: Quantity) -> Option<Vector2<f64>> {
        let held = &placed.held[sample];
        let by = |parameter: Parameter| {
            let load = placed.actuator.blocked_sensitivity(held, parameter).ok()?;
            Some(-Vector2::new(load.force_n, load.torque_nm))
        };
        // The winding follows both radii, and the outer one the inner one and the wall.
        let winding = |slope: fn([f64; 2]) -> f64| match tube.winding.radius_slopes() {
            Some(slopes) => Some(by(Parameter::WindingRadius)? * slope(slopes)),
            None => Some(Vector2::zeros()),
        };
        match quantity {
            Quantity::InnerRadius => {
                let outer = by(Parameter::OuterRadius)? + winding(|[inner, outer]| inner + outer)?;
                Some(by(Parameter::InnerRadius)? + outer)
            }
            Quantity::Wall => Some(by(Parameter::OuterRadius)? + winding(|[_, outer]| outer)?),
            Quantity::Angle => Some(by(Parameter::FiberAngle)? * tube.hand()),
            Quantity::Length => {
                let own = by(Parameter::Length)?;
                let Some(length) = self.problem.samples[sample].held_length_m else { return Some(own) };
                // At constant stretch `own`; the stretch is l/L, and the stiffness is by the length at constant L.
                let rest = placed.actuator.parameters().length_m;
                let stiffness = -Vector2::new(held.stiffness[0][0], held.stiffness[1][0]) * rest;
                Some(own - stiffness * (length / (rest * rest)))
            }
            Quantity::Pressure(of) if of == sample => Some(-Vector2::from(held.by_pressure)),
            _ => Some(Vector2::zeros()),
        }
    }
}

/// Derivatives of point and axis.
fn place_slope(placed: &Placed, quantity: Quantity) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let [first, second, slope_x, slope_y] = [4, 5, 7, 8].map(|slot: usize| placed.values[slot]);
    let none = Vector3::zeros();
    let out = || Vector3::new(second.cos(), second.sin(), 0.0);
    let tilt = |by: Vector3<f64>| {
        let along = Vector3::new(slope_x, slope_y, 1.0);
        (by - placed.axis * placed.axis.dot(&by)) / along.norm()
    };
    match quantity {
        Quantity::Radius => Some((out(), none)),
        Quantity::Azimuth => Some((Vector3::new(-out().y, out().x, 0.0) * first, none)),
        Quantity::X => Some((Vector3::x(), none)),
        Quantity::Y => Some((Vector3::y(), none)),
        Quantity::Height => Some((Vector3::z(), none)),
        Quantity::SlopeX => Some((none, tilt(Vector3::x()))),
        Quantity::SlopeY => Some((none, tilt(Vector3::y()))),
        _ => None,
    }
}

/// `dw` of `w = (F a, F d x a + M a)` with point and axis.
fn turned(placed: &Placed, load: &Vector2<f64>, point: &Vector3<f64>, axis: &Vector3<f64>) -> Vector6<f64> {
    let force = axis * load.x;
    let moment = (point.cross(&placed.axis) + placed.point_m.cross(axis)) * load.x + axis * load.y;
    Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z)
}

impl Placed {
    /// What it does to the connector.
    pub(super) fn load(&self, sample: usize) -> Vector2<f64> {
        -Vector2::new(self.held[sample].force_n, self.held[sample].torque_nm)
    }
}

impl LeastSquares for Forces<'_> {
    type Evaluation = Point;

    fn evaluate(&mut self, place: &[f64]) -> Option<Point> {
        self.evaluations += 1;
        let slots = self.layout.slots.iter().enumerate();
        let actuators = slots.map(|(index, slots)| self.placed(index, slots, place)).collect::<Option<Vec<_>>>()?;
        let wrench = |sample: usize| {
            actuators
                .iter()
                .map(|placed| lever(&placed.point_m, &placed.axis) * placed.load(sample))
                .sum::<Vector6<f64>>()
        };
        let wrenches = (0..self.problem.samples.len()).map(wrench).collect();
        Some(Point { actuators, wrenches })
    }

    fn residuals(&self, point: &Point) -> Vec<f64> {
        let pairs = point.wrenches.iter().zip(&self.problem.samples);
        let wrenches = pairs
            .flat_map(|(found, wanted)| (0..6).map(move |row| self.weight(row) * (found[row] - wanted.wrench[row])));
        let actuators = point.actuators.iter().enumerate().filter(|_| self.problem.effort > 0.0);
        let pressures = actuators.flat_map(|(index, placed)| {
            placed.values[PLACED..].iter().map(move |pressure| self.effort_per_pa(index) * pressure)
        });
        wrenches.chain(pressures).collect()
    }

    fn jacobian(&mut self, point: &Point) -> Option<Vec<Vec<f64>>> {
        self.jacobians += 1;
        let (width, samples) = (self.layout.width, self.problem.samples.len());
        let mut rows = vec![vec![0.0; width]; 6 * samples];
        for (index, slots) in self.layout.slots.iter().enumerate().filter(|_| self.problem.effort > 0.0) {
            for slot in &slots[PLACED..] {
                let mut row = vec![0.0; width];
                slot.axis.into_iter().for_each(|axis| row[axis] = self.effort_per_pa(index) * slot.range());
                rows.push(row);
            }
        }
        let attachments = &self.problem.actuators;
        for ((placed, slots), attachment) in point.actuators.iter().zip(&self.layout.slots).zip(attachments) {
            let d = lever(&placed.point_m, &placed.axis);
            for slot in slots {
                let Some(axis) = slot.axis else { continue };
                for sample in 0..samples {
                    if matches!(slot.quantity, Quantity::Pressure(of) if of != sample) {
                        continue;
                    }
                    let slope = match place_slope(placed, slot.quantity) {
                        Some((by_point, by_axis)) => turned(placed, &placed.load(sample), &by_point, &by_axis),
                        None => d * self.load_slope(&attachment.tube, placed, sample, slot.quantity)?,
                    };
                    for row in 0..6 {
                        rows[6 * sample + row][axis] += self.weight(row) * slope[row] * slot.range();
                    }
                }
            }
        }
        Some(rows)
    }
}
