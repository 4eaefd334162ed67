//! Work of the processor between two places of an image, instruction by instruction, by the account of the emulator.

use std::io::{BufRead, BufReader, Read};
use std::ops::Range;

use super::thumb::Instruction;
use crate::elf;

/// The functions of the image that are called just before and just after a stretch.
const BEGINS: &str = "stretch_begins";
const ENDS: &str = "stretch_ends";

/// One stretch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Stretch {
    /// Instructions.
    pub(super) instructions: i64,
    /// Cycles of the processor, by the estimate of [`Instruction::cost`].
    pub(super) cycles: i64,
}

/// Reads what the emulator tells and sums it up.
pub(super) struct Meter<'a> {
    code: Vec<elf::Segment<'a>>,
    begins: Range<usize>,
    ends: usize,
    /// Place of the last reported instruction, and the one before it.
    last: Option<usize>,
    before: Option<Instruction>,
    open: Option<Stretch>,
    done: Vec<Stretch>,
}

impl<'a> Meter<'a> {
    /// For an image.
    ///
    /// # Errors
    /// It has no places to begin and to end at.
    pub(super) fn new(file: &'a [u8]) -> Result<Self, String> {
        let (begins, ends) = (elf::code(file, BEGINS)?, elf::code(file, ENDS)?.start);
        Ok(Self { code: elf::segments(file)?, begins, ends, last: None, before: None, open: None, done: Vec::new() })
    }

    /// All stretches, in their order.
    ///
    /// # Errors
    /// The emulator tells of an instruction that is not in the image.
    pub(super) fn read(mut self, told: impl Read) -> Result<Vec<Stretch>, String> {
        let mut lines = BufReader::with_capacity(1 << 16, told);
        let mut line = Vec::new();
        loop {
            line.clear();
            if lines.read_until(b'\n', &mut line).map_err(|error| error.to_string())? == 0 {
                return Ok(self.done);
            }
            if line.starts_with(b"Trace ") {
                let address =
                    address(&line).ok_or_else(|| format!("the emulator tells `{}`", String::from_utf8_lossy(&line)))?;
                self.step(address)?;
            } else if line.starts_with(b"Stopped execution") {
                // The one that was told last has not run; it will be told again.
                self.last = None;
            }
        }
    }

    /// The instruction at `next` is about to run, and so the one before it has.
    fn step(&mut self, next: usize) -> Result<(), String> {
        if let Some(at) = self.last.replace(next) {
            let instruction = self.instruction(at).ok_or_else(|| format!("there is no instruction at {at:#x}"))?;
            if let Some(stretch) = &mut self.open {
                let straight = next == at + instruction.length as usize;
                stretch.instructions += 1;
                stretch.cycles += i64::try_from(instruction.cost(self.before.as_ref(), straight)).unwrap_or(i64::MAX);
            }
            self.before = Some(instruction);
            if self.begins.contains(&at) && !self.begins.contains(&next) {
                self.open = Some(Stretch::default());
            }
        }
        if next == self.ends {
            self.done.extend(self.open.take());
        }
        Ok(())
    }

    fn instruction(&self, at: usize) -> Option<Instruction> {
        let rest = |segment: &elf::Segment<'a>| segment.bytes.get(at.checked_sub(segment.address)?..);
        let bytes = self.code.iter().filter_map(rest).find(|rest| !rest.is_empty())?;
        let half = |index: usize| Some(u16::from_le_bytes(bytes.get(2 * index..2 * index + 2)?.try_into().ok()?));
        Some(Instruction::of(half(0)?, half(1).unwrap_or(0)))
    }
}

/// The address in a line such as `Trace 0: 0x7f.. [00800408/00045aac/00000110/ff020201] name`: the second number.
fn address(line: &[u8]) -> Option<usize> {
    let numbers = line.split(|byte| *byte == b'[').nth(1)?;
    let number = numbers.split(|byte| *byte == b'/').nth(1)?;
    usize::from_str_radix(std::str::from_utf8(number).ok()?, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A loop of three rounds at 0x100: `subs r0, #1; bne -4`, then a call of what ends the stretch.
    const CODE: [u16; 4] = [0x3801, 0xd1fd, 0xf000, 0xf87c];

    /// The code behind a table that ends where it begins.
    fn meter(bytes: &[u8]) -> Meter<'_> {
        let table = elf::Segment { address: 0, load_address: 0, start: 0, bytes: &[0; 0x100], length: 0x100 };
        let code =
            vec![table, elf::Segment { address: 0x100, load_address: 0x100, start: 0, bytes, length: bytes.len() }];
        Meter { code, begins: 0x10a..0x10c, ends: 0x200, last: None, before: None, open: None, done: Vec::new() }
    }

    /// The code, and at 0x10a what begins a stretch, `bx lr`.
    fn bytes() -> Vec<u8> {
        CODE.iter().chain(&[0xbf00, 0x4770]).flat_map(|half| half.to_le_bytes()).collect()
    }

    fn told(addresses: &[usize]) -> String {
        addresses.iter().map(|at| format!("Trace 0: 0x7fbc [00800408/{at:08x}/00000110/ff020201] \n")).collect()
    }

    #[test]
    fn a_loop_costs_what_it_must() {
        let path = told(&[0x10a, 0x100, 0x102, 0x100, 0x102, 0x100, 0x102, 0x104, 0x200]);
        let bytes = bytes();
        let stretches = meter(&bytes).read(path.as_bytes()).unwrap();
        // Twice 1 + 3, once 1 + 1, and the call 3.
        assert_eq!(stretches, [Stretch { instructions: 7, cycles: 13 }]);
    }

    #[test]
    fn what_did_not_run_is_not_counted() {
        let path = told(&[0x10a, 0x100, 0x102])
            + "Stopped execution of TB chain before 0x7fbc [00000102] \n"
            + &told(&[0x102, 0x100, 0x102, 0x104, 0x200]);
        let bytes = bytes();
        let stretches = meter(&bytes).read(path.as_bytes()).unwrap();
        assert_eq!(stretches, [Stretch { instructions: 5, cycles: 9 }]);
    }

    #[test]
    fn what_is_not_in_the_image_is_an_error() {
        let bytes = bytes();
        assert!(meter(&bytes).read(told(&[0x10a, 0x300, 0x302]).as_bytes()).is_err());
        assert!(meter(&bytes).read(&b"Trace 0: nowhere\n"[..]).is_err());
    }
}
