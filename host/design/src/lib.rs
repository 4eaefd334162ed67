//! Design by search: actuators from deformations, bundles from forces, limbs from way-points among obstacles.
//!
//! [`actuators`] solves eq. (14) of the paper, [`bundle`] eq. (18), [`synthesis`] sizes whole limbs, and [`from_scene`] turns scenes into
//! their problems and results into scenes. [`blocked`] designs for blocked force.
//!
//! The searches must not know scenes, files but problems of their own in JSON, or printing; only [`from_scene`] knows scenes.

pub mod actuators;
pub mod blocked;
pub mod bundle;
pub mod from_scene;
pub mod loaded;
pub mod synthesis;

#[cfg(test)]
mod exact_derivatives;
