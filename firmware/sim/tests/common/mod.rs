//! A host without cares around the simulated device: says what it is told to, hears everything.
#![allow(dead_code, unreachable_pub, reason = "each user takes its own part")]

#[path = "../../../tests/common/configuration.rs"]
mod configuration;
mod tables;

use fra_model::{ActuatorParameters, Material, Motion};
use softlimb_plant::{ChannelSettings, PlantSettings};
use softlimb_protocol::*;
use softlimb_sim::{Here, Processor, SimSettings, SimulatedMcu};

pub const SESSION: u16 = 0x51AB;

/// Time given to every message and its answer, us; an emulated serial port may take longer, beside other work above all.
const ANSWER_US: u64 = 8_000;
const ANSWER_MAX_US: u64 = 2_000_000;

/// Longest time until a configured device is ready, us: it names a reading that does not come to rest by then.
const READY_MAX_US: u64 = 5_200_000;

/// `channels` bending actuators of about 80 mL on a pump and a reservoir.
pub fn settings(channels: usize) -> SimSettings {
    let actuator = ActuatorParameters {
        motion: Motion::Bending,
        inner_radius_m: 15e-3,
        outer_radius_m: 20e-3,
        length_m: 0.1132,
        material: Material::NeoHookean { shear_modulus_pa: 0.4e6 },
        fiber: None,
    };
    SimSettings::new(PlantSettings::new(3, vec![ChannelSettings::new(actuator); channels]))
}

pub struct Host<P = Here> {
    pub mcu: SimulatedMcu<P>,
    /// All messages of the device, with the host time at which they were read.
    pub heard: Vec<(u64, DeviceMessage)>,
    /// All bytes of the device.
    pub bytes: Vec<u8>,
    /// Configuration of the whole device.
    pub system: ConfigSystem,
    decoder: Decoder<DeviceMessage>,
    seq: u16,
}

impl Host {
    pub fn new(settings: &SimSettings) -> Self {
        Self::on(SimulatedMcu::new(settings).expect("good settings"))
    }
}

impl<P: Processor> Host<P> {
    pub fn on(mcu: SimulatedMcu<P>) -> Self {
        let (heard, bytes) = (Vec::new(), Vec::new());
        Self { mcu, heard, bytes, system: system(), decoder: Decoder::new(), seq: 0 }
    }

    pub fn send(&mut self, message: impl Into<HostMessage>) {
        let mut frame = [0; MAX_FRAME_LEN];
        let len = encode_frame(&message.into(), self.seq, &mut frame).expect("a frame");
        self.seq += 1;
        self.mcu.write(&frame[..len]);
    }

    /// Lets time pass in steps of at most 1 ms and reads what arrives.
    pub fn wait(&mut self, us: u64) {
        let end_us = self.mcu.now_us() + us;
        while self.mcu.now_us() < end_us {
            self.mcu.advance_to((self.mcu.now_us() + 1_000).min(end_us));
            let before = self.bytes.len();
            self.mcu.read(&mut self.bytes);
            for &byte in &self.bytes[before..] {
                if let Some(Ok(frame)) = self.decoder.push(byte) {
                    self.heard.push((self.mcu.now_us(), frame.message));
                }
            }
        }
    }

    /// Sends a message and wants it applied.
    pub fn demand(&mut self, message: impl Into<HostMessage>) {
        let result = self.ask(message);
        assert_eq!(result, Some(ResultCode::Ok), "{:?}", self.mcu.failure());
    }

    /// Sends a message; what the device says to it.
    pub fn ask(&mut self, message: impl Into<HostMessage>) -> Option<ResultCode> {
        let (seq, before, began_us) = (self.seq, self.heard.len(), self.mcu.now_us());
        self.send(message);
        self.wait(ANSWER_US);
        loop {
            let answer = self.heard[before..].iter().find_map(|(_, message)| match message {
                DeviceMessage::Ack(ack) if ack.ref_seq == seq => Some(ack.result.known()),
                _ => None,
            });
            if answer.is_some() || self.mcu.now_us() > began_us + ANSWER_MAX_US {
                return answer.flatten();
            }
            self.wait(1_000);
        }
    }

    /// Opens a session, configures `channels` pressure channels, waits until the device is ready.
    pub fn get_ready(&mut self, channels: usize, kind: SetpointKind) {
        self.configure(channels, kind);
        let is_ready =
            |host: &Self| host.telemetry().last().is_some_and(|last| last.state.known() == Some(DeviceState::Ready));
        let until_us = self.mcu.now_us() + READY_MAX_US;
        while !is_ready(self) {
            assert!(self.mcu.now_us() < until_us, "{:?}", self.telemetry().last());
            self.wait(20_000);
        }
    }

    /// Opens a session and configures `channels` pressure channels.
    pub fn configure(&mut self, channels: usize, kind: SetpointKind) {
        self.demand(Hello { protocol_version: PROTOCOL_VERSION, schema_hash: SCHEMA_HASH, session: SESSION });
        let begin = ConfigBegin { session: SESSION, channels: channels as u8 };
        let mut hash = ConfigHash::begin(&begin);
        hash.add_system(&self.system);
        self.demand(begin);
        self.demand(self.system.clone());
        for channel in 0..channels {
            for part in tables::parts(&config_channel(channel, kind), &mut hash) {
                self.demand(part);
            }
        }
        self.demand(ConfigCommit { session: SESSION, config_hash: hash.value() });
    }

    pub fn setpoint(&mut self, index: u32, time_us: u64, values: &[i32]) {
        let values = List::from_slice(values).expect("1 to 27 channels");
        self.send(Setpoint { session: SESSION, index, time_us, outputs: Outputs::default(), values });
    }

    pub fn telemetry(&self) -> impl Iterator<Item = &Telemetry> {
        self.heard.iter().filter_map(|(_, message)| match message {
            DeviceMessage::Telemetry(telemetry) => Some(telemetry),
            _ => None,
        })
    }
}

pub fn system() -> ConfigSystem {
    ConfigSystem {
        link_timeout_us: 200_000,
        supply_min_pa: 100e3,
        supply_max_pa: 240e3,
        ..configuration::system(SESSION)
    }
}

/// A bending actuator; where its stretch is asked for, a wound tube of the same size that lengthens.
pub fn config_channel(channel: usize, kind: SetpointKind) -> ConfigChannel {
    if kind == SetpointKind::AxialStretch {
        return ConfigChannel {
            motion: MotionKind::Extension.into(),
            setpoint_kind: kind.into(),
            families: 2,
            fiber_angle_rad: 0.05,
            fiber_modulus_pa: 361e6,
            fiber_thickness_m: 0.178e-3,
            fiber_radius_m: 20e-3,
            setpoint_min: 999_000,
            setpoint_max: 1_200_000,
            ..config_channel(channel, SetpointKind::Pressure)
        };
    }
    ConfigChannel {
        session: SESSION,
        channel: channel as u8,
        motion: MotionKind::Bending.into(),
        setpoint_kind: kind.into(),
        law: MaterialLaw::NeoHookean.into(),
        families: 0,
        placement: FiberPlacement::Sheet.into(),
        inner_radius_m: 15e-3,
        outer_radius_m: 20e-3,
        length_m: 0.1132,
        c_pa_1: 0.4e6,
        c_pa_2: 0.0,
        c_pa_3: 0.0,
        fiber_angle_rad: 0.0,
        fiber_modulus_pa: 0.0,
        fiber_thickness_m: 0.0,
        fiber_radius_m: 0.0,
        pressure_max_pa: 150e3,
        dead_volume_m3: 6.9e-6,
        setpoint_min: 0,
        setpoint_max: if kind == SetpointKind::Pressure { 140_000 } else { 1_000_000 },
    }
}
