//! The flashed file where there are no sockets in the file system: nothing reaches it.

use std::convert::Infallible;
use std::io;
use std::path::Path;

use softlimb_firmware::Board;

use super::halt::Halt;
use crate::error::EmulatorError;
use crate::mcu::Processor;

/// The emulated chip, which there is none of.
#[derive(Debug)]
pub struct Flashed {
    none: Infallible,
}

impl Flashed {
    /// Says why it cannot start.
    ///
    /// # Errors
    /// [`EmulatorError::Gone`], always.
    pub fn start(_path: &Path, _trace: Option<&Path>) -> Result<Self, EmulatorError> {
        Err(io::Error::other("it is reached by sockets of Unix, which this system has not").into())
    }

    /// Is never called.
    ///
    /// # Errors
    /// None.
    pub fn halt(&mut self, _halt: Halt) -> Result<(), EmulatorError> {
        match self.none {}
    }

    /// Is never called.
    ///
    /// # Errors
    /// None.
    pub fn step(&mut self) -> Result<(), EmulatorError> {
        match self.none {}
    }
}

impl Processor for Flashed {
    fn turn(&mut self, _board: &mut dyn Board) -> Result<(), EmulatorError> {
        match self.none {}
    }

    fn crash(&mut self) -> Result<(), EmulatorError> {
        match self.none {}
    }
}
