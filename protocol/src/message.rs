//! The whole interface, as one table.
//!
//! All integers are little-endian. A `Code<..>` is one byte. A `List<..>` or `Batch<..>` is a count byte, then that many elements. Setpoints and
//! telemetry are integers only, so that a value that is not a number has no encoding; configuration carries IEEE 754
//! binary32, which the device checks for finiteness and range.

use crate::batch::Batch;
use crate::code::{Code, CodeSet};
use crate::codec::{Body, MAX_PAYLOAD_LEN, Message};
use crate::error::{EncodeError, PayloadError};
use crate::layout::{CodeLayout, Delivery, FieldLayout, MessageLayout, position};
use crate::list::List;
use crate::wire::{Reader, Wire, Writer, max_len};

/// Reads one message into its direction. Each in a function of its own: a device with all of them in one would need a stack for all at once.
#[inline(never)]
fn read<M: Wire + Into<D>, D>(reader: &mut Reader<'_>) -> Result<D, PayloadError> {
    M::read(reader).map(M::into)
}

interface! {
    protocol 1;
    channels 27;

    codes {
        /// State of the device.
        DeviceState {
            /// Not configured, or zeros not yet taken; supply cut, vents open while they are taken.
            Idle = 0,
            /// Configured, sensors plausible, valves closed.
            Ready = 1,
            /// Following the setpoints.
            Running = 2,
            /// Valves closed, pressure kept.
            Holding = 3,
            /// Pressure ramps down, then the vents stay open.
            Venting = 4,
            /// A fault is latched; only its reaction acts on the valves.
            Faulted = 5,
        }

        /// Why the device last started.
        BootCause {
            /// Power came on.
            PowerOn = 0,
            /// The reset pin.
            ResetPin = 1,
            /// The firmware asked for it.
            Software = 2,
            /// The watchdog ran out.
            Watchdog = 3,
            /// The supply voltage dipped.
            BrownOut = 4,
            /// The program found itself in a state that it cannot be in; `boot_detail` is the line of its source.
            Panic = 5,
            /// The processor met an instruction or address that it cannot serve; `boot_detail` is the address of the instruction.
            HardFault = 6,
            /// The external clock stopped.
            ClockFailure = 7,
            /// The image does not have its checksum: it is damaged, or was written in part. The device takes part in nothing.
            ImageDamaged = 8,
        }

        /// Behaviour of the device when the link is lost and its buffer is empty.
        LinkLossPolicy {
            /// Hold for the hold time, then ramp down.
            HoldThenRamp = 0,
            /// Hold without limit.
            Hold = 1,
            /// Vent at once.
            Vent = 2,
        }

        /// How the pressure of a channel follows its reference while the device is Running.
        PressureLoopKind {
            /// Predicted pulses: by the model of valve and chamber, with gains that the device learns.
            Pulses = 0,
            /// Pulses of a PI controller with feed-forward, by the model alone.
            ProportionalIntegral = 1,
            /// A valve is open while the reading is more than a dead band off.
            OnOff = 2,
        }

        /// Motion of an actuator under pressure.
        MotionKind {
            /// Lengthens.
            Extension = 0,
            /// Widens.
            Expansion = 1,
            /// Bends.
            Bending = 2,
            /// Twists.
            Twisting = 3,
        }

        /// Meaning of a channel's setpoint, and its unit on the wire.
        SetpointKind {
            /// Gauge pressure, 1 Pa.
            Pressure = 0,
            /// Axial stretch (deformed over rest length), 1e-6.
            AxialStretch = 1,
            /// Outer radius, 1 nm.
            OuterRadius = 2,
            /// Inner radius, 1 nm.
            InnerRadius = 3,
            /// Twist of the free end, 1 urad.
            Twist = 4,
            /// Bend angle of the free end, 1 urad.
            BendAngle = 5,
        }

        /// Elastomer law.
        MaterialLaw {
            /// One coefficient: the shear modulus.
            NeoHookean = 0,
            /// Three coefficients C1, C2, C3.
            Yeoh = 1,
        }

        /// Where the fiber energy sits in the wall.
        FiberPlacement {
            /// A sheet at the winding radius.
            Sheet = 0,
            /// From the winding radius to the outer surface.
            Layer = 1,
            /// Through the whole wall.
            Smeared = 2,
        }

        /// The variable in which the pressure of an inverse table is a polynomial.
        TableArgument {
            /// The share of the way from the first setpoint to the last.
            Linear = 0,
            /// The square root of that share.
            Root = 1,
        }

        /// Valve of a channel.
        PulseDirection {
            /// The one that lets air in from the supply.
            Fill = 0,
            /// The one that lets air out to the atmosphere.
            Vent = 1,
        }

        /// Request of the host in a Command.
        CommandCode {
            /// Follow the buffered setpoints from the given time on.
            Start = 0,
            /// Close the valves and keep the pressure.
            Hold = 1,
            /// Ramp down, then open the vents.
            Vent = 2,
            /// Vent at once, cut the supply, latch a fault.
            EmergencyStop = 3,
            /// Forget latched faults; refused while the cause of one is still there.
            ClearFaults = 4,
            /// Drop all buffered setpoints; the next index is 0.
            Flush = 5,
            /// Take the zeros of the channels' sensors anew; refused where a chamber is under pressure.
            Zero = 6,
        }

        /// Outcome of a message, in its Ack.
        ResultCode {
            /// Applied.
            Ok = 0,
            /// The session is not the one that commands the device, or a Hello came while another one does.
            WrongSession = 1,
            /// Protocol version or schema hash differ.
            SchemaMismatch = 2,
            /// Not allowed in the present state; detail is the code of the fault that forbids it, or 0.
            WrongState = 3,
            /// A value is out of range; detail is the channel (Setpoint) or the field number (all others).
            OutOfRange = 4,
            /// Not the next setpoint; detail is the expected index.
            UnexpectedIndex = 5,
            /// No free place in the setpoint buffer.
            QueueFull = 6,
            /// The time is past, or not after the previous setpoint; a Start lies after the first buffered setpoint.
            Late = 7,
            /// The upload was not begun, is incomplete, does not fit together, or its hash differs.
            ConfigMismatch = 8,
            /// A code that the device does not know; detail is the field number.
            UnknownCode = 9,
            /// The number of values is not the number of channels; detail is the number of channels.
            WrongChannelCount = 10,
            /// A channel has no tables, and the device does not solve the model of its actuator; detail is the channel.
            TablesMissing = 11,
            /// Knots without a preceding knot: the first knot after a flush must be a Setpoint.
            NoKnotBefore = 12,
            /// A setpoint changes faster than its channel's limits in 100 ms; detail is the channel.
            TooFast = 13,
            /// A setpoint lies too far in the future; detail is the farthest distance, us.
            BeyondHorizon = 14,
        }

        /// Faults of the device; bit `code - 1` of the fault bits in Telemetry.
        FaultCode {
            /// A pressure sensor left its plausible band, or its zero is too far off.
            SensorImplausible = 1,
            /// A chamber pressure exceeded its limit.
            OverPressure = 2,
            /// No valid frame of the session within the link timeout.
            LinkLost = 3,
            /// The last buffered setpoint was reached while running; also how a run ends.
            SetpointsExhausted = 4,
            /// Supply pressure below its limit.
            SupplyLow = 5,
            /// Supply pressure above its limit.
            SupplyHigh = 6,
            /// Emergency stop by input or command.
            EmergencyStop = 7,
            /// No pressure reaches the requested deformation, three control periods in a row.
            InverseFailed = 8,
            /// Two control ticks within a second came late while running.
            TickOverrun = 9,
            /// A pressure sensor repeats its code while air flows.
            SensorFrozen = 10,
            /// A reading fell as no venting makes it: the hose of the sensor is off, sensors were exchanged, the vent stays open, or the chamber burst.
            ReadingJumped = 11,
            /// Filling does not raise a reading: a valve or the supply stays closed, a hose is kinked, coils are exchanged, or the sensor is wrong.
            FillWithoutEffect = 12,
            /// A chamber holds more air than its valves explain: the fill valve stays open, the vent stays closed, coils are exchanged, a hose is kinked, or
            /// the sensor is wrong.
            ExcessAir = 13,
            /// A chamber holds less air than its valves explain: the vent stays open, a leak or burst, the fill valve or the supply stays closed, a hose is
            /// kinked, or the sensor is wrong.
            MissingAir = 14,
            /// Voltage of the valves' supply below its limit: coils may not open their valves.
            ValveSupplyLow = 15,
        }

        /// Kind of a record in the log.
        LogKind {
            /// The device started; `code` is the BootCause, `detail` as `boot_detail` of HelloReply.
            Boot = 1,
            /// A fault was latched; `code` is the FaultCode, `detail` the `value` of Fault in two's complement.
            Fault = 2,
        }

        /// Whether the device stores records.
        LogCondition {
            /// The device has no memory for a log.
            Absent = 0,
            /// Records are stored.
            Kept = 1,
            /// The memory is full until the next start.
            Full = 2,
            /// The memory has no header record, or a record did not read back as written. The device stores no records until the next start.
            Failed = 3,
        }

        /// Content of a sample.
        SampleContent {
            /// State, pressures and duties, in Samples messages.
            Measurements = 0,
            /// Inputs of every control tick, in Ticks messages.
            Ticks = 1,
        }
    }

    flags {
        /// State of the digital outputs: on where the bit is set.
        Outputs {
            /// The gripper closes while it is on.
            GRIPPER = 0,
        }

        /// Condition of one channel.
        ChannelStatus {
            /// The sensor reading is not plausible.
            SENSOR_IMPLAUSIBLE = 0,
            /// The setpoint asked for a pressure beyond the channel's limits; the reference stops at them.
            REFERENCE_LIMITED = 1,
            /// No pressure was found for the setpoint; the last good one is kept.
            INVERSE_FAILED = 2,
        }

        /// Inputs of a control tick that are on or off.
        TickFlags {
            /// The emergency stop is pressed.
            EMERGENCY_STOP = 0,
        }
    }

    records {
        /// One channel in a Telemetry message.
        ChannelSample {
            /// Gauge pressure at the manifold, 10 Pa; clipped at 0. Above the chamber's while filling, below it while venting.
            pressure_10pa: u16,
            /// Gauge pressure that the loop tracks now, 10 Pa; `pressure_10pa` while it tracks none.
            reference_10pa: u16,
            /// Share of the control period in 1/127: positive fills, negative vents; -127..=127.
            duty: i8,
            /// Condition of the channel.
            status: ChannelStatus,
        }

        /// One knot in a Knots message, as the step from the preceding knot.
        KnotStep {
            /// Time since the preceding knot, us; 1..=65535.
            step_us: u16,
            /// State of the digital outputs from the time of the knot on.
            outputs: Outputs,
            /// Value minus that of the preceding knot, one per configured channel, in the unit of its setpoint.
            steps: List<i16>,
        }

        /// One channel in a Sample.
        PressureSample {
            /// Gauge pressure at the manifold, 10 Pa; clipped at 0.
            pressure_10pa: u16,
            /// Share of the control period in 1/127: positive fills, negative vents; -127..=127.
            duty: i8,
        }

        /// All channels at one time, in a Samples message.
        Sample {
            /// State at that time.
            state: Code<DeviceState>,
            /// One per configured channel.
            channels: List<PressureSample>,
        }

        /// Inputs of one control tick and a checksum of its outputs, in a Ticks message.
        Tick {
            /// Inputs that are on or off.
            flags: TickFlags,
            /// Code of the supply's sensor.
            supply_code: u16,
            /// Code of the voltage of the valves' supply.
            valve_supply_code: u16,
            /// CRC-32C of the outputs: fill and vent time of each configured channel (u16 each, us), then one byte each for supply valve, pump and digital outputs.
            outputs_crc: u32,
            /// Codes of the sensors, one per configured channel.
            codes: List<u16>,
        }

        /// One record of the log, in a LogRecords message.
        LogRecord {
            /// Number of the record; each has a higher one than those before, not always the next.
            number: u32,
            /// Number of the start of the device, from 1.
            start: u32,
            /// Kind of the record.
            kind: Code<LogKind>,
            /// Code; the kind determines its meaning.
            code: u8,
            /// Channel, from 0; 255 means the system.
            channel: u8,
            /// Detail; the kind determines its meaning.
            detail: u32,
            /// Device time since the start, us; 0 for a start.
            time_us: u64,
        }
    }

    /// A message from the host to the device.
    host HostMessage {
        /// Opens a session; the device answers with HelloReply.
        0x01 Hello Reliable {
            /// Protocol version of the host.
            protocol_version: u16,
            /// Schema hash of the host.
            schema_hash: u32,
            /// Number that the host draws for this session; every later message carries it.
            session: u16,
        }

        /// Keeps the link alive and exchanges clocks; the device answers with HeartbeatReply.
        0x02 Heartbeat Unacknowledged {
            /// Session.
            session: u16,
            /// Clock of the host, us; any epoch.
            host_time_us: u64,
        }

        /// Starts a configuration upload; forgets an unfinished one.
        0x03 ConfigBegin Reliable {
            /// Session.
            session: u16,
            /// Number of channels, 1..=27.
            channels: u8,
        }

        /// The part of the configuration that all channels share.
        0x04 ConfigSystem Reliable {
            /// Session.
            session: u16,
            /// Time between two Telemetry messages, us.
            telemetry_period_us: u32,
            /// Period of the valve pulses, us.
            control_period_us: u32,
            /// Silence after which the link counts as lost, us.
            link_timeout_us: u32,
            /// Time from holding to ramping down after link loss, us.
            hold_time_us: u32,
            /// Reaction to link loss.
            link_loss_policy: Code<LinkLossPolicy>,
            /// Slope of the ramp down, Pa/s.
            vent_ramp_pa_per_s: f32,
            /// Lowest supply pressure for running, gauge Pa.
            supply_min_pa: f32,
            /// Highest supply pressure, gauge Pa.
            supply_max_pa: f32,
            /// Atmospheric pressure, absolute Pa.
            atmosphere_pa: f32,
            /// Air temperature, K.
            temperature_k: f32,
            /// Sonic conductance of a valve (ISO 6358), m3/(s Pa).
            valve_conductance_m3_per_s_pa: f32,
            /// Critical pressure ratio of a valve (ISO 6358), 0..1.
            valve_critical_ratio: f32,
            /// From coil on to open, us.
            valve_on_delay_us: u32,
            /// From coil off to closed, us.
            valve_off_delay_us: u32,
            /// Sonic conductance of the line to the chamber, m3/(s Pa).
            line_conductance_m3_per_s_pa: f32,
            /// Gauge pressure at 10 % of the channel sensors' supply, Pa.
            sensor_min_pa: f32,
            /// Gauge pressure at 90 % of the channel sensors' supply, Pa.
            sensor_max_pa: f32,
            /// Gauge pressure at 10 % of the supply sensor's supply, Pa.
            supply_sensor_min_pa: f32,
            /// Gauge pressure at 90 % of the supply sensor's supply, Pa.
            supply_sensor_max_pa: f32,
            /// ADC code at 100 % of the sensor supply.
            adc_full_scale: u16,
            /// Pressure loop of the channels.
            pressure_loop: Code<PressureLoopKind>,
            /// Voltage of the valves' supply at `adc_full_scale`, mV; 0 if the board does not sense it.
            valve_supply_scale_mv: u16,
            /// Lowest voltage of the valves' supply, mV; 0 if it is not watched.
            valve_supply_min_mv: u16,
        }

        /// One channel: its actuator, its limits and the meaning of its setpoint.
        0x05 ConfigChannel Reliable {
            /// Session.
            session: u16,
            /// Channel, from 0.
            channel: u8,
            /// Motion of the actuator.
            motion: Code<MotionKind>,
            /// Meaning and unit of the setpoint.
            setpoint_kind: Code<SetpointKind>,
            /// Elastomer law.
            law: Code<MaterialLaw>,
            /// Fiber families: 0 no fiber, 1 one helix, 2 two mirrored helices.
            families: u8,
            /// Where the fiber energy sits.
            placement: Code<FiberPlacement>,
            /// Inner radius at rest, m.
            inner_radius_m: f32,
            /// Outer radius at rest, m.
            outer_radius_m: f32,
            /// Length at rest, m.
            length_m: f32,
            /// Shear modulus (neo-Hookean) or C1 (Yeoh), Pa.
            c_pa_1: f32,
            /// C2 (Yeoh), Pa; unused otherwise.
            c_pa_2: f32,
            /// C3 (Yeoh), Pa; unused otherwise.
            c_pa_3: f32,
            /// Fiber angle from the hoop, rad.
            fiber_angle_rad: f32,
            /// Fiber modulus of one family, Pa.
            fiber_modulus_pa: f32,
            /// Thickness of the fiber sheet, m.
            fiber_thickness_m: f32,
            /// Winding radius at rest, m.
            fiber_radius_m: f32,
            /// Highest chamber pressure, gauge Pa; the reference stops 3 kPa below it, or 10 % of it where that is less.
            pressure_max_pa: f32,
            /// Air volume of fittings and line, m3.
            dead_volume_m3: f32,
            /// Lowest setpoint, in the unit of the setpoint.
            setpoint_min: i32,
            /// Highest setpoint, in the unit of the setpoint.
            setpoint_max: i32,
        }

        /// Ends a configuration upload: the device swaps to it as a whole, or keeps the old one.
        0x06 ConfigCommit Reliable {
            /// Session.
            session: u16,
            /// CRC-32C over all payloads of the upload in the order sent, each without its session.
            config_hash: u32,
        }

        /// Asks for a change of state.
        0x07 Command Reliable {
            /// Session.
            session: u16,
            /// The command.
            code: Code<CommandCode>,
            /// Device time at which Start takes effect, us; 0 means now. Other commands ignore it.
            time_us: u64,
        }

        /// One knot of the trajectory; between two knots the device interpolates linearly.
        0x08 Setpoint Indexed {
            /// Session.
            session: u16,
            /// Number of the knot since the last flush or configuration, from 0 without gaps.
            index: u32,
            /// Device time of the knot, us; strictly increasing.
            time_us: u64,
            /// State of the digital outputs from the time of the knot on.
            outputs: Outputs,
            /// One value per configured channel, in the unit of its setpoint.
            values: List<i32>,
        }

        /// Volume of the channel that was sent last, as a table; without it the device follows its model, if it has one of the actuator.
        0x09 ConfigVolume Reliable {
            /// Session.
            session: u16,
            /// Channel, from 0.
            channel: u8,
            /// Gauge pressure at which the table ends, Pa; it begins at 0.
            pressure_max_pa: f32,
            /// Chebyshev coefficients of the actuator's volume over the pressure, m3, from the constant one; at most 17.
            coefficients_m3: List<f32>,
        }

        /// Pressure for a setpoint of the channel that was sent last, as a table; without it the device follows its model, if it has one of the actuator.
        0x0a ConfigInverse Reliable {
            /// Session.
            session: u16,
            /// Channel, from 0.
            channel: u8,
            /// Argument of the polynomial.
            argument: Code<TableArgument>,
            /// Steps that the argument is rounded to.
            steps: u16,
            /// Setpoint at gauge pressure 0, SI units.
            setpoint_from: f32,
            /// Setpoint at `pressure_max_pa`, SI units; above or below `setpoint_from`.
            setpoint_to: f32,
            /// Gauge pressure at which the table ends, Pa.
            pressure_max_pa: f32,
            /// Chebyshev coefficients of the pressure over the argument, Pa, from the constant one; at most 17.
            coefficients_pa: List<f32>,
        }

        /// Opens one valve for a time, by hand; the valve closes by itself.
        0x0b ManualPulse Reliable {
            /// Session.
            session: u16,
            /// Channel, from 0.
            channel: u8,
            /// The valve.
            direction: Code<PulseDirection>,
            /// Time for which its coil is energized, us.
            duration_us: u32,
        }

        /// Switches the digital outputs by hand.
        0x0c SetOutputs Reliable {
            /// Session.
            session: u16,
            /// State of all outputs from the next tick on.
            outputs: Outputs,
        }

        /// Several knots of the trajectory, each as the step from the preceding one.
        0x0d Knots Indexed {
            /// Session.
            session: u16,
            /// Number of the first knot, as in Setpoint; the others follow without gaps.
            index: u32,
            /// The knots in order.
            knots: Batch<KnotStep>,
        }

        /// Requests Samples or Ticks beside the Telemetry, until the next session; Samples until the next configuration.
        0x0e SetSampling Reliable {
            /// Session.
            session: u16,
            /// Time between two samples, us; 0 stops them.
            period_us: u32,
            /// Samples in one message.
            samples: u8,
            /// Content of a sample.
            content: Code<SampleContent>,
        }

        /// Requests LinkErrors; changes nothing.
        0x0f ReadLinkErrors Reliable {
            /// Session.
            session: u16,
        }

        /// Requests a part of the log; changes nothing.
        0x10 ReadLog Reliable {
            /// Session.
            session: u16,
            /// Number from which on records are requested; 0 for the oldest.
            first: u32,
        }
    }

    /// A message from the device to the host.
    device DeviceMessage {
        /// Answers Hello.
        0x81 HelloReply Unacknowledged {
            /// Protocol version of the device.
            protocol_version: u16,
            /// Schema hash of the device.
            schema_hash: u32,
            /// Session of the Hello; if the Hello was refused, the commanding session.
            session: u16,
            /// Firmware version, major.
            firmware_major: u8,
            /// Firmware version, minor.
            firmware_minor: u8,
            /// Firmware version, patch.
            firmware_patch: u8,
            /// Why the device last started.
            boot_cause: Code<BootCause>,
            /// Where it stopped before it started, by the cause; 0 where that is unknown.
            boot_detail: u32,
            /// Present state.
            state: Code<DeviceState>,
            /// Channels of this device.
            channels_max: u8,
            /// Places in the setpoint buffer.
            knots_capacity: u16,
            /// Period of the control tick, us.
            tick_us: u32,
            /// Hash of the active configuration, as in ConfigCommit; 0 means none.
            config_hash: u32,
            /// Device time, us.
            mcu_time_us: u64,
        }

        /// Answers every reliable message and every Setpoint.
        0x82 Ack Unacknowledged {
            /// Type byte of the answered message.
            ref_type: u8,
            /// Sequence number of the answered frame.
            ref_seq: u16,
            /// Outcome.
            result: Code<ResultCode>,
            /// Depends on the outcome; 0 otherwise.
            detail: u32,
            /// Free places in the setpoint buffer.
            free_knots: u16,
            /// Device time, us.
            mcu_time_us: u64,
        }

        /// Answers Heartbeat.
        0x83 HeartbeatReply Unacknowledged {
            /// The host time of the Heartbeat, us.
            host_time_us: u64,
            /// Device time, us.
            mcu_time_us: u64,
            /// Present state.
            state: Code<DeviceState>,
            /// Free places in the setpoint buffer.
            free_knots: u16,
        }

        /// Measurements, sent periodically once configured.
        0x84 Telemetry Unacknowledged {
            /// Device time of the sample, us.
            time_us: u64,
            /// Present state.
            state: Code<DeviceState>,
            /// Faults since they were last cleared, bit `code - 1` each.
            fault_bits: u16,
            /// Supply pressure, gauge, 10 Pa; clipped at 0.
            supply_10pa: u16,
            /// Voltage of the valves' supply, mV; 65535 if the board does not sense it.
            valve_supply_mv: u16,
            /// Free places in the setpoint buffer.
            free_knots: u16,
            /// The setpoint index that the device expects next.
            next_index: u32,
            /// Control ticks that came late; stays at 65535.
            ticks_late: u16,
            /// The most that the stack has held since the start, bytes; 0 where it is not measured.
            stack_used: u16,
            /// Present state of the digital outputs.
            outputs: Outputs,
            /// One sample per configured channel.
            channels: List<ChannelSample>,
        }

        /// Tells of a fault when it occurs.
        0x85 Fault Unacknowledged {
            /// Device time of the fault, us.
            time_us: u64,
            /// Channel, from 0; 255 means the system.
            channel: u8,
            /// Kind of fault.
            code: Code<FaultCode>,
            /// The offending value; its meaning depends on the code.
            value: i32,
        }

        /// Several consecutive measurements, sent after a SetSampling.
        0x86 Samples Unacknowledged {
            /// Device time of the first sample, us.
            time_us: u64,
            /// Time from one sample to the next, us.
            period_us: u32,
            /// Samples dropped since SetSampling because the transmitter was full; stays at its maximum.
            left_out: u32,
            /// The samples in order.
            samples: Batch<Sample>,
        }

        /// Inputs of consecutive control ticks, sent after a SetSampling of Ticks.
        0x87 Ticks Unacknowledged {
            /// Device time of the first tick, us; the others follow each 1000 us.
            time_us: u64,
            /// Ticks dropped since SetSampling because the transmitter was full; stays at its maximum.
            left_out: u32,
            /// The ticks in order.
            ticks: Batch<Tick>,
        }

        /// Serial-port errors since the device started. Each count stops at its maximum.
        0x88 LinkErrors Unacknowledged {
            /// Overrun errors: a byte arrived before the previous one was read. Each loses at least one byte.
            overrun: u32,
            /// Framing errors: a byte without a stop bit, as from another baud rate or a broken line.
            framing: u32,
            /// Noise errors: the samples within one bit disagreed.
            noise: u32,
            /// Parity errors; always 0 on a port without parity.
            parity: u32,
            /// Intact bytes dropped because the receive queue was full.
            queue_full: u32,
        }

        /// Records of the log in order, before the LogState that answers a ReadLog.
        0x89 LogRecords Unacknowledged {
            /// The records.
            records: Batch<LogRecord>,
        }

        /// Answers ReadLog.
        0x8a LogState Unacknowledged {
            /// Whether records are stored.
            condition: Code<LogCondition>,
            /// Records since the start that were not stored; stays at its maximum.
            unstored: u32,
            /// Number that the next record gets.
            next: u32,
            /// First number of the next request; the log ends if it equals `next`.
            until: u32,
            /// Records in the LogRecords before this message; 0 without one.
            records: u8,
        }
    }
}

/// The `channel` of a [`Fault`] that concerns no single channel.
pub const SYSTEM_CHANNEL: u8 = 0xFF;

impl Telemetry {
    /// `valve_supply_mv` of a board that does not sense the voltage; no voltage reaches it.
    pub const VALVE_SUPPLY_NOT_SENSED: u16 = u16::MAX;
}

impl LinkErrors {
    /// No error.
    pub const NONE: Self = Self { overrun: 0, framing: 0, noise: 0, parity: 0, queue_full: 0 };
}

impl LogState {
    /// The answer of a device without a memory for a log.
    pub const ABSENT: Self =
        Self { condition: Code::from_raw(LogCondition::Absent as u8), unstored: 0, next: 0, until: 0, records: 0 };
}

impl FaultCode {
    /// The bit of this fault in [`Telemetry::fault_bits`].
    #[must_use]
    pub const fn bit(self) -> u16 {
        1 << (self as u8 - 1)
    }
}
