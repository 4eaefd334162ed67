//! The design of a bundle for wanted forces, eq. (18) of the paper: geometry, pressures, attachment points and axes.
//!
//! Residuals are the components of `f_total - f_des`, weighted with units; their derivatives are exact, from the model's own. The
//! search is bounded Gauss-Newton.

mod answer;
mod file;
mod forces;
mod layout;
mod problem;
mod search;

pub use answer::{ActuatorAnswer, Answer, SampleAnswer};
pub use forces::{Forces, Point};
pub use problem::{Attachment, ForceProblem, Place, Sample, Tube};
pub use search::{Budget, search};
