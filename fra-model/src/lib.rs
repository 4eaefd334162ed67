//! Analytic model of fiber-reinforced actuators (FRA): extension, expansion, bending and twisting, forward and inverse.
//!
//! The model is the gradient of one strain energy, so that a deformation's pressure is an explicit result and not an unknown.
//! It is generic over the scalar: the same source runs in `f32` on a microcontroller and in `f64` on the host. `no_std`, no heap,
//! no clock.
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
mod bending;
mod branch;
mod direct;
mod elementary;
mod energy;
mod goal;
mod held;
mod jet;
mod limb;
mod load_path;
mod parameters;
mod quadrature;
mod question;
mod real;
mod refine;
mod scalar;
mod section;
mod sensitivity;
mod series;
mod size;
mod solution;
mod table;
mod tracker;
mod tube;
mod two;

pub use actuator::Actuator;
pub use allocation::{Allocated, Allocation, AllocationStatus};
pub use batch::{Prepared, forward_many, forward_prepared};
pub use direct::{Arithmetic, LANES, Lanes, atanh_series};
pub use held::Held;
pub use limb::{Link, Segment, tip_pose};
pub use parameters::{ActuatorParameters, Families, Fiber, InvalidParameter, Material, Motion, Placement};
pub use real::Real;
pub use sensitivity::{NoDerivative, Parameter};
pub use series::{InvalidSeries, Series, SeriesLimit, SeriesSolution, SeriesState, SeriesTarget};
pub use solution::{Load, Solution, State, Status, Target};
pub use table::{Argument, InverseTable, Lookup, NotFinite, TABLE_COEFFICIENTS, TableParameters, Volume, VolumeTable};
pub use tracker::Tracker;
