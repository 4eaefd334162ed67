//! `softlimb device sensors`: what each pressure sensor reads, and how steadily.

use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

use clap::Args;
use serde::Serialize;

use super::super::port::MeasuringDevice;
use super::super::shared::{above_zero, show};
use super::super::{Failure, Outcome, warn};
use softlimb_rig::link::{Event, Transport, listen, status_names};
use softlimb_scene::Quantity;

/// Longest time without a measurement, us.
const SILENCE_MAX_US: u64 = 3_000_000;

/// Read every pressure sensor for a while: mean, scatter, lowest and highest value
#[derive(Args)]
#[command(
    after_help = "Without --scene it sends nothing to the device, and the device must have a configuration. With --scene, all vents open until the\n\
                  zeros are taken: after the first configuration since a reset, another sensor scale or another number of channels. A limb that\n\
                  holds a load drops it. The pump may run; the supply valve stays closed. A sensor that is not plausible is a warning.\n\n\
                  Examples:\n  softlimb device sensors --port /dev/ttyACM0\n  \
                  softlimb device sensors --port /dev/ttyACM0 --scene scenes/single-bending.toml"
)]
pub(super) struct Sensors {
    #[command(flatten)]
    device: MeasuringDevice,
    /// Time to measure
    #[arg(long, value_parser = above_zero("s", 3600.0), default_value = "1s")]
    time: Quantity,
    /// Print the readings as JSON
    #[arg(long)]
    json: bool,
}

/// Readings of one sensor. Pressures are gauge, Pa.
#[derive(Serialize)]
struct Reading {
    sensor: String,
    mean_pa: f64,
    deviation_pa: f64,
    lowest_pa: f64,
    highest_pa: f64,
    /// What is wrong with it.
    status: Vec<&'static str>,
}

/// Values of one sensor.
#[derive(Default)]
struct Values {
    pressures_pa: Vec<f64>,
    status: Vec<&'static str>,
}

impl Values {
    fn add(&mut self, pressure_10pa: u16, status: Vec<&'static str>) {
        self.pressures_pa.push(10.0 * f64::from(pressure_10pa));
        for word in status {
            if !self.status.contains(&word) {
                self.status.push(word);
            }
        }
    }

    fn reading(self, sensor: String) -> Reading {
        let count = self.pressures_pa.len() as f64;
        let mean_pa = self.pressures_pa.iter().sum::<f64>() / count;
        let variance = self.pressures_pa.iter().map(|value| (value - mean_pa).powi(2)).sum::<f64>() / count;
        Reading {
            sensor,
            mean_pa,
            deviation_pa: variance.sqrt(),
            lowest_pa: self.pressures_pa.iter().copied().fold(f64::INFINITY, f64::min),
            highest_pa: self.pressures_pa.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            status: self.status,
        }
    }
}

impl Sensors {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let mut port = self.device.open()?;
        let end_us = port.now_us() + (self.time.si() * 1e6) as u64;
        let (mut supply, mut channels) = (Values::default(), Vec::<Values>::new());
        listen(&mut port, SILENCE_MAX_US, &AtomicBool::new(false), |event| {
            let Event::Telemetry { host_time_us, message } = event else { return ControlFlow::Continue(()) };
            supply.add(message.supply_10pa, Vec::new());
            channels.resize_with(message.channels.len(), Values::default);
            for (values, sample) in channels.iter_mut().zip(message.channels.iter()) {
                values.add(sample.pressure_10pa, status_names(sample.status));
            }
            if host_time_us >= end_us { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .map_err(Failure::new)?;
        let numbered = channels.into_iter().enumerate();
        let mut readings = vec![supply.reading("supply".to_owned())];
        readings.extend(numbered.map(|(number, values)| values.reading(format!("channel {number}"))));
        show(self.json, &readings, || table(&readings))?;
        let wrong = |reading: &Reading| {
            (!reading.status.is_empty()).then(|| format!("{}: {}", reading.sensor, reading.status.join(", ")))
        };
        Ok(warn(&readings.iter().filter_map(wrong).collect::<Vec<_>>()))
    }
}

fn table(readings: &[Reading]) -> String {
    let heading = "sensor         mean, kPa  deviation    lowest   highest\n".to_owned();
    let row = |reading: &Reading| {
        let [mean, deviation, lowest, highest] =
            [reading.mean_pa, reading.deviation_pa, reading.lowest_pa, reading.highest_pa].map(|value| value * 1e-3);
        format!("{:12}  {mean:10.2}  {deviation:9.3}  {lowest:8.2}  {highest:8.2}\n", reading.sensor)
    };
    heading + &readings.iter().map(row).collect::<String>()
}
