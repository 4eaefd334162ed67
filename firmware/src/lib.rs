//! The controller of the limb: setpoint queue, inverse model, pressure loop, safety. No hardware, no clock, no allocation.
//!
//! [`Controller`] eats link bytes and samples and yields link bytes and coil times; time is an argument. A [`Board`], real or
//! simulated, is all it needs around it. The walk of a datum: `dispatch` takes a message, `queue` keeps the knot,
//! `inverse` turns the deformation into a pressure, `pressure_loop` into a pulse, `valve` into coil times; `supervise` may overrule.
//!
//! ```
//! use softlimb_firmware::{AdcCode, BootInfo, Controller, TickInputs, TickOutputs};
//! use softlimb_protocol::{BootCause, DeviceState};
//!
//! let mut controller = Controller::new(BootInfo { cause: BootCause::PowerOn, detail: 0 });
//! let inputs = TickInputs { now_us: 1_000, pressure: [AdcCode(410); 27], supply: AdcCode(2_000),
//!     valve_supply: AdcCode(2_708), emergency_stop: false };
//! assert_eq!(controller.tick(&inputs), TickOutputs::SAFE);
//! assert_eq!(controller.state(), DeviceState::Idle);
//! ```
#![cfg_attr(not(test), no_std)]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing))]

mod adapt;
mod air_balance;
mod board;
mod channel;
mod config;
mod controller;
mod dispatch;
mod duty;
mod faults;
mod fine_regulation;
mod flow;
mod gas;
mod inverse;
mod link;
pub mod log;
mod manual;
mod observer;
mod outbox;
mod pneumatics;
mod pressure_loop;
mod pulse;
mod queue;
mod reference;
mod relief;
mod safety;
mod sampling;
mod sensor;
mod setpoints;
mod state;
mod supervise;
mod telemetry;
mod valve;

pub use adapt::{Adaptation, Effect};
pub use air_balance::AirBalance;
pub use board::{Board, LOOK_US, exchange, turn};
pub use channel::Channel;
pub use config::{ActiveConfig, ChannelConfig, ConfigError, Source, StagedConfig, StagingError, SystemConfig};
pub use controller::{BootInfo, Controller, TickInputs, TickOutputs};
pub use duty::Duty;
pub use faults::{Faults, Occurrence, Reaction, VentScope, reaction};
pub use flow::Orifice;
pub use gas::{Absolute, Chamber};
pub use inverse::{Inverse, InverseStatus};
pub use pneumatics::Pneumatics;
pub use pressure_loop::{LoopInput, PressureLoop};
pub use queue::{KNOTS, KnotQueue, QueueError};
pub use reference::Reference;
pub use sensor::{AdcCode, Sensor, SensorScale, VoltageScale};
pub use state::{Event, TRANSITIONS, next};
pub use valve::{Direction, TICK_US, ValvePair, ValvePulse, ValveTiming};
