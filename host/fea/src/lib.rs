//! Finite elements of fiber-reinforced actuators: the analytic model's independent judge.
//!
//! [`cross_section`] solves generalised plane strain of a cut through the tube, [`axisymmetric`] its ends and threads, and [`solid`]
//! writes three-dimensional decks and runs CalculiX.
//!
//! This crate must not know an equation of `fra-model` (it takes parameters alone, so that it can judge the model), scenes, or a clock.

pub mod axisymmetric;
pub mod cross_section;
mod elastomer;
#[cfg(test)]
mod hyper_dual;
mod quadrilateral;
pub mod solid;
mod spacing;
