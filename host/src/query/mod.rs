//! Single questions to the actuator model: pressure curves of a scene's actuators, and batches from other programs.

mod batch;
mod chunks;
mod complaint;
mod convert;
mod curve;
mod errors;
mod fields;
mod request;
mod scan;
mod section_all;
mod section_fe;
mod series;
mod single;
mod two_windings;

pub use batch::{Scalar, batch, batch_on};
pub use curve::{Curve, CurvePoint, curves};
pub use request::Question;
pub use section_fe::{SectionAnswer, SectionQuery, solve_section};
pub use single::actuator;
