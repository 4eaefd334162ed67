//! Target: damaged measurements of a device on their way to the host, which is the rig's session.

use softlimb_protocol::{
    Batch, ChannelSample, DeviceMessage, DeviceState, List, PressureSample, RetryPolicy, Sample, Samples, Telemetry,
};
use softlimb_rig::link::{Event, Session};

use crate::draw::Draw;
use crate::fault::hurt;
use crate::frame;

/// Damages measurements, up to a number of faults or the end of the draw. After each damaged frame two intact ones follow. The first may
/// lack its leading delimiter.
///
/// # Panics
/// Where the host takes anything but what was sent, or loses the second whole frame.
pub fn host(draw: &mut Draw<'_>, faults: u64) {
    let mut session = Session::new(7, RetryPolicy::default(), 25_000, 4);
    let (mut time_us, mut done) = (0, 0);
    while done < faults && !draw.is_over() {
        let mut sent = Vec::new();
        for copy in 0..3 {
            time_us += 5_000;
            let message = match draw.below(2) {
                1 => samples(time_us, draw).into(),
                _ => DeviceMessage::from(telemetry(time_us, draw)),
            };
            let mut wire = frame::<DeviceMessage>(copy, message.clone());
            match copy {
                0 => wire = hurt(&wire, draw),
                1 => drop(wire.drain(..draw.below(2))),
                _ => {}
            }
            sent.push(message);
            session.receive(time_us, &wire).expect("measurements refuse nothing");
        }
        let told = std::iter::from_fn(|| session.next_event());
        let taken: Vec<DeviceMessage> = told
            .filter_map(|event| match event {
                Event::Telemetry { message, .. } => Some(message.into()),
                Event::Samples { message, .. } => Some(message.into()),
                Event::State(state) => {
                    assert_eq!(state, DeviceState::Running);
                    None
                }
                other => panic!("nobody sent {other:?}"),
            })
            .collect();
        // Messages arrive in the order in which they were sent. A repeated piece may deliver one twice.
        assert!(taken.iter().all(|message| sent.contains(message)), "{taken:?} of {sent:?}");
        assert!(taken.is_sorted_by_key(time_us_of), "{taken:?}");
        assert_eq!(taken.last(), sent.last());
        done += 1;
    }
}

fn time_us_of(message: &DeviceMessage) -> u64 {
    match message {
        DeviceMessage::Telemetry(message) => message.time_us,
        DeviceMessage::Samples(message) => message.time_us,
        other => panic!("nobody sent {other:?}"),
    }
}

/// One to four samples of two channels.
fn samples(time_us: u64, draw: &mut Draw<'_>) -> Samples {
    let mut samples = Batch::new();
    for _ in 0..=draw.below(4) {
        let channel =
            |draw: &mut Draw<'_>| PressureSample { pressure_10pa: draw.number() as u16, duty: draw.number() as i8 };
        let channels = [channel(draw), channel(draw)];
        let channels = List::from_slice(&channels).expect("a list as long as the channels");
        samples.push(&Sample { state: DeviceState::Running.into(), channels }).expect("a frame holds four");
    }
    Samples { time_us, period_us: 1_000, left_out: draw.number(), samples }
}

fn telemetry(time_us: u64, draw: &mut Draw<'_>) -> Telemetry {
    let sample = |draw: &mut Draw<'_>| ChannelSample {
        pressure_10pa: draw.number() as u16,
        reference_10pa: draw.number() as u16,
        duty: draw.number() as i8,
        status: Default::default(),
    };
    let channels = [sample(draw), sample(draw)];
    Telemetry {
        time_us,
        state: DeviceState::Running.into(),
        fault_bits: 0,
        supply_10pa: draw.number() as u16,
        valve_supply_mv: draw.number() as u16,
        free_knots: 3,
        next_index: draw.number(),
        ticks_late: 0,
        stack_used: 0,
        outputs: Default::default(),
        channels: List::from_slice(&channels).expect("a list as long as the channels"),
    }
}
