//! An actuator and the sensor that reads its pressure.

use fra_model::{
    Actuator, ActuatorParameters, Fiber, InvalidParameter, Load, Motion, NoDerivative, Parameter, State, StateQuantity,
    Status,
};

use super::{Branch, Observation, Property};
use softlimb_limb::winding_effect_up_to;

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
    /// Pressure on loading less that on unloading, at one deformation, Pa.
    pub loop_width_pa: f64,
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
    /// Gauge pressure that the reading means, Pa.
    pressure_pa: f64,
    deforming: Deforming,
    branch: Branch,
}

/// The part of a gauge pressure that deforms an actuator.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deforming {
    /// Deforming pressure, Pa.
    pub(super) pressure_pa: f64,
    /// -1 where it is that of the mirrored bend, else 1.
    pub(super) sign: f64,
    /// Its derivatives by the gauge pressure and by the width of the dead band.
    by_pressure: f64,
    by_band: f64,
}

impl Body {
    /// An actuator whose sensor reads the truth.
    pub fn new(name: impl Into<String>, parameters: ActuatorParameters<f64>) -> Self {
        Self {
            name: name.into(),
            parameters,
            second_fiber: None,
            seating_pressure_pa: 0.0,
            loop_width_pa: 0.0,
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

    /// The part of the pressure of a reading that deforms the actuator: beyond the seating pressure, and half the width of the loop more on loading or less on
    /// unloading. A vacuum needs no seating.
    ///
    /// A bending actuator does not bend backwards; readings a little below zero, as noise gives them, mean the mirrored bend at the opposite pressure, so that the
    /// mean of readings around zero means none.
    pub(super) fn deforming(&self, reading_pa: f64, branch: Branch) -> Deforming {
        let band_pa = self.seating_pressure_pa + 0.5 * branch.sign() * self.loop_width_pa;
        let pressure_pa = self.pressure_pa(reading_pa);
        // On unloading a wide loop leaves a deformation at no pressure.
        let (band_pa, moved_pa, by_band) =
            if band_pa < 0.0 { (0.0, pressure_pa - band_pa, -1.0) } else { (band_pa, pressure_pa, 0.0) };
        let sign = if self.parameters.motion == Motion::Bending && moved_pa < 0.0 { -1.0 } else { 1.0 };
        let pressure_pa = sign * moved_pa;
        if pressure_pa < 0.0 {
            Deforming { pressure_pa, sign, by_pressure: sign, by_band: sign * by_band }
        } else if pressure_pa < band_pa {
            Deforming { pressure_pa: 0.0, sign, by_pressure: 0.0, by_band: 0.0 }
        } else {
            let by_band = if by_band < 0.0 { sign * by_band } else { -1.0 };
            Deforming { pressure_pa: pressure_pa - band_pa, sign, by_pressure: sign, by_band }
        }
    }

    /// The largest relative change of its bend if the winding is 2 deg off, up to the highest pressure among the measurements of the body with that
    /// `index`; `None` of other actuators than wound benders.
    pub fn winding_effect(&self, observations: &[Observation], index: usize, by_section: bool) -> Option<f64> {
        let own = observations.iter().filter(|seen| seen.body == index);
        let deforming_pa = own.map(|seen| self.deforming(seen.reading_pa, seen.branch).pressure_pa);
        let most_pa = deforming_pa.fold(0.0, f64::max);
        winding_effect_up_to(&self.parameters, self.second_fiber.as_ref(), most_pa, by_section)
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
    pub(super) fn at(&self, reading_pa: f64, branch: Branch, quantity: StateQuantity) -> Result<Answer, NoAnswer> {
        let deforming = self.body.deforming(reading_pa, branch);
        let solution = self.actuator.forward(deforming.pressure_pa, &Load::none())?;
        if solution.status != Status::Solved {
            return Err(NoAnswer::BeyondLimit(solution.limit_pressure_pa));
        }
        let value = deforming.sign * quantity.of(&solution.state);
        let pressure_pa = self.body.pressure_pa(reading_pa);
        Ok(Answer { value, quantity, state: solution.state, pressure_pa, deforming, branch })
    }

    /// The derivative of an answer by a property.
    pub(super) fn slope(&self, answer: &Answer, property: Property) -> Result<f64, NoAnswer> {
        let by = |parameter| -> Result<f64, NoAnswer> {
            let change = self.actuator.sensitivity(&answer.state, &Load::none(), parameter)?;
            Ok(answer.quantity.of(&change))
        };
        let Deforming { sign, by_pressure, by_band, .. } = answer.deforming;
        // Where nothing deforms there may be no derivative to ask for.
        let by_deforming =
            |factor: f64| if factor == 0.0 { Ok(0.0) } else { Ok(sign * factor * by(Parameter::Pressure)?) };
        match property {
            Property::SeatingPressure => by_deforming(by_band),
            Property::LoopWidth => by_deforming(0.5 * answer.branch.sign() * by_band),
            Property::PressureOffset => by_deforming(-by_pressure / self.body.pressure_gain),
            Property::PressureGain => by_deforming(-by_pressure * answer.pressure_pa / self.body.pressure_gain),
            _ => property
                .inputs(self.body)
                .into_iter()
                .try_fold(0.0, |sum, (parameter, factor)| Ok(sum + sign * factor * by(parameter)?)),
        }
    }
}
