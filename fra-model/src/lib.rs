//! Analytic model of fiber-reinforced actuators (FRA): extension, expansion, bending and twisting, forward and inverse.
//!
//! The model is the gradient of one strain energy: the pressure of a deformation is an explicit result and not an unknown.
//! It is generic over the scalar: the same source runs in `f32` on a microcontroller and in `f64` on the host. `no_std`, no heap,
//! no clock.
//!
//! Entry points:
//! - [`Actuator`] for a host: every motion, material and load, forward and inverse, blocked forces, derivatives; straight tubes with two
//!   windings.
//! - [`Tracker`] for a device: straight, unloaded tubes with closed forms, from state to state, in bounded time.
//!
//! Several actuators along one tube are a [`Series`], several pressures for one wrench an [`Allocation`], polynomials in place of the
//! solver an [`InverseTable`].
//!
//! Conventions: SI units; gauge pressure; fiber angle from the hoop direction; closed caps; tension positive.
//!
//! ```
//! use fra_model::*;
//! let actuator = Actuator::new(&ActuatorParameters {
//!     motion: Motion::Bending,
//!     inner_radius_m: 6e-3,
//!     outer_radius_m: 8e-3,
//!     length_m: 0.1,
//!     material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
//!     fiber: None,
//! })?;
//! let solution = actuator.forward(30e3, &Load::none())?;
//! assert_eq!(solution.status, Status::Solved);
//! assert!((solution.state.bend_angle_rad - 43.0_f64.to_radians()).abs() < 0.01);
//! # Ok::<(), InvalidParameter<f64>>(())
//! ```
#![no_std]

mod actuator;
mod allocation;
mod batch;
mod model;
mod number;
mod parameters;
mod precision;
mod quantity;
mod sensitivity;
mod series;
mod solution;
mod solve;
mod table;
mod tracker;

pub use actuator::Actuator;
pub use allocation::{Allocated, Allocation, AllocationStatus};
pub use batch::{Prepared, forward_many, forward_prepared, inverse_many};
pub use model::arrangement::Arrangement;
pub use model::limb::{Link, Segment, tip_pose};
pub use number::arithmetic::{Arithmetic, atanh_series};
pub use number::lanes::{LANES, Lanes};
pub use number::real::Real;
pub use parameters::{ActuatorParameters, Families, Fiber, InvalidParameter, Material, Motion, Placement};
pub use precision::Precision;
pub use quantity::StateQuantity;
pub use sensitivity::{NoDerivative, Parameter};
pub use series::{InvalidSeries, Series, SeriesLimit, SeriesSolution, SeriesState, SeriesTarget};
pub use solution::{Load, PressureRange, Solution, State, Status, Target};
pub use solve::blocked::Blocked;
pub use table::{Argument, InverseTable, Lookup, NotFinite, TABLE_COEFFICIENTS, TableParameters, Volume, VolumeTable};
pub use tracker::Tracker;
