//! Why something cannot be made.

use thiserror::Error;

use softlimb_files::range::OutOfRange;
use softlimb_scene::SceneError;

/// What stands between a scene and a workshop.
#[derive(Debug, Error)]
pub enum FabricateError {
    /// A setting is out of its range.
    #[error(transparent)]
    Invalid(#[from] OutOfRange),
    /// An actuator of the scene cannot be made with these settings; a diagnostic at its line.
    #[error(transparent)]
    Scene(#[from] SceneError),
}
