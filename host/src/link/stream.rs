//! A whole run: connect, configure, buffer, start, follow, vent.

use softlimb_protocol::{CommandCode, DeviceState, ResultCode};

use super::clock::ClockMap;
use super::configuration::DeviceConfiguration;
use super::device::DeviceInfo;
use super::driver::Driver;
use super::error::{LinkError, VentOutcome};
use super::event::Event;
use super::options::StreamOptions;
use super::statistics::LinkStatistics;
use super::trajectory::{Knot, Trajectory};
use super::transport::Transport;

/// For how long the device has a setpoint beyond the last knot, us: the time to tell it to vent.
const TAIL_US: u64 = 1_000_000;

/// How late the news of a state may be, us.
const STATE_NEWS_US: u64 = 250_000;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The last knot has passed.
    Completed,
    /// The user stopped it.
    Canceled,
}

/// What a run was. The limb is vented and the device ready.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The device.
    pub device: DeviceInfo,
    /// Hash of the configuration it ran on.
    pub config_hash: u32,
    /// How the run ended.
    pub ending: Ending,
    /// Device time of the start, us; `None` if it was canceled before.
    pub start_us: Option<u64>,
    /// Setpoints that the device accepted, the last one counted twice: it is held until venting.
    pub setpoints: u32,
    /// The shortest stretch of setpoints buffered while more were to come, us; `None` when all fitted at once.
    pub buffered_min_us: Option<u64>,
    /// The device's clock.
    pub clock: ClockMap,
    /// What the link did.
    pub statistics: LinkStatistics,
}

/// Runs `knots` on the device behind `transport` and vents the limb afterwards, whatever happens on the way.
///
/// `on_event` is called for everything as it happens, between two turns: it may use the transport, and while it takes its time the device
/// lives on its buffer.
///
/// # Errors
/// [`LinkError`]. Once the device is configured it is wrapped in [`LinkError::Run`], which says when it happened and whether venting
/// is confirmed.
pub fn stream<T: Transport>(
    transport: &mut T,
    configuration: &DeviceConfiguration,
    knots: &[Knot],
    options: &StreamOptions<'_>,
    mut on_event: impl FnMut(&mut T, Event),
) -> Result<Summary, LinkError> {
    let trajectory = Trajectory::new(knots, configuration.channels.len(), TAIL_US)?;
    let mut driver = Driver::new(transport, options, &mut on_event);
    let device = connect(&mut driver, configuration, &trajectory, options)?;
    let mut run =
        Run { driver, options, device, start_us: None, length_us: knots.last().map_or(0, |knot| knot.time_us) };
    run.driver.session.load(trajectory);
    run.make_safe()?;
    match run.whole(configuration) {
        Ok(config_hash) => run.summary(config_hash, Ending::Completed),
        Err(cause) => run.give_up(cause, configuration),
    }
}

/// Opens the session and compares what is wanted with what the device can do.
fn connect<T: Transport>(
    driver: &mut Driver<'_, T>,
    configuration: &DeviceConfiguration,
    trajectory: &Trajectory,
    options: &StreamOptions<'_>,
) -> Result<DeviceInfo, LinkError> {
    let device = DeviceInfo::from(&driver.hello()?);
    let (count, max) = (configuration.channels.len(), usize::from(device.channels_max));
    if count > max {
        return Err(LinkError::ChannelCount { count, max });
    }
    let capacity = device.knots_capacity;
    if let Some(span_us) = trajectory.shortest_span_us(usize::from(capacity))
        && span_us < options.buffer_us
    {
        return Err(LinkError::TooDense { capacity, span_us, needed_us: options.buffer_us });
    }
    driver.tell(Event::Connected(device.clone()));
    Ok(device)
}

struct Run<'a, T> {
    driver: Driver<'a, T>,
    options: &'a StreamOptions<'a>,
    device: DeviceInfo,
    /// Device time of the start.
    start_us: Option<u64>,
    length_us: u64,
}

impl<T: Transport> Run<'_, T> {
    fn whole(&mut self, configuration: &DeviceConfiguration) -> Result<u32, LinkError> {
        let config_hash = self.configure(configuration)?;
        self.get_ready(configuration)?;
        let start_us = self.arm()?;
        self.follow(start_us)?;
        self.driver.session.close_window();
        self.driver.tell(Event::Finished);
        self.vent()?;
        Ok(config_hash)
    }

    /// Brings a device that was left under pressure or with a fault to where it can be configured.
    fn make_safe(&mut self) -> Result<(), LinkError> {
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

    fn clear_faults(&mut self) -> Result<(), LinkError> {
        self.driver.command(CommandCode::ClearFaults)?;
        self.driver.forget_faults();
        Ok(())
    }

    fn configure(&mut self, configuration: &DeviceConfiguration) -> Result<u32, LinkError> {
        let (messages, config_hash) = configuration.upload(self.driver.session.id())?;
        for message in &messages {
            self.driver.demand(message)?;
        }
        self.driver.tell(Event::Configured { config_hash });
        Ok(config_hash)
    }

    fn get_ready(&mut self, configuration: &DeviceConfiguration) -> Result<(), LinkError> {
        let waited_us = self.options.ready_max_us;
        let not_ready = |driver: &Driver<'_, T>| {
            let (state, fault) = (driver.session.state(), driver.known_fault());
            LinkError::NotReady { waited_us, state, fault }
        };
        self.driver.until_state(&[DeviceState::Ready], waited_us, not_ready)?;
        // A fault that did not stop the device may be left from an earlier run, and would forbid the start.
        self.clear_faults()?;
        self.driver.until_state(&[DeviceState::Ready], waited_us, not_ready)?;
        self.fill_supply(f64::from(configuration.system.supply_min_pa))
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
    fn arm(&mut self) -> Result<u64, LinkError> {
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
            self.driver.command(CommandCode::Flush)?;
            self.driver.until_state(&[DeviceState::Ready], STATE_NEWS_US, |driver| LinkError::Stopped {
                state: driver.session.state(),
            })?;
            lead_us = lead_us.saturating_mul(2);
        }
        Err(LinkError::TooSlow { attempts: self.options.attempts_max })
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
            window.is_filled() || until_us >= start_us.saturating_add(buffer_us) || !is_ready(driver)
        });
        if !late_is_false(buffered)? {
            return Ok(false);
        }
        if !is_ready(&self.driver) {
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
            let device_us = clock.device_us(now_us);
            match self.driver.session.state() {
                // A host that overslept the end finds the device holding.
                Some(DeviceState::Running | DeviceState::Holding) if self.is_over(device_us, end_us) => return Ok(()),
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

    fn why_stopped(&mut self) -> LinkError {
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

    /// Lets the pressures down and waits until the device is ready again.
    fn vent(&mut self) -> Result<(), LinkError> {
        self.driver.command(CommandCode::Vent)?;
        self.wait_for_rest()
    }

    fn wait_for_rest(&mut self) -> Result<(), LinkError> {
        let waited_us = self.options.vent_max_us;
        self.driver.until_state(&[DeviceState::Ready], waited_us, |_| LinkError::StillPressurized { waited_us })
    }

    /// Vents as well as can be; a canceled run then has a summary, all else an error.
    fn give_up(mut self, cause: LinkError, configuration: &DeviceConfiguration) -> Result<Summary, LinkError> {
        let at_us = self.run_time_of(&cause);
        self.driver.ending = true;
        self.driver.session.close_window();
        let vent = self.try_to_vent();
        let cause = if matches!(cause, LinkError::Canceled) && vent == VentOutcome::Venting {
            match self.wait_for_rest() {
                Ok(()) => {
                    let (_, config_hash) = configuration.upload(self.driver.session.id())?;
                    return self.summary(config_hash, Ending::Canceled);
                }
                Err(error) => error,
            }
        } else {
            cause
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

    fn summary(mut self, config_hash: u32, ending: Ending) -> Result<Summary, LinkError> {
        let clock = self.driver.clock()?;
        let session = &self.driver.session;
        Ok(Summary {
            config_hash,
            ending,
            start_us: self.start_us,
            setpoints: session.window().accepted(),
            buffered_min_us: session.buffered_min_us(),
            clock,
            statistics: session.statistics(),
            device: self.device,
        })
    }
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
