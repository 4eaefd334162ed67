//! What is tabulated: one quantity of one actuator over its pressures.

use fra_model::{Actuator, Load, State, StateQuantity, Status, Target};

use super::NoTable;
use softlimb_fea::cross_section::BendPolynomial;
use softlimb_limb::{LimbModule, StateCurve};

/// Newton steps from the interpolated curve to the model itself; two or three do.
const NEWTON_STEPS: usize = 12;

/// An unloaded actuator with the quantity its setpoints give.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The actuator.
    pub actuator: &'a Actuator<f64>,
    /// The quantity.
    pub kind: StateQuantity,
    /// Its states from zero to the highest pressure of the table.
    pub curve: &'a StateCurve,
    /// Whether the curve is the model ([`LimbModule::is_by_curve`]).
    pub by_curve: bool,
    /// The bend in place of the actuator's own, if its setpoints are bend angles.
    pub bend: Option<BendPolynomial>,
}

impl<'a> Subject<'a> {
    /// The actuators of a module.
    pub fn of(module: &'a LimbModule) -> Self {
        let alone = Self::new(&module.actuator, module.kind, &module.curve);
        Self { by_curve: module.is_by_curve(), ..alone }
    }

    /// An actuator by its own model.
    pub fn new(actuator: &'a Actuator<f64>, kind: StateQuantity, curve: &'a StateCurve) -> Self {
        Self { actuator, kind, curve, by_curve: false, bend: None }
    }

    /// The polynomial in place of the model, and the length it bends.
    fn polynomial(&self) -> Option<(BendPolynomial, f64)> {
        let bend = self.bend.filter(|_| self.kind == StateQuantity::BendAngle)?;
        Some((bend, self.actuator.parameters().length_m))
    }

    /// The quantity without pressure and at the highest one.
    ///
    /// # Errors
    /// [`NoTable::NotMonotone`] unless it runs from one to the other without turning back; [`NoTable::NotSolved`] without any pressure.
    pub fn range(&self) -> Result<(f64, f64), NoTable> {
        if let Some((bend, length_m)) = self.polynomial() {
            return Ok((0.0, bend.bend_rate_rad_per_m(self.curve.pressure_max_pa()) * length_m));
        }
        let values: Vec<f64> = self.curve.states().iter().map(|state| self.kind.of(state)).collect();
        let (Some(&first), Some(&last)) = (values.first(), values.last()) else {
            return Err(NoTable::NotSolved { pressure_pa: 0.0 });
        };
        if values.len() < 2 || first == last {
            return Err(NoTable::NotSolved { pressure_pa: self.curve.pressure_max_pa() });
        }
        let turned = values.windows(2).position(|pair| (pair[1] - pair[0]) * (last - first) <= 0.0);
        match turned {
            Some(node) => Err(NoTable::NotMonotone { pressure_pa: self.curve.states()[node].pressure_pa }),
            None => Ok((first, last)),
        }
    }

    /// The quantity that the model has at a gauge pressure, Pa.
    ///
    /// # Errors
    /// [`NoTable::NotSolved`].
    pub fn value_at(&self, pressure_pa: f64) -> Result<f64, NoTable> {
        if let Some((bend, length_m)) = self.polynomial() {
            return Ok(bend.bend_rate_rad_per_m(pressure_pa) * length_m);
        }
        let start: State<f64> = self.curve.at(pressure_pa);
        if self.by_curve {
            return Ok(self.kind.of(&start));
        }
        match self.actuator.forward_from(&start, pressure_pa, &Load::none()) {
            Ok(solution) if solution.status == Status::Solved => Ok(self.kind.of(&solution.state)),
            _ => Err(NoTable::NotSolved { pressure_pa }),
        }
    }

    /// The gauge pressure, Pa, at which the model has a value of the quantity within its range. In bending the model gives it
    /// explicitly; else the curve tells it nearly and Newton's method on the forward model exactly.
    ///
    /// # Errors
    /// [`NoTable::NotSolved`].
    pub fn pressure_at(&self, value: f64) -> Result<f64, NoTable> {
        let highest_pa = self.curve.pressure_max_pa();
        if let Some((bend, length_m)) = self.polynomial() {
            return Ok(bend.pressure_pa(value / length_m).clamp(0.0, highest_pa));
        }
        if self.kind == StateQuantity::BendAngle && !self.by_curve {
            return match self.actuator.inverse(Target::BendAngle(value), &Load::none()) {
                Ok(found) if found.status == Status::Solved => Ok(found.state.pressure_pa.clamp(0.0, highest_pa)),
                _ => Err(NoTable::NotSolved { pressure_pa: self.interpolated(value) }),
            };
        }
        let mut pressure_pa = self.interpolated(value);
        let mut last_step_pa = f64::INFINITY;
        for _ in 0..NEWTON_STEPS {
            let step_pa = (value - self.value_at(pressure_pa)?) / self.slope(pressure_pa);
            // Near a slope of zero the last digits of the value decide; there it gets no better.
            if !step_pa.is_finite() || step_pa.abs() >= last_step_pa {
                break;
            }
            pressure_pa = (pressure_pa + step_pa).clamp(0.0, highest_pa);
            last_step_pa = step_pa.abs();
        }
        Ok(pressure_pa)
    }

    /// Bisection on the curve, which runs one way.
    fn interpolated(&self, value: f64) -> f64 {
        let at = |pressure_pa: f64| self.kind.of(&self.curve.at(pressure_pa));
        let (mut low, mut high) = (0.0, self.curve.pressure_max_pa());
        let rises = at(high) > at(low);
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if (at(middle) < value) == rises { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// The slope of the curve, per Pa.
    fn slope(&self, pressure_pa: f64) -> f64 {
        let highest_pa = self.curve.pressure_max_pa();
        let width_pa = 1e-5 * highest_pa;
        let (low, high) = ((pressure_pa - width_pa).max(0.0), (pressure_pa + width_pa).min(highest_pa));
        let at = |pressure_pa: f64| self.kind.of(&self.curve.at(pressure_pa));
        (at(high) - at(low)) / (high - low)
    }
}
