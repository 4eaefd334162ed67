//! `softlimb device`: one device and its port.

mod clear;
mod hand;
mod info;
mod list;
mod log;
mod monitor;
mod screen;
mod sensors;
mod serve;
mod test;
mod valve;

use clap::{Args, Subcommand};

use super::{Failure, Outcome};

/// Talk to one device, or be one
#[derive(Args)]
#[command(after_help = "Example: softlimb device list")]
pub(super) struct Device {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    List(list::List),
    Info(info::Info),
    Log(log::Log),
    Sensors(sensors::Sensors),
    Monitor(monitor::Monitor),
    Test(test::Test),
    Clear(clear::Clear),
    Valve(valve::Valve),
    Vent(hand::Vent),
    Zero(hand::Zero),
    Gripper(hand::Gripper),
    Serve(serve::Serve),
}

impl Device {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        match &self.verb {
            Verb::List(verb) => verb.run(),
            Verb::Info(verb) => verb.run(),
            Verb::Log(verb) => verb.run(),
            Verb::Sensors(verb) => verb.run(),
            Verb::Monitor(verb) => verb.run(),
            Verb::Test(verb) => verb.run(),
            Verb::Clear(verb) => verb.run(),
            Verb::Valve(verb) => verb.run(),
            Verb::Vent(verb) => verb.run(),
            Verb::Zero(verb) => verb.run(),
            Verb::Gripper(verb) => verb.run(),
            Verb::Serve(verb) => verb.run(),
        }
    }
}
