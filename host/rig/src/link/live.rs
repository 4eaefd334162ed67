//! Streams setpoints that an operator makes while they are sent.
//!
//! Knots are sent a short lead ahead of the device's clock. When the lead runs out, the device holds. The stream then restarts at the held
//! setpoints and leads to those of the pilot.

use softlimb_protocol::{DeviceState, ResultCode};

use super::configuration::DeviceConfiguration;
use super::driver::Driver;
use super::error::LinkError;
use super::event::Event;
use super::options::StreamOptions;
use super::run::Run;
use super::stream::{Ending, Summary, greet, summary};
use super::trajectory::{Knot, Trajectory};
use super::transport::Transport;

/// Lead of the knots over the device's clock, us: the longest pause of the host that does no harm.
const LEAD_US: u64 = 120_000;
/// Time between two knots, us.
const PERIOD_US: u64 = 20_000;
/// Time for which the first setpoints of a pilot hold, us.
pub(crate) const START_US: u64 = LEAD_US + PERIOD_US;
/// Longest time between two looks at the pilot, us.
const LOOK_US: u64 = 1_000;
/// Longest time until the host learns that a device without knots holds, us: more than the lead and the delay of the message.
const HELD_US: u64 = 1_000_000;
/// Largest delay of the message that the device has started, us.
const START_NEWS_US: u64 = 500_000;
/// Duration of the move from the held setpoints to those of the pilot, us: longer than the lead.
const RESUMED_US: u64 = 500_000;

/// The next thing to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Go on. A vented device stays vented.
    Nothing,
    /// Send a knot at once, because there was an order. A vented device goes on.
    Move,
    /// Let the pressures down.
    Vent,
    /// Let the pressures down and end the session.
    End,
}

/// Makes setpoints. Times are of the device's clock since the first start, us.
pub trait Pilot {
    /// Looks at the hand, at a time of the transport's clock, us.
    fn look(&mut self, now_us: u64) -> Wish;

    /// The knot at a time, which never decreases.
    fn knot(&mut self, time_us: u64) -> Knot;

    /// Called after all due knots have been sent, at a time of the transport's clock, us.
    fn sent(&mut self, now_us: u64);

    /// The device holds by itself: the pilot must stop moving.
    fn stop(&mut self);

    /// The limb is vented: setpoints begin anew from rest.
    fn vented(&mut self);
}

/// Follows a pilot on the device behind `transport`, and vents the limb at the end if the options say so, after an error in any case.
///
/// `on_event` is called as [`stream`](super::stream()) does; there is an [`Event::Armed`] at each start, and the first one is the zero of all times.
///
/// # Errors
/// [`LinkError`], as [`stream`](super::stream()).
pub fn live<T: Transport>(
    transport: &mut T,
    configuration: &DeviceConfiguration,
    options: &StreamOptions<'_>,
    pilot: &mut dyn Pilot,
    mut on_event: impl FnMut(&mut T, Event),
) -> Result<Summary, LinkError> {
    let (upload, config_hash) = configuration.upload(options.session)?;
    let mut driver = Driver::new(transport, options, &mut on_event);
    let device = greet(&mut driver, configuration)?;
    driver.tell(Event::Connected(device.clone()));
    let supply_min_pa = f64::from(configuration.system.supply_min_pa);
    let mut run =
        Run { driver, options, device, upload, config_hash, supply_min_pa, length_us: LEAD_US, start_us: None };
    run.make_safe()?;
    let mut live = Live { run, pilot, zero_us: None, start_us: 0, last_us: 0 };
    let ending = match live.whole() {
        Ok(()) => Ok(Ending::Completed),
        Err(cause) => live.run.give_up(cause).map(|()| Ending::Canceled),
    };
    let mut run = live.run;
    let statistics = run.driver.session.statistics();
    run.driver.tell(Event::Closed(statistics));
    summary(run, ending?)
}

struct Live<'a, 'p, T> {
    run: Run<'a, T>,
    pilot: &'p mut dyn Pilot,
    /// Device time of the first start, us.
    zero_us: Option<u64>,
    /// Device time of the present start, us.
    start_us: u64,
    /// Time of the last knot since the first start, us.
    last_us: u64,
}

/// Why the stream of knots ended.
enum Pause {
    /// The device holds, by itself.
    Held,
    Wish(Wish),
}

impl<T: Transport> Live<'_, '_, T> {
    fn whole(&mut self) -> Result<(), LinkError> {
        self.run.configure()?;
        self.run.get_ready()?;
        let mut from = self.pilot.knot(0);
        loop {
            self.start(&from)?;
            let pause = match self.follow() {
                Err(LinkError::KnotRefused { result, .. }) if result == ResultCode::Late => self.held()?,
                other => other?,
            };
            match pause {
                Pause::Held => {
                    // Knots on their way would come too late.
                    self.run.driver.session.close_window();
                    self.pilot.stop();
                    let held = self.run.driver.session.window().last_accepted();
                    from = held.map_or(from, |knot| Knot {
                        values: knot.values.to_vec(),
                        time_us: 0,
                        outputs: knot.outputs,
                    });
                }
                Pause::Wish(wish) => {
                    self.vent(wish)?;
                    if wish == Wish::End || self.rest()? == Wish::End {
                        self.run.driver.tell(Event::Finished);
                        return Ok(());
                    }
                    from = self.pilot.knot(self.last_us);
                }
            }
        }
    }

    /// Starts the device at given setpoints, with those of the pilot behind them.
    fn start(&mut self, from: &Knot) -> Result<(), LinkError> {
        // A lost link is latched, and forbids a start.
        self.run.clear_faults()?;
        self.run.flush()?;
        let wanted = self.pilot.knot(self.last_us);
        let first_us = if wanted.values == from.values { LEAD_US } else { RESUMED_US };
        let knots = [Knot { time_us: 0, ..from.clone() }, Knot { time_us: first_us, ..wanted }];
        let trajectory = Trajectory::new(&knots, from.values.len(), PERIOD_US)?;
        self.run.driver.session.load(trajectory);
        self.start_us = self.run.arm()?;
        let zero_us = *self.zero_us.get_or_insert(self.start_us);
        self.last_us = self.start_us - zero_us + first_us + PERIOD_US;
        // The last knot is there twice, once by the trajectory.
        self.pilot.knot(self.last_us);
        Ok(())
    }

    /// Sends the pilot's knots until he wishes something else, or the device holds.
    fn follow(&mut self) -> Result<Pause, LinkError> {
        let mut has_run = false;
        loop {
            match self.run.driver.session.state() {
                Some(DeviceState::Running) => has_run = true,
                Some(DeviceState::Holding) if has_run => return Ok(Pause::Held),
                // It may have started and run out of knots without a message.
                Some(DeviceState::Holding) if self.is_overdue()? => return Ok(Pause::Held),
                Some(DeviceState::Ready) if !has_run && self.is_overdue()? => {
                    return Err(LinkError::NotStarted { fault: self.run.driver.fault_news() });
                }
                Some(DeviceState::Ready | DeviceState::Holding) if !has_run => {}
                None => {}
                _ => return Err(self.run.why_stopped()),
            }
            let wish = self.pilot.look(self.run.driver.now_us());
            match wish {
                Wish::Vent | Wish::End => return Ok(Pause::Wish(wish)),
                Wish::Move => self.push()?,
                Wish::Nothing => {}
            }
            let device_us = self.run.driver.device_now_us()?.saturating_sub(self.zero_us.unwrap_or(0));
            while self.last_us < device_us.saturating_add(LEAD_US) {
                self.push()?;
            }
            self.run.driver.send()?;
            let now_us = self.run.driver.now_us();
            self.pilot.sent(now_us);
            self.run.driver.turn(now_us + LOOK_US)?;
        }
    }

    /// Whether the device should have started by now.
    fn is_overdue(&mut self) -> Result<bool, LinkError> {
        Ok(self.run.driver.device_now_us()? > self.start_us.saturating_add(START_NEWS_US))
    }

    /// Waits until a device that refuses late knots has used up its knots.
    fn held(&mut self) -> Result<Pause, LinkError> {
        self.run.driver.session.close_window();
        let stopped = |driver: &Driver<'_, T>| LinkError::Stopped { state: driver.session.state() };
        self.run.driver.until_state(&[DeviceState::Holding], HELD_US, stopped)?;
        Ok(Pause::Held)
    }

    fn push(&mut self) -> Result<(), LinkError> {
        self.last_us += PERIOD_US;
        let knot = self.pilot.knot(self.last_us);
        let offset_us = self.start_us - self.zero_us.unwrap_or(self.start_us);
        self.run.driver.session.push(&Knot { time_us: self.last_us - offset_us, ..knot })
    }

    fn vent(&mut self, wish: Wish) -> Result<(), LinkError> {
        self.run.driver.session.close_window();
        if wish == Wish::End {
            return self.run.end();
        }
        self.run.driver.settle(self.run.options.abort_max_us);
        self.run.begin_vent()?;
        self.pilot.vented();
        Ok(())
    }

    /// Waits until the pressures are down and the pilot wishes to go on or to end. Meanwhile it keeps asking the pilot.
    fn rest(&mut self) -> Result<Wish, LinkError> {
        let (mut is_at_rest, waited_us) = (false, self.run.options.vent_max_us);
        let until_us = self.run.driver.now_us().saturating_add(waited_us);
        loop {
            if !is_at_rest && self.run.driver.session.state() == Some(DeviceState::Ready) {
                is_at_rest = true;
                // It may be canceled again.
                self.run.driver.ending = false;
            }
            match self.pilot.look(self.run.driver.now_us()) {
                Wish::Move if is_at_rest => return Ok(Wish::Move),
                Wish::End => return self.run.wait_for_rest().map(|()| Wish::End),
                Wish::Nothing | Wish::Move | Wish::Vent => {}
            }
            let now_us = self.run.driver.now_us();
            if !is_at_rest && now_us > until_us {
                return Err(LinkError::StillPressurized { waited_us });
            }
            self.run.driver.turn(now_us + LOOK_US)?;
        }
    }
}
