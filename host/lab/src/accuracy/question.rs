//! What a method is asked: a sample, what is true of it, and a state nearby.

use fra_model::{Actuator, ActuatorParameters, Fiber, Load, Material, Motion, State, Status, Target};
use qd::Quad;

use super::number::Number;
use super::reference::{Doubt, Reference, Truth};
use super::series::Series;
use super::set::Sample;

/// A warm start is the state at this share of the pressure.
const NEARBY: f64 = 0.99;

/// A scalar of the product.
pub(super) trait Scalar: Number + fra_model::Precision {
    const NAME: &'static str;
}

impl Scalar for f64 {
    const NAME: &'static str = "f64";
}

impl Scalar for f32 {
    const NAME: &'static str = "f32";
}

/// One question of the set.
#[derive(Clone, Copy, Debug)]
pub(super) struct Question {
    pub(super) parameters: ActuatorParameters<f64>,
    pub(super) pressure_pa: f64,
    pub(super) truth: Truth,
    /// A state nearby, where an earlier tick of a controller would have left the actuator.
    pub(super) nearby: State<f64>,
    /// The inverse as a series.
    pub(super) series: Series,
}

impl Question {
    /// `None` where the reference has no answer; how often is counted.
    pub(super) fn new(reference: &Reference, sample: &Sample) -> Option<Self> {
        Self::with(sample, reference.truth(sample)?)
    }

    /// A question whose truth is what the product says: enough to time methods, not to judge them.
    pub(super) fn untold(sample: &Sample) -> Option<Self> {
        let actuator = Actuator::new(&sample.parameters).ok()?;
        let state = actuator.forward(sample.pressure_pa, &Load::none()).ok()?.state;
        let at = coordinates(&sample.parameters, &state).map(Quad::of);
        let target = f64::from(reached(sample.parameters.motion, &state) as f32);
        let pressure = Quad::of(sample.pressure_pa);
        Self::with(sample, Truth { deformation: at, target, at_target: at, pressure, doubt: Doubt::default() })
    }

    fn with(sample: &Sample, truth: Truth) -> Option<Self> {
        let Sample { parameters, pressure_pa } = *sample;
        let actuator = Actuator::new(&parameters).ok()?;
        let nearby = actuator.forward(NEARBY * pressure_pa, &Load::none()).ok()?;
        let series = Series::new(&actuator, pressure_pa)?;
        let solved = nearby.status == Status::Solved;
        solved.then_some(Self { parameters, pressure_pa, truth, nearby: nearby.state, series })
    }

    pub(super) fn motion(&self) -> Motion {
        self.parameters.motion
    }

    /// The nearby state in the model's coordinates.
    pub(super) fn start<N: Number>(&self) -> [N; 3] {
        self.coordinates(&self.nearby).map(N::of)
    }

    /// The actuator in a scalar.
    pub(super) fn actuator<T: Scalar>(&self) -> Option<Actuator<T>> {
        Actuator::new(&parameters::<T>(&self.parameters)).ok()
    }

    /// What a state is judged by: `(e, w, g)`, or the angle of a bend.
    pub(super) fn coordinates<T: Scalar>(&self, state: &State<T>) -> [T; 3] {
        coordinates(&self.parameters, state)
    }
}

fn coordinates<T: Scalar>(p: &ActuatorParameters<f64>, state: &State<T>) -> [T; 3] {
    if p.motion == Motion::Bending {
        return [state.bend_angle_rad, T::of(0.0), T::of(0.0)];
    }
    // The twist is stated in the scalar; so is the ratio.
    [state.axial_strain, state.volume_strain, state.twist_rad * T::of(p.inner_radius_m / p.length_m)]
}

/// The deformation a motion is made for, as a target states it.
pub(super) fn reached(motion: Motion, state: &State<f64>) -> f64 {
    match motion {
        Motion::Extension => state.axial_stretch,
        Motion::Expansion => state.outer_radius_m,
        Motion::Twisting => state.twist_rad,
        Motion::Bending => state.bend_angle_rad,
    }
}

/// A target of a motion.
pub(super) fn target<T>(motion: Motion, value: T) -> Target<T> {
    match motion {
        Motion::Extension => Target::AxialStretch(value),
        Motion::Expansion => Target::OuterRadius(value),
        Motion::Twisting => Target::Twist(value),
        Motion::Bending => Target::BendAngle(value),
    }
}

/// Parameters in a scalar. Nothing is rounded: the set holds no number that single precision does not.
fn parameters<T: Scalar>(p: &ActuatorParameters<f64>) -> ActuatorParameters<T> {
    let material = match p.material {
        Material::NeoHookean { shear_modulus_pa } => Material::NeoHookean { shear_modulus_pa: T::of(shear_modulus_pa) },
        Material::Yeoh { c_pa } => Material::Yeoh { c_pa: c_pa.map(T::of) },
    };
    let fiber = p.fiber.map(|fiber| Fiber {
        angle_rad: T::of(fiber.angle_rad),
        families: fiber.families,
        modulus_pa: T::of(fiber.modulus_pa),
        placement: fiber.placement,
        thickness_m: T::of(fiber.thickness_m),
        radius_m: T::of(fiber.radius_m),
    });
    ActuatorParameters {
        motion: p.motion,
        inner_radius_m: T::of(p.inner_radius_m),
        outer_radius_m: T::of(p.outer_radius_m),
        length_m: T::of(p.length_m),
        material,
        fiber,
    }
}
