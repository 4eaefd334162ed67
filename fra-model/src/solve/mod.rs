//! The strain energy of the straight wall and its equilibria: continuation of the branch, the closed-form solver and its warm start, bends, blocked ends.

pub(crate) mod bend;
pub(crate) mod blocked;
pub(crate) mod closed_form;
pub(crate) mod continuation;
pub(crate) mod energy;
mod load_path;
mod query;
mod refine;
pub(crate) mod residual;
pub(crate) mod size;
pub(crate) mod tube;
