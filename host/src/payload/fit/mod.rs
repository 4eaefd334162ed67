//! The design of a bundle for wanted forces, eq. (18) of the paper: geometry, pressures, attachment points and axes.
//!
//! Residuals are the components of `f_total - f_des`, weighted with units; their derivatives are exact, from the model's own. The
//! search is bounded Gauss-Newton; the paper's quasi-Newton method with a barrier is there to compare.

mod answer;
mod barrier;
mod file;
mod forces;
mod kinds;
mod layout;
mod problem;
mod search;

pub use answer::{ActuatorAnswer, Answer, SampleAnswer};
pub use barrier::{Barrier, barrier};
pub use kinds::{KINDS, kind};
pub use problem::{Attachment, ForceProblem, Sample};
pub use search::{Effort, search};
