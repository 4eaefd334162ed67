//! The file that is flashed, on an emulated chip, tick by tick.
//!
//! The emulator stops where a tick begins. There the codes of the sensors are put where the converter would have put
//! them, what the ports are told in this tick becomes of the valves, and the link's bytes go to and from the serial port. Nothing in
//! the image knows of it. Time in the emulator passes only in between, however busy this computer is.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::Stdio;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use softlimb_firmware::Board;
use softlimb_image_stm32f4::pins::CHANNELS;
use softlimb_image_stm32f4::samples::ROUNDS;

use super::channels::widened;
use super::halt::Halt;
use super::qemu::{Qemu, image};
use super::remote::{Remote, connect};
use super::{elf, pins};
use crate::error::EmulatorError;
use crate::mcu::Processor;

/// As for the twin: an instruction takes 2^3 ns of the emulated time, and nothing waits for this computer's clock.
const PACE: &str = "shift=3,sleep=off";

/// Start of every tick: an instruction that does nothing, and the length of it.
const TICK: &str = "tick_begins";
const NOTHING_LEN: u32 = 2;

/// A function that uses the stack.
const TURN: &str = "EXTI0";

/// The device's clock counts ticks, and its first turn comes with the first of them.
const FIRST_TICK_US: u64 = 1_000;

/// Longest wait of a byte for room on the way to the emulator. A stopped one takes nothing once its port is full, so that whoever waited
/// for ever would keep it stopped.
const PATIENCE: Duration = Duration::from_millis(1);

/// Numbers of registers.
const FIRST_ARGUMENT: u32 = 0;
const STACK_POINTER: u32 = 13;

/// An address that no instruction can be fetched from.
const NOWHERE: u32 = 0xf000_0000;

/// Entry of the table of vectors for the interrupt that cannot be masked.
const NON_MASKABLE_VECTOR: u32 = 0x0800_0008;

/// The instruction that goes to itself.
const BRANCH_HERE: u16 = 0xe7fe;

/// The emulated chip.
#[derive(Debug)]
pub struct Flashed {
    remote: Remote,
    serial: UnixStream,
    /// Bytes for the device, sent as soon as there is room.
    unsent: Vec<u8>,
    /// Bytes of the device.
    received: Receiver<Vec<u8>>,
    /// Address to go on at; `None` for the present one.
    next: Option<u32>,
    tick: u32,
    turn: u32,
    samples: u32,
    coils: u32,
    stack_end: u32,
    panic: Result<u32, String>,
    /// Ended when this goes.
    _qemu: Qemu,
}

impl Flashed {
    /// Starts the emulator with the image and runs it up to its first tick. A `trace` takes every access to the ports.
    ///
    /// # Errors
    /// [`EmulatorError`]: no emulator, no image, an image of something else.
    pub fn start(path: &Path, trace: Option<&Path>) -> Result<Self, EmulatorError> {
        let file = image(path)?;
        let address = |name: &str| {
            elf::address(&file, name).map_err(|reason| EmulatorError::PoorImage { path: path.to_owned(), reason })
        };
        let [tick, turn, samples, coils, stack_end] = [TICK, TURN, "SAMPLES", "COILS", "_stack_end"].map(address);
        let tick = tick?;
        let qemu = Qemu::start(path, |folder| arguments(folder, trace), (Stdio::null(), Stdio::null()))?;
        let mut remote = Remote::connect(&qemu.folder().join("debug"))?;
        let serial = connect(&qemu.folder().join("serial"))?;
        serial.set_write_timeout(Some(PATIENCE))?;
        let received = listen(serial.try_clone()?);
        remote.stop_at(tick)?;
        remote.resume(None)?;
        let panic = elf::address(&file, "rust_begin_unwind");
        let next = Some(tick + NOTHING_LEN);
        Ok(Self {
            remote,
            serial,
            unsent: Vec::new(),
            received,
            next,
            tick,
            turn: turn?,
            samples: samples?,
            coils: coils?,
            stack_end: stack_end?,
            panic,
            _qemu: qemu,
        })
    }

    /// Makes the program stop in its next turn.
    ///
    /// # Errors
    /// [`EmulatorError`]; also where the image has no place for it.
    pub fn halt(&mut self, halt: Halt) -> Result<(), EmulatorError> {
        match halt {
            Halt::HardFault => self.next = Some(NOWHERE),
            Halt::StackOverflow => {
                self.remote.set_register(STACK_POINTER, self.stack_end + 8)?;
                self.next = Some(self.turn);
            }
            Halt::Panic { line } => {
                let address = self.panic.clone().map_err(io::Error::other)?;
                self.put_panic(line)?;
                self.next = Some(address);
            }
            Halt::ClockFailure => {
                // The emulator has no such clock, and its debugger cannot raise the interrupt: it goes where the table of vectors leads.
                let vector = self.remote.read(NON_MASKABLE_VECTOR, 4)?;
                self.next = vector.try_into().ok().map(|vector| u32::from_le_bytes(vector) & !1);
            }
            Halt::EndlessTurn => self.remote.write(self.turn & !1, &BRANCH_HERE.to_le_bytes())?,
        }
        Ok(())
    }

    /// What a panic tells its handler, at the end of the stack that nothing uses. The compiler may hand over the place in the source, or
    /// what points to it in one of two orders: these words are all of that.
    fn put_panic(&mut self, line: u32) -> Result<(), EmulatorError> {
        let place = self.stack_end + 16;
        let words = [place, place, line, 0, 0, 0, line, 0].map(u32::to_le_bytes);
        self.remote.write(self.stack_end, &words.concat())?;
        self.remote.set_register(FIRST_ARGUMENT, self.stack_end)
    }

    /// One instruction further.
    ///
    /// # Errors
    /// [`EmulatorError`].
    pub fn step(&mut self) -> Result<(), EmulatorError> {
        self.remote.step(self.next.take())
    }

    fn put_samples(&mut self, board: &mut dyn Board) -> Result<(), EmulatorError> {
        let inputs = board.inputs();
        if inputs.emergency_stop {
            return Err(io::Error::other("the emulator has no input for the emergency stop; send the command").into());
        }
        let channels = inputs.pressure.iter().take(CHANNELS);
        let codes: Vec<u16> = channels.chain([&inputs.supply, &inputs.valve_supply]).map(|code| code.0).collect();
        let memory: Vec<u8> = (0..ROUNDS)
            .flat_map(|round| codes.iter().map(move |&code| converted(code, round)))
            .flat_map(u16::to_le_bytes)
            .collect();
        self.remote.write(self.samples, &memory)
    }

    fn send(&mut self, board: &mut dyn Board) -> io::Result<()> {
        let mut bytes = [0; 256];
        while let count @ 1.. = board.read_link(&mut bytes) {
            self.unsent.extend(bytes.iter().take(count));
        }
        while !self.unsent.is_empty() {
            match self.serial.write(&self.unsent) {
                Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
                Ok(count) => drop(self.unsent.drain(..count)),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => (),
                Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut) => break,
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

impl Processor for Flashed {
    fn turn(&mut self, board: &mut dyn Board) -> Result<(), EmulatorError> {
        self.put_samples(board)?;
        let coils = self.remote.read(self.coils, pins::COILS_LEN)?;
        let slots = pins::active(&coils).ok_or_else(|| io::Error::other("the schedule of the coils is broken"))?;
        board.apply(&widened(&pins::outputs(&slots)));
        self.send(board)?;
        self.remote.resume(self.next.replace(self.tick + NOTHING_LEN))?;
        self.received.try_iter().for_each(|bytes| board.write_link(&bytes));
        Ok(())
    }

    fn crash(&mut self) -> Result<(), EmulatorError> {
        self.halt(Halt::HardFault)
    }

    fn first_tick_us(&self) -> u64 {
        FIRST_TICK_US
    }

    fn is_at_pins(&self) -> bool {
        true
    }

    fn channels_max(&self) -> usize {
        CHANNELS
    }
}

/// What the converter puts into memory in a round of an even number of them: one more and one less in turn. The device finds the code itself as
/// their mean, and as nothing else. A code outside the range of any sensor stays what it is.
fn converted(code: u16, round: usize) -> u16 {
    match code {
        2..4_095 if round.is_multiple_of(2) => code + 1,
        2..4_095 => code - 1,
        _ => code,
    }
}

/// Takes what the device sends when it sends it: the emulator waits for whoever does not, after some hundred bytes.
fn listen(mut serial: UnixStream) -> Receiver<Vec<u8>> {
    let (sender, receiver) = channel();
    thread::spawn(move || {
        let mut bytes = [0; 1024];
        // Ends with the emulator, or with the one who asked.
        while let Ok(count @ 1..) = serial.read(&mut bytes) {
            if sender.send(bytes.get(..count).unwrap_or(&bytes).to_vec()).is_err() {
                break;
            }
        }
    });
    receiver
}

fn arguments(folder: &Path, trace: Option<&Path>) -> Vec<String> {
    let socket = |name: &str| format!("unix:{},server=on,wait=off", folder.join(name).display());
    let (serial, debug) = (socket("serial"), socket("debug"));
    let mut arguments: Vec<String> =
        ["-serial", "null", "-serial", &serial, "-gdb", &debug, "-S", "-icount", PACE].map(str::to_owned).to_vec();
    if let Some(trace) = trace {
        arguments.extend(["-d".to_owned(), "unimp".to_owned(), "-D".to_owned(), trace.display().to_string()]);
    }
    arguments
}
