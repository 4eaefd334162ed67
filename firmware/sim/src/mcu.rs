//! The simulated MCU as its host sees it.

use softlimb_firmware::{Board, BootInfo, Controller, TickInputs, TickOutputs, exchange, turn};
use softlimb_plant::{PartFault, Plant, PlantError, Snapshot, Truth};
use softlimb_protocol::{BootCause, MAX_CHANNELS};

use crate::board::SimulatedBoard;
use crate::clock::Clocks;
use crate::error::{EmulatorError, SimError};
use crate::line::Line;
use crate::noise::Noise;
use crate::settings::{LineFaults, SimSettings};

/// Processor that runs the controller.
pub trait Processor {
    /// One turn of the device: samples in, coil times out, bytes both ways.
    ///
    /// # Errors
    /// [`EmulatorError`] where the processor is emulated and the emulator fails: it will not run again.
    fn turn(&mut self, board: &mut dyn Board) -> Result<(), EmulatorError>;

    /// The second look at the link in a tick, at a time of the device's clock, us. A processor whose link goes by ticks alone leaves it out.
    ///
    /// # Errors
    /// [`EmulatorError`], as [`turn`](Self::turn).
    fn exchange(&mut self, _board: &mut dyn Board, _now_us: u64) -> Result<(), EmulatorError> {
        Ok(())
    }

    /// Makes the program stop by a fault of the processor: its next turn is the first of a new start.
    ///
    /// # Errors
    /// [`EmulatorError`] where the processor is emulated and the emulator fails.
    fn crash(&mut self) -> Result<(), EmulatorError>;

    /// The most channels that it drives.
    fn channels_max(&self) -> usize {
        MAX_CHANNELS
    }

    /// Time of the device's clock at its first tick, us.
    fn first_tick_us(&self) -> u64 {
        0
    }

    /// Whether the outputs are those of pins: one tick after the controller's decision, in steps of a pin's clock.
    fn is_at_pins(&self) -> bool {
        false
    }
}

/// The controller on this very computer.
pub type Here = Box<Controller>;

/// The controller on this very computer, switched on.
pub fn here() -> Here {
    Box::new(Controller::new(BootInfo { cause: BootCause::PowerOn, detail: 0 }))
}

impl Processor for Here {
    fn turn(&mut self, board: &mut dyn Board) -> Result<(), EmulatorError> {
        turn(self.as_mut(), board);
        Ok(())
    }

    fn exchange(&mut self, board: &mut dyn Board, now_us: u64) -> Result<(), EmulatorError> {
        exchange(self.as_mut(), board, now_us);
        Ok(())
    }

    fn crash(&mut self) -> Result<(), EmulatorError> {
        **self = Controller::new(BootInfo { cause: BootCause::HardFault, detail: 0 });
        Ok(())
    }
}

impl Processor for Box<dyn Processor> {
    fn turn(&mut self, board: &mut dyn Board) -> Result<(), EmulatorError> {
        self.as_mut().turn(board)
    }

    fn exchange(&mut self, board: &mut dyn Board, now_us: u64) -> Result<(), EmulatorError> {
        self.as_mut().exchange(board, now_us)
    }

    fn crash(&mut self) -> Result<(), EmulatorError> {
        self.as_mut().crash()
    }

    fn first_tick_us(&self) -> u64 {
        self.as_ref().first_tick_us()
    }

    fn channels_max(&self) -> usize {
        self.as_ref().channels_max()
    }

    fn is_at_pins(&self) -> bool {
        self.as_ref().is_at_pins()
    }
}

/// Controller, plant and line in virtual time. All times are the host's, in us from 0, unless the name says device.
#[derive(Debug)]
pub struct SimulatedMcu<P = Here> {
    processor: P,
    board: SimulatedBoard,
    now_us: u64,
    /// Whether the second look of the present tick is over.
    has_looked: bool,
    failure: Option<EmulatorError>,
    has_failed: bool,
}

impl SimulatedMcu {
    /// A device that is switched on at host time 0 with an empty limb.
    ///
    /// # Errors
    /// [`SimError`] names the first setting that is not accepted.
    pub fn new(settings: &SimSettings) -> Result<Self, SimError> {
        Self::with_processor(settings, here())
    }

    /// The controller, for tests: a real host sees it only through the link.
    pub fn controller(&self) -> &Controller {
        &self.processor
    }
}

impl<P: Processor> SimulatedMcu<P> {
    /// A device with the given processor that is switched on at host time 0 with an empty limb.
    ///
    /// # Errors
    /// [`SimError`] names the first setting that is not accepted.
    pub fn with_processor(settings: &SimSettings, processor: P) -> Result<Self, SimError> {
        settings.check()?;
        let (channels, max) = (settings.plant.channels.len(), processor.channels_max());
        if channels > max {
            return Err(SimError::TooManyChannels { channels, max });
        }
        let line = |place| Line::new(settings.baud, settings.line_faults, Noise::new(settings.seed, place));
        let offset_us = settings.clock_offset_us + processor.first_tick_us();
        let clocks = Clocks::new(offset_us, settings.clock_drift_ppm);
        Ok(Self {
            processor,
            board: SimulatedBoard::new(Plant::new(&settings.plant)?, line(0), line(1), clocks),
            now_us: 0,
            has_looked: false,
            failure: None,
            has_failed: false,
        })
    }

    /// Host time, us.
    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Host time of the next control tick, us.
    pub fn next_tick_us(&self) -> u64 {
        self.board.clocks.host_us(self.board.tick)
    }

    /// Device time up to which the plant has come, us: the time that [`truth`](Self::truth) belongs to.
    pub fn device_time_us(&self) -> u64 {
        self.board.clocks.device_us(self.board.tick)
    }

    /// Lets time pass up to `host_us`, with every tick on the way. A time in the past changes nothing. A processor that has failed
    /// leaves its outputs as they were and is silent.
    pub fn advance_to(&mut self, host_us: u64) {
        loop {
            self.look(host_us);
            if self.next_tick_us() > host_us {
                break;
            }
            self.board.begin_tick();
            self.work(|processor, board| processor.turn(board));
            self.board.finish_tick();
            self.has_looked = false;
        }
        self.now_us = self.now_us.max(host_us);
    }

    /// The second look at the link in the present tick, once its time has come.
    fn look(&mut self, host_us: u64) {
        if self.has_looked || self.board.look_us().is_none_or(|look_us| look_us > host_us) {
            return;
        }
        self.has_looked = true;
        if let Some(device_us) = self.board.begin_look() {
            self.work(|processor, board| processor.exchange(board, device_us));
        }
    }

    fn work(&mut self, work: impl FnOnce(&mut P, &mut SimulatedBoard) -> Result<(), EmulatorError>) {
        if !self.has_failed {
            self.failure = work(&mut self.processor, &mut self.board).err();
            self.has_failed = self.failure.is_some();
        }
    }

    /// Hands bytes to the line now; they reach the device at the speed of the line.
    pub fn write(&mut self, bytes: &[u8]) {
        self.board.to_device.write(self.now_us * 1_000, bytes);
    }

    /// Appends the bytes that have arrived from the device.
    pub fn read(&mut self, into: &mut Vec<u8>) {
        let now_ns = self.now_us * 1_000;
        into.extend(std::iter::from_fn(|| self.board.to_host.read(now_ns)));
    }

    /// Whether a byte from the device has arrived.
    pub fn is_readable(&self) -> bool {
        self.board.to_host.is_readable(self.now_us * 1_000)
    }

    /// True state of the plant, air used included, at [`device_time_us`](Self::device_time_us).
    pub fn truth(&self) -> Truth {
        self.board.plant.truth()
    }

    /// Writes the changing part of the truth of now over another, for [`truth_of`](Self::truth_of) later.
    pub fn snapshot(&self, into: &mut Snapshot) {
        self.board.plant.snapshot(into);
    }

    /// The truth at the time of a snapshot of this device.
    pub fn truth_of(&self, snapshot: &Snapshot) -> Truth {
        self.board.plant.truth_of(snapshot)
    }

    /// Outputs to the valves, the supply and the pump in the latest tick.
    pub fn outputs(&self) -> TickOutputs {
        self.board.outputs()
    }

    /// Inputs of the controller in the latest tick; those of an emulated chip that counts its ticks itself are put where its converter would.
    pub fn inputs(&self) -> TickInputs {
        self.board.latest_inputs()
    }

    /// Number of channels of the plant.
    pub fn channels(&self) -> usize {
        self.board.plant.pressure_codes().len()
    }

    /// Why the processor does not run any more, if it does not.
    pub fn failure(&self) -> Option<&EmulatorError> {
        self.failure.as_ref()
    }

    /// The same, to be kept; the device stays silent.
    pub fn take_failure(&mut self) -> Option<EmulatorError> {
        self.failure.take()
    }

    /// The processor.
    pub fn processor(&self) -> &P {
        &self.processor
    }

    /// The processor, to be meddled with.
    pub fn processor_mut(&mut self) -> &mut P {
        &mut self.processor
    }

    /// Presses or releases the emergency stop.
    pub fn set_emergency_stop(&mut self, pressed: bool) {
        self.board.emergency_stop = pressed;
    }

    /// Changes the faults of the line, each way, for later bytes.
    ///
    /// # Errors
    /// [`SimError::OutOfRange`] for a probability outside 0..=1.
    pub fn set_line_faults(&mut self, faults: LineFaults) -> Result<(), SimError> {
        faults.check()?;
        self.board.to_device.set_faults(faults);
        self.board.to_host.set_faults(faults);
        Ok(())
    }

    /// Whether the plant has the part of a fault.
    ///
    /// # Errors
    /// As [`inject`](Self::inject).
    pub fn can_break(&self, channel: usize, fault: &PartFault) -> Result<(), PlantError> {
        self.board.plant.can_break(channel, fault)
    }

    /// Highest true gauge pressure of each chamber since the start, Pa.
    pub fn peak_chamber_pa(&self) -> Vec<f64> {
        self.board.plant.peak_chamber_pa()
    }

    /// True gauge pressure of each chamber at [`device_time_us`](Self::device_time_us), Pa.
    pub fn chamber_pa(&self) -> impl Iterator<Item = f64> {
        self.board.plant.chamber_pa()
    }

    /// Breaks a part of the plant from the next tick on.
    ///
    /// # Errors
    /// [`PlantError`] when there is no such channel or the fault is out of range.
    pub fn inject(&mut self, channel: usize, fault: PartFault) -> Result<(), PlantError> {
        self.board.plant.inject(channel, fault)
    }
}
