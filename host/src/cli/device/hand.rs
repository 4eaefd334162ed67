//! `softlimb device zero`, `vent` and `gripper`: one act of a device by hand.

use clap::{Args, ValueEnum};

use super::super::port::MeasuringDevice;
use super::super::{Failure, Outcome, say};
use softlimb_rig::link::Outputs;

/// Take the zeros of the pressure sensors anew
#[derive(Args)]
#[command(
    after_help = "Vent first: the pressure that a chamber has becomes its zero. The device refuses beyond 3 % of a sensor's range.\n\n\
                  Example: softlimb device zero --port /dev/ttyACM0"
)]
pub(super) struct Zero {
    #[command(flatten)]
    device: MeasuringDevice,
}

/// Let all pressures down
#[derive(Args)]
#[command(after_help = "The supply is cut, the pressures fall by the configuration's ramp, then all vents open.\n\n\
                  Example: softlimb device vent --port /dev/ttyACM0")]
pub(super) struct Vent {
    #[command(flatten)]
    device: MeasuringDevice,
}

/// Open or close the gripper
#[derive(Args)]
#[command(
    after_help = "The device takes it where it is ready or holding, and keeps it until it is told otherwise or starts anew.\n\n\
                  Example: softlimb device gripper close --port /dev/ttyACM0"
)]
pub(super) struct Gripper {
    /// State of the gripper
    jaws: Jaws,
    #[command(flatten)]
    device: MeasuringDevice,
}

/// State of the gripper.
#[derive(Clone, Copy, ValueEnum)]
enum Jaws {
    /// The output is off
    Open,
    /// The output is on
    Close,
}

impl Zero {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        self.device.by_hand(|hand| hand.zero())?;
        say("the zeros are taken; the device is ready")?;
        Ok(Outcome::Done)
    }
}

impl Vent {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        self.device.by_hand(|hand| hand.vent())?;
        say("the pressures are down; the device is ready")?;
        Ok(Outcome::Done)
    }
}

impl Gripper {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (outputs, done) = match self.jaws {
            Jaws::Open => (Outputs::default(), "the gripper is told to open"),
            Jaws::Close => (Outputs::GRIPPER, "the gripper is told to close"),
        };
        self.device.by_hand(|hand| hand.set_outputs(outputs))?;
        say(done)?;
        Ok(Outcome::Done)
    }
}
