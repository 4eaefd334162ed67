//! softlimb on the host: the command, and the crates a library user may rely on.
//!
//! A scene file becomes a [`scene::Scene`], a [`limb::Limb`], a plan ([`motion`]), a run on a device with its log and report ([`rig`]).
//! [`design`] searches limbs, [`fea`] judges the model, [`query`] answers questions to the actuator model alone, [`batch`] for many
//! actuators at once, [`sweep`] runs studies of scenes, [`results`] has what the command prints as data, and [`comparison`] puts the model beside finite elements.
//! [`cli`] is the command line.

pub mod cli;
pub mod comparison;
pub mod query;
pub mod results;
pub mod sweep;

pub use softlimb_design as design;
pub use softlimb_fea as fea;
pub use softlimb_limb as limb;
pub use softlimb_limb::batch;
pub use softlimb_motion as motion;
pub use softlimb_rig as rig;
pub use softlimb_scene as scene;
