//! What a scene asks of a design: its modules, bounds, targets and way-points as problems of the searches, and what those find as a
//! scene again.
//!
//! A scene whose phases have targets is eq. (14) of the paper ([`fit`](super::fit)); one whose tip shall be somewhere is a task
//! ([`path`](super::path)). The searches know no scene, and this room no search from inside.

mod attempts;
mod error;
mod loaded;
mod space;
mod targets;
mod task;

pub use attempts::{Attempt, design_to_run};
pub use error::BriefError;
pub use loaded::{LoadedDesign, loaded_design, loaded_text};
pub use targets::{redesigned_targets, redesigned_totals, targets, totals, with_ends};
pub use task::{Tasked, redesigned_limb, task};

use softlimb_scene::{Goal, Scene};

/// Whether the tip of a scene is led, so that a design of it is a task; otherwise its modules have targets of their own.
pub fn leads_the_tip(scene: &Scene) -> bool {
    scene.phases().iter().any(|phase| !matches!(phase.goal, Goal::Targets(_)))
}
