//! From a scene to what a workshop needs: a sheet, the paths of the thread, and the parts of the mold for each actuator.
//!
//! [`plan`] resolves how an actuator is wound and cast, or says at the scene's line why it cannot be made. [`sheet`] writes that down,
//! [`path`] walks along the thread, [`mold`] shapes the core and the shells. [`tolerance`] has how far wall, angle and modulus
//! may be off, as the sheet says it. `docs/explanation/fabrication.md` has the conventions.
//!
//! [`advice`] warns of windings that a person cannot wind.
//!
//! This room takes scenes and gives texts and meshes; it reads and writes no file.

mod advice;
mod drawing;
mod error;
pub mod mold;
pub mod path;
mod piece;
mod rows;
mod settings;
pub mod sheet;
pub mod tolerance;
mod winding;

pub use advice::advice;
pub use error::FabricateError;
pub use piece::{Copy, Piece, SecondWinding, TubeSegment, plan};
pub use settings::{Settings, Thread};
pub use tolerance::Tolerances;
pub use winding::{Hand, Winding, Worth};
