//! `softlimb device monitor`: live measurements in the terminal.

use std::io::{IsTerminal, stdout};
use std::ops::ControlFlow;

use clap::Args;
use serde::Serialize;

use super::super::interrupt::interrupt;
use super::super::port::MeasuringDevice;
use super::super::shared::{quantity, show};
use super::super::{Failure, Outcome, note, say};
use super::screen::Screen;
use softlimb_rig::link::{DeviceFault, Event, code_name, fault_names, listen, valve_supply_v};
use softlimb_scene::Quantity;

/// Longest time without a measurement, us.
const SILENCE_MAX_US: u64 = 3_000_000;

/// Show the measurements of a device while they come: state, pressures, valves, faults in words
#[derive(Args)]
#[command(
    after_help = "Says nothing to the device, which must have a configuration; --scene gives it one. A terminal shows a screen with the last\n\
                  pressures of each channel; elsewhere there is one line a period. Ctrl-C ends it.\n\n\
                  Examples:\n  softlimb device monitor --port /dev/ttyACM0\n  \
                  softlimb device monitor --port tcp:127.0.0.1:7000 --period 1s --lines 10 --json"
)]
pub(super) struct Monitor {
    #[command(flatten)]
    device: MeasuringDevice,
    /// Time between two lines or screens, by the device's clock
    #[arg(long, value_parser = quantity("s", 0.0, 3600.0), default_value = "0.2s")]
    period: Quantity,
    /// End after so many lines or screens
    #[arg(long, value_name = "N")]
    lines: Option<u32>,
    /// Print one JSON object a line
    #[arg(long)]
    json: bool,
}

/// One line, as `--json` prints it. Pressures are gauge, Pa.
#[derive(Serialize)]
pub(super) struct Line {
    /// Time since the device's start, s.
    pub(super) time_s: f64,
    pub(super) state: String,
    pub(super) supply_pa: f64,
    /// Voltage of the valves' supply, V; `None` if the board does not sense it.
    pub(super) valve_supply_v: Option<f64>,
    pub(super) pressures_pa: Vec<f64>,
    pub(super) references_pa: Vec<f64>,
    /// Share of the control period that a valve is open: + fill, - vent.
    pub(super) duties: Vec<f64>,
    /// Latched faults in words.
    pub(super) faults: Vec<String>,
}

impl Line {
    /// The device's time, us, and what it measured then; `None` of another event.
    fn of(event: &Event) -> Option<(u64, Self)> {
        let Event::Telemetry { message, .. } = event else { return None };
        let channels = message.channels.iter();
        let line = Self {
            time_s: message.time_us as f64 * 1e-6,
            state: code_name(message.state),
            supply_pa: 10.0 * f64::from(message.supply_10pa),
            valve_supply_v: valve_supply_v(message),
            pressures_pa: channels.clone().map(|channel| 10.0 * f64::from(channel.pressure_10pa)).collect(),
            references_pa: channels.clone().map(|channel| 10.0 * f64::from(channel.reference_10pa)).collect(),
            duties: channels.map(|channel| f64::from(channel.duty) / 127.0).collect(),
            faults: fault_names(message.fault_bits),
        };
        Some((message.time_us, line))
    }

    /// The voltage of the valves' supply as text; empty if the board does not sense it.
    pub(super) fn valves(&self) -> String {
        self.valve_supply_v.map_or_else(String::new, |volts| format!("  valves {volts:.1} V"))
    }

    /// As one line of text; pressures in kPa.
    pub(super) fn text(&self) -> String {
        let kpa: Vec<String> = self.pressures_pa.iter().map(|pressure| format!("{:.1}", pressure * 1e-3)).collect();
        let faults = if self.faults.is_empty() { String::new() } else { format!("  {}", self.faults.join(", ")) };
        let (time_s, supply, valves) = (self.time_s, self.supply_pa * 1e-3, self.valves());
        format!("{time_s:.3} s  {}  supply {supply:.1}{valves}  {}{faults}", self.state, kpa.join(" "))
    }
}

impl Monitor {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let stop = interrupt()?;
        let mut port = self.device.open()?;
        let period_us = (self.period.si() * 1e6) as u64;
        let mut screen = (stdout().is_terminal() && !self.json).then(Screen::default);
        let (mut next_us, mut shown, mut failure) = (0, 0, None);
        listen(&mut port, SILENCE_MAX_US, &stop, |event| {
            if let Event::Fault { message, .. } = &event {
                let fault = DeviceFault::from(message);
                screen.as_mut().map_or_else(|| note(&format!("fault: {fault}")), |screen| screen.fault(&fault));
            }
            let Some((time_us, line)) = Line::of(&event) else { return ControlFlow::Continue(()) };
            // A clock that falls is that of a device that has started anew.
            if time_us < next_us && time_us + period_us >= next_us {
                return ControlFlow::Continue(());
            }
            next_us = time_us + period_us;
            shown += 1;
            failure = self.print(&line, screen.as_mut()).err();
            if failure.is_some() || self.lines == Some(shown) {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })
        .map_err(Failure::new)?;
        failure.map_or(Ok(Outcome::Done), Err)
    }

    fn print(&self, line: &Line, screen: Option<&mut Screen>) -> Result<(), Failure> {
        match screen {
            Some(screen) => say(&screen.draw(line)),
            None => show(self.json, line, || line.text()),
        }
    }
}
