//! Results of the command's verbs as data: `--json` prints them, and the Python package returns them.
//!
//! Each result is made from a scene and its limb, and has its warnings beside it.

pub(crate) mod bend;
mod check;
mod margins;
mod run;
mod statics;
mod swing;
mod workspace;
mod workspace_loaded;

use serde::Serialize;
use softlimb_scene::SceneError;

pub use bend::with_bends;
pub use check::CheckResult;
pub(crate) use margins::warnings as margin_warnings;
#[cfg(any(feature = "console", feature = "terminal"))]
pub(crate) use run::warnings as run_warnings;
pub use run::{RunSummary, margin_warning, recorded_limb};
pub(crate) use statics::Row as StaticsRow;
pub use statics::{StaticsOptions, StaticsResult};
pub(crate) use workspace::NAMES;
pub use workspace::{WorkspaceOptions, WorkspaceResult};
pub use workspace_loaded::LoadedWorkspaceResult;
pub(crate) use workspace_loaded::unreached;

/// A result as one line of JSON.
pub fn json(result: &impl Serialize) -> String {
    // Cannot fail: keys are strings, and numbers that are not finite become null.
    serde_json::to_string(result).unwrap_or_default()
}

/// Why there is no result.
#[derive(Clone, Debug, thiserror::Error)]
pub enum ResultError {
    /// The scene does not have a plan.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The model has no equilibrium.
    #[error("{0}")]
    NoEquilibrium(String),
}
