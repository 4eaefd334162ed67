//! An actuator and the sensor that reads its pressure.

use fra_model::{
    Actuator, ActuatorParameters, Fiber, InvalidParameter, Load, Motion, NoDerivative, Parameter, State, StateQuantity,
    Status,
};

use super::Property;

/// One actuator, or the actuators of a module taken as equal, with the sensor of its pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name, for messages.
    pub name: String,
    /// The actuator.
    pub parameters: ActuatorParameters<f64>,
    /// Its second winding.
    pub second_fiber: Option<Fiber<f64>>,
    /// Pressure that seats wall and thread before they deform, Pa.
    pub seating_pressure_pa: f64,
    /// Reading of the sensor at no pressure, Pa.
    pub pressure_offset_pa: f64,
    /// Change of the reading by 1 Pa more; > 0.
    pub pressure_gain: f64,
}

/// Why a body has no deformation at a pressure.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum NoAnswer {
    /// A parameter that the model refuses.
    Invalid(InvalidParameter<f64>),
    /// The branch ends before the pressure, at the limit pressure where it is known, Pa.
    BeyondLimit(Option<f64>),
    /// No derivative exists.
    NoDerivative,
}

impl From<InvalidParameter<f64>> for NoAnswer {
    fn from(error: InvalidParameter<f64>) -> Self {
        Self::Invalid(error)
    }
}

impl From<NoDerivative<f64>> for NoAnswer {
    fn from(_: NoDerivative<f64>) -> Self {
        Self::NoDerivative
    }
}

/// A body ready to solve.
pub(super) struct Solver<'a> {
    body: &'a Body,
    actuator: Actuator<f64>,
}

/// The deformation that a reading of the sensor means, and what its derivatives need.
pub(super) struct Answer {
    pub(super) value: f64,
    quantity: StateQuantity,
    state: State<f64>,
    /// Gauge pressure that the reading means, Pa; of a mirrored bend the opposite.
    pressure_pa: f64,
    /// -1 where the bend at the opposite pressure was asked in place of a bend backwards, else 1.
    sign: f64,
}

impl Body {
    /// An actuator whose sensor reads the truth.
    pub fn new(name: impl Into<String>, parameters: ActuatorParameters<f64>) -> Self {
        Self {
            name: name.into(),
            parameters,
            second_fiber: None,
            seating_pressure_pa: 0.0,
            pressure_offset_pa: 0.0,
            pressure_gain: 1.0,
        }
    }

    /// The same with a second winding.
    #[must_use]
    pub fn with_second_fiber(self, second_fiber: Option<Fiber<f64>>) -> Self {
        Self { second_fiber, ..self }
    }

    /// The model of the actuator.
    ///
    /// # Errors
    /// [`InvalidParameter`] names a field that the model does not accept.
    pub fn actuator(&self) -> Result<Actuator<f64>, InvalidParameter<f64>> {
        let actuator = Actuator::new(&self.parameters)?;
        self.second_fiber.as_ref().map_or(Ok(actuator), |second| actuator.with_second_fiber(second))
    }

    /// The gauge pressure, Pa, that a reading of the sensor means.
    pub fn pressure_pa(&self, reading_pa: f64) -> f64 {
        (reading_pa - self.pressure_offset_pa) / self.pressure_gain
    }

    /// The part of a gauge pressure that deforms the actuator, Pa: beyond the seating pressure. A vacuum needs no seating.
    pub fn deforming_pa(&self, pressure_pa: f64) -> f64 {
        if pressure_pa < 0.0 { pressure_pa } else { (pressure_pa - self.seating_pressure_pa).max(0.0) }
    }

    /// The gauge pressure, Pa, that a reading means, and the sign of the deformation. A bending actuator does not bend backwards; readings a little below zero, as
    /// noise gives them, mean the mirrored bend at the opposite pressure, so that the mean of readings around zero means none.
    pub(super) fn mirrored(&self, reading_pa: f64) -> (f64, f64) {
        let pressure_pa = self.pressure_pa(reading_pa);
        let sign = if self.parameters.motion == Motion::Bending && pressure_pa < 0.0 { -1.0 } else { 1.0 };
        (sign * pressure_pa, sign)
    }

    /// The deformation without pressure, in the SI unit of the quantity.
    pub fn at_rest(&self, quantity: StateQuantity) -> f64 {
        quantity.at_rest(&self.parameters)
    }

    pub(super) fn solver(&self) -> Result<Solver<'_>, NoAnswer> {
        Ok(Solver { body: self, actuator: self.actuator()? })
    }
}

impl Solver<'_> {
    /// The deformation at a reading of the sensor.
    pub(super) fn at(&self, reading_pa: f64, quantity: StateQuantity) -> Result<Answer, NoAnswer> {
        let (pressure_pa, sign) = self.body.mirrored(reading_pa);
        let solution = self.actuator.forward(self.body.deforming_pa(pressure_pa), &Load::none())?;
        if solution.status != Status::Solved {
            return Err(NoAnswer::BeyondLimit(solution.limit_pressure_pa));
        }
        let value = sign * quantity.of(&solution.state);
        Ok(Answer { value, quantity, state: solution.state, pressure_pa, sign })
    }

    /// The derivative of an answer by a property.
    pub(super) fn slope(&self, answer: &Answer, property: Property) -> Result<f64, NoAnswer> {
        let by = |parameter| -> Result<f64, NoAnswer> {
            let change = self.actuator.sensitivity(&answer.state, &Load::none(), parameter)?;
            Ok(answer.quantity.of(&change))
        };
        // Two signs cancel in what the pressure does to a mirrored bend.
        let is_unseated = (0.0..self.body.seating_pressure_pa).contains(&answer.pressure_pa);
        let by_reading = |factor: f64| if is_unseated { Ok(0.0) } else { Ok(factor * by(Parameter::Pressure)?) };
        match property {
            Property::SeatingPressure if answer.pressure_pa < 0.0 => Ok(0.0),
            Property::SeatingPressure => by_reading(-answer.sign),
            Property::PressureOffset => by_reading(-1.0 / self.body.pressure_gain),
            Property::PressureGain => by_reading(-answer.sign * answer.pressure_pa / self.body.pressure_gain),
            _ => property
                .inputs(self.body)
                .into_iter()
                .try_fold(0.0, |sum, (parameter, factor)| Ok(sum + answer.sign * factor * by(parameter)?)),
        }
    }
}
