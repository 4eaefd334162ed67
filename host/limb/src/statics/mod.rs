//! The limb under load: what its tubes are as springs, what a bundle of them is, and what the limb does under weight.
//!
//! A tube at its pressure is a spring by the model's own tangent ([`Tangent`]), parallel tubes are one rod ([`Bundle`]), modules in series
//! are a chain of rods ([`Rod`]) whose potential has a minimum ([`solve`]) as long as the limb is stable. [`cheapest`] takes as
//! many unknowns as a tolerance needs.

mod bend_share;
mod between;
mod buckling;
mod bundle;
mod deformed;
mod exponential;
mod fidelity;
mod load;
mod modes;
mod newton_step;
mod plates;
mod response;
mod restraint;
mod rod;
mod settled;
mod solve;
mod spring;
mod standing;
mod step;
mod tip_response;
mod tube;
mod wall;

pub use bend_share::{BEND_SHARE_MIN, BendShare, check_bundles};
pub use buckling::Buckling;
pub(crate) use buckling::column_n;
pub use bundle::{Bundle, Free};
pub use deformed::Deformed;
pub use fidelity::{Answer, Fidelity, Judged, by_fidelity, by_tubes, cheapest, cheapest_rod, choose};
pub use load::{GRAVITY_M_PER_S2, Load, LoadedLimb};
pub use modes::{Gyration, Mode, Part};
pub use plates::Plates;
pub(crate) use response::{responses, shape_change};
pub use rod::{Piece, Potential, Rod, UNKNOWNS};
pub use settled::Settled;
pub use solve::{Bends, EquilibriumError, LOAD_FACTOR_MAX, Shape, solve, solve_pressurized};
pub use spring::{Spring, TubeStrain};
pub use standing::{BUCKLING_MARGIN_MAX, Standing};
pub use tip_response::{Neighbours, Responding};
pub use tube::Tangent;
pub(crate) use tube::shear_n;
