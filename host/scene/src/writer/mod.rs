//! Scenes with other values: the text as its author wrote it, comments and order, read again before it is handed out.

mod draft;
mod rebase;
mod redesign;
mod refit;
mod setting;
mod sheets;

pub use rebase::{Rebase, redesigned_at};
pub use redesign::{Redesign, RedesignedTarget, redesigned};
pub use refit::{recast, rewritten};
pub(crate) use setting::set;

use super::data::Module;
use super::error::SceneError;

/// Why a scene cannot be written anew.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RewriteError {
    /// The scene has another number of modules.
    #[error("{found} actuators for the {modules} modules of the scene")]
    Modules {
        /// Actuators given.
        found: usize,
        /// Modules of the scene.
        modules: usize,
    },
    /// A module of several segments, whose sizes are not written.
    #[error(transparent)]
    Segments(SceneError),
    /// A parameter that a scene has no key for, or that is written in a way that is not touched.
    #[error("cannot write the {what} of module `{module}` into this scene: change it by hand")]
    NotWritten {
        /// The module.
        module: String,
        /// The part to change.
        what: &'static str,
    },
    /// The new values are not what a scene may say.
    #[error("the scene does not take the new values: {0}")]
    Refused(SceneError),
}

fn not_written(module: &Module, what: &'static str) -> RewriteError {
    RewriteError::NotWritten { module: module.name.to_string(), what }
}
