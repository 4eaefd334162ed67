//! What the ports are told, in order, as the emulator sees it.

use std::fs;
use std::path::Path;

use softlimb_image_stm32f4::pins::{FILL, OUTPUTS, PORTS, PUMP, SUPPLY, VENT};
use softlimb_image_stm32f4::schedule::OFF;
use softlimb_sim::emulated::{Flashed, Halt};

use crate::crash::filling;
use crate::devices::Images;

const MODE: u32 = 0x00;
const SET_RESET: u32 = 0x18;

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

#[test]
fn outputs_are_low_before_they_are_outputs() {
    let Some(images) = Images::find("outputs_are_low_before_they_are_outputs") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let trace = folder.path().join("trace");
    let _flashed = traced(&images, &trace);
    let start = writes(&trace);
    for (port, mask) in OUTPUTS.into_iter().enumerate() {
        let of_port: Vec<_> = start.iter().filter(|write| write.port == port).collect();
        let is_output = |write: &&Write| {
            write.offset == MODE && (0..16).any(|pin| mask & 1 << pin != 0 && write.value >> (2 * pin) & 3 == 1)
        };
        let first = of_port.iter().position(is_output).expect("they become outputs");
        let told: Vec<_> = of_port[..first].iter().filter(|write| write.offset == SET_RESET).collect();
        assert!(!told.is_empty(), "port {port} is told nothing before");
        assert!(told.iter().all(|write| write.value == OFF[port]), "port {port}: {told:x?}");
    }
}

#[test]
fn every_coil_is_let_go_within_a_tick_of_a_crash() {
    let Some(images) = Images::find("every_coil_is_let_go_within_a_tick_of_a_crash") else { return };
    for halt in [Halt::HardFault, Halt::Panic { line: 4711 }, Halt::StackOverflow] {
        let folder = tempfile::tempdir().expect("a folder");
        let trace = folder.path().join("trace");
        let mut host = filling(traced(&images, &trace));
        let before = writes(&trace);
        let lit = before.iter().rev().find(|write| write.port == 2 && write.offset == SET_RESET).expect("a schedule");
        assert!(lit.value & u32::from(OUTPUTS[2]) != 0, "{halt:?}: port C is on before: {lit:x?}");
        host.mcu.processor_mut().halt(halt).expect("the emulator takes it");
        host.wait(1_000);
        let after = &writes(&trace)[before.len()..];
        let off: Vec<_> = (0..PORTS).map(|port| Write { port, offset: SET_RESET, value: OFF[port] }).collect();
        assert_eq!(after.get(..PORTS), Some(&off[..]), "{halt:?}: the first that the ports hear");
        for pin in VENT.into_iter().chain(FILL).chain([SUPPLY, PUMP]) {
            assert!(OFF[pin.port as usize] >> 16 & u32::from(pin.bit()) != 0, "{pin:?} is told to be low");
        }
        let on = after.iter().filter(|write| write.offset == SET_RESET && write.value & 0xffff != 0);
        assert_eq!(on.count(), 0, "{halt:?}: nothing is switched on again");
    }
}
