//! From measurements to parameters: data from computations of the tests' own, noise by seed, and data that cannot tell.

mod creep;
mod loaded;
mod loops;
mod noise;
mod pressure;
mod range;
mod refusals;
mod specimens;
mod tension;
mod tube;
mod wound;
