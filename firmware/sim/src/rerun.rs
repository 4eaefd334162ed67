//! A controller without a plant: it gets the inputs of a device that has run, and is asked for the outputs.

use softlimb_firmware::{Board, BootInfo, Controller, TickInputs, TickOutputs, turn};
use softlimb_protocol::BootCause;

/// The controller of the firmware, on inputs that are known.
#[derive(Debug)]
pub struct Rerun(Box<Controller>);

impl Rerun {
    /// A controller that has just been switched on, for this cause.
    #[must_use]
    pub fn new(cause: BootCause, detail: u32) -> Self {
        Self(Box::new(Controller::new(BootInfo { cause, detail })))
    }

    /// One turn: outputs, and bytes for the host, which the link takes at once.
    pub fn turn(&mut self, inputs: &TickInputs, received: &[u8]) -> (TickOutputs, Vec<u8>) {
        let mut board = KnownInputs { inputs: *inputs, received, sent: Vec::new() };
        let outputs = turn(self.0.as_mut(), &mut board);
        (outputs, board.sent)
    }
}

struct KnownInputs<'a> {
    inputs: TickInputs,
    received: &'a [u8],
    sent: Vec<u8>,
}

impl Board for KnownInputs<'_> {
    fn inputs(&mut self) -> TickInputs {
        self.inputs
    }

    fn apply(&mut self, _outputs: &TickOutputs) {}

    fn read_link(&mut self, into: &mut [u8]) -> usize {
        let (now, later) = self.received.split_at(into.len().min(self.received.len()));
        into.iter_mut().zip(now).for_each(|(place, &byte)| *place = byte);
        self.received = later;
        now.len()
    }

    fn link_room(&self) -> usize {
        usize::MAX
    }

    fn write_link(&mut self, bytes: &[u8]) {
        self.sent.extend_from_slice(bytes);
    }
}
