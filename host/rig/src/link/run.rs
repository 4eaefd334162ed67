//! The steps of a run: make safe, configure, buffer, start, follow, vent; and what happens when one of them fails.

use softlimb_protocol::{CommandCode, DeviceState, HostMessage, ResultCode, SampleContent, SetSampling};

use super::device::DeviceInfo;
use super::driver::Driver;
use super::error::{LinkError, VentOutcome};
use super::event::Event;
use super::options::StreamOptions;
use super::sampling::Sampling;
use super::transport::Transport;

/// Largest delay of the news of a state, us.
const STATE_NEWS_US: u64 = 250_000;

/// States that a device starts from.
const STARTABLE: [DeviceState; 2] = [DeviceState::Ready, DeviceState::Holding];

/// A run on a device that has answered.
pub(super) struct Run<'a, T> {
    pub(super) driver: Driver<'a, T>,
    pub(super) options: &'a StreamOptions<'a>,
    pub(super) device: DeviceInfo,
    /// The upload of the configuration, and its hash.
    pub(super) upload: Vec<HostMessage>,
    pub(super) config_hash: u32,
    /// Lowest gauge pressure of the supply for running, Pa.
    pub(super) supply_min_pa: f64,
    /// Time of the last knot, us.
    pub(super) length_us: u64,
    /// Device time of the start, us.
    pub(super) start_us: Option<u64>,
}

impl<T: Transport> Run<'_, T> {
    /// From configuring to the end.
    pub(super) fn whole(&mut self) -> Result<(), LinkError> {
        self.configure()?;
        self.get_ready()?;
        let start_us = self.arm()?;
        self.follow(start_us)?;
        self.driver.session.close_window();
        self.driver.tell(Event::Finished);
        self.end()
    }

    /// Brings a device that was left under pressure or with a fault to where it can be configured.
    pub(super) fn make_safe(&mut self) -> Result<(), LinkError> {
        let state = self.driver.session.state();
        if state == Some(DeviceState::Faulted) {
            if !self.options.clear_faults {
                return Err(LinkError::LatchedFault { fault: self.driver.fault_news() });
            }
            self.clear_faults()?;
        }
        if matches!(state, Some(DeviceState::Running | DeviceState::Holding)) {
            self.driver.command(CommandCode::Vent)?;
        }
        let resting = [DeviceState::Idle, DeviceState::Ready];
        let waited_us = self.options.vent_max_us;
        self.driver.until_state(&resting, waited_us, |_| LinkError::StillPressurized { waited_us })
    }

    pub(super) fn clear_faults(&mut self) -> Result<(), LinkError> {
        self.driver.command(CommandCode::ClearFaults)?;
        self.driver.forget_faults();
        Ok(())
    }

    pub(super) fn configure(&mut self) -> Result<(), LinkError> {
        // A configuration ends measurements; a replay needs ticks from its first one on.
        self.request(SampleContent::Ticks)?;
        for message in &self.upload {
            self.driver.demand(message)?;
        }
        self.request(SampleContent::Measurements)?;
        self.driver.tell(Event::Configured { config_hash: self.config_hash });
        Ok(())
    }

    /// Requests the samples of the options, if they are of this content.
    fn request(&mut self, wanted: SampleContent) -> Result<(), LinkError> {
        let Some(Sampling { period_us, samples, content }) = self.options.sampling else { return Ok(()) };
        if content != wanted {
            return Ok(());
        }
        let content = content.into();
        self.driver.demand(&SetSampling { session: self.options.session, period_us, samples, content }.into())?;
        Ok(())
    }

    pub(super) fn get_ready(&mut self) -> Result<(), LinkError> {
        let waited_us = self.options.ready_max_us;
        let not_ready = |driver: &Driver<'_, T>| {
            let (state, fault) = (driver.session.state(), driver.known_fault());
            LinkError::NotReady { waited_us, state, fault }
        };
        self.driver.until_state(&[DeviceState::Ready], waited_us, not_ready)?;
        // A fault that did not stop the device may be left from an earlier run, and would forbid the start.
        self.clear_faults()?;
        self.driver.until_state(&[DeviceState::Ready], waited_us, not_ready)?;
        self.fill_supply(self.supply_min_pa)
    }

    fn fill_supply(&mut self, needed_pa: f64) -> Result<(), LinkError> {
        let supply_pa = |driver: &Driver<'_, T>| {
            driver.session.telemetry().map_or(0.0, |telemetry| f64::from(telemetry.supply_10pa) * 10.0)
        };
        let waited_us = self.options.supply_max_us;
        if self.driver.until(waited_us, |driver| supply_pa(driver) >= needed_pa)? {
            return Ok(());
        }
        Err(LinkError::NoSupply { found_pa: supply_pa(&self.driver), needed_pa, waited_us })
    }

    /// Buffers setpoints and sets the start; begins again with more lead when the line was too slow. The device time of the start.
    pub(super) fn arm(&mut self) -> Result<u64, LinkError> {
        let mut lead_us = self.options.lead_us;
        for _ in 0..self.options.attempts_max {
            let start_us = self.driver.device_now_us()?.saturating_add(lead_us);
            if self.try_to_arm(start_us)? {
                self.start_us = Some(start_us);
                self.driver.tell(Event::Armed { start_us, end_us: start_us + self.length_us });
                return Ok(start_us);
            }
            self.driver.session.close_window();
            self.driver.settle(self.options.abort_max_us);
            self.flush()?;
            lead_us = lead_us.saturating_mul(2);
        }
        Err(LinkError::TooSlow { attempts: self.options.attempts_max })
    }

    /// Flushes the device's knots, and returns its state.
    pub(super) fn flush(&mut self) -> Result<(), LinkError> {
        self.driver.command(CommandCode::Flush)?;
        let stopped = |driver: &Driver<'_, T>| LinkError::Stopped { state: driver.session.state() };
        self.driver.until_state(&STARTABLE, STATE_NEWS_US, stopped)
    }

    /// False when setpoints or start would have come too late.
    fn try_to_arm(&mut self, start_us: u64) -> Result<bool, LinkError> {
        let now_us = self.driver.now_us();
        self.driver.session.open_window(now_us, start_us, self.device.knots_capacity);
        let deadline_us = self.driver.clock()?.host_us(start_us);
        let buffer_us = self.options.buffer_us;
        let buffered = self.driver.until(deadline_us.saturating_sub(now_us), |driver| {
            let window = driver.session.window();
            let until_us = window.accepted_until_us().unwrap_or(0);
            window.is_filled() || until_us >= start_us.saturating_add(buffer_us) || !can_start(driver)
        });
        if !late_is_false(buffered)? {
            return Ok(false);
        }
        if !can_start(&self.driver) {
            return Err(self.why_stopped());
        }
        late_is_false(self.driver.start(start_us))
    }

    /// Streams until the last knot has passed.
    fn follow(&mut self, start_us: u64) -> Result<(), LinkError> {
        let end_us = start_us.saturating_add(self.length_us);
        let mut has_run = false;
        loop {
            let (now_us, clock) = (self.driver.now_us(), self.driver.clock()?);
            let device_us = self.driver.device_now_us()?;
            match self.driver.session.state() {
                // A host that overslept the end finds the device holding.
                Some(DeviceState::Running | DeviceState::Holding) if self.is_over(device_us, end_us) => {
                    return Ok(());
                }
                Some(DeviceState::Running) => has_run = true,
                Some(DeviceState::Ready) if !has_run && device_us < start_us + STATE_NEWS_US => {}
                Some(DeviceState::Ready) if !has_run => {
                    return Err(LinkError::NotStarted { fault: self.driver.fault_news() });
                }
                _ => return Err(self.why_stopped()),
            }
            self.driver.turn(clock.host_us(end_us).max(now_us + 1))?;
        }
    }

    fn is_over(&self, device_us: u64, end_us: u64) -> bool {
        device_us >= end_us && self.driver.session.window().is_complete()
    }

    pub(super) fn why_stopped(&mut self) -> LinkError {
        let state = self.driver.session.state();
        if state == Some(DeviceState::Faulted) {
            return LinkError::Fault { fault: self.driver.fault_news() };
        }
        let window = self.driver.session.window();
        if state == Some(DeviceState::Holding) && !window.is_complete() {
            return LinkError::Starved { accepted: window.accepted(), total: window.total() };
        }
        LinkError::Stopped { state }
    }

    /// Vents, or waits for the report of the last moment of the run where the options leave the device holding.
    pub(super) fn end(&mut self) -> Result<(), LinkError> {
        if self.options.vents {
            return self.vent();
        }
        let end_us = self.driver.device_now_us()?;
        let reported_us = |driver: &Driver<'_, T>| driver.session.telemetry().map_or(0, |telemetry| telemetry.time_us);
        self.driver.until(STATE_NEWS_US, |driver| reported_us(driver) >= end_us).map(drop)
    }

    /// Lets the pressures down and waits until the device is ready again.
    pub(super) fn vent(&mut self) -> Result<(), LinkError> {
        self.begin_vent()?;
        self.wait_for_rest()
    }

    pub(super) fn begin_vent(&mut self) -> Result<(), LinkError> {
        // The run is over: there is nothing left to cancel.
        self.driver.ending = true;
        self.driver.command(CommandCode::Vent).map(drop)
    }

    pub(super) fn wait_for_rest(&mut self) -> Result<(), LinkError> {
        let waited_us = self.options.vent_max_us;
        self.driver.until_state(&[DeviceState::Ready], waited_us, |_| LinkError::StillPressurized { waited_us })
    }

    /// Vents as well as can be; a canceled run that is vented is no error.
    pub(super) fn give_up(&mut self, cause: LinkError) -> Result<(), LinkError> {
        let at_us = self.run_time_of(&cause);
        self.driver.ending = true;
        self.driver.session.close_window();
        let vent = self.try_to_vent();
        let cause = match (cause, vent) {
            (LinkError::Canceled, VentOutcome::Venting) => match self.wait_for_rest() {
                Ok(()) => return Ok(()),
                Err(error) => error,
            },
            (cause, VentOutcome::Unconfirmed) => cause,
            (cause, VentOutcome::Venting | VentOutcome::ByDevice) => {
                // Whether it gets to rest in this time changes nothing about the cause.
                let _ = self.driver.until(self.options.aftermath_us, |driver| is_ready(driver));
                cause
            }
        };
        Err(LinkError::Run { at_us, vent, cause: Box::new(cause) })
    }

    /// When it happened: by the device, if it told, else now.
    fn run_time_of(&self, cause: &LinkError) -> Option<u64> {
        let told_us = match cause {
            LinkError::Fault { fault } => fault.and_then(|fault| fault.time_us),
            _ => None,
        };
        let now_us = || self.driver.session.clock().map(|clock| clock.device_us(self.driver.now_us()));
        told_us.or_else(now_us)?.checked_sub(self.start_us?)
    }

    fn try_to_vent(&mut self) -> VentOutcome {
        let ack = self.driver.try_command(CommandCode::Vent, self.options.abort_max_us);
        match ack.and_then(|ack| ack.result.known()) {
            Some(ResultCode::Ok) => VentOutcome::Venting,
            // It has faulted, or is venting already.
            Some(ResultCode::WrongState) => VentOutcome::ByDevice,
            _ => VentOutcome::Unconfirmed,
        }
    }
}

fn can_start<T: Transport>(driver: &Driver<'_, T>) -> bool {
    driver.session.state().is_some_and(|state| STARTABLE.contains(&state))
}

fn is_ready<T: Transport>(driver: &Driver<'_, T>) -> bool {
    driver.session.state() == Some(DeviceState::Ready)
}

/// Too late is not an error while a run can still begin again.
fn late_is_false(outcome: Result<bool, LinkError>) -> Result<bool, LinkError> {
    match outcome {
        Err(LinkError::KnotRefused { result, .. }) if result == ResultCode::Late => Ok(false),
        other => other,
    }
}
