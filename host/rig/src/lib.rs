//! The rig: a device on a link, a run of a scene on it, its log and report, and what is learned from logs.
//!
//! [`run`] streams a plan over [`link`] to a device, simulated by [`simulate`]; [`record`] writes and reads the log, [`report`] draws it, [`export`] makes tables of
//! it, and [`replay`] runs the controller again on it.
//! [`calibrate`], [`learning`] and [`payload_estimation`] find parameters, corrections and masses from measurements.
//!
//! This crate must not parse scenes, plan motion, or print.

pub mod calibrate;
mod camera;
mod configuration;
mod correction;
pub mod export;
mod imu;
pub mod learning;
pub mod link;
pub mod payload_estimation;
pub mod record;
pub mod replay;
pub mod report;
pub mod run;
pub mod simulate;

pub use configuration::configuration;
