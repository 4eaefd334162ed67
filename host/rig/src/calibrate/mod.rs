//! From measurements to parameters: what a tensile test says about an elastomer, and what pressure and deformation say about
//! actuators.
//!
//! [`fit`] finds parameters of actuators by least squares with the exact derivatives of the model, gives each its confidence interval,
//! and refuses what the data cannot tell. Files are read and drawn elsewhere; nothing here opens one. `docs/explanation/calibration.md` has the equations.

mod body;
mod creep;
mod descent;
mod equalizing;
mod error;
mod estimate;
mod fit;
mod free;
mod holds;
mod loaded;
mod model;
mod picture;
mod points;
mod problem;
mod property;
mod range;
mod runs;
mod section;
mod specimens;
mod tension;

pub use body::Body;
pub use creep::{CreepFit, Step, fit_creep};
pub use equalizing::equalizing;
pub use error::CalibrationError;
pub use estimate::{Estimate, Noise, Value};
pub use fit::{Branch, Fit, Observation, Settings, Unknown, fit};
pub use holds::{Hold, LimbHold, holds, limb_holds};
pub use loaded::{Loaded, fit_loaded};
pub use model::{BodyModel, Reason};
pub use picture::{picture, range_picture, tension_picture};
pub use points::{Point, Points};
pub use property::Property;
pub use range::{RangeFit, fit_range};
pub use runs::Outlier;
pub use softlimb_files::table::TableError;
pub use specimens::{RandomEffects, SPECIMENS_MIN, random_effects};
pub use tension::{Law, Tension, TensionFit, fit_tension};
