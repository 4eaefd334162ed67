//! Where the tip can be: the extents exactly, and a picture of all of it.
//!
//! A workspace is the image of a box of pressures, from none to the highest that each actuator may be given. [`Workspace`] maps the box to
//! the tip by polynomials, [`extents`] finds how far the tip gets in each direction, [`sample`] fills the box with points of low discrepancy,
//! [`sample_single`] does so in single precision for pictures,
//! [`Grid`] counts the cells they fall into. [`Loaded`] is the same under weight.
//! Neither collisions of the limb with itself nor obstacles are looked at.

mod ascent;
mod bundle;
mod compare;
mod extents;
mod fit;
mod grid;
mod lanes;
mod loaded;
mod loaded_extents;
mod module;
mod picture;
mod sample;
mod single;
mod single_lanes;
mod single_sample;
mod space;

pub use compare::{Convergence, convergence};
pub use extents::{Extents, Measure, Reach, extents};
pub use grid::Grid;
pub use loaded::{Loaded, LoadedPoseError, Pose, Tally};
pub use loaded_extents::{LoadedExtents, LoadedReach, loaded_extents};
pub use module::ModuleTable;
pub use picture::{ExtremeLine, picture};
pub use sample::{Points, sample};
pub use single_sample::sample_single;
pub use space::{Axis, Command, Workspace, WorkspaceError};
