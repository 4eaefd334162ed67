//! From measurements to parameters: data from computations of the tests' own, noise by seed, and data that cannot tell.

#[path = "calibrate/noise.rs"]
mod noise;
#[path = "calibrate/pressure.rs"]
mod pressure;
#[path = "calibrate/refusals.rs"]
mod refusals;
#[path = "calibrate/tube.rs"]
mod tube;
