//! Samples beside the telemetry, and the share of a line that they take.

use softlimb_protocol::{
    Ack, Batch, ChannelSample, ChannelStatus, Code, DeviceMessage, DeviceState, HeartbeatReply, List, MAX_FRAME_LEN,
    Outputs, PressureSample, ResultCode, Sample, SampleContent, Samples, Telemetry, Tick, TickFlags, Ticks,
    encode_frame,
};

/// Longest time that a sample waits for its message to be full, us.
const MESSAGE_MAX_US: u32 = 100_000;
/// Largest share of a line to the host; the rest is for repetitions and faults.
const SHARE_MAX: f64 = 0.85;
/// Bits of a byte on the line.
const BITS: f64 = 10.0;
/// Length of a control tick, us, and the longest period of samples.
const TICK_US: u32 = 1_000;
const PERIOD_MAX_US: u32 = 10_000_000;

/// Samples that a user requests beside the telemetry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleRequest {
    /// Pressures and duties, each so often, us.
    Measurements(u32),
    /// Converter codes of every control tick, for a replay.
    Codes,
}

/// Samples of all channels, several in one message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Time between two samples, us; whole milliseconds, at most 10 s.
    pub period_us: u32,
    /// Samples in one message; at least 1, at most [`Samples::most`] or [`Ticks::most`] of the channels.
    pub samples: u8,
    /// Their content.
    pub content: SampleContent,
}

/// Traffic to the host beside the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traffic {
    /// Channels of the configuration.
    pub channels: usize,
    /// Time between two telemetry messages, us.
    pub telemetry_us: u32,
    /// Time between two knots, each answered in the worst case by itself, us.
    pub knot_us: u64,
    /// Time between two heartbeats, us.
    pub heartbeat_us: u64,
}

/// Samples that a line or a device cannot carry.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SamplingError {
    /// Not whole ticks of the device.
    #[error("the sample period is {period_us} us: allowed are whole milliseconds from 1 ms to 10 s")]
    Period {
        /// Time between two samples, us.
        period_us: u32,
    },
    /// More than the line carries.
    #[error(
        "{} of {channels} {} each {} ms take {:.0} % of a line of {baud} baud, telemetry and answers included, and at most {:.0} % are \
         allowed: {}choose a higher baud or a longer telemetry period",
        if *content == SampleContent::Ticks { "converter codes" } else { "samples" },
        if *channels == 1 { "channel" } else { "channels" },
        period_us / TICK_US,
        100.0 * share,
        100.0 * SHARE_MAX,
        least_us.map_or_else(String::new, |us| format!("sample each {} ms or less often, or ", us / TICK_US))
    )]
    Line {
        /// Content of the samples.
        content: SampleContent,
        /// Channels.
        channels: usize,
        /// Time between two samples, us.
        period_us: u32,
        /// Bits per second of the line.
        baud: u32,
        /// Share of the line that all messages to the host take.
        share: f64,
        /// The shortest period that the line carries, us, if it carries one.
        least_us: Option<u32>,
    },
}

impl Sampling {
    /// Samples for a line of some baud; `None` for a connection that is no such line.
    ///
    /// # Errors
    /// [`SamplingError`].
    pub fn new(request: SampleRequest, traffic: &Traffic, baud: Option<u32>) -> Result<Self, SamplingError> {
        let (content, period_us) = match request {
            SampleRequest::Measurements(period_us) => (SampleContent::Measurements, period_us),
            SampleRequest::Codes => (SampleContent::Ticks, TICK_US),
        };
        if !(TICK_US..=PERIOD_MAX_US).contains(&period_us) || !period_us.is_multiple_of(TICK_US) {
            return Err(SamplingError::Period { period_us });
        }
        let wanted = Self::each(period_us, traffic.channels, content);
        let Some(baud) = baud else { return Ok(wanted) };
        let share = wanted.share(traffic, baud);
        if share <= SHARE_MAX {
            return Ok(wanted);
        }
        // Codes are those of every tick.
        let longest_us = if content == SampleContent::Ticks { TICK_US } else { PERIOD_MAX_US };
        let mut longer = (period_us..=longest_us).step_by(TICK_US as usize);
        let least_us = longer.find(|us| Self::each(*us, traffic.channels, content).share(traffic, baud) <= SHARE_MAX);
        Err(SamplingError::Line { content, channels: traffic.channels, period_us, baud, share, least_us })
    }

    fn each(period_us: u32, channels: usize, content: SampleContent) -> Self {
        let most = match content {
            SampleContent::Measurements => Samples::most(channels),
            SampleContent::Ticks => Ticks::most(channels),
        };
        Self { period_us, samples: (MESSAGE_MAX_US / period_us).clamp(1, most.clamp(1, 255) as u32) as u8, content }
    }

    /// Share of a line to the host.
    pub fn share(&self, traffic: &Traffic, baud: u32) -> f64 {
        let channels = traffic.channels;
        let message = match self.content {
            SampleContent::Measurements => samples(channels, self.samples),
            SampleContent::Ticks => ticks(channels, self.samples),
        };
        let bytes_per_us = [
            (message, f64::from(self.samples) * f64::from(self.period_us)),
            (telemetry(channels), f64::from(traffic.telemetry_us)),
            (Some(answer()), traffic.knot_us as f64),
            (Some(heartbeat_reply()), traffic.heartbeat_us as f64),
        ];
        let bytes_per_s: f64 = bytes_per_us.iter().map(|(message, us)| 1e6 * length(message.as_ref()) / us).sum();
        BITS * bytes_per_s / f64::from(baud)
    }
}

/// Length of the frame of a message, bytes.
fn length(message: Option<&DeviceMessage>) -> f64 {
    let encoded = |message| encode_frame(message, u16::MAX, &mut [0; MAX_FRAME_LEN]).ok();
    message.and_then(encoded).unwrap_or(MAX_FRAME_LEN) as f64
}

/// `None` for more channels than a message has.
fn of_channels<T: Clone>(channels: usize, value: T) -> Option<List<T>> {
    List::try_from_iter(std::iter::repeat_n(value, channels)).ok()
}

fn samples(channels: usize, count: u8) -> Option<DeviceMessage> {
    let sample = Sample {
        state: DeviceState::Running.into(),
        channels: of_channels(channels, PressureSample { pressure_10pa: u16::MAX, duty: -1 })?,
    };
    let mut samples = Batch::new();
    (0..count).for_each(|_| {
        // The batch holds them: there are at most `Samples::most`.
        let _ = samples.push(&sample);
    });
    Some(Samples { time_us: 1, period_us: 1, left_out: 0, samples }.into())
}

fn ticks(channels: usize, count: u8) -> Option<DeviceMessage> {
    let codes = of_channels(channels, u16::MAX)?;
    let tick = Tick { flags: TickFlags::default(), supply_code: 1, valve_supply_code: 1, outputs_crc: u32::MAX, codes };
    let mut ticks = Batch::new();
    (0..count).for_each(|_| {
        // The batch holds them: there are at most `Ticks::most`.
        let _ = ticks.push(&tick);
    });
    Some(Ticks { time_us: 1, left_out: 0, ticks }.into())
}

fn telemetry(channels: usize) -> Option<DeviceMessage> {
    let channel = ChannelSample { pressure_10pa: 1, reference_10pa: 1, duty: 1, status: ChannelStatus::default() };
    let message = Telemetry {
        time_us: 1,
        state: DeviceState::Running.into(),
        fault_bits: 0,
        supply_10pa: 1,
        valve_supply_mv: 1,
        free_knots: 1,
        next_index: 1,
        ticks_late: 0,
        stack_used: 1,
        outputs: Outputs::default(),
        channels: of_channels(channels, channel)?,
    };
    Some(message.into())
}

fn answer() -> DeviceMessage {
    let result: Code<ResultCode> = ResultCode::Ok.into();
    Ack { ref_type: 1, ref_seq: 1, result, detail: 0, free_knots: 1, mcu_time_us: 1 }.into()
}

fn heartbeat_reply() -> DeviceMessage {
    HeartbeatReply { host_time_us: 1, mcu_time_us: 1, state: DeviceState::Running.into(), free_knots: 1 }.into()
}

#[cfg(test)]
mod tests {
    use super::SampleRequest::{Codes, Measurements};
    use super::*;

    const TRAFFIC: Traffic = Traffic { channels: 9, telemetry_us: 100_000, knot_us: 80_000, heartbeat_us: 25_000 };

    /// The busy shares of the line to the host that `lines_carry_their_rates_without_a_drop` measures, eight knots a frame.
    #[test]
    fn shares_are_those_of_the_line() {
        for (baud, channels, period_us, knot_us, busy) in [
            (115_200, 9, 5_000, 80_000, 0.77),
            (1_000_000, 27, 2_000, 40_000, 0.53),
            (1_000_000, 9, 1_000, 8_000, 0.39),
        ] {
            let traffic = Traffic { channels, knot_us, ..TRAFFIC };
            let share = Sampling::new(Measurements(period_us), &traffic, Some(baud)).unwrap().share(&traffic, baud);
            println!("{baud} baud, {channels} channels: {share:.3}, {busy} measured");
            assert!((share - busy).abs() < 0.04, "{baud} baud, {channels} channels: {share}");
        }
    }

    #[test]
    fn rates_that_a_line_does_not_carry_are_refused_with_one_that_it_does() {
        let Err(error @ SamplingError::Line { share, least_us: Some(least_us), .. }) =
            Sampling::new(Measurements(1_000), &TRAFFIC, Some(115_200))
        else {
            panic!("it is carried")
        };
        assert!(share > 3.0 && (4_000..=5_000).contains(&least_us), "{share} {least_us}");
        assert!(Sampling::new(Measurements(least_us), &TRAFFIC, Some(115_200)).is_ok());
        assert!(Sampling::new(Measurements(least_us - 1_000), &TRAFFIC, Some(115_200)).is_err());
        let text = error.to_string();
        assert!(text.contains("9 channels each 1 ms") && text.contains("115200 baud"), "{text}");
        // A connection without a line has no bound but the control tick.
        let content = SampleContent::Measurements;
        let each_ms = Sampling { period_us: 1_000, samples: 7, content };
        assert_eq!(Sampling::new(Measurements(1_000), &TRAFFIC, None), Ok(each_ms));
        for period_us in [0, 1_500, 10_001_000] {
            assert_eq!(
                Sampling::new(Measurements(period_us), &TRAFFIC, None),
                Err(SamplingError::Period { period_us })
            );
        }
        // A sample does not wait for long.
        assert_eq!(Sampling::new(Measurements(60_000), &TRAFFIC, None).unwrap().samples, 1);
        // What telemetry alone fills carries no samples.
        let full = Traffic { telemetry_us: 5_000, ..TRAFFIC };
        assert!(matches!(
            Sampling::new(Measurements(1_000), &full, Some(115_200)),
            Err(SamplingError::Line { least_us: None, .. })
        ));
    }

    /// Nine channels: 8 ticks of 28 bytes, 13 before them, 7 of header and checksum, 2 of COBS and 2 delimiters, each 8 ms.
    #[test]
    fn codes_of_every_tick_are_a_share_of_a_megabaud() {
        let quiet = Traffic { telemetry_us: u32::MAX, knot_us: u64::MAX, heartbeat_us: u64::MAX, ..TRAFFIC };
        let codes = Sampling::new(Codes, &quiet, Some(1_000_000)).unwrap();
        assert_eq!((codes.period_us, codes.samples), (1_000, 8));
        let by_hand = 10.0 * (8.0 * 28.0 + 13.0 + 7.0 + 2.0 + 2.0) / 8_000.0;
        let share = codes.share(&quiet, 1_000_000);
        println!("codes of 9 channels: {share:.4} of 1 MBd");
        assert!((share - by_hand).abs() < 0.002, "{share} {by_hand}");
        let refused = Sampling::new(Codes, &TRAFFIC, Some(115_200)).unwrap_err().to_string();
        assert!(
            refused.contains("converter codes of 9 channels each 1 ms") && refused.contains("choose a higher baud")
        );
    }
}
