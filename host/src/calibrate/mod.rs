//! From measurements to parameters: what a tensile test says about an elastomer, and what pressure and deformation say about
//! actuators.
//!
//! [`fit`] finds parameters of actuators by least squares with the exact derivatives of the model, gives each its confidence interval,
//! and refuses what the data cannot tell. Files are read and drawn elsewhere; nothing here opens one.

mod body;
mod descent;
mod estimate;
mod fit;
mod property;
mod refusal;
mod student;

pub use body::Body;
pub use estimate::{Estimate, Noise};
pub use fit::{Fit, Observation, Settings, Unknown, fit};
pub use property::Property;
pub use refusal::Refusal;
pub use student::quantile as student_quantile;
