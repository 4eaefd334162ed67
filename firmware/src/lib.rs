//! The controller of the limb: setpoint queue, inverse model, pressure loop, safety. No hardware, no clock, no allocation.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod adapt;
mod flow;
mod gas;
mod pneumatics;
mod pressure_loop;
mod sensor;
mod valve;

pub use adapt::{Adaptation, Effect};
pub use flow::Orifice;
pub use gas::{Absolute, Chamber};
pub use pneumatics::Pneumatics;
pub use pressure_loop::{LoopInput, PressureLoop, Reference};
pub use sensor::{AdcCode, Sensor, SensorScale, ZeroCheck};
pub use valve::{Direction, ValvePair, ValvePulse, ValveTiming};
