//! The failure of a step.

/// Failure of a step.
pub(crate) enum Trouble {
    /// A tool is not installed; its cure.
    Missing(String),
    /// The finding.
    Failed(String),
}
