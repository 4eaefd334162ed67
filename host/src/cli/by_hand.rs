//! What `jog` and `console` share: the session with a device, and the times from an order to its setpoint on the wire.

use std::fmt;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use clap::Args;
use serde::Serialize;

use super::Failure;
use super::port::PortOption;
use super::shared::quantity;
use softlimb_rig::link::port::Address;
use softlimb_rig::run;
use softlimb_rig::run::{JogDevice, JogOptions, Mcu, Operator, RunError, RunFiles};
use softlimb_scene::{Quantity, Scene};

/// The device of a session, and what counts as there.
#[derive(Args)]
pub(super) struct HandOptions {
    /// Seed of the plant [default: the scene's]
    #[arg(long)]
    seed: Option<u64>,
    #[command(flatten)]
    port: PortOption,
    /// Largest distance at which the tip is at a target
    #[arg(long, value_name = "LENGTH", value_parser = quantity("mm", 0.1, 1000.0), default_value = "10mm")]
    pub(super) within: Quantity,
}

/// A device that is not connected yet.
pub(super) struct Device {
    address: Option<Address>,
    seed: Option<u64>,
}

impl HandOptions {
    /// The device, or why the options contradict each other.
    pub(super) fn device(&self) -> Result<Device, Failure> {
        let address = self.port.address()?;
        if let (Some(address @ Address::Port(_)), Some(_)) = (&address, self.seed) {
            return Err(Failure::wrong_line(format!("--seed cannot be used with --port {address}")));
        }
        Ok(Device { address, seed: self.seed })
    }
}

impl Device {
    /// Its address in words.
    pub(super) fn name(&self) -> String {
        self.address.as_ref().map_or_else(|| "sim".to_owned(), ToString::to_string)
    }

    pub(super) fn is_simulated(&self) -> bool {
        !matches!(self.address, Some(Address::Port(_)))
    }

    /// Moves the limb of a scene by an operator's orders.
    pub(super) fn session(
        &self,
        scene: &Scene,
        options: &JogOptions,
        operator: &mut dyn Operator,
        cancel: &AtomicBool,
    ) -> Result<RunFiles, RunError> {
        let mcu = match &self.address {
            Some(Address::Port(port)) => return run::jog_behind(scene, port, options, operator, cancel),
            Some(Address::Emulated) => Mcu::Flashed("target/firmware/softlimb-stm32f405.elf".into()),
            Some(Address::Simulated) | None => Mcu::Here,
        };
        let device = JogDevice { seed: self.seed.unwrap_or(scene.seed()), mcu, in_real_time: true };
        run::jog(scene, &device, options, operator, cancel)
    }
}

/// Percentiles of some times, ms.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Latency {
    p50_ms: f64,
    p99_ms: f64,
    max_ms: f64,
}

impl Latency {
    /// Of times in any order; `None` of none.
    pub(super) fn of(mut waits: Vec<Duration>) -> Option<Self> {
        waits.sort_unstable();
        let at = |share: f64| {
            let rank = (share * waits.len() as f64).ceil() as usize;
            waits.get(rank.saturating_sub(1)).map(|wait| 1e3 * wait.as_secs_f64())
        };
        Some(Self { p50_ms: at(0.5)?, p99_ms: at(0.99)?, max_ms: at(1.0)? })
    }
}

impl fmt::Display for Latency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "p50 {:.1}, p99 {:.1}, max {:.1} ms", self.p50_ms, self.p99_ms, self.max_ms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_those_of_the_rank() {
        let waits: Vec<Duration> = (1..=200).rev().map(Duration::from_millis).collect();
        let expected = Latency { p50_ms: 100.0, p99_ms: 198.0, max_ms: 200.0 };
        assert_eq!(Latency::of(waits), Some(expected));
        assert_eq!(Latency::of(Vec::new()), None);
    }
}
