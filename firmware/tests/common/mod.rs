//! A bench around the controller: a host that speaks the wire, samples that a test sets or a chamber gives.

pub(crate) mod configuration;
pub(crate) mod fixture;
pub(crate) mod spec;
#[path = "../../sim/tests/common/tables.rs"]
pub(crate) mod tables;

pub(crate) use configuration::{SENSOR_MAX_PA, SUPPLY_SENSOR_MAX_PA};
use softlimb_firmware::{AdcCode, BootInfo, Controller, TICK_US, TickInputs, TickOutputs};
use softlimb_protocol::*;

/// Session of the host.
pub(crate) const SESSION: u16 = 0x51AB;

/// A device with a host at its link and a sensor bench at its converters.
#[derive(Clone)]
pub(crate) struct Bench {
    pub(crate) controller: Controller,
    pub(crate) now_us: u64,
    /// Gauge pressures that the sensors show, Pa.
    pub(crate) pressure_pa: [f64; MAX_CHANNELS],
    pub(crate) supply_pa: f64,
    /// Voltage of the valves' supply, V.
    pub(crate) valve_supply_v: f64,
    /// Chambers that give the first channels' pressures; without them the pressures stay as set.
    pub(crate) fixtures: Vec<fixture::Fixture>,
    /// Raw codes that replace a sensor's.
    pub(crate) code: [Option<u16>; MAX_CHANNELS],
    pub(crate) emergency_stop: bool,
    /// Whether the host sends heartbeats.
    pub(crate) heartbeats: bool,
    /// Whether the host reads what the device sends.
    pub(crate) reads: bool,
    /// All messages of the device so far.
    pub(crate) messages: Vec<DeviceMessage>,
    decoder: Decoder<DeviceMessage>,
    seq: u16,
}

impl Bench {
    /// A device that was just switched on, limb empty, supply full.
    pub(crate) fn new() -> Self {
        Self {
            controller: Controller::new(BootInfo { cause: BootCause::PowerOn, detail: 0 }),
            now_us: 1_000_000,
            pressure_pa: [0.0; MAX_CHANNELS],
            supply_pa: fixture::SUPPLY_PA,
            valve_supply_v: 24.0,
            fixtures: Vec::new(),
            code: [None; MAX_CHANNELS],
            emergency_stop: false,
            heartbeats: true,
            reads: true,
            messages: Vec::new(),
            decoder: Decoder::new(),
            seq: 0,
        }
    }

    /// A ready device with channels of the given kinds.
    pub(crate) fn ready(kinds: &[SetpointKind]) -> Self {
        let mut bench = Self::new();
        bench.hello();
        bench.configure(&system(), &channels(kinds));
        bench.ticks(550);
        assert_eq!(bench.controller.state(), DeviceState::Ready);
        bench
    }

    /// A running device: pressure channels whose sensors show `pressure_pa`, and knots at that pressure every 20 ms for `knots` times 20 ms.
    pub(crate) fn running(channels: usize, pressure_pa: i32, knots: u32) -> Self {
        let mut bench = Self::ready(&vec![SetpointKind::Pressure; channels]);
        bench.pressure_pa[..channels].fill(f64::from(pressure_pa));
        let first_us = bench.now_us + 20_000;
        for index in 0..knots {
            let values = vec![pressure_pa; channels];
            assert_eq!(bench.setpoint(index, first_us + u64::from(index) * 20_000, &values).result, ResultCode::Ok);
        }
        assert_eq!(bench.command(CommandCode::Start).result, ResultCode::Ok);
        bench.ticks(1);
        assert_eq!(bench.controller.state(), DeviceState::Running);
        bench
    }

    /// Gives the first channels a chamber each, at a gauge pressure.
    pub(crate) fn attach(&mut self, channels: usize, gauge_pa: f64) {
        self.fixtures = (0..channels).map(|_| fixture::Fixture::new(fixture::NOMINAL, gauge_pa)).collect();
        self.pressure_pa[..channels].fill(gauge_pa);
    }

    pub(crate) fn hello(&mut self) {
        let hello = Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: SESSION };
        assert_eq!(self.request(&hello.into()).result, ResultCode::Ok);
    }

    pub(crate) fn configure(&mut self, system: &ConfigSystem, channels: &[ConfigChannel]) {
        for message in upload(system, channels) {
            assert_eq!(self.request(&message).result, ResultCode::Ok, "{message:?}");
        }
    }

    pub(crate) fn command(&mut self, code: CommandCode) -> Ack {
        self.request(&Command { session: SESSION, code: code.into(), time_us: 0 }.into())
    }

    pub(crate) fn setpoint(&mut self, index: u32, time_us: u64, values: &[i32]) -> Ack {
        self.knot(index, time_us, Outputs::default(), values)
    }

    /// Sends a knot with outputs.
    pub(crate) fn knot(&mut self, index: u32, time_us: u64, outputs: Outputs, values: &[i32]) -> Ack {
        let values = List::from_slice(values).unwrap();
        self.request(&Setpoint { session: SESSION, index, time_us, outputs, values }.into())
    }

    pub(crate) fn pulse(&mut self, channel: u8, direction: PulseDirection, duration_us: u32) -> Ack {
        let direction = direction.into();
        self.request(&ManualPulse { session: SESSION, channel, direction, duration_us }.into())
    }

    pub(crate) fn set_outputs(&mut self, outputs: Outputs) -> Ack {
        self.request(&SetOutputs { session: SESSION, outputs }.into())
    }

    /// Sends a message as a new one and returns its answer.
    pub(crate) fn request(&mut self, message: &HostMessage) -> Ack {
        self.seq = self.seq.wrapping_add(1);
        self.request_as(self.seq, message).expect("an answer")
    }

    /// Sends a message with a given number and returns its answer, if there is one.
    pub(crate) fn request_as(&mut self, seq: u16, message: &HostMessage) -> Option<Ack> {
        self.drain();
        self.controller.receive(self.now_us, &frame(seq, message));
        let before = self.messages.len();
        self.drain();
        self.messages[before..].iter().find_map(|message| match message {
            DeviceMessage::Ack(ack) if ack.ref_seq == seq => Some(ack.clone()),
            _ => None,
        })
    }

    /// One tick with the samples as set.
    pub(crate) fn tick(&mut self) -> TickOutputs {
        if self.heartbeats {
            let heartbeat = Heartbeat { session: SESSION, host_time_us: 0 };
            self.controller.receive(self.now_us, &frame(0, &heartbeat.into()));
        }
        let code = |pressure_pa: f64, max_pa: f32| {
            let share = 0.1 + 0.8 * pressure_pa / f64::from(max_pa);
            AdcCode((share * 4095.0).round().clamp(0.0, 4095.0) as u16)
        };
        let inputs = TickInputs {
            now_us: self.now_us,
            pressure: std::array::from_fn(|i| self.code[i].map_or(code(self.pressure_pa[i], SENSOR_MAX_PA), AdcCode)),
            supply: code(self.supply_pa, SUPPLY_SENSOR_MAX_PA),
            valve_supply: AdcCode((self.valve_supply_v / 36.3 * 4095.0).round() as u16),
            emergency_stop: self.emergency_stop,
        };
        let outputs = self.controller.tick(&inputs);
        for pulse in outputs.valves {
            assert!(pulse.fill_us == 0 || pulse.vent_us == 0, "both coils at once: {pulse:?}");
            assert!(pulse.fill_us <= 1_000 && pulse.vent_us <= 1_000);
        }
        self.drain();
        for (index, fixture) in self.fixtures.iter_mut().enumerate() {
            fixture.tick(outputs.valves[index]);
            self.pressure_pa[index] = fixture.manifold_pa();
        }
        self.now_us += u64::from(TICK_US);
        outputs
    }

    /// Many ticks; the outputs of the last.
    pub(crate) fn ticks(&mut self, count: usize) -> TickOutputs {
        let mut outputs = TickOutputs::SAFE;
        for _ in 0..count {
            outputs = self.tick();
        }
        outputs
    }

    /// Ticks until the state is reached; how many it took.
    pub(crate) fn ticks_until(&mut self, state: DeviceState, limit: usize) -> usize {
        for count in 0..limit {
            if self.controller.state() == state {
                return count;
            }
            self.tick();
        }
        panic!("still {:?} after {limit} ticks", self.controller.state());
    }

    /// The faults that were told, with their channels.
    pub(crate) fn told_faults(&self) -> Vec<(FaultCode, u8)> {
        let faults = self.messages.iter().filter_map(|message| match message {
            DeviceMessage::Fault(fault) => Some((fault.code.known()?, fault.channel)),
            _ => None,
        });
        faults.collect()
    }

    fn drain(&mut self) {
        if !self.reads {
            return;
        }
        let mut chunk = [0; 100];
        loop {
            let count = self.controller.transmit(&mut chunk);
            if count == 0 {
                break;
            }
            let frames = chunk[..count].iter().filter_map(|&byte| self.decoder.push(byte));
            self.messages.extend(frames.map(|frame| frame.expect("the device sends valid frames").message));
        }
    }
}

/// The bytes of one frame.
pub(crate) fn frame(seq: u16, message: &HostMessage) -> Vec<u8> {
    let mut bytes = [0; MAX_FRAME_LEN];
    let len = encode_frame(message, seq, &mut bytes).unwrap();
    bytes[..len].to_vec()
}

/// The messages of a configuration upload, with the tables of channels that bend.
pub(crate) fn upload(system: &ConfigSystem, channels: &[ConfigChannel]) -> Vec<HostMessage> {
    let begin = ConfigBegin { session: SESSION, channels: channels.len() as u8 };
    let mut hash = ConfigHash::begin(&begin);
    hash.add_system(system);
    let mut messages = vec![begin.into(), system.clone().into()];
    for channel in channels {
        messages.extend(tables::parts(channel, &mut hash));
    }
    messages.push(ConfigCommit { session: SESSION, config_hash: hash.value() }.into());
    messages
}

/// The system part of the nominal fixture.
pub(crate) fn system() -> ConfigSystem {
    configuration::system(SESSION)
}

/// A bending actuator of 80 mL.
pub(crate) fn channel(index: usize, kind: SetpointKind) -> ConfigChannel {
    let setpoint_max = if kind == SetpointKind::Pressure { 150_000 } else { 3_000_000 };
    ConfigChannel {
        session: SESSION,
        channel: index as u8,
        motion: MotionKind::Bending.into(),
        setpoint_kind: kind.into(),
        law: MaterialLaw::NeoHookean.into(),
        families: 0,
        placement: FiberPlacement::Sheet.into(),
        inner_radius_m: 15e-3,
        outer_radius_m: 20e-3,
        length_m: 0.1132,
        c_pa_1: 0.2e6,
        c_pa_2: 0.0,
        c_pa_3: 0.0,
        fiber_angle_rad: 0.0,
        fiber_modulus_pa: 0.0,
        fiber_thickness_m: 0.0,
        fiber_radius_m: 0.0,
        pressure_max_pa: 150e3,
        dead_volume_m3: 5.9e-6,
        setpoint_min: 0,
        setpoint_max,
    }
}

pub(crate) fn channels(kinds: &[SetpointKind]) -> Vec<ConfigChannel> {
    kinds.iter().enumerate().map(|(index, &kind)| channel(index, kind)).collect()
}

/// A tube of the same size that lengthens: the device solves its model.
pub(crate) fn straight(index: usize) -> ConfigChannel {
    ConfigChannel {
        motion: MotionKind::Extension.into(),
        families: 2,
        c_pa_1: 0.4e6,
        fiber_angle_rad: 0.05,
        fiber_modulus_pa: 361e6,
        fiber_thickness_m: 0.178e-3,
        fiber_radius_m: 20e-3,
        setpoint_max: 1_500_000,
        setpoint_min: 900_000,
        ..channel(index, SetpointKind::AxialStretch)
    }
}
