//! A whole run in one call.

use super::clock::ClockMap;
use super::configuration::DeviceConfiguration;
use super::device::DeviceInfo;
use super::driver::Driver;
use super::error::LinkError;
use super::event::Event;
use super::options::StreamOptions;
use super::run::Run;
use super::statistics::LinkStatistics;
use super::trajectory::{Knot, Trajectory};
use super::transport::Transport;

/// For how long the device has a setpoint beyond the last knot, us: the time to tell it to vent.
const TAIL_US: u64 = 1_000_000;

/// End of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The last knot has passed.
    Completed,
    /// The user stopped it.
    Canceled,
}

/// Summary of a run. The limb is vented and the device ready, unless the options leave it holding.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The device.
    pub device: DeviceInfo,
    /// Hash of the configuration it ran on.
    pub config_hash: u32,
    /// End of the run.
    pub ending: Ending,
    /// Device time of the start, us; `None` if it was canceled before.
    pub start_us: Option<u64>,
    /// Setpoints that the device accepted, the last one counted twice: it is held until venting.
    pub setpoints: u32,
    /// The shortest stretch of setpoints buffered while more were to come, us; `None` when all fitted at once.
    pub buffered_min_us: Option<u64>,
    /// The device's clock.
    pub clock: ClockMap,
    /// Statistics of the link.
    pub statistics: LinkStatistics,
}

/// Runs `knots` on the device behind `transport` and vents the limb afterwards if the options say so, after an error in any case.
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
    let (upload, config_hash) = configuration.upload(options.session)?;
    let mut driver = Driver::new(transport, options, &mut on_event);
    let device = connect(&mut driver, configuration, &trajectory, options)?;
    driver.session.load(trajectory);
    let length_us = knots.last().map_or(0, |knot| knot.time_us);
    let supply_min_pa = f64::from(configuration.system.supply_min_pa);
    let mut run = Run { driver, options, device, upload, config_hash, supply_min_pa, length_us, start_us: None };
    run.make_safe()?;
    let ending = match run.whole() {
        Ok(()) => Ok(Ending::Completed),
        Err(cause) => run.give_up(cause).map(|()| Ending::Canceled),
    };
    let statistics = run.driver.session.statistics();
    run.driver.tell(Event::Closed(statistics));
    summary(run, ending?)
}

/// Opens the session and compares what is wanted with what the device can do.
fn connect<T: Transport>(
    driver: &mut Driver<'_, T>,
    configuration: &DeviceConfiguration,
    trajectory: &Trajectory,
    options: &StreamOptions<'_>,
) -> Result<DeviceInfo, LinkError> {
    let device = greet(driver, configuration)?;
    let capacity = device.knots_capacity;
    if let Some(span_us) = trajectory.shortest_span_us(usize::from(capacity))
        && span_us < options.buffer_us
    {
        return Err(LinkError::TooDense { capacity, span_us, needed_us: options.buffer_us });
    }
    driver.tell(Event::Connected(device.clone()));
    Ok(device)
}

/// Opens the session with a device that has enough channels.
pub(super) fn greet<T: Transport>(
    driver: &mut Driver<'_, T>,
    configuration: &DeviceConfiguration,
) -> Result<DeviceInfo, LinkError> {
    let device = DeviceInfo::from(&driver.hello()?);
    let (count, max) = (configuration.channels.len(), usize::from(device.channels_max));
    if count > max { Err(LinkError::ChannelCount { count, max }) } else { Ok(device) }
}

pub(super) fn summary<T: Transport>(mut run: Run<'_, T>, ending: Ending) -> Result<Summary, LinkError> {
    let clock = run.driver.clock()?;
    let session = &run.driver.session;
    Ok(Summary {
        device: run.device,
        config_hash: run.config_hash,
        ending,
        start_us: run.start_us,
        setpoints: session.window().accepted(),
        buffered_min_us: session.buffered_min_us(),
        clock,
        statistics: session.statistics(),
    })
}
