//! Why a verb failed, as its user reads it.

use std::path::Path;

use crate::scene::SceneError;

/// A failure with the text that explains it.
#[derive(Debug)]
pub(crate) struct Failure {
    text: String,
}

impl Failure {
    /// A failure explained by `text`, without `error:` in front.
    pub(crate) fn new(text: impl std::fmt::Display) -> Self {
        Self { text: format!("error: {text}") }
    }

    /// Something could not be done to a file.
    pub(crate) fn file(doing: &str, path: &Path, error: &dyn std::fmt::Display) -> Self {
        Self::new(format!("cannot {doing} {}: {error}", path.display()))
    }

    pub(super) fn print(&self) {
        super::note(self.text.trim_end());
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self { text: error.render(super::colour()) }
    }
}
