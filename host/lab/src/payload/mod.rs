//! Eq. (18) of the paper by the product's search and by the paper's own method, on problems by kind and seed.

mod barrier;
mod command;
mod kinds;

pub use barrier::{Barrier, barrier};
pub(crate) use command::Payload;
pub use kinds::{KINDS, kind};
