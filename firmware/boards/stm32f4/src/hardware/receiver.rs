//! Receiver of the link's serial port. The HAL reports one error of a byte; this receiver counts all of them.

use stm32f4xx_hal::pac::USART2;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::serial::Rx;

use crate::reception::{ErrorCounts, PENDING};

/// Receiver with an interrupt for every byte.
pub struct Receiver {
    /// Exclusive ownership of the receiving half.
    _owned: Rx<USART2>,
}

impl Receiver {
    /// Enables the interrupt for received bytes.
    #[must_use]
    pub fn start(mut receiver: Rx<USART2>) -> Self {
        receiver.listen();
        Self { _owned: receiver }
    }

    /// Received byte, if it has no error. Counts its errors; reading the data register clears them.
    pub fn read(&mut self, errors: &ErrorCounts) -> Option<u8> {
        // SAFETY: the receiver owns the receiving half of the port. RM0090 prescribes this order: status first, then data.
        let port = unsafe { &*USART2::PTR };
        let status = u32::from(port.sr().read().bits());
        if status & PENDING == 0 {
            return None;
        }
        let byte = port.dr().read().dr().bits() as u8;
        errors.take(status).then_some(byte)
    }
}
