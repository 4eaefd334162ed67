//! Why a scene is no problem that a design can take up.

use softlimb_scene::SceneError;

use crate::synthesis::TaskError;

/// Why there is nothing to search.
#[derive(Debug, thiserror::Error)]
pub enum BriefError {
    /// Something in the scene, shown at its line.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The search does not take what the scene asks for.
    #[error("{0}")]
    Task(#[from] TaskError),
}
