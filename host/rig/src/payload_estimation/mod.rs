//! What hangs on the tip, by how far the tip goes under it.
//!
//! A camera sees the tip at the ends of phases, without the load and with it ([`Sighting`]). The difference of the two does not hold where the
//! camera stands, and little of what the model gets wrong about the limb without load; the mass whose weight makes it, by the nonlinear statics of
//! the limb with its creep, is sought by least squares ([`mass`]). `docs/explanation/payload-estimation.md` has the equations, `docs/guide/estimate-a-payload.md` the format of the table.

mod creep;
mod limb;
mod mass;
mod refusal;
mod sighting;

pub use mass::{Mass, Way, mass};
pub use refusal::Refusal;
pub use sighting::Sighting;
pub use softlimb_files::table::TableError;
