//! `softlimb device test`: a device step by step, at its first light or whenever something is wrong with it.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::super::port::{PortOption, options};
use super::super::shared::{limb, show};
use super::super::{Failure, Outcome, note, warn};
use softlimb_motion::inverses;
use softlimb_rig::configuration;
use softlimb_rig::link::port::{Address, Port};
use softlimb_rig::link::{DeviceConfiguration, Step, Transport, Verdict, commission};
use softlimb_rig::run::{Mcu, simulated_device};

/// Test a device step by step: link, sensors, supply, then valves and leaks of each channel
#[derive(Args)]
#[command(
    after_help = "Moves air: each channel is filled to 10 kPa or 30 % of its highest pressure, watched for 5 s with closed valves, and vented.\n\
                  Keep clear of the limb. Steps that depend on one that failed are left out. A failure is a warning, with what to look at.\n\n\
                  Examples:\n  softlimb device test scenes/single-bending.toml --port /dev/ttyACM0\n  \
                  softlimb device test scenes/single-bending.toml --port sim --json"
)]
pub(super) struct Test {
    /// The scene of the limb and its pneumatics, which configures the device
    scene: PathBuf,
    #[command(flatten)]
    port: PortOption,
    /// Print the steps as JSON
    #[arg(long)]
    json: bool,
}

/// The result, as `--json` prints it.
#[derive(Serialize)]
struct Printed {
    port: String,
    passed: bool,
    steps: Vec<PrintedStep>,
}

/// One step.
#[derive(Serialize)]
struct PrintedStep {
    step: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    channel: Option<u8>,
    verdict: String,
    finding: String,
    /// Places to look at, where the step failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    look_at: Option<&'static str>,
}

impl Test {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let address = self.port.address()?.unwrap_or(Address::Simulated);
        let (scene, limb) = limb(&self.scene)?;
        let configuration = configuration(&scene, &inverses(&scene, &limb)?, &limb);
        let steps = match &address {
            Address::Port(place) => steps(&mut Port::open(place).map_err(Failure::new)?, &configuration),
            Address::Simulated => {
                steps(&mut simulated_device((&scene, &limb), scene.seed(), &Mcu::Here)?, &configuration)
            }
            Address::Emulated => {
                return Err(Failure::wrong_line(
                    "--port qemu: start `softlimb device serve SCENE --mcu qemu` and give its address",
                ));
            }
        };
        let printed = Printed::new(address.to_string(), &steps);
        show(self.json, &printed, || printed.table())?;
        let failed = steps.iter().filter(|step| step.verdict == Verdict::Failed);
        Ok(warn(&failed.map(|step| format!("{}: {}", place(step), step.finding)).collect::<Vec<_>>()))
    }
}

/// Runs the steps, and prints each one as it ends.
fn steps<T: Transport>(port: &mut T, configuration: &DeviceConfiguration) -> Vec<Step> {
    commission(port, configuration, &options(), &mut |step| {
        if step.verdict != Verdict::LeftOut {
            note(&format!("{}: {}", place(step), step.verdict));
        }
    })
}

fn place(step: &Step) -> String {
    step.channel.map_or_else(|| step.kind.to_string(), |channel| format!("{}, channel {channel}", step.kind))
}

impl Printed {
    fn new(port: String, steps: &[Step]) -> Self {
        let printed = |step: &Step| PrintedStep {
            step: step.kind.to_string(),
            channel: step.channel,
            verdict: step.verdict.to_string(),
            finding: step.finding.clone(),
            look_at: step.advice(),
        };
        let passed = steps.iter().all(|step| step.verdict == Verdict::Passed);
        Self { port, passed, steps: steps.iter().map(printed).collect() }
    }

    fn table(&self) -> String {
        let row = |step: &PrintedStep| {
            let channel = step.channel.map_or_else(String::new, |channel| channel.to_string());
            let advice = step.look_at.map_or_else(String::new, |advice| format!("{:34}look at: {advice}\n", ""));
            let finding = if step.verdict == Verdict::LeftOut.to_string() { "" } else { &step.finding };
            format!("{:14}  {channel:>2}  {:9}  {finding}", step.step, step.verdict).trim_end().to_owned()
                + "\n"
                + &advice
        };
        "step            ch  verdict\n".to_owned() + &self.steps.iter().map(row).collect::<String>()
    }
}
