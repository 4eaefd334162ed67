//! The twin image: the controller on an emulated processor, one query and one answer a tick, and one more if the link has bytes between two.

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, ChildStdout, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::thread;
use std::time::Duration;

use softlimb_firmware::Board;
use softlimb_image_stm32f4::exchange::{ANSWER_LEN, Answer, Query, RECEIVED_MAX, SENT_MAX};
use softlimb_image_stm32f4::pins::{CHANNELS, TickInputs, TickOutputs};

use super::channels::{narrowed, widened};
use super::qemu::{Qemu, image};
use crate::error::EmulatorError;
use crate::mcu::Processor;

/// An instruction takes 2^3 ns of the emulated time, and nothing waits for this computer's clock.
const PACE: &str = "shift=3,sleep=off";

/// Counts of the processor's timer in a thousand instructions: 168 MHz times 8 ns.
const COUNTS_PER_1000: u64 = 1344;

/// A turn takes a fraction of a millisecond; an image that takes this long hangs.
const PATIENCE: Duration = Duration::from_secs(30);

/// Cost of the turns so far, instructions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// The dearest turn, or look at the link between two.
    pub worst: u64,
    /// All together.
    pub total: u64,
    /// Turns and looks.
    pub turns: u64,
}

/// The emulated twin.
#[derive(Debug)]
pub struct LockStep {
    to_image: ChildStdin,
    from_image: ChildStdout,
    progress: Arc<AtomicU64>,
    cost: Cost,
    path: PathBuf,
    /// The next tick is the first after a crash.
    after_crash: bool,
    /// Shared with the one who ends an image that hangs. Ended when this goes.
    _qemu: Arc<Mutex<Qemu>>,
}

impl LockStep {
    /// Starts the emulator with the twin image.
    ///
    /// # Errors
    /// [`EmulatorError`]: no emulator, no image.
    pub fn start(path: &Path) -> Result<Self, EmulatorError> {
        let _ = image(path)?;
        let arguments = |_: &Path| {
            let words = ["-serial", "null", "-semihosting-config", "enable=on,target=native", "-icount", PACE];
            words.map(str::to_owned).to_vec()
        };
        let mut qemu = Qemu::start(path, arguments, (Stdio::piped(), Stdio::piped()))?;
        let (to_image, from_image) = qemu.take_streams()?;
        let (qemu, progress) = (Arc::new(Mutex::new(qemu)), Arc::new(AtomicU64::new(0)));
        watch(Arc::downgrade(&qemu), Arc::clone(&progress));
        Ok(Self {
            to_image,
            from_image,
            progress,
            cost: Cost::default(),
            path: path.to_owned(),
            after_crash: false,
            _qemu: qemu,
        })
    }

    /// Cost of the turns so far.
    #[must_use]
    pub fn cost(&self) -> Cost {
        self.cost
    }

    /// The same, and begins anew.
    pub fn take_cost(&mut self) -> Cost {
        std::mem::take(&mut self.cost)
    }

    fn note_cost(&mut self, counts: u32) {
        let instructions = u64::from(counts) * 1000 / COUNTS_PER_1000;
        let Cost { worst, total, turns } = self.cost;
        self.cost = Cost { worst: worst.max(instructions), total: total + instructions, turns: turns + 1 };
    }

    /// One query with the link's bytes, and its answer's to the link. The outputs.
    fn round(&mut self, board: &mut dyn Board, query: Query) -> Result<TickOutputs, EmulatorError> {
        let mut received = [0; RECEIVED_MAX];
        let count = board.read_link(&mut received);
        let room = board.link_room().min(SENT_MAX) as u16;
        self.ask(&Query { room, received: count as u16, ..query }, received.get(..count).unwrap_or(&received))?;
        let (answer, sent) = self.listen()?;
        self.note_cost(answer.cost);
        board.write_link(&sent);
        Ok(answer.outputs)
    }

    fn ask(&mut self, query: &Query, received: &[u8]) -> io::Result<()> {
        let mut bytes = query.encode().to_vec();
        bytes.extend(received);
        self.progress.fetch_add(1, Ordering::Relaxed);
        self.to_image.write_all(&bytes)?;
        self.to_image.flush()
    }

    fn listen(&mut self) -> io::Result<(Answer, Vec<u8>)> {
        let mut fixed = [0; ANSWER_LEN];
        self.from_image.read_exact(&mut fixed)?;
        let answer = Answer::decode(&fixed);
        let mut sent = vec![0; usize::from(answer.sent)];
        self.from_image.read_exact(&mut sent)?;
        self.progress.fetch_add(1, Ordering::Relaxed);
        Ok((answer, sent))
    }
}

impl Processor for LockStep {
    fn turn(&mut self, board: &mut dyn Board) -> Result<(), EmulatorError> {
        let inputs = narrowed(&board.inputs());
        let after_crash = std::mem::take(&mut self.after_crash);
        let outputs = self.round(board, Query { inputs, after_crash, last: false, ..Query::END })?;
        board.apply(&widened(&outputs));
        Ok(())
    }

    fn exchange(&mut self, board: &mut dyn Board, now_us: u64) -> Result<(), EmulatorError> {
        let inputs = TickInputs { now_us, ..Query::END.inputs };
        self.round(board, Query { inputs, link_alone: true, last: false, ..Query::END }).map(drop)
    }

    /// A new processor; what the image does not remember, it is told.
    fn crash(&mut self) -> Result<(), EmulatorError> {
        let mut started = Self::start(&self.path)?;
        (started.cost, started.after_crash) = (self.cost, true);
        *self = started;
        Ok(())
    }

    fn channels_max(&self) -> usize {
        CHANNELS
    }
}

impl Drop for LockStep {
    fn drop(&mut self) {
        // An image that is gone already needs no farewell.
        let _ = self.ask(&Query::END, &[]);
    }
}

/// Ends an emulator that makes no progress between a query and its answer, so that whoever waits for it sees its end.
fn watch(qemu: Weak<Mutex<Qemu>>, progress: Arc<AtomicU64>) {
    thread::spawn(move || {
        let mut seen = 0;
        loop {
            thread::sleep(PATIENCE);
            let Some(qemu) = qemu.upgrade() else { return };
            let now = progress.load(Ordering::Relaxed);
            // Odd between a query and its answer.
            if now == seen && now % 2 == 1 {
                qemu.lock().unwrap_or_else(PoisonError::into_inner).kill();
                return;
            }
            seen = now;
        }
    });
}
