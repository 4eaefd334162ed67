//! The board around the controller: its converters read the plant, its coils drive it, its link is the line.

use softlimb_firmware::log::{Log, LogMemory, prepare};
use softlimb_firmware::{AdcCode, Board, LOOK_US, TickInputs, TickOutputs};
use softlimb_plant::{ChannelDrive, Drive, Plant};
use softlimb_protocol::{MAX_CHANNELS, Outputs};

use crate::clock::Clocks;
use crate::line::Line;
use crate::memory::ArrayMemory;

/// Bytes that the transmitter takes before they have left: what a DMA buffer holds.
const TRANSMIT_BUFFER: usize = 256;

/// Pins, converters and link, all simulated.
#[derive(Debug)]
pub(crate) struct SimulatedBoard {
    pub(crate) plant: Plant,
    pub(crate) to_device: Line,
    pub(crate) to_host: Line,
    pub(crate) clocks: Clocks,
    /// Ticks begun so far: the number of the next one.
    pub(crate) tick: u64,
    /// Host time of the turn or look in progress, us.
    now_us: u64,
    pub(crate) emergency_stop: bool,
    inputs: TickInputs,
    outputs: TickOutputs,
    log: Log,
    log_memory: ArrayMemory,
}

impl SimulatedBoard {
    pub(crate) fn new(plant: Plant, to_device: Line, to_host: Line, clocks: Clocks) -> Self {
        let outputs = TickOutputs::SAFE;
        let (log, mut log_memory) = (Log::new(), ArrayMemory::new());
        prepare(&mut log_memory);
        let pressure = [AdcCode(0); MAX_CHANNELS];
        let inputs = TickInputs {
            now_us: clocks.device_us(0),
            pressure,
            supply: AdcCode(0),
            valve_supply: AdcCode(0),
            emergency_stop: false,
        };
        Self {
            plant,
            to_device,
            to_host,
            clocks,
            tick: 0,
            now_us: 0,
            emergency_stop: false,
            inputs,
            outputs,
            log,
            log_memory,
        }
    }

    /// Begins the next tick.
    pub(crate) fn begin_tick(&mut self) {
        self.now_us = self.clocks.host_us(self.tick);
    }

    /// Host time of the second look at the link in the present tick, us; none before the first tick.
    pub(crate) fn look_us(&self) -> Option<u64> {
        Some(self.clocks.host_us_at(self.tick.checked_sub(1)?, LOOK_US))
    }

    /// Begins the second look at the link in the present tick. Device time of it, us; `None` without a new byte.
    pub(crate) fn begin_look(&mut self) -> Option<u64> {
        self.now_us = self.look_us()?;
        let has_bytes = self.to_device.is_readable(self.now_ns());
        has_bytes.then(|| self.clocks.device_us(self.tick - 1) + LOOK_US)
    }

    /// Lets the plant follow the outputs of the present tick up to the next.
    pub(crate) fn finish_tick(&mut self) {
        let channels =
            self.outputs.valves.map(|valves| ChannelDrive { fill_us: valves.fill_us, vent_us: valves.vent_us });
        self.plant.step(&Drive {
            channels: &channels,
            supply_open: self.outputs.supply_open,
            pump: f64::from(self.outputs.pump_duty) / 255.0,
            gripper_on: self.outputs.digital.contains(Outputs::GRIPPER),
        });
        self.tick += 1;
    }

    pub(crate) fn outputs(&self) -> TickOutputs {
        self.outputs
    }

    pub(crate) fn latest_inputs(&self) -> TickInputs {
        self.inputs
    }

    fn now_ns(&self) -> u64 {
        self.now_us * 1_000
    }
}

impl Board for SimulatedBoard {
    fn inputs(&mut self) -> TickInputs {
        let mut pressure = [AdcCode(0); MAX_CHANNELS];
        for (input, &code) in pressure.iter_mut().zip(self.plant.pressure_codes()) {
            *input = AdcCode(code);
        }
        self.inputs = TickInputs {
            now_us: self.clocks.device_us(self.tick),
            pressure,
            supply: AdcCode(self.plant.supply_code()),
            valve_supply: AdcCode(self.plant.valve_supply_code()),
            emergency_stop: self.emergency_stop,
        };
        self.inputs
    }

    fn apply(&mut self, outputs: &TickOutputs) {
        self.outputs = *outputs;
    }

    fn read_link(&mut self, into: &mut [u8]) -> usize {
        let now_ns = self.now_ns();
        let mut count = 0;
        for place in into {
            let Some(byte) = self.to_device.read(now_ns) else { break };
            *place = byte;
            count += 1;
        }
        count
    }

    fn log(&mut self) -> Option<(&mut Log, &mut dyn LogMemory)> {
        Some((&mut self.log, &mut self.log_memory))
    }

    fn write_link(&mut self, bytes: &[u8]) {
        self.to_host.write(self.now_ns(), bytes);
    }

    fn link_room(&self) -> usize {
        TRANSMIT_BUFFER.saturating_sub(self.to_host.backlog(self.now_ns()))
    }
}
