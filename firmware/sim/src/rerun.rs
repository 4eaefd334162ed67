//! Runs the controller without a plant, on recorded inputs of a device.

use softlimb_firmware::{Board, BootInfo, Controller, LOOK_US, TickInputs, TickOutputs, exchange, turn};
use softlimb_protocol::BootCause;

/// The firmware's controller, driven by recorded inputs.
#[derive(Debug)]
pub struct Rerun(Box<Controller>);

impl Rerun {
    /// A controller just after a boot with this cause.
    #[must_use]
    pub fn new(cause: BootCause, detail: u32) -> Self {
        Self(Box::new(Controller::new(BootInfo { cause, detail })))
    }

    /// Takes the next reading for right, whatever the valves did: for a turn whose codes are an approximation.
    pub fn believe_readings(&mut self) {
        self.0.believe_readings();
    }

    /// Runs one turn. Returns the outputs and the bytes for the host; the link accepts them all.
    pub fn turn(&mut self, inputs: &TickInputs, received: &[u8]) -> (TickOutputs, Vec<u8>) {
        let mut board = KnownInputs { inputs: *inputs, received, sent: Vec::new() };
        let outputs = turn(self.0.as_mut(), &mut board);
        (outputs, board.sent)
    }

    /// Runs the second look at the link in the tick of the last turn, which had these inputs. Returns the bytes for the host.
    pub fn look(&mut self, inputs: &TickInputs, received: &[u8]) -> Vec<u8> {
        let mut board = KnownInputs { inputs: *inputs, received, sent: Vec::new() };
        exchange(self.0.as_mut(), &mut board, inputs.now_us + LOOK_US);
        board.sent
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
