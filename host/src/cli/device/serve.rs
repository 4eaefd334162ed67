//! `softlimb device serve`: the simulated device as a program of its own.

use std::path::PathBuf;

use clap::Args;

use super::super::interrupt::interrupt;
use super::super::run::Controller;
use super::super::shared::limb;
use super::super::{Failure, Outcome, note, say};
use softlimb_limb::Limb;
use softlimb_rig::link::port::{ClientPort, Leave, Served, serve};
use softlimb_rig::run::simulated_device;
use softlimb_scene::Scene;

/// Run the simulated device with the limb of a scene in real time, behind a port, until Ctrl-C
#[derive(Args)]
#[command(
    after_help = "Without a scene it serves one bending actuator. Prints the address for clients first. At a TCP address several connect: the first that opens a session commands, the others\n\
                  look. A terminal has one client. The device lives on between them.\n\
                  `softlimb run SCENE --port ADDRESS` in another window is such a client.\n\n\
                  Examples:\n  softlimb device serve scenes/single-bending.toml\n  \
                  softlimb device serve scenes/single-bending.toml --tcp 127.0.0.1:7000"
)]
pub(super) struct Serve {
    /// The scene of the limb and its pneumatics [default: one bending actuator, scenes/single-bending.toml]
    scene: Option<PathBuf>,
    /// Serve at a TCP address instead of a pseudo-terminal; port 0 takes a free one
    #[arg(long, value_name = "HOST:PORT", conflicts_with = "pty")]
    tcp: Option<String>,
    /// Serve at a new pseudo-terminal [default]
    #[arg(long)]
    pty: bool,
    /// Seed of the plant [default: the scene's]
    #[arg(long)]
    seed: Option<u64>,
    #[command(flatten)]
    controller: Controller,
}

/// The rig where no scene is given.
const DEFAULT_RIG: &str = include_str!("../../../../scenes/single-bending.toml");

fn default_rig() -> Result<(Scene, Limb), Failure> {
    let scene = softlimb_scene::parse(DEFAULT_RIG, "single-bending.toml")?;
    let limb = Limb::new(&scene)?;
    Ok((scene, limb))
}

impl Serve {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (scene, limb) = match &self.scene {
            Some(file) => limb(file)?,
            None => default_rig()?,
        };
        let seed = self.seed.unwrap_or(scene.seed());
        let mut device = simulated_device((&scene, &limb), seed, &self.controller.mcu())?;
        let stop = interrupt()?;
        let mut port = self.port()?;
        let address = port.address().map_err(|error| Failure::new(format!("the port has no address: {error}")))?;
        say(&address)?;
        serve(&mut device, &mut port, &stop, |time_us, news| {
            note(&format!("{:10.3} s  {}", time_us as f64 * 1e-6, in_words(&news)));
        })
        .map_err(Failure::new)?;
        Ok(Outcome::Done)
    }

    fn port(&self) -> Result<ClientPort, Failure> {
        match &self.tcp {
            Some(address) => {
                ClientPort::tcp(address).map_err(|error| Failure::new(format!("cannot serve at {address}: {error}")))
            }
            None => {
                ClientPort::terminal().map_err(|error| Failure::new(format!("cannot open a pseudo-terminal: {error}")))
            }
        }
    }
}

fn in_words(news: &Served) -> String {
    match news {
        Served::Connected(client) => format!("client {client} connected"),
        Served::Commands(client) => format!("client {client} commands"),
        Served::Left { client, why: Leave::Closed } => format!("client {client} left"),
        Served::Left { client, why: Leave::TookNothing(time) } => {
            format!("client {client} took no bytes for {} s: connection closed", time.as_secs())
        }
        Served::Left { client, why: Leave::MadeRoom } => {
            format!("client {client} makes room for a new one: it was silent the longest")
        }
        Served::State(state) => state.known().map_or_else(|| format!("state {}", state.raw()), |s| format!("{s:?}")),
        Served::Fault(fault) => format!("fault: {fault}"),
        Served::Lag(lag_us) => format!("this computer is too slow: the clock stood still for {} ms", lag_us / 1_000),
    }
}
