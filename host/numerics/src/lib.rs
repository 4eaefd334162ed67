//! Numerical methods without physics: bounded least squares, multi-start search, seeded random numbers, points of low discrepancy,
//! Gauss rules, polynomials through nodes, statistics.
//!
//! This crate knows nothing of actuators, files or scenes, and uses no other crate of the workspace.

pub mod gauss;
mod interpolation;
pub mod least_squares;
mod low_discrepancy;
pub mod multi_start;
mod random;
pub mod statistics;

pub use interpolation::lagrange_weights;
pub use low_discrepancy::Kronecker;
pub use random::{Random, uniform_at};
