//! The options that say where a device is.

use std::path::PathBuf;

use clap::Args;

use super::Failure;
use super::shared::limb;
use softlimb_motion::inverses;
use softlimb_rig::configuration;
use softlimb_rig::link::port::{Address, Port, PortAddress, session_number};
use softlimb_rig::link::{Direct, LinkError, StreamOptions};

/// Longest wait for a device to notice that its last host has gone, us: twice the timeout of most scenes.
const OCCUPIED_MAX_US: u64 = 500_000;

/// Address of a device, and its baud.
#[derive(Args)]
pub(super) struct PortOption {
    /// Device: /dev/ttyACM0, COM3, tcp:HOST:PORT, sim, qemu
    #[arg(long, value_name = "ADDRESS")]
    port: Option<Address>,
    /// Bits per second of a serial port [default: 921600]
    #[arg(long, requires = "port")]
    baud: Option<u32>,
}

impl PortOption {
    /// The address with its baud; `None` where there is none.
    pub(super) fn address(&self) -> Result<Option<Address>, Failure> {
        self.port.as_ref().map(|address| at_baud(address, self.baud)).transpose()
    }
}

/// Address of a device behind a port, and its baud.
#[derive(Args)]
pub(super) struct DevicePort {
    /// Device: /dev/ttyACM0, COM3, tcp:HOST:PORT; `softlimb device list` lists the serial ports
    #[arg(long, value_name = "ADDRESS")]
    port: Address,
    /// Bits per second of a serial port [default: 921600]
    #[arg(long)]
    baud: Option<u32>,
}

impl DevicePort {
    /// The address, and the open port.
    pub(super) fn open(&self) -> Result<(PortAddress, Port), Failure> {
        let address = self.address()?;
        Port::open(&address).map(|port| (address, port)).map_err(Failure::new)
    }

    /// The address.
    pub(super) fn address(&self) -> Result<PortAddress, Failure> {
        match at_baud(&self.port, self.baud)? {
            Address::Port(address) => Ok(address),
            other => Err(Failure::wrong_line(format!(
                "--port {other} is no port: start `softlimb device serve SCENE` and give the address that it prints"
            ))),
        }
    }
}

/// A device that measures: behind a port, and configured.
#[derive(Args)]
pub(super) struct MeasuringDevice {
    #[command(flatten)]
    port: DevicePort,
    /// Configure the device for a scene first: it measures only then. It may open vent valves to zero its sensors, and refuses while it runs or holds
    #[arg(long, value_name = "SCENE")]
    scene: Option<PathBuf>,
}

impl MeasuringDevice {
    /// The open port of a device that has the scene's configuration, where there is a scene.
    pub(super) fn open(&self) -> Result<Port, Failure> {
        match &self.scene {
            Some(_) => self.session(|_| Ok(())).map(|(port, ())| port),
            None => self.port.open().map(|(_, port)| port),
        }
    }

    /// The outcome of acts in a session with the device, which has the scene's configuration where there is a scene.
    pub(super) fn by_hand<R>(
        &self,
        act: impl FnOnce(&mut Direct<'_, Port>) -> Result<R, LinkError>,
    ) -> Result<R, Failure> {
        self.session(act).map(|(_, done)| done)
    }

    fn session<R>(
        &self,
        act: impl FnOnce(&mut Direct<'_, Port>) -> Result<R, LinkError>,
    ) -> Result<(Port, R), Failure> {
        let configuration = match &self.scene {
            Some(file) => {
                let (scene, limb) = limb(file)?;
                Some(configuration(&scene, &inverses(&scene, &limb)?, &limb))
            }
            None => None,
        };
        let (_, mut port) = self.port.open()?;
        let (options, mut on_event) = (options(), |_: &mut Port, _| {});
        let mut hand = Direct::open(&mut port, &options, &mut on_event).map_err(Failure::new)?;
        if let Some(configuration) = configuration {
            hand.configure(&configuration).map_err(Failure::new)?;
        }
        let done = act(&mut hand).map_err(Failure::new)?;
        Ok((port, done))
    }
}

fn at_baud(address: &Address, baud: Option<u32>) -> Result<Address, Failure> {
    baud.map_or(Ok(address.clone()), |baud| address.clone().at_baud(baud).map_err(Failure::wrong_line))
}

/// Settings of a short session.
pub(super) fn options() -> StreamOptions<'static> {
    StreamOptions { occupied_max_us: OCCUPIED_MAX_US, ..StreamOptions::new(session_number()) }
}
