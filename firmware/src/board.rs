//! Board interface of the controller, real or simulated.

use softlimb_protocol::{DeviceState, LinkErrors, MAX_CHANNELS};

use crate::controller::{Controller, TickInputs, TickOutputs};
use crate::log::{self, Log, LogMemory};
use crate::valve::TICK_US;

/// Bytes moved to or from the link at once.
const CHUNK: usize = 64;

/// Pins, converters, clock and link of one device of `N` channels. Nothing here blocks or fails: a board reports what it cannot do as a sample out of
/// the plausible band or as no bytes.
pub trait Board<const N: usize = MAX_CHANNELS> {
    /// Time and samples for the tick that begins now.
    fn inputs(&mut self) -> TickInputs<N>;

    /// Applies the outputs of the tick from its start on.
    fn apply(&mut self, outputs: &TickOutputs<N>);

    /// Moves received bytes to `into`; returns how many.
    fn read_link(&mut self, into: &mut [u8]) -> usize;

    /// Bytes that the link can take now.
    fn link_room(&self) -> usize;

    /// The most that the stack has held since the start, bytes; 0 where it is not measured.
    fn stack_used(&self) -> u16 {
        0
    }

    /// Serial-port errors since the device started; zeros without a serial port.
    fn link_errors(&self) -> LinkErrors {
        LinkErrors::NONE
    }

    /// The log and its memory; `None` without a memory.
    fn log(&mut self) -> Option<(&mut Log, &mut dyn LogMemory)> {
        None
    }

    /// Sends bytes; never more than [`Self::link_room`].
    fn write_link(&mut self, bytes: &[u8]);
}

/// Time from the start of a tick to the second look at the link, us.
pub const LOOK_US: u64 = TICK_US as u64 / 2;

/// One turn of the device: control first, then the link and the log.
pub fn turn<const N: usize, B: Board<N> + ?Sized>(controller: &mut Controller<N>, board: &mut B) -> TickOutputs<N> {
    let (now_us, outputs) = control(controller, board);
    receive(controller, board, now_us);
    log::keep(controller, board);
    transmit(controller, board);
    outputs
}

/// The link alone, at `now_us`: while the limb follows setpoints, a look [`LOOK_US`] behind the start of a tick halves their wait. Nothing
/// happens in any other state or without new bytes.
pub fn exchange<const N: usize, B: Board<N> + ?Sized>(controller: &mut Controller<N>, board: &mut B, now_us: u64) {
    if controller.state() == DeviceState::Running && receive(controller, board, now_us) {
        transmit(controller, board);
    }
}

/// One tick of the controller. It and the two below have stack frames of their own: the largest frames do not add up.
#[inline(never)]
fn control<const N: usize, B: Board<N> + ?Sized>(
    controller: &mut Controller<N>,
    board: &mut B,
) -> (u64, TickOutputs<N>) {
    let inputs = board.inputs();
    controller.set_stack_used(board.stack_used());
    controller.set_link_errors(board.link_errors());
    let boot = controller.ticks.is_first().then_some(controller.boot);
    let outputs = controller.act(&inputs);
    board.apply(&outputs);
    // Before the report, which forgets them.
    log::note(board, boot, controller.faults.untold_of(inputs.now_us));
    controller.report(&inputs, &outputs);
    (inputs.now_us, outputs)
}

/// Hands all received bytes to the controller; whether there were some.
#[inline(never)]
fn receive<const N: usize, B: Board<N> + ?Sized>(controller: &mut Controller<N>, board: &mut B, now_us: u64) -> bool {
    let (mut chunk, mut any) = ([0; CHUNK], false);
    loop {
        let count = board.read_link(&mut chunk);
        let Some(bytes) = chunk.get(..count).filter(|bytes| !bytes.is_empty()) else { return any };
        controller.receive(now_us, bytes);
        any = true;
    }
}

/// Hands bytes to the link while it has room.
#[inline(never)]
fn transmit<const N: usize, B: Board<N> + ?Sized>(controller: &mut Controller<N>, board: &mut B) {
    let mut chunk = [0; CHUNK];
    loop {
        let room = board.link_room().min(CHUNK);
        let count = chunk.get_mut(..room).map_or(0, |space| controller.transmit(space));
        let Some(bytes) = chunk.get(..count).filter(|bytes| !bytes.is_empty()) else { return };
        board.write_link(bytes);
    }
}
