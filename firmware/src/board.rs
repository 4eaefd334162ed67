//! Board interface of the controller, real or simulated.

use softlimb_protocol::MAX_CHANNELS;

use crate::controller::{Controller, TickInputs, TickOutputs};

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

    /// Sends bytes; never more than [`Self::link_room`].
    fn write_link(&mut self, bytes: &[u8]);
}

/// One turn of the device: control first, then the link.
pub fn turn<const N: usize, B: Board<N> + ?Sized>(controller: &mut Controller<N>, board: &mut B) -> TickOutputs<N> {
    let inputs = board.inputs();
    controller.set_stack_used(board.stack_used());
    let outputs = controller.tick(&inputs);
    board.apply(&outputs);
    let mut chunk = [0; CHUNK];
    loop {
        let count = board.read_link(&mut chunk);
        let Some(bytes) = chunk.get(..count).filter(|bytes| !bytes.is_empty()) else { break };
        controller.receive(inputs.now_us, bytes);
    }
    loop {
        let room = board.link_room().min(CHUNK);
        let count = chunk.get_mut(..room).map_or(0, |space| controller.transmit(space));
        let Some(bytes) = chunk.get(..count).filter(|bytes| !bytes.is_empty()) else { break };
        board.write_link(bytes);
    }
    outputs
}
