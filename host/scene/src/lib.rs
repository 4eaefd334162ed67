//! Scene files: TOML with units in, checked SI data out.
//!
//! A scene says what the limb is made of, what it does and which pneumatics move it. [`load`] and [`parse`] read it once; afterwards
//! nothing checks again. What is wrong is collected, not only the first of it, and drawn with the lines of the file underlined:
//!
//! ```
//! let error = softlimb_scene::parse("format = 1\nnmae = \"elbow\"\n", "elbow.toml").unwrap_err();
//! assert!(error.render(false).contains("did you mean `name`?"));
//! ```
//!
//! The schema is a table ([`reference()`] writes it as a page), the reader follows that table, and `read` turns what it reads into
//! a [`Scene`]. Values keep their place in the text ([`Located`]), so that a later room which finds, say, a target beyond the
//! limit pressure can point at it with [`Scene::diagnostic`].
//!
//! This room does not know what a limb can reach, and no other room knows TOML or units.

pub mod collision;
mod data;
mod elastomers;
mod error;
mod quantity;
mod read;
mod reader;
mod reference;
mod schema;
mod source;
mod study;
mod suggest;
mod unit;
mod value;
mod writer;

use std::path::Path;

pub use data::{
    Aim, Ambient, BendingModel, BodyEffects, Bounds, Camera, Chamber, Choice, Controller, CorrectionRow, Corrections,
    Design, EndEffector, Excess, Goal, Gripper, Imu, InverseChoice, Limb, Limits, Line, LinkLoss, MarginLimits, Marker,
    Module, ModuleBounds, ModuleSegment, Object, Obstacle, Phase, PhaseCorrections, PhaseTimes, Plant, PressureLoop,
    Region, Scene, Sensor, Shaping, Spread, Supply, Swing, Target, Thread, TrueLimb, Valve, Weight, WoundActuator,
    WoundWall,
};
pub use elastomers::{CASTABLE_ELASTOMERS, CastableElastomer, TENSILE_TESTS, castable_elastomer};
pub use error::{Diagnostic, Problems, SceneError, Unreadable};
pub use quantity::{Quantity, quantity};
pub use read::{check_creep, check_law};
pub use reference::{reference, study_reference};
pub use source::{Located, SCENE_BYTES_MAX, Span};
pub use study::{Experiment, Study, load_study};
pub use writer::{Rebase, Redesign, RedesignedTarget, RewriteError, recast, redesigned, redesigned_at, rewritten};

use source::Source;

/// Reads and checks a scene file.
///
/// # Errors
/// [`SceneError::Unreadable`] if the file is missing, a directory, larger than [`SCENE_BYTES_MAX`] or not UTF-8; else as [`parse`].
pub fn load(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
    read::scene(Source::read(path.as_ref())?)
}

/// Checks the text of a scene; `name` stands for the file in diagnostics.
///
/// # Errors
/// [`SceneError::Invalid`] with every problem found.
pub fn parse(text: &str, name: &str) -> Result<Scene, SceneError> {
    read::scene(Source::new(name, text))
}
