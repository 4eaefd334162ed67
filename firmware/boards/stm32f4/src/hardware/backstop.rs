//! The timer TIM1 and three streams of DMA2, which let go of the coils without the processor.

use core::sync::atomic::AtomicU32;

use stm32f4xx_hal::pac::{DMA2, TIM1};
use stm32f4xx_hal::rcc::Rcc;

use super::ports;
use crate::backstop::{ENABLE, PATIENCE_US, PRESCALER, REQUESTS, STREAMS, TRANSFER};
use crate::pins::PORTS;
use crate::schedule::VENTING;

/// Words for the ports that open all vents. They lie in memory, since the flash may be what failed.
static LET_GO: [AtomicU32; PORTS] = {
    let [a, b, c] = VENTING;
    [AtomicU32::new(a), AtomicU32::new(b), AtomicU32::new(c)]
};

/// TIM1_CR1: it counts.
const COUNT: u32 = 1;
/// TIM1_EGR: take the prescaler's value now.
const UPDATE: u32 = 1;

/// The timer, running.
pub struct Backstop(TIM1);

impl Backstop {
    /// Starts it. Slots must follow at once.
    #[must_use]
    pub fn start(timer: TIM1, dma: &DMA2, rcc: &mut Rcc) -> Self {
        rcc.ahb1enr().modify(|_, w| w.dma2en().set_bit());
        rcc.apb2enr().modify(|_, w| w.tim1en().set_bit());
        for ((port, stream), word) in STREAMS.into_iter().enumerate().zip(&LET_GO) {
            let stream = dma.st(stream);
            // SAFETY: the stream reads one word of `LET_GO`, which is never freed or written, and writes one register of a port.
            unsafe {
                stream.par().write(|w| w.bits(ports::set_reset(port) as u32));
                stream.m0ar().write(|w| w.bits(word.as_ptr() as u32));
                stream.ndtr().write(|w| w.bits(1));
                stream.cr().write(|w| w.bits(TRANSFER));
                stream.cr().write(|w| w.bits(TRANSFER | ENABLE));
            }
        }
        // SAFETY: values of the registers as RM0090, "Advanced-control timers", has them. The requests come last: no event is left of before.
        unsafe {
            timer.psc().write(|w| w.bits(PRESCALER));
            for compare in 0..STREAMS.len() {
                timer.ccr(compare).write(|w| w.bits(u32::from(PATIENCE_US)));
            }
            timer.egr().write(|w| w.bits(UPDATE));
            timer.sr().write(|w| w.bits(0));
            timer.dier().write(|w| w.bits(REQUESTS));
            timer.cr1().write(|w| w.bits(COUNT));
        }
        Self(timer)
    }

    /// A slot is served: the time begins anew.
    pub fn set_back(&self) {
        // SAFETY: the counter takes any value.
        self.0.cnt().write(|w| unsafe { w.bits(0) });
    }
}
