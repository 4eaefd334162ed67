//! Ways in which the program on a chip ends.

/// A way to make the program stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halt {
    /// It goes where there is no program.
    HardFault,
    /// It finds itself in a state that it cannot be in.
    Panic {
        /// In this line of its source.
        line: u32,
    },
    /// Its stack leaves the memory.
    StackOverflow,
    /// The external clock stops: the interrupt comes that this raises on a chip.
    ClockFailure,
    /// Its turn never ends; its interrupts go on.
    EndlessTurn,
}
