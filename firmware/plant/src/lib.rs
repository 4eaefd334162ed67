//! Simulated pneumatics and actuators: the truth a controller is tried on.
//!
//! Pump and reservoir, valves, lines, the air in the actuators, pressure sensors; one tick of
//! 1 ms at a time. Volume and shape come from [`fra_model`] with parameters that differ from the
//! nominal ones by a seeded spread, so that a controller's model is never compared with itself.
//! The crate knows nothing about who drives it.
//!
//! The same settings and the same drive give the same bits: the gas uses only `+ - * /` and
//! square roots. Equations, parameters and their sources, and what is left out: `docs/explanation/plant.md`.
//!
//! ```
//! use fra_model::{ActuatorParameters, Material, Motion};
//! use softlimb_plant::{ChannelDrive, ChannelSettings, Drive, Plant, PlantSettings};
//!
//! let actuator = ActuatorParameters {
//!     motion: Motion::Bending,
//!     inner_radius_m: 6e-3,
//!     outer_radius_m: 8e-3,
//!     length_m: 0.1,
//!     material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
//!     fiber: None,
//! };
//! let mut plant = Plant::new(&PlantSettings::new(1, vec![ChannelSettings::new(actuator)]))?;
//! let fill = [ChannelDrive { fill_us: 1_000, vent_us: 0 }];
//! for _ in 0..20 {
//!     plant.step(&Drive { channels: &fill, supply_open: true, pump: 1.0, gripper_on: false });
//! }
//! let truth = plant.truth();
//! assert!(truth.channels[0].pressure_pa > 5e3);
//! assert!(truth.channels[0].shape.bend_angle_rad > 0.0);
//! # Ok::<(), softlimb_plant::PlantError>(())
//! ```

mod actuator;
mod channel;
mod check;
mod curve;
mod error;
mod fault;
mod gas;
mod gripper;
mod plant;
mod pneumatics;
mod random;
mod sensor;
mod settings;
mod spread;
mod supply;
mod truth;
mod valve;

pub use error::PlantError;
pub use fault::PartFault;
pub use gas::REFERENCE_DENSITY_KG_PER_M3;
pub use plant::{ChannelDrive, Drive, Plant, TICK_US};
pub use settings::{
    ActuatorLaw, ChannelSettings, Equilibria, MotionSettings, PlantSettings, PumpSettings, SegmentSettings,
    SensorSettings, Spread, Supply, TubeSettings, ValveSettings, ValveSupplySettings,
};
pub use spread::{TrueParameters, TrueSegment};
pub use truth::{ChannelTruth, Snapshot, Truth};
