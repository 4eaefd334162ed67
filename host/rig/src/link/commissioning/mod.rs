//! Commissioning of a device: link, sensors, supply and valves one after another, each step with a verdict.
//!
//! The steps move air: a channel is filled by pulses to 10 kPa or 30 % of its highest pressure, whichever is less, watched with closed
//! valves, and vented. The test compares the flow of both valves with the device's own model, and watches all faults of the device.

mod flow;
mod probe;
mod step;

use std::cell::RefCell;

use softlimb_protocol::{BootCause, DeviceState};

use super::configuration::DeviceConfiguration;
use super::direct::Direct;
use super::error::LinkError;
use super::event::Event;
use super::options::StreamOptions;
use super::transport::Transport;
use super::words::code_name;
use probe::{Probe, mean_pa, rise_pa, scatter_pa, supply_pa};

use step::{Finding, failed, passed};
pub use step::{Step, StepKind, Verdict};

/// Time over which a sensor is read, us.
const SENSOR_US: u64 = 500_000;
/// Largest reading of an empty chamber, and largest standard deviation of a sensor, Pa.
const EMPTY_PA: f64 = 1_000.0;
const SCATTER_PA: f64 = 500.0;
/// Longest wait for a supply that does not rise, us, and the least rise in that time, Pa.
const SUPPLY_US: u64 = 5_000_000;
const SUPPLY_RISE_PA: f64 = 1_000.0;
/// Time for which closed valves are watched, us, and the largest change of a chamber meanwhile, Pa.
const CLOSED_US: u64 = 1_000_000;
const CLOSED_PA: f64 = 500.0;

/// Commissions the device behind `transport` for a configuration. `on_step` is called after each step. A step that fails ends what depends on it,
/// which is then left out; the pressures are let down at the end.
pub fn commission<T: Transport>(
    transport: &mut T,
    configuration: &DeviceConfiguration,
    options: &StreamOptions<'_>,
    on_step: &mut dyn FnMut(&Step),
) -> Vec<Step> {
    let heard = RefCell::new(Vec::new());
    let mut on_event = |_: &mut T, event| {
        if let Event::Telemetry { message, .. } = event {
            heard.borrow_mut().push(message);
        }
    };
    let mut steps = Steps { done: Vec::new(), on_step };
    match Direct::open(transport, options, &mut on_event) {
        Ok(hand) => whole(&mut Probe::new(hand, &heard), configuration, options, &mut steps),
        Err(error) => steps.failed(StepKind::Link, None, error.to_string()),
    }
    steps.leave_out(configuration.channels.len());
    steps.done
}

/// The steps so far.
struct Steps<'a> {
    done: Vec<Step>,
    on_step: &'a mut dyn FnMut(&Step),
}

impl Steps<'_> {
    /// Notes a step; whether it passed.
    fn add(&mut self, kind: StepKind, channel: Option<u8>, finding: Finding) -> bool {
        let step = Step::new(kind, channel, finding);
        (self.on_step)(&step);
        let has_passed = step.verdict == Verdict::Passed;
        self.done.push(step);
        has_passed
    }

    fn failed(&mut self, kind: StepKind, channel: Option<u8>, text: String) {
        self.add(kind, channel, failed(text));
    }

    /// Names the steps that were not taken.
    fn leave_out(&mut self, channels: usize) {
        for (kind, channel) in step::all(channels) {
            if !self.done.iter().any(|step| (step.kind, step.channel) == (kind, channel)) {
                let left_out = Step::left_out(kind, channel);
                (self.on_step)(&left_out);
                self.done.push(left_out);
            }
        }
    }
}

fn whole<T: Transport>(
    probe: &mut Probe<'_, '_, T>,
    configuration: &DeviceConfiguration,
    options: &StreamOptions<'_>,
    steps: &mut Steps<'_>,
) {
    if !steps.add(StepKind::Link, None, link(probe)) {
        return;
    }
    let configured = probe.hand.configure(configuration);
    if let Err(error) = &configured
        && !matches!(error, LinkError::NotReady { .. })
    {
        return steps.failed(StepKind::Configuration, None, error.to_string());
    }
    let model = match configuration.active() {
        Ok(model) => model,
        Err(error) => return steps.failed(StepKind::Configuration, None, error.to_string()),
    };
    steps.add(StepKind::Configuration, None, passed(format!("{} channels", configuration.channels.len())));
    if !sensors(probe, configured, configuration.channels.len(), steps) {
        return;
    }
    let supply = supply(probe, configuration, options.supply_max_us);
    if steps.add(StepKind::Supply, None, supply) && closed(probe, configuration.channels.len(), steps) {
        for index in 0..configuration.channels.len() as u8 {
            probe.channel(index, &model, |kind, finding| steps.add(kind, Some(index), finding));
        }
    }
    let down = probe.down();
    steps.add(StepKind::Down, None, down);
}

/// The device's answer, its last start and its state.
fn link<T: Transport>(probe: &Probe<'_, '_, T>) -> Finding {
    let device = probe.hand.device();
    let text = format!(
        "firmware {}, {} channels, last start: {}, {}",
        device.firmware,
        device.channels_max,
        code_name(device.boot_cause),
        code_name(device.state),
    );
    let stopped = matches!(
        device.boot_cause.known(),
        Some(
            BootCause::Watchdog
                | BootCause::Panic
                | BootCause::HardFault
                | BootCause::BrownOut
                | BootCause::ClockFailure
                | BootCause::ImageDamaged
        )
    );
    let is_at_rest = matches!(device.state.known(), Some(DeviceState::Idle | DeviceState::Ready));
    if stopped || !is_at_rest { failed(text) } else { passed(text) }
}

/// Each sensor at an empty limb; whether the device is ready.
fn sensors<T: Transport>(
    probe: &mut Probe<'_, '_, T>,
    configured: Result<u32, LinkError>,
    channels: usize,
    steps: &mut Steps<'_>,
) -> bool {
    let heard = probe.observe(SENSOR_US);
    let fault = match &configured {
        Err(LinkError::NotReady { fault, .. }) => *fault,
        _ => None,
    };
    let mut all = true;
    for index in 0..channels {
        let (mean_pa, scatter_pa) = (mean_pa(&heard, index), scatter_pa(&heard, index));
        let text = format!("{:.2} kPa, deviation {:.3} kPa", mean_pa * 1e-3, scatter_pa * 1e-3);
        let is_plausible = heard.last().is_some_and(|last| probe::is_plausible(last, index));
        let has_fault = fault.is_some_and(|fault| fault.channel == Some(index as u8));
        let finding = match fault {
            _ if !is_plausible => failed("implausible: outside of 2.5 to 97.5 % of its converter".to_owned()),
            Some(fault) if has_fault => failed(fault.to_string()),
            // Not a number fails too.
            _ if rise_pa(&heard, index) > SCATTER_PA => {
                failed(probe.with_faults(format!("{text}: it rises with closed valves")))
            }
            _ if !(mean_pa.abs() <= EMPTY_PA && scatter_pa <= SCATTER_PA) => failed(probe.with_faults(text)),
            _ => passed(text),
        };
        all &= steps.add(StepKind::Sensor, Some(index as u8), finding);
    }
    if let (true, Err(error)) = (all, &configured) {
        steps.failed(StepKind::Ready, None, error.to_string());
    }
    configured.is_ok() && all
}

/// The supply, once it no longer rises.
fn supply<T: Transport>(probe: &mut Probe<'_, '_, T>, configuration: &DeviceConfiguration, limit_us: u64) -> Finding {
    let range_pa = [configuration.system.supply_min_pa, configuration.system.supply_max_pa].map(f64::from);
    let (mut found_pa, mut waited_us) = (supply_pa(&probe.observe(SENSOR_US)), SENSOR_US);
    while found_pa < range_pa[0] && waited_us < limit_us {
        let before_pa = std::mem::replace(&mut found_pa, supply_pa(&probe.observe(SUPPLY_US)));
        waited_us += SUPPLY_US;
        if found_pa - before_pa < SUPPLY_RISE_PA {
            break;
        }
    }
    let [found, low, high] = [found_pa, range_pa[0], range_pa[1]].map(|pressure_pa| pressure_pa * 1e-3);
    let text = format!("{found:.1} kPa, allowed {low:.1} to {high:.1} kPa");
    if (low..=high).contains(&found) { passed(text) } else { failed(probe.with_faults(text)) }
}

/// Each chamber while all valves are closed and the supply is on.
fn closed<T: Transport>(probe: &mut Probe<'_, '_, T>, channels: usize, steps: &mut Steps<'_>) -> bool {
    if let Err(error) = probe.open_supply() {
        return steps.add(StepKind::Closed, None, failed(probe.with_faults(error.to_string())));
    }
    let heard = probe.observe(CLOSED_US);
    let mut all = true;
    for index in 0..channels {
        let change_pa = rise_pa(&heard, index);
        let text = format!("{:+.2} kPa in 1 s", change_pa * 1e-3);
        let finding = if change_pa.abs() <= CLOSED_PA { passed(text) } else { failed(probe.with_faults(text)) };
        all &= steps.add(StepKind::Closed, Some(index as u8), finding);
    }
    all && probe.is_ready()
}
