//! Equilibria of the model: continuation of the branch, the closed-form solver and its warm start, bends, blocked ends.

pub(crate) mod bend;
pub(crate) mod blocked;
pub(crate) mod closed_form;
pub(crate) mod continuation;
mod load_path;
mod query;
mod refine;
pub(crate) mod residual;
pub(crate) mod size;
pub(crate) mod tube;
