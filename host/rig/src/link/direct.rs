//! A device under direct control: a session without a run.

use softlimb_protocol::{
    CommandCode, DeviceState, HostMessage, ManualPulse, Outputs, PulseDirection, SetOutputs, Telemetry,
};

use super::configuration::DeviceConfiguration;
use super::device::DeviceInfo;
use super::driver::Driver;
use super::error::LinkError;
use super::event::Event;
use super::options::StreamOptions;
use super::transport::Transport;

/// A session with a device whose valves, outputs and zeros somebody operates by hand.
pub struct Direct<'a, T> {
    driver: Driver<'a, T>,
    options: &'a StreamOptions<'a>,
    device: DeviceInfo,
}

impl<'a, T: Transport> Direct<'a, T> {
    /// Opens a session with the device behind `transport`. `on_event` is called for everything as it happens.
    ///
    /// # Errors
    /// [`LinkError`].
    pub fn open(
        transport: &'a mut T,
        options: &'a StreamOptions<'a>,
        on_event: &'a mut dyn FnMut(&mut T, Event),
    ) -> Result<Self, LinkError> {
        let mut driver = Driver::new(transport, options, on_event);
        let device = DeviceInfo::from(&driver.hello()?);
        Ok(Self { driver, options, device })
    }

    /// The device, as it answered.
    pub fn device(&self) -> &DeviceInfo {
        &self.device
    }

    /// The latest state that it told, if it has told one since the last request.
    pub fn state(&self) -> Option<DeviceState> {
        self.driver.session.state()
    }

    /// Its latest measurements.
    pub fn telemetry(&self) -> Option<&Telemetry> {
        self.driver.session.telemetry()
    }

    /// Configures it and waits until it is ready; the hash of the configuration.
    ///
    /// # Errors
    /// [`LinkError`].
    pub fn configure(&mut self, configuration: &DeviceConfiguration) -> Result<u32, LinkError> {
        let (upload, config_hash) = configuration.upload(self.options.session)?;
        upload.iter().try_for_each(|message| self.driver.demand(message))?;
        self.driver.tell(Event::Configured { config_hash });
        self.wait_until_ready()?;
        Ok(config_hash)
    }

    /// Lets time pass, us, with all that a session needs meanwhile.
    ///
    /// # Errors
    /// [`LinkError`].
    pub fn wait(&mut self, time_us: u64) -> Result<(), LinkError> {
        self.driver.until(time_us, |_| false).map(|_| ())
    }

    /// Opens one valve for a time, us; it closes by itself, and this does not wait for it. A device that fills holds until it is vented.
    ///
    /// # Errors
    /// [`LinkError`]; the device refuses where it is neither ready nor holding, and what it cannot do.
    pub fn pulse(&mut self, channel: u8, direction: PulseDirection, duration_us: u32) -> Result<(), LinkError> {
        let (session, direction) = (self.options.session, direction.into());
        self.demand(ManualPulse { session, channel, direction, duration_us })
    }

    /// Switches the digital outputs.
    ///
    /// # Errors
    /// [`LinkError`]; the device refuses where it is neither ready nor holding.
    pub fn set_outputs(&mut self, outputs: Outputs) -> Result<(), LinkError> {
        self.demand(SetOutputs { session: self.options.session, outputs })
    }

    /// Has a ready device take the zeros of its sensors anew, and waits until it has.
    ///
    /// # Errors
    /// [`LinkError`]; the device refuses where it is not ready, or a chamber is under pressure.
    pub fn zero(&mut self) -> Result<(), LinkError> {
        self.driver.command(CommandCode::Zero)?;
        self.wait_until_ready()
    }

    /// Lets all pressures down and waits until the device is ready again.
    ///
    /// # Errors
    /// [`LinkError`].
    pub fn vent(&mut self) -> Result<(), LinkError> {
        self.driver.command(CommandCode::Vent)?;
        let waited_us = self.options.vent_max_us;
        self.driver.until_state(&[DeviceState::Ready], waited_us, |_| LinkError::StillPressurized { waited_us })
    }

    fn demand(&mut self, message: impl Into<HostMessage>) -> Result<(), LinkError> {
        self.driver.demand(&message.into())
    }

    fn wait_until_ready(&mut self) -> Result<(), LinkError> {
        let waited_us = self.options.ready_max_us;
        self.driver.until_state(&[DeviceState::Ready], waited_us, |driver| LinkError::NotReady {
            waited_us,
            state: driver.session.state(),
            fault: driver.known_fault(),
        })
    }
}
