//! What the ports are told, in order, as the emulator sees it.

use std::fs;
use std::path::Path;

use softlimb_image_stm32f4::pins::{FILL, OUTPUTS, PORTS, PUMP, SUPPLY, VENT};
use softlimb_image_stm32f4::schedule::{OFF, SLOTS, VENTING, Words};
use softlimb_sim::emulated::{Flashed, Halt};

use crate::crash::filling;
use crate::crash::host::Host;
use crate::devices::Images;
use crate::turns::{CYCLES, TICK};

const MODE: u32 = 0x00;
const SET_RESET: u32 = 0x18;

/// Instructions within which a crash reaches the ports; a tick has ten times as many.
const SOON: usize = 8_000;

/// A write to a register of a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Write {
    port: usize,
    offset: u32,
    value: u32,
}

/// Lines such as `GPIOB: unimplemented device write (size 4, offset 0x018, value 0xf7e00000)`.
fn write(line: &str) -> Option<Write> {
    let (name, rest) = line.split_once(": unimplemented device write")?;
    let port = ["GPIOA", "GPIOB", "GPIOC"].iter().position(|port| *port == name.trim())?;
    let number = |key: &str| {
        let digits = rest.split_once(key)?.1.trim_start().strip_prefix("0x")?;
        u32::from_str_radix(digits.split(|c: char| !c.is_ascii_hexdigit()).next()?, 16).ok()
    };
    Some(Write { port, offset: number("offset")?, value: number("value")? })
}

fn writes(trace: &Path) -> Vec<Write> {
    let text = fs::read_to_string(trace).expect("the trace");
    text.lines().filter_map(write).collect()
}

/// Runs the flashed image with a trace of its ports.
fn traced(images: &Images, trace: &Path) -> Flashed {
    Flashed::start(&images.flashed(), Some(trace)).expect("the image starts")
}

/// Every port is told what its outputs shall be, and nothing else, before one of them becomes an output.
fn assert_told_before_outputs(start: &[Write], first: &Words) {
    for (port, mask) in OUTPUTS.into_iter().enumerate() {
        let of_port: Vec<_> = start.iter().filter(|write| write.port == port).collect();
        let is_output = |write: &&Write| {
            write.offset == MODE && (0..16).any(|pin| mask & 1 << pin != 0 && write.value >> (2 * pin) & 3 == 1)
        };
        let becomes = of_port.iter().position(is_output).expect("they become outputs");
        let told: Vec<_> = of_port[..becomes].iter().filter(|write| write.offset == SET_RESET).collect();
        assert!(!told.is_empty(), "port {port} is told nothing before");
        assert!(told.iter().all(|write| write.value == first[port]), "port {port}: {told:x?}");
    }
}

#[test]
fn outputs_are_low_before_they_are_outputs() {
    let Some(images) = Images::find("outputs_are_low_before_they_are_outputs") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let trace = folder.path().join("trace");
    let _flashed = traced(&images, &trace);
    assert_told_before_outputs(&writes(&trace), &OFF);
}

#[test]
fn vents_are_high_before_they_are_outputs_again_after_a_crash() {
    let Some(images) = Images::find("vents_are_high_before_they_are_outputs_again_after_a_crash") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let trace = folder.path().join("trace");
    let mut host = filling(traced(&images, &trace));
    let before = writes(&trace).len();
    host.mcu.processor_mut().halt(Halt::HardFault).expect("the emulator takes it");
    host.wait(1_000);
    // The crash itself tells each port once; the rest is the new start.
    assert_told_before_outputs(&writes(&trace)[before + PORTS..], &VENTING);
}

/// Instructions until the ports have been told as often as there are ports.
fn instructions_until_told(host: &mut Host<Flashed>, trace: &Path, before: usize) -> usize {
    let told = || writes(trace).iter().skip(before).filter(|write| write.offset == SET_RESET).count();
    let length = || fs::metadata(trace).expect("the trace").len();
    let mut seen = length();
    for count in 1..=SOON {
        host.mcu.processor_mut().step().expect("the emulator takes it");
        if std::mem::replace(&mut seen, length()) != seen && told() >= PORTS {
            return count;
        }
    }
    panic!("nothing is told within {SOON} instructions")
}

#[test]
fn vents_open_and_all_else_is_let_go_within_a_tick_of_a_crash() {
    let Some(images) = Images::find("vents_open_and_all_else_is_let_go_within_a_tick_of_a_crash") else { return };
    // All five seconds of the vents once: `crash` watches the pins of every kind so long.
    let kinds = [
        (Halt::HardFault, 4_900),
        (Halt::Panic { line: 4711 }, 200),
        (Halt::StackOverflow, 200),
        (Halt::ClockFailure, 200),
    ];
    for (halt, watched_ms) in kinds {
        let folder = tempfile::tempdir().expect("a folder");
        let trace = folder.path().join("trace");
        let mut host = filling(traced(&images, &trace));
        let before = writes(&trace);
        let lit = before.iter().rev().find(|write| write.port == 2 && write.offset == SET_RESET).expect("a schedule");
        assert!(lit.value & u32::from(OUTPUTS[2]) != 0, "{halt:?}: port C is on before: {lit:x?}");
        host.mcu.processor_mut().halt(halt).expect("the emulator takes it");
        let count = instructions_until_told(&mut host, &trace, before.len());
        println!("{halt:?}: the ports are told within {count} instructions of the tick");
        assert!(CYCLES * (count as u64) < TICK, "{halt:?}");
        // The reset, the first tick, and the vents.
        host.wait(1_000 * watched_ms);
        let after = &writes(&trace)[before.len()..];
        let told: Vec<_> = (0..PORTS).map(|port| Write { port, offset: SET_RESET, value: VENTING[port] }).collect();
        assert_eq!(after.get(..PORTS), Some(&told[..]), "{halt:?}: the first that the ports hear");
        let mut heard = 0;
        for write in after.iter().filter(|write| write.offset == SET_RESET) {
            assert_eq!(write.value, VENTING[write.port], "{halt:?}: port {} after {heard} words", write.port);
            heard += 1;
        }
        assert!(heard > (watched_ms as usize - 100) * SLOTS * PORTS, "{halt:?}: {heard} words");
        for (pin, is_on) in VENT.map(|pin| (pin, true)).into_iter().chain(FILL.map(|pin| (pin, false))) {
            assert_eq!(VENTING[pin.port as usize] & u32::from(pin.bit()) != 0, is_on, "{pin}");
        }
        for pin in FILL.into_iter().chain([SUPPLY, PUMP]) {
            assert!(VENTING[pin.port as usize] >> 16 & u32::from(pin.bit()) != 0, "{pin} is told to be low");
        }
    }
}
