//! Why a verb failed, as its user reads it.

use std::path::Path;

use crate::results::ResultError;
use softlimb_scene::SceneError;

/// A failure with the text that explains it.
#[derive(Debug)]
pub struct Failure {
    text: String,
    wrong_line: bool,
}

impl Failure {
    /// A failure explained by `text`, without `error:` in front.
    pub fn new(text: impl std::fmt::Display) -> Self {
        Self { text: format!("error: {text}"), wrong_line: false }
    }

    /// A command line that contradicts itself, whatever the files say.
    pub fn wrong_line(text: impl std::fmt::Display) -> Self {
        Self { wrong_line: true, ..Self::new(text) }
    }

    /// Something could not be done to a file.
    pub fn file(doing: &str, path: &Path, error: &dyn std::fmt::Display) -> Self {
        Self::new(format!("cannot {doing} {}: {error}", path.display()))
    }

    /// The exit code it ends the program with.
    pub(super) fn code(&self) -> u8 {
        if self.wrong_line { 2 } else { 1 }
    }

    pub(super) fn print(&self) {
        super::note(self.text.trim_end());
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self { text: error.render(super::colour()), wrong_line: false }
    }
}

impl From<ResultError> for Failure {
    fn from(error: ResultError) -> Self {
        match error {
            ResultError::Scene(error) => error.into(),
            other => Self::new(other),
        }
    }
}
