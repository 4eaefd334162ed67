//! Helpers of the tests: a decoder run to its end, arbitrary messages, a seeded generator.

#[path = "../../../tests/support/samples.rs"]
mod samples;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use softlimb_protocol::*;

pub(crate) use samples::samples;

/// Everything a new decoder yields for `bytes`.
pub(crate) fn decode_all<M: Message>(bytes: &[u8]) -> Vec<Result<Frame<M>, FrameError>> {
    let mut decoder = Decoder::new();
    bytes.iter().filter_map(|&byte| decoder.push(byte)).collect()
}

/// One message as a frame.
pub(crate) fn encode<M: Message>(message: &M, seq: u16) -> Vec<u8> {
    let mut wire = [0; MAX_FRAME_LEN];
    let len = encode_frame(message, seq, &mut wire).unwrap();
    wire[..len].to_vec()
}

/// The same cases at every run: failing ones are printed, not kept in files.
pub(crate) fn config() -> ProptestConfig {
    ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2026), ..ProptestConfig::default() }
}

/// SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number below `end`.
    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }
}

fn code<E: CodeSet>() -> impl Strategy<Value = Code<E>> {
    any::<u8>().prop_map(Code::from_raw)
}

/// Any binary32 that equals itself; what is not a number has a test of its own.
fn number() -> impl Strategy<Value = f32> {
    any::<f32>().prop_filter("NaN equals nothing", |value| !value.is_nan())
}

fn list<T: Clone + core::fmt::Debug>(element: impl Strategy<Value = T>) -> impl Strategy<Value = List<T>> {
    vec(element, 1..=MAX_CHANNELS).prop_map(|elements| List::from_slice(&elements).unwrap())
}

fn sample() -> impl Strategy<Value = ChannelSample> {
    any::<(u16, u16, i8, u8)>().prop_map(|(pressure_10pa, reference_10pa, duty, status)| ChannelSample {
        pressure_10pa,
        reference_10pa,
        duty,
        status: ChannelStatus::from_bits(status),
    })
}

fn config_system() -> impl Strategy<Value = HostMessage> {
    let integers = any::<(u16, [u32; 6], [u16; 3])>();
    let codes = (code(), code());
    (integers, codes, vec(number(), 12)).prop_map(|((session, u, w), (link_loss_policy, pressure_loop), f)| {
        ConfigSystem {
            session,
            telemetry_period_us: u[0],
            control_period_us: u[1],
            link_timeout_us: u[2],
            hold_time_us: u[3],
            link_loss_policy,
            vent_ramp_pa_per_s: f[0],
            supply_min_pa: f[1],
            supply_max_pa: f[2],
            atmosphere_pa: f[3],
            temperature_k: f[4],
            valve_conductance_m3_per_s_pa: f[5],
            valve_critical_ratio: f[6],
            valve_on_delay_us: u[4],
            valve_off_delay_us: u[5],
            line_conductance_m3_per_s_pa: f[7],
            sensor_min_pa: f[8],
            sensor_max_pa: f[9],
            supply_sensor_min_pa: f[10],
            supply_sensor_max_pa: f[11],
            adc_full_scale: w[0],
            pressure_loop,
            valve_supply_scale_mv: w[1],
            valve_supply_min_mv: w[2],
        }
        .into()
    })
}

fn config_channel() -> impl Strategy<Value = HostMessage> {
    let codes = (code(), code(), code(), code());
    (any::<(u16, u8, u8, i32, i32)>(), codes, vec(number(), 12)).prop_map(
        |((session, channel, families, setpoint_min, setpoint_max), (motion, setpoint_kind, law, placement), f)| {
            ConfigChannel {
                session,
                channel,
                motion,
                setpoint_kind,
                law,
                families,
                placement,
                inner_radius_m: f[0],
                outer_radius_m: f[1],
                length_m: f[2],
                c_pa_1: f[3],
                c_pa_2: f[4],
                c_pa_3: f[5],
                fiber_angle_rad: f[6],
                fiber_modulus_pa: f[7],
                fiber_thickness_m: f[8],
                fiber_radius_m: f[9],
                pressure_max_pa: f[10],
                dead_volume_m3: f[11],
                setpoint_min,
                setpoint_max,
            }
            .into()
        },
    )
}

fn config_tables() -> impl Strategy<Value = HostMessage> {
    let volume = (any::<(u16, u8)>(), number(), list(number())).prop_map(
        |((session, channel), pressure_max_pa, coefficients_m3)| {
            ConfigVolume { session, channel, pressure_max_pa, coefficients_m3 }.into()
        },
    );
    let inverse = (any::<(u16, u8, u16)>(), code(), vec(number(), 3), list(number())).prop_map(
        |((session, channel, steps), argument, f, coefficients_pa)| {
            ConfigInverse {
                session,
                channel,
                argument,
                steps,
                setpoint_from: f[0],
                setpoint_to: f[1],
                pressure_max_pa: f[2],
                coefficients_pa,
            }
            .into()
        },
    );
    prop_oneof![volume, inverse]
}

/// Any message to the device.
pub(crate) fn host_message() -> impl Strategy<Value = HostMessage> {
    let hello = any::<(u16, u32, u16)>()
        .prop_map(|(protocol_version, schema_hash, session)| Hello { protocol_version, schema_hash, session }.into());
    let heartbeat = any::<(u16, u64)>().prop_map(|(session, host_time_us)| Heartbeat { session, host_time_us }.into());
    let begin = any::<(u16, u8)>().prop_map(|(session, channels)| ConfigBegin { session, channels }.into());
    let commit = any::<(u16, u32)>().prop_map(|(session, config_hash)| ConfigCommit { session, config_hash }.into());
    let command =
        (any::<(u16, u64)>(), code()).prop_map(|((session, time_us), code)| Command { session, code, time_us }.into());
    let setpoint =
        (any::<(u16, u32, u64, u8)>(), list(any::<i32>())).prop_map(|((session, index, time_us, bits), values)| {
            Setpoint { session, index, time_us, outputs: Outputs::from_bits(bits), values }.into()
        });
    prop_oneof![
        hello,
        heartbeat,
        begin,
        config_system(),
        config_channel(),
        config_tables(),
        commit,
        command,
        setpoint,
        knots(),
        by_hand(),
    ]
}

/// As many records as fit, of those given.
fn batch<T: core::fmt::Debug>(records: Vec<T>, push: fn(&mut Batch<T>, &T) -> bool) -> Batch<T> {
    let mut batch = Batch::new();
    records.iter().take_while(|record| push(&mut batch, record)).count();
    batch
}

fn knots() -> impl Strategy<Value = HostMessage> {
    let step = (any::<(u16, u8)>(), list(any::<i16>())).prop_map(|((step_us, bits), steps)| KnotStep {
        step_us,
        outputs: Outputs::from_bits(bits),
        steps,
    });
    (any::<(u16, u32)>(), vec(step, 1..4)).prop_map(|((session, index), steps)| {
        let knots = batch(steps, |batch, step| batch.len() < 2 && batch.push(step).is_ok());
        Knots { session, index, knots }.into()
    })
}

fn samples_message() -> impl Strategy<Value = DeviceMessage> {
    let channel = any::<(u16, i8)>().prop_map(|(pressure_10pa, duty)| PressureSample { pressure_10pa, duty });
    let sample = (code(), list(channel)).prop_map(|(state, channels)| Sample { state, channels });
    (any::<(u64, u32, u32)>(), vec(sample, 1..4)).prop_map(|((time_us, period_us, left_out), all)| {
        let samples = batch(all, |batch, sample| batch.len() < 2 && batch.push(sample).is_ok());
        Samples { time_us, period_us, left_out, samples }.into()
    })
}

fn ticks_message() -> impl Strategy<Value = DeviceMessage> {
    let tick = (any::<(u8, u16, u16, u32)>(), list(any::<u16>())).prop_map(
        |((bits, supply_code, valve_supply_code, outputs_crc), codes)| Tick {
            flags: TickFlags::from_bits(bits),
            supply_code,
            valve_supply_code,
            outputs_crc,
            codes,
        },
    );
    (any::<(u64, u32)>(), vec(tick, 1..4)).prop_map(|((time_us, left_out), all)| {
        let ticks = batch(all, |batch, tick| batch.len() < 3 && batch.push(tick).is_ok());
        Ticks { time_us, left_out, ticks }.into()
    })
}

/// What is asked of the device by hand.
fn by_hand() -> impl Strategy<Value = HostMessage> {
    let pulse = (any::<(u16, u8, u32)>(), code()).prop_map(|((session, channel, duration_us), direction)| {
        ManualPulse { session, channel, direction, duration_us }.into()
    });
    let outputs =
        any::<(u16, u8)>().prop_map(|(session, bits)| SetOutputs { session, outputs: Outputs::from_bits(bits) }.into());
    let sampling = (any::<(u16, u32, u8)>(), code()).prop_map(|((session, period_us, samples), content)| {
        SetSampling { session, period_us, samples, content }.into()
    });
    let errors = any::<u16>().prop_map(|session| ReadLinkErrors { session }.into());
    let log = any::<(u16, u32)>().prop_map(|(session, first)| ReadLog { session, first }.into());
    prop_oneof![pulse, outputs, sampling, errors, log]
}

fn hello_reply() -> impl Strategy<Value = DeviceMessage> {
    let versions = any::<(u16, u32, u16, [u8; 3])>();
    let limits = any::<(u8, u16, u32, u32, u64, u32)>();
    (versions, limits, code(), code()).prop_map(|(v, l, boot_cause, state)| {
        HelloReply {
            protocol_version: v.0,
            schema_hash: v.1,
            session: v.2,
            firmware_major: v.3[0],
            firmware_minor: v.3[1],
            firmware_patch: v.3[2],
            boot_cause,
            boot_detail: l.5,
            state,
            channels_max: l.0,
            knots_capacity: l.1,
            tick_us: l.2,
            config_hash: l.3,
            mcu_time_us: l.4,
        }
        .into()
    })
}

fn telemetry() -> impl Strategy<Value = DeviceMessage> {
    let numbers = any::<(u64, [u16; 4], u32, u16, u16, u8)>();
    (numbers, code(), list(sample())).prop_map(|(n, state, channels)| {
        Telemetry {
            time_us: n.0,
            state,
            fault_bits: n.1[0],
            supply_10pa: n.1[1],
            valve_supply_mv: n.1[2],
            free_knots: n.1[3],
            next_index: n.2,
            ticks_late: n.3,
            stack_used: n.4,
            outputs: Outputs::from_bits(n.5),
            channels,
        }
        .into()
    })
}

fn log_messages() -> impl Strategy<Value = DeviceMessage> {
    let record = (any::<(u32, u32, u8, u8, u32, u64)>(), code()).prop_map(
        |((number, start, code, channel, detail, time_us), kind)| LogRecord {
            number,
            start,
            kind,
            code,
            channel,
            detail,
            time_us,
        },
    );
    let records = vec(record, 1..=10)
        .prop_map(|records| LogRecords { records: batch(records, |batch, record| batch.push(record).is_ok()) }.into());
    let state = (any::<(u32, u32, u32, u8)>(), code()).prop_map(|((unstored, next, until, records), condition)| {
        LogState { condition, unstored, next, until, records }.into()
    });
    prop_oneof![records, state]
}

/// Any message to the host.
pub(crate) fn device_message() -> impl Strategy<Value = DeviceMessage> {
    let ack = (any::<(u8, u16, u32, u16, u64)>(), code()).prop_map(|(n, result)| {
        Ack { ref_type: n.0, ref_seq: n.1, result, detail: n.2, free_knots: n.3, mcu_time_us: n.4 }.into()
    });
    let heartbeat = (any::<(u64, u64, u16)>(), code()).prop_map(|((host_time_us, mcu_time_us, free_knots), state)| {
        HeartbeatReply { host_time_us, mcu_time_us, state, free_knots }.into()
    });
    let fault = (any::<(u64, u8, i32)>(), code())
        .prop_map(|((time_us, channel, value), code)| Fault { time_us, channel, code, value }.into());
    let errors = any::<[u32; 5]>().prop_map(|[overrun, framing, noise, parity, queue_full]| {
        LinkErrors { overrun, framing, noise, parity, queue_full }.into()
    });
    prop_oneof![
        hello_reply(),
        ack,
        heartbeat,
        telemetry(),
        samples_message(),
        ticks_message(),
        fault,
        errors,
        log_messages(),
    ]
}
