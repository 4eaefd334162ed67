//! The mass on the tip, from the tip's displacement under it.
//!
//! A camera observes the tip at the ends of phases, without the load and with it ([`Observation`]). The displacement is independent of the
//! camera's position, and depends little on the model's error without load. Least squares gives the mass that displaces the tip as far by the
//! nonlinear statics of the limb with its creep ([`mass`]). `docs/explanation/payload-estimation.md` has the
//! equations, `docs/guide/estimate-a-payload.md` the format of the table.

mod creep;
mod error;
mod limb;
mod mass;
mod observation;

pub use error::EstimationError;
pub use mass::{Displacement, Mass, mass};
pub(crate) use observation::ACCURACY_M;
pub use observation::Observation;
pub use softlimb_files::table::TableError;
