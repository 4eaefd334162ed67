//! Target: damaged frames of a session on their way to the device, which is the firmware's controller.

use softlimb_firmware::{AdcCode, BootInfo, Controller, TickInputs};
use softlimb_protocol::{
    Batch, BootCause, Command, CommandCode, ConfigBegin, ConfigChannel, ConfigCommit, ConfigHash, Decoder,
    DeviceMessage, DeviceState, FiberPlacement, Heartbeat, Hello, HostMessage, KnotStep, Knots, List, MaterialLaw,
    MotionKind, Outputs, PROTOCOL_VERSION, ResultCode, SCHEMA_HASH, SampleContent, SetSampling, Setpoint, SetpointKind,
};

#[path = "../../firmware/tests/common/configuration.rs"]
mod configuration;

use crate::draw::Draw;
use crate::fault::hurt;
use crate::{ROUND, frame};

const SESSION: u16 = 0x51AB;
const CHANNELS: usize = 2;
/// Highest setpoint, Pa.
const HIGHEST_PA: i32 = 140_000;
/// Knots between two flushes, and two more at most: fewer than the buffer holds.
const KNOTS: u32 = 40;
/// Time from the present to the first knot, us: longer than any input lasts between two flushes.
const LEAD_US: u64 = 50_000_000;
/// Time between two whole knots, us: any change of a setpoint is slow enough.
const KNOT_US: u64 = 100_000;
/// Shortest step in time, us: slow enough for the largest step of 16 bits.
const STEP_US: u16 = 24_000;
const TICK_US: u64 = 1_000;
/// Ticks in which a configured device takes its zeros.
const READY_TICKS: u64 = 550;

/// Damages the frames of a session, up to a number of faults or the end of the draw.
///
/// After each damaged frame the intact frame follows twice, as a host repeats it. The first copy may lack its leading delimiter.
///
/// # Panics
/// Where the device applies anything but what was sent, where it misses the second copy, and where its state changes.
pub fn device(draw: &mut Draw<'_>, faults: u64) {
    let mut bench = Bench::new();
    let mut done = 0;
    while done < faults && !draw.is_over() {
        bench.flush();
        let mut index = 0;
        while index < KNOTS {
            index += match draw.below(2) {
                1 if index > 0 => bench.knots(index, draw),
                _ => bench.knot(index, draw),
            };
            bench.heartbeat(draw);
            done += 2;
        }
        bench.sampling(draw);
        done += 1;
        for _ in 0..ROUND {
            bench.tick();
        }
        bench.check();
    }
}

struct Bench {
    controller: Box<Controller<CHANNELS>>,
    decoder: Decoder<DeviceMessage>,
    now_us: u64,
    seq: u16,
    config_hash: u32,
    /// The knot sent last.
    last: Knot,
    /// Period and number of the samples in the last message of them.
    samples: (u32, usize),
}

#[derive(Clone, Copy)]
struct Knot {
    time_us: u64,
    values: [i32; CHANNELS],
}

impl Bench {
    /// A device that is configured and ready.
    fn new() -> Self {
        let boot = BootInfo { cause: BootCause::PowerOn, detail: 0 };
        let controller = Box::new(Controller::new(boot));
        let last = Knot { time_us: 0, values: [0; CHANNELS] };
        let mut bench =
            Self { controller, decoder: Decoder::new(), now_us: 0, seq: 0, config_hash: 0, last, samples: (0, 0) };
        bench.accept(&Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: SESSION }.into());
        let (upload, config_hash) = upload();
        upload.iter().for_each(|part| bench.accept(part));
        bench.config_hash = config_hash;
        (0..READY_TICKS).for_each(|_| bench.tick());
        bench.check();
        bench
    }

    /// Sends a whole frame, which the device must apply.
    fn accept(&mut self, message: &HostMessage) {
        self.seq = self.seq.wrapping_add(1);
        let results = self.send(&frame::<HostMessage>(self.seq, message.clone()));
        assert_eq!(results, [(self.seq, ResultCode::Ok)], "{message:?}");
    }

    fn flush(&mut self) {
        self.accept(&Command { session: SESSION, code: CommandCode::Flush.into(), time_us: 0 }.into());
        assert_eq!(self.controller.queue().next_index(), 0);
    }

    /// Sends one knot as a whole. Returns 1.
    fn knot(&mut self, index: u32, draw: &mut Draw<'_>) -> u32 {
        let time_us = self.now_us + LEAD_US + u64::from(index) * KNOT_US;
        let values: [i32; CHANNELS] = std::array::from_fn(|_| (draw.number() % (HIGHEST_PA as u32 + 1)) as i32);
        let list = List::from_slice(&values).expect("a list as long as the channels");
        let outputs = Outputs::default();
        let whole = frame::<HostMessage>(0, Setpoint { session: SESSION, index, time_us, outputs, values: list });
        self.apply(index, &whole, &[Knot { time_us, values }], draw);
        1
    }

    /// Sends one to three knots as steps from the last one. Returns their number.
    fn knots(&mut self, index: u32, draw: &mut Draw<'_>) -> u32 {
        let (mut batch, mut sent, mut last) = (Batch::new(), Vec::new(), self.last);
        for _ in 0..=draw.below(3) {
            let step_us = STEP_US + draw.below(20_000) as u16;
            let values = last.values.map(|value| {
                let far = value + i32::from(draw.number() as i16);
                far.clamp(0, HIGHEST_PA)
            });
            // A clamped step is shorter than the one drawn.
            let steps =
                List::try_from_iter(values.iter().zip(last.values).map(|(value, before)| (value - before) as i16));
            let steps = steps.expect("a list as long as the channels");
            batch.push(&KnotStep { step_us, outputs: Outputs::default(), steps }).expect("a frame holds three");
            last = Knot { time_us: last.time_us + u64::from(step_us), values };
            sent.push(last);
        }
        let whole = frame::<HostMessage>(0, Knots { session: SESSION, index, knots: batch });
        self.apply(index, &whole, &sent, draw);
        sent.len() as u32
    }

    /// Sends a frame of knots: damaged, then intact twice. Asserts that they are applied once and whole.
    fn apply(&mut self, index: u32, whole: &[u8], knots: &[Knot], draw: &mut Draw<'_>) {
        let end = index + knots.len() as u32;
        for wire in wires(whole, draw) {
            for (_, result) in self.send(&wire) {
                // Only a second copy is refused.
                assert!(matches!(result, ResultCode::Ok | ResultCode::UnexpectedIndex), "{result:?} to {wire:02x?}");
            }
            let next = self.controller.queue().next_index();
            assert!(next == index || next == end, "knot {next} after {index}: {wire:02x?}");
        }
        let queue = self.controller.queue();
        assert_eq!(queue.next_index(), end, "knot {index} is lost behind one fault");
        for Knot { time_us, values } in knots {
            let found: [Option<f32>; CHANNELS] = std::array::from_fn(|channel| queue.value(channel, *time_us));
            assert_eq!(found, values.map(|value| Some(value as f32)), "knot {index}");
        }
        self.last = knots.last().copied().unwrap_or(self.last);
    }

    /// Requests samples: damaged, then intact twice. Asserts that they come as requested.
    fn sampling(&mut self, draw: &mut Draw<'_>) {
        let (ticks, samples) = (1 + draw.below(3), 1 + draw.below(3) as u8);
        let period_us = ticks as u32 * TICK_US as u32;
        self.seq = self.seq.wrapping_add(1);
        let whole = frame::<HostMessage>(
            self.seq,
            SetSampling { session: SESSION, period_us, samples, content: SampleContent::Measurements.into() },
        );
        for wire in wires(&whole, draw) {
            let results = self.send(&wire);
            assert!(results.iter().all(|&answer| answer == (self.seq, ResultCode::Ok)), "{results:?} to {wire:02x?}");
        }
        self.samples = (0, 0);
        (0..ticks * usize::from(samples)).for_each(|_| self.tick());
        assert_eq!(self.samples, (period_us, usize::from(samples)));
    }

    /// Sends one heartbeat: damaged, then intact twice.
    fn heartbeat(&mut self, draw: &mut Draw<'_>) {
        let next = self.controller.queue().next_index();
        let whole = frame::<HostMessage>(0, Heartbeat { session: SESSION, host_time_us: u64::from(draw.number()) });
        for wire in wires(&whole, draw) {
            assert_eq!(self.send(&wire), [], "a heartbeat has no result: {wire:02x?}");
        }
        assert_eq!(self.controller.queue().next_index(), next);
    }

    /// Sends bytes to the device. Returns number and result of each message that it acknowledges.
    fn send(&mut self, wire: &[u8]) -> Vec<(u16, ResultCode)> {
        self.controller.receive(self.now_us, wire);
        let (mut results, mut chunk) = (Vec::new(), [0; 512]);
        loop {
            let count = self.controller.transmit(&mut chunk);
            if count == 0 {
                return results;
            }
            for frame in chunk[..count].iter().filter_map(|&byte| self.decoder.push(byte)) {
                match frame.expect("the device sends valid frames").message {
                    DeviceMessage::Ack(ack) => {
                        results.push((ack.ref_seq, ack.result.known().expect("a known result")));
                    }
                    DeviceMessage::Samples(message) => self.samples = (message.period_us, message.samples.len()),
                    _ => {}
                }
            }
        }
    }

    fn tick(&mut self) {
        let pressure = [AdcCode(410); CHANNELS];
        let (supply, valve_supply) = (AdcCode(1_360), AdcCode(2_708));
        let inputs = TickInputs { now_us: self.now_us, pressure, supply, valve_supply, emergency_stop: false };
        self.controller.tick(&inputs);
        self.send(&[]);
        self.now_us += TICK_US;
    }

    /// Asserts that no damaged frame has changed the device.
    fn check(&self) {
        let config = self.controller.config().map(|config| config.hash);
        assert_eq!((self.controller.state(), config), (DeviceState::Ready, Some(self.config_hash)));
    }
}

/// A damaged frame, then the intact frame twice. The first copy may lack its leading delimiter.
fn wires(whole: &[u8], draw: &mut Draw<'_>) -> [Vec<u8>; 3] {
    [hurt(whole, draw), whole[draw.below(2)..].to_vec(), whole.to_vec()]
}

/// An upload whose setpoints are pressures, and its hash.
fn upload() -> (Vec<HostMessage>, u32) {
    let begin = ConfigBegin { session: SESSION, channels: CHANNELS as u8 };
    let mut hash = ConfigHash::begin(&begin);
    let system = configuration::system(SESSION);
    hash.add_system(&system);
    let mut parts = vec![begin.into(), system.into()];
    for index in 0..CHANNELS as u8 {
        let channel = channel(index);
        hash.add_channel(&channel);
        parts.push(channel.into());
    }
    parts.push(ConfigCommit { session: SESSION, config_hash: hash.value() }.into());
    (parts, hash.value())
}

/// A tube that lengthens: the device solves its model without tables.
fn channel(channel: u8) -> ConfigChannel {
    ConfigChannel {
        session: SESSION,
        channel,
        motion: MotionKind::Extension.into(),
        setpoint_kind: SetpointKind::Pressure.into(),
        law: MaterialLaw::NeoHookean.into(),
        families: 2,
        placement: FiberPlacement::Sheet.into(),
        inner_radius_m: 15e-3,
        outer_radius_m: 20e-3,
        length_m: 0.1132,
        c_pa_1: 0.4e6,
        c_pa_2: 0.0,
        c_pa_3: 0.0,
        fiber_angle_rad: 0.05,
        fiber_modulus_pa: 361e6,
        fiber_thickness_m: 0.178e-3,
        fiber_radius_m: 20e-3,
        pressure_max_pa: 150e3,
        dead_volume_m3: 5.9e-6,
        setpoint_min: 0,
        setpoint_max: HIGHEST_PA,
    }
}
