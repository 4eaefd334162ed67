//! Derivatives of a straight tube's equilibrium.

use nalgebra::{Matrix3, Vector3};

use crate::number::double_double::DoubleDouble;
use crate::number::dual::Dual;
use crate::number::real::{Real, epsilon, real};
use crate::number::scalar::{Scalar, largest};
use crate::parameters::{ActuatorParameters, InvalidParameter};
use crate::solution::{State, Target};
use crate::solve::energy::{Derivatives, Wall};

use super::inputs::{Inputs, Parameter};
use super::{Change, Fixed, NoDerivative, Slope, slopes};

/// Most corrections of the rounding of a state.
const CORRECTIONS: u32 = 12;
/// Largest correction, as a fraction of the deformation.
const MOST_CORRECTED: f64 = 0.01;

/// A tube of any scalar in the units of the model.
struct Units<S> {
    wall: Wall<S>,
    inputs: Inputs<S>,
}

impl<S: Scalar> Units<S> {
    fn new(inputs: &Inputs<S>) -> Self {
        Self { wall: inputs.wall(), inputs: *inputs }
    }

    fn shear_modulus_pa(&self) -> S {
        self.inputs.parameters.material.shear_modulus_pa()
    }

    /// `P/mu1`, `N_ext/(pi R_i^2 mu1)`, `M_ext/(pi R_i^3 mu1)`, in the order `(e, w, g)` of their conjugates.
    fn loads(&self) -> Vector3<S> {
        let radius = self.inputs.parameters.inner_radius_m;
        let mu1 = self.shear_modulus_pa();
        let force = pi::<S>() * radius * radius * mu1;
        Vector3::new(
            self.inputs.force_n / force,
            self.inputs.pressure_pa / mu1,
            self.inputs.torque_nm / (force * radius),
        )
    }

    fn derivatives(&self, at: &Vector3<S>) -> Derivatives<S> {
        self.wall.derivatives(at.x, at.y, at.z)
    }

    /// The state at `(e, w, g)` with its `P` and `d(P/mu1)/dw`.
    fn state(&self, at: &Vector3<S>, slope: S) -> State<S> {
        let ActuatorParameters { inner_radius_m, outer_radius_m, length_m, .. } = self.inputs.parameters;
        let one = S::one();
        let lambda = one + at.x;
        let x_outer = self.wall.x_outer;
        let rest_volume = pi::<S>() * inner_radius_m * inner_radius_m * length_m;
        State {
            pressure_pa: self.inputs.pressure_pa,
            axial_stretch: lambda,
            axial_strain: at.x,
            inner_radius_m: inner_radius_m * ((one + at.y) / lambda).sqrt(),
            outer_radius_m: outer_radius_m * ((x_outer + at.y) / (lambda * x_outer)).sqrt(),
            twist_rad: at.z * length_m / inner_radius_m,
            bend_angle_rad: S::zero(),
            volume_m3: rest_volume * (one + at.y),
            volume_strain: at.y,
            compliance_m3_per_pa: rest_volume / (self.shear_modulus_pa() * slope),
        }
    }
}

fn pi<S: Scalar>() -> S {
    S::constant(core::f64::consts::PI)
}

/// The two load equations linearised at a state.
struct Block<S> {
    hessian: Matrix3<S>,
    twists: bool,
}

impl<S: Scalar> Block<S> {
    /// `None` where the state is not stable at constant volume.
    fn new(hessian: Matrix3<S>, twists: bool) -> Option<Self> {
        let block = Self { hessian, twists };
        let positive = hessian[(0, 0)] > S::zero() && (!twists || block.rest() > S::zero());
        positive.then_some(block)
    }

    /// Torsional stiffness when the axial strain follows.
    fn rest(&self) -> S {
        let (ee, eg, gg) = (self.hessian[(0, 0)], self.hessian[(0, 2)], self.hessian[(2, 2)]);
        gg - eg * eg / ee
    }

    /// `(de, 0, dg)` that changes the two equations by the given amounts.
    fn solve(&self, by_e: S, by_g: S) -> Vector3<S> {
        let (ee, eg) = (self.hessian[(0, 0)], self.hessian[(0, 2)]);
        if !self.twists {
            return Vector3::new(by_e / ee, S::zero(), S::zero());
        }
        let dg = (by_g - eg / ee * by_e) / self.rest();
        Vector3::new((by_e - eg * dg) / ee, S::zero(), dg)
    }

    /// `d(e, w, g)/dw` under constant loads.
    fn tangent(&self) -> Vector3<S> {
        let along = self.solve(-self.hessian[(0, 1)], -self.hessian[(2, 1)]);
        Vector3::new(along.x, S::one(), along.z)
    }

    /// Change of `u_w` with the state.
    fn pressure_change(&self, by: &Vector3<S>) -> S {
        self.hessian[(1, 0)] * by.x + self.hessian[(1, 1)] * by.y + self.hessian[(1, 2)] * by.z
    }

    /// `d(P/mu1)/dw` along the branch.
    fn slope(&self) -> S {
        self.pressure_change(&self.tangent())
    }
}

/// A tube's equilibrium with twice the digits.
pub(super) struct StraightPoint<T: Real> {
    inputs: Inputs<DoubleDouble<T>>,
    at: Vector3<DoubleDouble<T>>,
    twists: bool,
    /// Whether the derivatives at constant pressure are infinite.
    at_limit: bool,
}

impl<T: Real> StraightPoint<T> {
    pub(super) fn new(inputs: Inputs<DoubleDouble<T>>, state: &State<T>) -> Result<Self, NoDerivative<T>> {
        let radius_per_length = inputs.parameters.inner_radius_m / inputs.parameters.length_m;
        let given = Vector3::new(
            DoubleDouble::from(state.axial_strain),
            DoubleDouble::from(state.volume_strain),
            DoubleDouble::from(state.twist_rad) * radius_per_length,
        );
        let twists = inputs.twists_by_itself() || inputs.torque_nm != DoubleDouble::zero();
        let mut point = Self { inputs, at: given, twists, at_limit: false };
        if !(given.x > -DoubleDouble::one() && given.y > -DoubleDouble::one()) {
            return Err(NoDerivative::NotAnEquilibrium);
        }
        point.at = point.polished()?;
        point.at_limit = point.is_at_limit()?;
        Ok(point)
    }

    pub(super) fn deformation(&self) -> [T; 3] {
        [self.at.x.round(), self.at.y.round(), self.at.z.round()]
    }

    /// The state without its rounding, which stiff fibers would magnify: the equilibrium of the same volume, or that of the same
    /// pressure where the pressure pins the state down more closely.
    fn polished(&self) -> Result<Vector3<DoubleDouble<T>>, NoDerivative<T>> {
        let units = Units::new(&self.inputs);
        let loads = units.loads();
        let mut at = self.at;
        let mut holds_volume = None;
        let mut last = None;
        for _ in 0..CORRECTIONS {
            let d = units.derivatives(&at);
            let block = Block::new(d.hessian, self.twists).ok_or(NoDerivative::AtLimit)?;
            let settling = block.solve(loads.x - d.gradient.x, loads.z - d.gradient.z);
            let pressure = d.gradient.y + block.pressure_change(&settling);
            let slope = block.slope();
            let by_pressure = (loads.y - pressure) / slope;
            let holds_volume =
                *holds_volume.get_or_insert(!(slope > DoubleDouble::zero() && slope * at.y.abs() > loads.y.abs()));
            let dw = if holds_volume { DoubleDouble::zero() } else { by_pressure };
            let correction = settling + block.tangent() * dw;
            at += correction;
            let scale = largest(&at);
            let most = scale.max(largest(&self.at)) * DoubleDouble::constant(MOST_CORRECTED) + DoubleDouble::epsilon();
            let imbalance = DoubleDouble::constant(MOST_CORRECTED) * (loads.y.abs() + slope.abs() * scale)
                + DoubleDouble::epsilon();
            let balanced = !holds_volume || (loads.y - pressure).abs() <= imbalance;
            // The conditions also refuse a NaN.
            if !(balanced && largest(&(at - self.at)) <= most) {
                return Err(NoDerivative::NotAnEquilibrium);
            }
            // One more correction once the steps are within the rounding of the scalar.
            let size = largest(&correction);
            if last.is_some_and(|last| last <= DoubleDouble::epsilon() * scale || size >= last)
                || size == DoubleDouble::zero()
            {
                return Ok(at);
            }
            last = Some(size);
        }
        Ok(at)
    }

    /// Whether the slope of the pressure is zero within the rounding of the volume.
    fn is_at_limit(&self) -> Result<bool, NoDerivative<T>> {
        let units = Units::new(&self.inputs.map(Dual::fixed));
        let d = Units::new(&self.inputs).derivatives(&self.at);
        let tangent = Block::new(d.hessian, self.twists).ok_or(NoDerivative::AtLimit)?.tangent();
        let block = Block::new(units.derivatives(&along(&self.at, &tangent)).hessian, self.twists)
            .ok_or(NoDerivative::AtLimit)?;
        let Dual { value, slope } = block.slope();
        let rounding = DoubleDouble::from(real::<T>(4.0) * epsilon::<T>());
        let rises = value > slope.abs() * self.at.y.abs() * rounding;
        Ok(!rises)
    }

    pub(super) fn change(&self, of: Parameter, fixed: Fixed<T>) -> Result<Change<T>, NoDerivative<T>> {
        let inputs = self.inputs.varied(of).ok_or(NoDerivative::NotAnInput(of))?;
        let mut units = Units::new(&inputs);
        let d = units.derivatives(&self.at.map(Dual::fixed));
        // An input that turns two families against each other makes the twist an unknown.
        let twists = self.twists || of == Parameter::Torque;
        let block = Block::new(d.hessian.map(|h| h.value), twists).ok_or(NoDerivative::AtLimit)?;
        let loads = units.loads();
        // At constant volume: how the strains follow the input, and what the pressure then has to be.
        let rest = loads - d.gradient;
        let following = block.solve(rest.x.slope, rest.z.slope);
        let mu1 = units.shear_modulus_pa();
        let u_w = Dual::new(d.gradient.y.value, d.gradient.y.slope + block.pressure_change(&following));
        let at_volume = (mu1 * u_w).slope;
        let per_volume = mu1.value * block.slope();
        // How far the volume follows, so that the pressure or the target is held.
        let dw = self.volume_change(fixed, &units, &following, &block, (at_volume, per_volume))?;
        let by = following + block.tangent() * dw;
        if matches!(fixed, Fixed::Target(_)) {
            units.inputs.pressure_pa.slope = at_volume + per_volume * dw;
        }
        let at = along(&self.at, &by);
        let slope = Block { hessian: units.derivatives(&at).hessian, twists }.slope();
        let state = slopes(&units.state(&at, slope), DoubleDouble::round).ok_or(NoDerivative::AtLimit)?;
        Ok(Change { state, deformation: [by.x.round(), by.y.round(), by.z.round()] })
    }

    /// `dw/dp`, given how the pressure changes at constant volume and with the volume.
    fn volume_change(
        &self,
        fixed: Fixed<T>,
        units: &Units<Slope<T>>,
        following: &Vector3<DoubleDouble<T>>,
        block: &Block<DoubleDouble<T>>,
        (at_volume, per_volume): (DoubleDouble<T>, DoubleDouble<T>),
    ) -> Result<DoubleDouble<T>, NoDerivative<T>> {
        let target = match fixed {
            Fixed::Pressure if self.at_limit => return Err(NoDerivative::AtLimit),
            Fixed::Pressure => return Ok((units.inputs.pressure_pa.slope - at_volume) / per_volume),
            Fixed::Target(target) => target,
        };
        let measure = |units: &Units<Slope<T>>, by: &Vector3<DoubleDouble<T>>| {
            reached(&units.state(&along(&self.at, by), Dual::one()), target).map(|q| q.slope)
        };
        let at_volume = measure(units, following)?;
        let per_volume = measure(&Units::new(&self.inputs.map(Dual::fixed)), &block.tangent())?;
        let dw = -at_volume / per_volume;
        if per_volume == DoubleDouble::zero() || !dw.is_finite() { Err(NoDerivative::Stationary) } else { Ok(dw) }
    }
}

/// A state with a direction.
fn along<S: Scalar>(at: &Vector3<S>, direction: &Vector3<S>) -> Vector3<Dual<S>> {
    at.zip_map(direction, Dual::new)
}

/// The field of a state that a target is about.
fn reached<T: Real, S: Copy>(state: &State<S>, target: Target<T>) -> Result<S, NoDerivative<T>> {
    match target {
        Target::AxialStretch(_) => Ok(state.axial_stretch),
        Target::OuterRadius(_) => Ok(state.outer_radius_m),
        Target::InnerRadius(_) => Ok(state.inner_radius_m),
        Target::Twist(_) => Ok(state.twist_rad),
        Target::BendAngle(value) => Err(NoDerivative::Invalid(InvalidParameter {
            field: "bend_angle_rad",
            value,
            allowed: "a target of bending actuators only",
        })),
    }
}
