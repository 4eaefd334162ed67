//! Several segments with different windings along one tube, under one pressure.
//!
//! Each segment is an actuator in its own equilibrium at the common pressure; their extensions, twists, bends and volumes add up.
//! The tube has no equilibrium beyond the least of the segments' limit pressures.

mod search;
mod sum;

use core::fmt;

use nalgebra::Isometry3;

use crate::actuator::Actuator;
use crate::model::limb::{Link, Segment, tip_pose};
use crate::number::real::Real;
use crate::parameters::{InvalidParameter, Motion, require};
use crate::precision::Precision;
use crate::solution::{Load, Solution, State, Status};

use sum::Sum;

/// Segments along one tube, checked to fit together.
///
/// ```
/// use fra_model::*;
/// let tube = ActuatorParameters {
///     motion: Motion::Bending,
///     inner_radius_m: 6e-3,
///     outer_radius_m: 8e-3,
///     length_m: 0.06,
///     material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
///     fiber: None,
/// };
/// let wound = Fiber {
///     angle_rad: 0.05,
///     families: Families::Two,
///     modulus_pa: 361e6,
///     placement: Placement::Sheet,
///     thickness_m: 0.178e-3,
///     radius_m: 8e-3,
/// };
/// let straight = ActuatorParameters { motion: Motion::Extension, fiber: Some(wound), ..tube };
/// let segments = [Actuator::new(&tube)?, Actuator::new(&straight)?];
/// let series = Series::new(&segments).expect("one tube");
/// let solution = series.inverse(SeriesTarget::BendAngle(0.5), &Load::none())?;
/// assert_eq!(solution.status, Status::Solved);
/// assert!(solution.state.extension_m > 0.0);
/// # Ok::<(), InvalidParameter<f64>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Series<'a, T: Real> {
    segments: &'a [Actuator<T>],
}

/// Why segments make no tube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InvalidSeries<T> {
    /// There is no segment.
    Empty,
    /// A segment does not fit the first.
    Segment {
        /// Index of the segment, from 0.
        segment: usize,
        /// Its field that does not fit.
        error: InvalidParameter<T>,
    },
}

impl<T: fmt::Display> fmt::Display for InvalidSeries<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("a series needs at least one segment"),
            Self::Segment { segment, error } => write!(f, "segment {segment}: {error}"),
        }
    }
}

impl<T: fmt::Display + fmt::Debug> core::error::Error for InvalidSeries<T> {}

/// Target of an inverse problem of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SeriesTarget<T> {
    /// Change of the length of the centre line, m; > -length.
    Extension(T),
    /// Sum of the twists, rad.
    Twist(T),
    /// Sum of the bend angles in any directions, rad, >= 0.
    BendAngle(T),
}

/// Totals over the segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesState<T> {
    /// Gauge pressure, Pa.
    pub pressure_pa: T,
    /// Length of the centre line, m.
    pub length_m: T,
    /// Change of that length from rest, with all its digits where it is small, m.
    pub extension_m: T,
    /// Sum of the twists: of one end against the other while nothing bends, rad.
    pub twist_rad: T,
    /// Sum of the bend angles, rad.
    pub bend_angle_rad: T,
    /// Volume of the lumen, m3.
    pub volume_m3: T,
    /// Change of that volume from rest, with all its digits where it is small, m3.
    pub volume_change_m3: T,
    /// `dV/dP` at constant external load, m3/Pa.
    pub compliance_m3_per_pa: T,
}

/// The segment that keeps a series from an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesLimit<T> {
    /// Its index, from 0.
    pub segment: usize,
    /// The pressure at which its branch ends, Pa: the least of all segments. `None` where it ends at no pressure, as under a load that
    /// it cannot bear.
    pub pressure_pa: Option<T>,
}

/// Result of a solve of a series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesSolution<T> {
    /// Outcome of the solve.
    pub status: Status,
    /// The equilibrium when `status` is [`Status::Solved`]; where a limit pressure is known, the state there; else not to be used.
    pub state: SeriesState<T>,
    /// The segment without a solution, if there is one, and its limit pressure.
    pub limit: Option<SeriesLimit<T>>,
    /// Largest residual of a segment, in units of its shear modulus.
    pub residual: T,
    /// Newton iterations of all segments.
    pub iterations: u32,
}

impl<'a, T: Precision> Series<'a, T> {
    /// Checks that the segments make one tube: at least one, all with the same inner and the same outer radius.
    ///
    /// # Errors
    /// [`InvalidSeries`] names the first segment and field that does not fit.
    pub fn new(segments: &'a [Actuator<T>]) -> Result<Self, InvalidSeries<T>> {
        let Some(first) = segments.first().map(Actuator::parameters) else { return Err(InvalidSeries::Empty) };
        for (segment, actuator) in segments.iter().enumerate() {
            let p = actuator.parameters();
            for (field, value, expected) in [
                ("inner_radius_m", p.inner_radius_m, first.inner_radius_m),
                ("outer_radius_m", p.outer_radius_m, first.outer_radius_m),
            ] {
                require(value == expected, field, value, "that of the first segment: they are one tube")
                    .map_err(|error| InvalidSeries::Segment { segment, error })?;
            }
        }
        Ok(Self { segments })
    }

    /// The segments from the base to the tip.
    pub fn segments(&self) -> &'a [Actuator<T>] {
        self.segments
    }

    /// The equilibrium at a gauge pressure, Pa.
    ///
    /// An external force along the axis and a torque about it act on all straight segments alike; where all segments bend, the torque
    /// is the bending moment and both act on each as they do on a single [`Actuator`]. A series of straight and of bending segments
    /// takes no load: what a load on its tip does to each depends on the pose.
    ///
    /// # Errors
    /// [`InvalidParameter`] when the pressure or the load is not finite, or the series takes no load.
    pub fn forward(&self, pressure_pa: T, load: &Load<T>) -> Result<SeriesSolution<T>, InvalidParameter<T>> {
        self.forward_each(pressure_pa, load, |_, _| {})
    }

    /// [`forward`](Self::forward), with the solution of every segment handed to `each` in order, with its index from 0.
    ///
    /// # Errors
    /// As [`forward`](Self::forward).
    pub fn forward_each(
        &self,
        pressure_pa: T,
        load: &Load<T>,
        mut each: impl FnMut(usize, &Solution<T>),
    ) -> Result<SeriesSolution<T>, InvalidParameter<T>> {
        self.check_load(load)?;
        let mut sum = Sum::new(pressure_pa);
        for (index, actuator) in self.segments.iter().enumerate() {
            let solution = actuator.forward(pressure_pa, load)?;
            each(index, &solution);
            sum.add(index, actuator, &solution);
        }
        match sum.limit {
            Some(SeriesLimit { segment, pressure_pa: Some(limit_pa) }) if sum.status == Status::NoSolution => {
                self.at_limit(segment, limit_pa, load, sum)
            }
            _ => Ok(sum.solution()),
        }
    }

    /// The state where the branch of one segment ends, the first to do so.
    fn at_limit(
        &self,
        segment: usize,
        limit_pa: T,
        load: &Load<T>,
        beyond: Sum<T>,
    ) -> Result<SeriesSolution<T>, InvalidParameter<T>> {
        let mut sum = Sum::new(limit_pa);
        for (index, actuator) in self.segments.iter().enumerate() {
            let solution =
                actuator.forward(if index == segment { beyond.state.pressure_pa } else { limit_pa }, load)?;
            sum.add(index, actuator, &solution);
        }
        let iterations = beyond.iterations + sum.iterations;
        Ok(SeriesSolution { status: Status::NoSolution, limit: beyond.limit, iterations, ..sum.solution() })
    }

    /// The first gauge pressure, on raising it from zero, at which the series reaches a target, and the state there.
    ///
    /// Only pressures above zero are searched. The load is that of [`forward`](Self::forward); a load that leaves no equilibrium without pressure, as one
    /// that would bend a bending segment backwards, leaves none for the search to begin with: no solution.
    ///
    /// # Errors
    /// [`InvalidParameter`] when the target is out of its range or of a kind that no segment moves in, the load is not finite, or the
    /// series takes no load.
    pub fn inverse(&self, target: SeriesTarget<T>, load: &Load<T>) -> Result<SeriesSolution<T>, InvalidParameter<T>> {
        self.inverse_each(target, load, |_, _| {})
    }

    /// [`inverse`](Self::inverse), with the solution of every segment at the pressure found handed to `each`, as in
    /// [`forward_each`](Self::forward_each); not where there is no solution.
    ///
    /// # Errors
    /// As [`inverse`](Self::inverse).
    pub fn inverse_each(
        &self,
        target: SeriesTarget<T>,
        load: &Load<T>,
        each: impl FnMut(usize, &Solution<T>),
    ) -> Result<SeriesSolution<T>, InvalidParameter<T>> {
        self.check_load(load)?;
        self.check_target(target)?;
        let found = search::search(self, target, load)?;
        match found.status {
            Status::Solved => {
                let solution = self.forward_each(found.state.pressure_pa, load, each)?;
                Ok(SeriesSolution { iterations: found.iterations + solution.iterations, ..solution })
            }
            Status::NoSolution | Status::NotConverged => Ok(found),
        }
    }

    /// Pose of the tip of a tube that starts at `base` along its `z`, from the state of every segment and the direction it bends
    /// towards: rotation of its `x` about the tube's axis, rad, as painted on the undeformed tube. Earlier segments' twists turn the
    /// directions of later ones. Missing shapes end the tube.
    pub fn tip_pose(&self, base: &Isometry3<T>, shapes: impl IntoIterator<Item = (State<T>, T)>) -> Isometry3<T> {
        let links = self.segments.iter().zip(shapes).map(|(actuator, (state, mount_angle_rad))| Link {
            segment: Segment {
                length_m: actuator.parameters().length_m * state.axial_stretch,
                bend_angle_rad: state.bend_angle_rad,
                twist_rad: state.twist_rad,
            },
            mount_angle_rad,
            rigid_length_m: T::zero(),
        });
        tip_pose(base, links)
    }

    /// Length at rest, m.
    fn length_m(&self) -> T {
        self.segments.iter().fold(T::zero(), |sum, actuator| sum + actuator.parameters().length_m)
    }

    fn bending(&self) -> usize {
        self.segments.iter().filter(|actuator| actuator.parameters().motion == Motion::Bending).count()
    }

    fn check_load(&self, load: &Load<T>) -> Result<(), InvalidParameter<T>> {
        load.check()?;
        let bending = self.bending();
        let alike = bending == 0 || bending == self.segments.len();
        let allowed = "zero where straight and bending segments are in one series";
        require(alike || load.force_n == T::zero(), "external_force_n", load.force_n, allowed)?;
        require(alike || load.torque_nm == T::zero(), "external_torque_nm", load.torque_nm, allowed)
    }

    fn check_target(&self, target: SeriesTarget<T>) -> Result<(), InvalidParameter<T>> {
        let bending = self.bending();
        match target {
            SeriesTarget::Extension(v) => {
                let possible = v.is_finite() && v > -self.length_m();
                require(possible, "extension_m", v, "finite and > -(length of the series)")
            }
            SeriesTarget::Twist(v) => {
                require(v.is_finite(), "twist_rad", v, "finite")?;
                require(bending < self.segments.len(), "twist_rad", v, "a target of series with a straight segment")
            }
            SeriesTarget::BendAngle(v) => {
                require(v.is_finite() && v >= T::zero(), "bend_angle_rad", v, "finite and >= 0")?;
                require(bending > 0, "bend_angle_rad", v, "a target of series with a bending segment")
            }
        }
    }
}
