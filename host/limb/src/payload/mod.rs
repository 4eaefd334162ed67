//! Force and payload: what bundles of actuators push and turn with, eqs. (15)-(17) of the paper, the largest load that a bundle or a limb
//! can hold, and the design of a bundle for wanted forces, eq. (18).
//!
//! Forces come from the model's own energy, [`fra_model::Actuator::blocked`]: the pressure Jacobian that the paper prints is not their
//! derivative. `docs/explanation/payload.md` has the derivation, the file format and the figures.

pub mod bundle;
mod capacity;
mod carried;
mod held;
mod limb;
mod polar;
mod program;

pub use bundle::{Bundle, Hold, Mounted, PayloadError, Push, lever, rank};
pub use capacity::{AFFINE, Active, Capacity, Linearised, LoadQuery, capacity};
pub use carried::{CarriedLoad, CarryLimit, CarryLimits, PAYLOAD_MAX_KG, carried_load};
pub use limb::{LimbCapacity, LoadCase, ModuleLoad, limb_capacity};
pub use polar::{Polar, polar, polar_picture};
pub use program::{Outcome, Program, Solution};
