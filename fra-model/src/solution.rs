//! Loads, targets, states and solutions: inputs and outputs of the solvers.

use crate::number::real::{Real, real};
use crate::parameters::{InvalidParameter, require};

/// External load on the free end of one actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load<T> {
    /// Axial force `N_ext`, N; tension is positive. On a bending actuator it acts along the tube's axis.
    pub force_n: T,
    /// Torque about the axis `M_ext`, N m. On a bending actuator: the bending moment, positive in the sense of the bend.
    pub torque_nm: T,
}

impl<T: Real> Load<T> {
    /// No external load.
    pub fn none() -> Self {
        Self { force_n: T::zero(), torque_nm: T::zero() }
    }

    /// Whether there is no external load.
    pub(crate) fn is_none(&self) -> bool {
        self.force_n == T::zero() && self.torque_nm == T::zero()
    }

    pub(crate) fn check(&self) -> Result<(), InvalidParameter<T>> {
        require(self.force_n.is_finite(), "external_force_n", self.force_n, "finite")?;
        require(self.torque_nm.is_finite(), "external_torque_nm", self.torque_nm, "finite")
    }
}

/// Target deformation of an inverse problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target<T> {
    /// Axial stretch `lambda = l/L`, > 0.
    AxialStretch(T),
    /// Deformed outer radius, m, > 0.
    OuterRadius(T),
    /// Deformed inner radius, m, > 0.
    InnerRadius(T),
    /// Twist `Phi` of one end against the other, rad.
    Twist(T),
    /// Bend angle `phi`, rad, >= 0.
    BendAngle(T),
}

impl<T> Target<T> {
    /// The same target in another scalar.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Target<U> {
        match self {
            Self::AxialStretch(value) => Target::AxialStretch(f(value)),
            Self::OuterRadius(value) => Target::OuterRadius(f(value)),
            Self::InnerRadius(value) => Target::InnerRadius(f(value)),
            Self::Twist(value) => Target::Twist(f(value)),
            Self::BendAngle(value) => Target::BendAngle(f(value)),
        }
    }
}

/// Gauge pressures that an inverse problem may answer with, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureRange<T> {
    /// The least, Pa; below zero it is a vacuum.
    pub least_pa: T,
    /// The largest, Pa; at least `least_pa`.
    pub most_pa: T,
}

/// An absolute pressure of zero under a standard atmosphere, Pa, gauge.
const ABSOLUTE_ZERO_PA: f64 = -101_325.0;

impl<T: Real> PressureRange<T> {
    /// Every pressure, and every vacuum down to an absolute pressure of zero under a standard atmosphere.
    pub fn physical() -> Self {
        Self { least_pa: real(ABSOLUTE_ZERO_PA), most_pa: T::max_value().unwrap_or_else(|| real(1e30)) }
    }

    /// Whether a pressure lies in it.
    pub fn contains(&self, pressure_pa: T) -> bool {
        pressure_pa >= self.least_pa && pressure_pa <= self.most_pa
    }

    /// Checks both ends.
    ///
    /// # Errors
    /// [`InvalidParameter`] names the end that is not accepted.
    pub fn check(&self) -> Result<(), InvalidParameter<T>> {
        require(self.least_pa.is_finite(), "pressure_range[0]", self.least_pa, "finite")?;
        let most = self.most_pa;
        require(most.is_finite() && most >= self.least_pa, "pressure_range[1]", most, "finite and >= pressure_range[0]")
    }
}

/// Outcome of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// The state is the equilibrium on the branch connected to zero pressure.
    Solved,
    /// That branch ends before the requested pressure or target.
    NoSolution,
    /// The iteration stopped before its tolerance; the state is not to be used.
    NotConverged,
}

/// Equilibrium of one actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T> {
    /// Gauge pressure in the lumen, Pa.
    pub pressure_pa: T,
    /// Axial stretch; of the centre line for a bending actuator.
    pub axial_stretch: T,
    /// `axial_stretch - 1`, with all its digits where it is small.
    pub axial_strain: T,
    /// Deformed inner radius, m; for a bending actuator that of a circle of the lumen's mean area.
    pub inner_radius_m: T,
    /// Deformed outer radius, m; for a bending actuator that of a circle of the section's mean area.
    pub outer_radius_m: T,
    /// Twist of one end against the other, rad.
    pub twist_rad: T,
    /// Bend angle, rad.
    pub bend_angle_rad: T,
    /// Lumen volume, m3.
    pub volume_m3: T,
    /// Change of the lumen volume relative to that without pressure and load, with all its digits where it is small.
    pub volume_strain: T,
    /// `dV/dP` at constant external load, m3/Pa.
    pub compliance_m3_per_pa: T,
}

impl<T: Real> State<T> {
    /// The state of segments in series, each with its length at rest, m: deformations and volumes add up, the radii are the largest. `None` without
    /// a segment. The pressure is that of the first.
    pub fn in_series(segments: impl IntoIterator<Item = (T, Self)>) -> Option<Self> {
        let mut segments = segments.into_iter();
        let weighted = |(length_m, state): (T, Self)| {
            let own = |strain: T| length_m * strain;
            (length_m, Self { axial_strain: own(state.axial_strain), volume_strain: own(state.volume_strain), ..state })
        };
        let first = weighted(segments.next()?);
        let (length_m, sum) = segments.map(weighted).fold(first, |(length_m, sum), (more_m, state)| {
            let all = Self {
                axial_strain: sum.axial_strain + state.axial_strain,
                inner_radius_m: sum.inner_radius_m.max(state.inner_radius_m),
                outer_radius_m: sum.outer_radius_m.max(state.outer_radius_m),
                twist_rad: sum.twist_rad + state.twist_rad,
                bend_angle_rad: sum.bend_angle_rad + state.bend_angle_rad,
                volume_m3: sum.volume_m3 + state.volume_m3,
                volume_strain: sum.volume_strain + state.volume_strain,
                compliance_m3_per_pa: sum.compliance_m3_per_pa + state.compliance_m3_per_pa,
                ..sum
            };
            (length_m + more_m, all)
        });
        let axial_strain = sum.axial_strain / length_m;
        Some(Self {
            axial_stretch: T::one() + axial_strain,
            axial_strain,
            volume_strain: sum.volume_strain / length_m,
            ..sum
        })
    }
}

impl<T: Copy> State<T> {
    /// Combines states field by field: interpolation, means, conversions.
    pub fn combine<const N: usize, U>(states: [&Self; N], mut f: impl FnMut([T; N]) -> U) -> State<U> {
        let mut field = |value: fn(&Self) -> T| f(states.map(value));
        State {
            pressure_pa: field(|s| s.pressure_pa),
            axial_stretch: field(|s| s.axial_stretch),
            axial_strain: field(|s| s.axial_strain),
            inner_radius_m: field(|s| s.inner_radius_m),
            outer_radius_m: field(|s| s.outer_radius_m),
            twist_rad: field(|s| s.twist_rad),
            bend_angle_rad: field(|s| s.bend_angle_rad),
            volume_m3: field(|s| s.volume_m3),
            volume_strain: field(|s| s.volume_strain),
            compliance_m3_per_pa: field(|s| s.compliance_m3_per_pa),
        }
    }
}

impl<T: Real> State<T> {
    /// Whether every value is a number that the scalar holds: nothing has overflowed, and the lumen's volume has not vanished.
    fn is_sound(&self) -> bool {
        let mut finite = true;
        Self::combine([self], |[value]| finite &= value.is_finite());
        finite && self.volume_m3 > T::zero()
    }
}

impl<T: Real> Solution<T> {
    /// The same solution, marked as not converged if a number has overflowed or the volume has vanished.
    #[inline(always)]
    pub(crate) fn sound(self) -> Self {
        let sound = self.status != Status::Solved || (self.state.is_sound() && self.residual.is_finite());
        if sound { self } else { Self { status: Status::NotConverged, ..self } }
    }
}

/// Result of a solve: state, status and how good it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution<T> {
    /// Outcome of the solve.
    pub status: Status,
    /// The equilibrium when `status` is [`Status::Solved`], else the last state on the branch.
    pub state: State<T>,
    /// Pressure at the end of the branch, Pa, if the solution fails because the branch ends.
    pub limit_pressure_pa: Option<T>,
    /// Largest residual of the equilibrium equations, in units of the shear modulus.
    pub residual: T,
    /// Newton iterations in all.
    pub iterations: u32,
}
