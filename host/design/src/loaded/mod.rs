//! Design of a limb under its own weight and that of what it carries: a search over sizes around the statics.
//!
//! [`LoadedTask`] says what the tip shall do and with which loads, [`ModuleSpace`] what each module may be. [`search`] solves for sizes and for the
//! pressures of all poses at once: every margin is a residual that is zero where it is kept. It drives the sum of squares to zero from several starts, and then
//! raises the reserve of all margins. [`evaluate`] judges one limb alone, with pressures by inverse kinematics under load.

mod bounds;
mod built;
mod candidate;
mod clearance;
mod confirm;
mod evaluate;
mod hinges;
mod inverse;
mod laws;
mod limits;
mod local_solve;
mod moves;
mod nearby;
mod places;
mod plates;
mod pose;
mod race;
mod residuals;
mod search;
mod seeded;
mod space;
mod task;
mod walk;

pub use bounds::{ActiveBound, active_bounds};
pub use built::Built;
pub use confirm::{ConfirmedPose, LOAD_FACTOR_MOST, REACHED_M};
pub use evaluate::{Evaluation, Judgement, evaluate};
pub use laws::Laws;
pub use limits::{Margin, StandingLimits};
#[cfg(test)]
pub(crate) use local_solve::compared::{Compared, compare};
pub use plates::Shift;
pub use pose::{LoadState, PoseState};
pub use residuals::Lack;
pub use search::{Effort, Found, Refusal, confirmed, search, search_to_run};
pub use seeded::{Seeded, seeded};
pub use space::{BaseSpace, LimbSizes, LimbSpace, ModuleSizes, ModuleSpace, Variable};

pub use task::{CarriedBody, LoadedPose, LoadedTask};
