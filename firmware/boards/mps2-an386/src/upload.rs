//! Messages of a host to a device with nine channels: a configuration, knots, the start.

use fra_model::TABLE_COEFFICIENTS;
use softlimb_protocol::*;

/// Channels of the board.
pub(crate) const CHANNELS: usize = 9;

const SESSION: u16 = 7;

/// Time from knot to knot, us, and knots in a frame.
pub(crate) const KNOT_US: u16 = 10_000;
pub(crate) const FRAME: u32 = 8;

/// Highest pressure of a table, gauge Pa.
const TABLE_MAX_PA: f32 = 80e3;
/// Highest pressure of a chamber, gauge Pa.
const PRESSURE_MAX_PA: f32 = 150e3;

/// Inner radius, outer radius and length at rest, m.
const INNER_M: f32 = 10e-3;
const OUTER_M: f32 = 14e-3;
const LENGTH_M: f32 = 0.24;

/// Inverse of the device, from a deformation to a pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Inverse {
    /// By tables of the highest degree: their cost depends on nothing else.
    Tables,
    /// By solving the model: wound actuators that extend, expand and twist.
    Model,
}

/// One kind of actuator, with the setpoint of its largest deformation here, in wire units.
struct Kind {
    motion: MotionKind,
    setpoint: SetpointKind,
    fiber: (f32, u8),
    rest: i32,
    most: i32,
}

const DEGREE: f32 = core::f32::consts::PI / 180.0;

const KINDS: [Kind; 3] = [
    Kind {
        motion: MotionKind::Extension,
        setpoint: SetpointKind::AxialStretch,
        fiber: (3.0 * DEGREE, 2),
        rest: 1_000_000,
        most: 1_250_000,
    },
    Kind {
        motion: MotionKind::Expansion,
        setpoint: SetpointKind::OuterRadius,
        fiber: (80.0 * DEGREE, 2),
        rest: 14_000_000,
        most: 15_500_000,
    },
    Kind {
        motion: MotionKind::Twisting,
        setpoint: SetpointKind::Twist,
        fiber: (28.0 * DEGREE, 1),
        rest: 0,
        most: -600_000,
    },
];

fn kind(channel: usize) -> &'static Kind {
    &KINDS[channel % KINDS.len()]
}

/// Hello, then the messages of a configuration, in order.
pub(crate) fn configuration(by: Inverse, mut send: impl FnMut(HostMessage)) {
    send(Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: SESSION }.into());
    let begin = ConfigBegin { session: SESSION, channels: CHANNELS as u8 };
    let mut hash = ConfigHash::begin(&begin);
    hash.add_system(&system());
    send(begin.into());
    send(system().into());
    for channel in 0..CHANNELS {
        let part = actuator(channel);
        hash.add_channel(&part);
        send(part.into());
        if by == Inverse::Tables {
            let (volume, inverse) = (volume(channel), inverse(channel));
            hash.add_volume(&volume);
            send(volume.into());
            hash.add_inverse(&inverse);
            send(inverse.into());
        }
    }
    send(ConfigCommit { session: SESSION, config_hash: hash.value() }.into());
}

/// The knot of a number: every channel up and down between rest and its largest deformation, each at a phase of its own.
pub(crate) fn knot(index: u32, time_us: u64) -> Setpoint {
    let value = |channel: usize| {
        let Kind { rest, most, .. } = *kind(channel);
        // A triangle of 160 knots.
        let phase = (index as i32 + 8 * channel as i32) % 160;
        rest + (most - rest) / 80 * if phase < 80 { phase } else { 160 - phase }
    };
    let values = List::try_from_iter((0..CHANNELS).map(value)).expect("as many as there is room for");
    let outputs = Outputs::default().with(Outputs::GRIPPER, index % 160 < 80);
    Setpoint { session: SESSION, index, time_us, outputs, values }
}

/// The knots from a number on, each as its step from the one before, as many as a host sends in a frame.
pub(crate) fn knots(index: u32) -> Knots {
    let mut knots = Batch::new();
    for index in index..index + FRAME {
        let (before, knot) = (knot(index - 1, 0), knot(index, 0));
        let steps = knot.values.iter().zip(before.values.iter()).map(|(value, before)| (value - before) as i16);
        let steps = List::try_from_iter(steps).expect("as many as there is room for");
        let step = KnotStep { step_us: KNOT_US, outputs: knot.outputs, steps };
        knots.push(&step).expect("a frame has room for as many");
    }
    Knots { session: SESSION, index, knots }
}

/// The command to begin with the first knot.
pub(crate) fn start() -> Command {
    Command { session: SESSION, code: CommandCode::Start.into(), time_us: 0 }
}

fn system() -> ConfigSystem {
    ConfigSystem {
        session: SESSION,
        telemetry_period_us: 10_000,
        control_period_us: 20_000,
        link_timeout_us: 10_000_000,
        hold_time_us: 2_000_000,
        link_loss_policy: LinkLossPolicy::HoldThenRamp.into(),
        vent_ramp_pa_per_s: 20_000.0,
        supply_min_pa: 150e3,
        supply_max_pa: 230e3,
        atmosphere_pa: 101_325.0,
        temperature_k: 293.15,
        valve_conductance_m3_per_s_pa: 1.44e-9,
        valve_critical_ratio: 0.3,
        valve_on_delay_us: 3_500,
        valve_off_delay_us: 2_000,
        line_conductance_m3_per_s_pa: 3.78e-9,
        sensor_min_pa: 0.0,
        sensor_max_pa: 206_843.0,
        supply_sensor_min_pa: 0.0,
        supply_sensor_max_pa: 689_476.0,
        adc_full_scale: 4095,
        pressure_loop: PressureLoopKind::Pulses.into(),
        valve_supply_scale_mv: 36_300,
        valve_supply_min_mv: 20_000,
    }
}

fn actuator(channel: usize) -> ConfigChannel {
    let Kind { motion, setpoint, fiber: (fiber_angle_rad, families), rest, most } = *kind(channel);
    ConfigChannel {
        session: SESSION,
        channel: channel as u8,
        motion: motion.into(),
        setpoint_kind: setpoint.into(),
        law: MaterialLaw::NeoHookean.into(),
        families,
        placement: FiberPlacement::Sheet.into(),
        inner_radius_m: INNER_M,
        outer_radius_m: OUTER_M,
        length_m: LENGTH_M,
        c_pa_1: 0.223e6,
        c_pa_2: 0.0,
        c_pa_3: 0.0,
        fiber_angle_rad,
        fiber_modulus_pa: 361e6,
        fiber_thickness_m: 0.178e-3,
        fiber_radius_m: OUTER_M,
        pressure_max_pa: PRESSURE_MAX_PA,
        dead_volume_m3: 5.9e-6,
        setpoint_min: rest.min(most),
        setpoint_max: rest.max(most),
    }
}

/// Rises by half from the volume at rest, the last coefficients too small to tell.
fn volume(channel: usize) -> ConfigVolume {
    let rest_m3 = core::f32::consts::PI * INNER_M * INNER_M * LENGTH_M;
    let first = [1.25 * rest_m3, 0.25 * rest_m3];
    let coefficients_m3 = coefficients(first, 1e-12);
    ConfigVolume { session: SESSION, channel: channel as u8, pressure_max_pa: TABLE_MAX_PA, coefficients_m3 }
}

fn inverse(channel: usize) -> ConfigInverse {
    let Kind { setpoint, rest, most, .. } = *kind(channel);
    ConfigInverse {
        session: SESSION,
        channel: channel as u8,
        argument: TableArgument::Root.into(),
        steps: 32_768,
        setpoint_from: setpoint.from_wire(rest),
        setpoint_to: setpoint.from_wire(most),
        pressure_max_pa: TABLE_MAX_PA,
        coefficients_pa: coefficients([0.5 * TABLE_MAX_PA; 2], 0.25),
    }
}

/// As many as a table may have.
fn coefficients(first: [f32; 2], rest: f32) -> List<f32> {
    let coefficients = (0..TABLE_COEFFICIENTS).map(|index| first.get(index).copied().unwrap_or(rest));
    List::try_from_iter(coefficients).expect("as many as there is room for")
}
