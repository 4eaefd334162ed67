//! From measurements to parameters: data from computations of the tests' own, noise by seed, and data that cannot tell.

#[path = "calibrate/command.rs"]
mod command;
#[path = "calibrate/creep.rs"]
mod creep;
#[path = "calibrate/noise.rs"]
mod noise;
#[path = "calibrate/pressure.rs"]
mod pressure;
#[path = "calibrate/refusals.rs"]
mod refusals;
#[path = "calibrate/tension.rs"]
mod tension;
#[path = "calibrate/tube.rs"]
mod tube;
