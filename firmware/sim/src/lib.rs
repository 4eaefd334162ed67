//! The simulated MCU: the very controller of the firmware against the plant, in virtual time, behind a serial line.
//!
//! Nothing of the controller is repeated here: [`softlimb_firmware::turn`] runs on a simulated [`softlimb_firmware::Board`].
//! Time passes only in [`SimulatedMcu::advance_to`]; the same settings and the same bytes at the same times give the same bits.
//!
//! ```
//! use fra_model::{ActuatorParameters, Material, Motion};
//! use softlimb_plant::{ChannelSettings, PlantSettings};
//! use softlimb_sim::{SimSettings, SimulatedMcu};
//!
//! let actuator = ActuatorParameters {
//!     motion: Motion::Bending,
//!     inner_radius_m: 6e-3,
//!     outer_radius_m: 8e-3,
//!     length_m: 0.1,
//!     material: Material::NeoHookean { shear_modulus_pa: 0.2e6 },
//!     fiber: None,
//! };
//! let plant = PlantSettings::new(1, vec![ChannelSettings::new(actuator)]);
//! let mut mcu = SimulatedMcu::new(&SimSettings::new(plant))?;
//! mcu.write(&[0x00]);
//! mcu.advance_to(10_000);
//! assert_eq!(mcu.controller().state() as u8, 0);
//! # Ok::<(), softlimb_sim::SimError>(())
//! ```

mod board;
mod clock;
pub mod emulated;
mod error;
mod line;
mod mcu;
mod memory;
mod noise;
mod rerun;
mod settings;

pub use error::{EmulatorError, SimError};
pub use mcu::{Here, Processor, SimulatedMcu, here};
pub use rerun::Rerun;
pub use settings::{LineFaults, SimSettings};
pub use softlimb_firmware::{AdcCode, LOOK_US, TickInputs, TickOutputs, ValvePulse};
pub use softlimb_plant as plant;
