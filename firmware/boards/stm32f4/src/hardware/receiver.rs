//! The receiving half of the link's port. The library reports one of several errors of a byte; here all are seen.

use stm32f4xx_hal::pac::USART2;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::serial::Rx;

use crate::reception::{ErrorCounts, PENDING};

/// The receiver, whose interrupt comes with every byte.
pub struct Receiver {
    /// Nobody else reads while it is held.
    _owned: Rx<USART2>,
}

impl Receiver {
    /// Asks for an interrupt at every byte.
    #[must_use]
    pub fn start(mut receiver: Rx<USART2>) -> Self {
        receiver.listen();
        Self { _owned: receiver }
    }

    /// The byte that has arrived, if it is good. Reading it clears all errors, which are counted.
    pub fn read(&mut self, errors: &ErrorCounts) -> Option<u8> {
        // SAFETY: the receiver owns the half of the port that these two registers belong to; the order of reads is that of RM0090.
        let port = unsafe { &*USART2::PTR };
        let status = u32::from(port.sr().read().bits());
        if status & PENDING == 0 {
            return None;
        }
        let byte = port.dr().read().dr().bits() as u8;
        errors.take(status).then_some(byte)
    }
}
