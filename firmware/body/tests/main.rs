//! Properties and oracles of the true body.

mod laws;
mod memory;
mod rods;
mod statics;
