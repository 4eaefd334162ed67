//! ADC1 converts all sensors over and over, and DMA2 puts the codes into memory.
//!
//! Set up by hand: what the library does would reset the converter over a bus that a common emulator does not survive, and waits.

use core::sync::atomic::{AtomicU16, Ordering};

use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, DMA2};
use stm32f4xx_hal::rcc::Rcc;

use crate::pins::{SENSOR, SENSORS};
use crate::samples::{CODES, Mean};

/// Codes of the sensors, 12 bits, round after round in the order of [`SENSOR`]. Its name is what an emulator finds it by.
#[unsafe(no_mangle)]
pub static SAMPLES: [AtomicU16; CODES] = [const { AtomicU16::new(0) }; CODES];

/// 84 cycles a sample, in the registers of the sampling times.
const CYCLES_84: u32 = 0b100;

/// Starts the conversions: eleven in 50 us at 21 MHz.
pub fn start(adc: &ADC1, common: &ADC_COMMON, dma: &DMA2, rcc: &mut Rcc) {
    rcc.apb2enr().modify(|_, w| w.adc1en().set_bit());
    rcc.ahb1enr().modify(|_, w| w.dma2en().set_bit());
    transfer(adc, dma);
    let (sequence, times) = sequence();
    // SAFETY: the values are those of the reference manual RM0090, section "ADC registers".
    unsafe {
        common.ccr().write(|w| w.adcpre().div4());
        adc.cr1().write(|w| w.scan().set_bit());
        adc.smpr1().write(|w| w.bits(times[0]));
        adc.smpr2().write(|w| w.bits(times[1]));
        adc.sqr3().write(|w| w.bits(sequence[0]));
        adc.sqr2().write(|w| w.bits(sequence[1]));
        adc.sqr1().write(|w| w.bits((SENSORS as u32 - 1) << 20));
        adc.cr2().write(|w| w.dma().set_bit().dds().set_bit().cont().set_bit().adon().set_bit());
    }
    // The converter needs 3 us from being switched on.
    cortex_m::asm::delay(1_000);
    adc.cr2().modify(|_, w| w.swstart().set_bit());
}

/// Stream 0, whose channel 0 is ADC1: half-words, around and around.
fn transfer(adc: &ADC1, dma: &DMA2) {
    let stream = dma.st(0);
    // SAFETY: the transfer stays within `SAMPLES`, which is never freed and which the program reads as atomics only.
    unsafe {
        stream.par().write(|w| w.bits(adc.dr().as_ptr() as u32));
        stream.m0ar().write(|w| w.bits(SAMPLES.as_ptr() as u32));
        stream.ndtr().write(|w| w.bits(CODES as u32));
        stream.cr().write(|w| w.msize().bits16().psize().bits16().minc().set_bit().circ().set_bit().en().set_bit());
    }
}

/// Registers SQR3 and SQR2 with the order of the inputs, SMPR1 and SMPR2 with their times.
fn sequence() -> ([u32; 2], [u32; 2]) {
    let (mut sequence, mut times) = ([0; 2], [0; 2]);
    for (index, (_, input)) in SENSOR.iter().enumerate() {
        let input = u32::from(*input);
        sequence[index / 6] |= input << (5 * (index % 6));
        // SMPR2 has the inputs 0 to 9.
        let (register, place) = if input < 10 { (1, input) } else { (0, input - 10) };
        times[register] |= CYCLES_84 << (3 * place);
    }
    (sequence, times)
}

/// The mean code of each sensor since the last call. Each code is taken once: where the converter has stopped, the next means are 0, which no
/// sensor says.
pub fn take() -> [u16; SENSORS] {
    let mut means = [Mean::NONE; SENSORS];
    for round in SAMPLES.chunks_exact(SENSORS) {
        for (mean, code) in means.iter_mut().zip(round) {
            // A code that comes in between is lost: one of eighteen.
            mean.add(code.load(Ordering::Relaxed));
            code.store(0, Ordering::Relaxed);
        }
    }
    means.map(Mean::code)
}
