//! Numerical methods without physics: bounded least squares, seeded random numbers, statistics.

pub mod least_squares;
mod random;
mod student;

pub use random::Random;
pub use student::quantile as student_quantile;
