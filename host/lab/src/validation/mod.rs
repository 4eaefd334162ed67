//! The analytic model beside finite elements on the published set of actuators: four motions, two sizes, two materials.

mod bundles;
mod cases;
mod command;
mod page;

pub(crate) use bundles::Bundles;
pub use cases::cases;
pub(crate) use command::Validation;
pub use page::{PLACE, page};
