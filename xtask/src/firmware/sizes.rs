//! Size of an image beside the recorded one.

use std::fs;

use super::Sizes;
use crate::cargo::root;
use crate::elf;

/// The record, from the root of the workspace.
const RECORD: &str = "firmware/boards/stm32f4/sizes.tsv";
const HEADER: &str = "board\tflash\tram\tstack";

/// An image may be this much larger or smaller than recorded, in per cent.
const MARGIN: usize = 2;

/// Largest size of an image, bytes: of flash, and of memory for variables and stack together.
const FLASH_MAX: usize = 96 * 1024;
const RAM_MAX: usize = 32 * 1024;

/// The chip's memory for variables begins here.
const RAM: usize = 0x2000_0000;

/// Bytes of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Size {
    /// Bytes written into the chip.
    flash: usize,
    /// Variables.
    ram: usize,
    /// Bytes set aside for the stack.
    stack: usize,
}

fn size(file: &[u8]) -> Result<Size, String> {
    let segments = elf::segments(file)?;
    let value = |name: &str| elf::value(file, name)?.ok_or_else(|| format!("it has no `{name}`"));
    Ok(Size {
        flash: segments.iter().map(|segment| segment.bytes.len()).sum(),
        ram: segments.iter().filter(|segment| segment.address >= RAM).map(|segment| segment.length).sum(),
        stack: value("_stack_start")?.saturating_sub(value("_stack_end")?),
    })
}

/// The part of an image that is too large.
fn excess(size: Size) -> Option<String> {
    let memory = size.ram + size.stack;
    let over = |what: &str, found: usize, most: usize| format!("{found} bytes of {what}, more than {most}");
    (size.flash > FLASH_MAX)
        .then(|| over("flash", size.flash, FLASH_MAX))
        .or_else(|| (memory > RAM_MAX).then(|| over("memory for variables and stack", memory, RAM_MAX)))
}

/// Prints the size; compares it with the record, or records it.
///
/// # Errors
/// An image that is too large for a small chip; another size than recorded with the same compiler.
pub(super) fn report(board: &str, file: &[u8], compiler: &str, what: Sizes) -> Result<(), String> {
    let size = size(file)?;
    println!(
        "xtask: {board}: {} bytes of flash, {} of variables, {} set aside for the stack",
        size.flash, size.ram, size.stack
    );
    if let Some(excess) = excess(size) {
        return Err(format!("{board} takes {excess}"));
    }
    let path = root().join(RECORD);
    let recorded = fs::read_to_string(&path).unwrap_or_default();
    if what == Sizes::Record {
        println!("xtask: recorded in {RECORD}");
        let text = with(&recorded, board, size, compiler);
        return fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()));
    }
    match verdict(&recorded, board, size, compiler) {
        Verdict::Same => println!("xtask: as recorded in {RECORD}, within {MARGIN} %"),
        Verdict::OtherCompiler => println!("xtask: not compared with {RECORD}, which another compiler made"),
        Verdict::Other(before) => {
            return Err(format!(
                "{board} is no longer as large as recorded in {RECORD}: {size:?}, was {before}; \
                 `cargo xtask firmware --board {board} --record` records it anew"
            ));
        }
    }
    Ok(())
}

/// The record with a board's line in place of the one before; lines of another compiler are dropped.
fn with(recorded: &str, board: &str, size: Size, compiler: &str) -> String {
    let title = format!("# bytes; {compiler}; made by `cargo xtask firmware --record`");
    let same = recorded.lines().next() == Some(title.as_str());
    let others = recorded.lines().skip(2).filter(|line| same && line.split('\t').next() != Some(board));
    let mut lines: Vec<String> = others.map(str::to_owned).collect();
    lines.push(format!("{board}\t{}\t{}\t{}", size.flash, size.ram, size.stack));
    lines.sort();
    format!("{title}\n{HEADER}\n{}\n", lines.join("\n"))
}

#[derive(Debug, PartialEq, Eq)]
enum Verdict {
    Same,
    OtherCompiler,
    /// The recorded sizes.
    Other(String),
}

fn verdict(recorded: &str, board: &str, size: Size, compiler: &str) -> Verdict {
    if !recorded.lines().next().is_some_and(|line| line.contains(compiler)) {
        return Verdict::OtherCompiler;
    }
    let line = recorded.lines().find(|line| line.split('\t').next() == Some(board));
    let Some(line) = line else { return Verdict::Other("not recorded".to_owned()) };
    let before: Vec<usize> = line.split('\t').skip(1).filter_map(|number| number.parse().ok()).collect();
    let near = |(now, before): (usize, &usize)| now.abs_diff(*before) * 100 <= before * MARGIN;
    let same = before.len() == 3 && [size.flash, size.ram, size.stack].into_iter().zip(&before).all(near);
    if same { Verdict::Same } else { Verdict::Other(line.to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::{FLASH_MAX, RAM_MAX, Size, Verdict, excess, verdict, with};

    #[test]
    fn an_image_must_fit_a_small_chip() {
        let size = Size { flash: FLASH_MAX, ram: RAM_MAX - 4096, stack: 4096 };
        assert_eq!(excess(size), None);
        assert_eq!(excess(Size { flash: 98_305, ..size }).as_deref(), Some("98305 bytes of flash, more than 98304"));
        assert!(excess(Size { stack: 4100, ..size }).is_some_and(|text| text.contains("variables and stack")));
    }

    #[test]
    fn sizes_are_compared_with_the_board_s_line() {
        let size = |flash| Size { flash, ram: 1000, stack: 4096 };
        let recorded = with("", "f446", size(10_000), "rustc 1.96.0");
        let recorded = with(&recorded, "f405", size(20_000), "rustc 1.96.0");
        assert_eq!(verdict(&recorded, "f446", size(10_200), "rustc 1.96.0"), Verdict::Same);
        assert_eq!(verdict(&recorded, "f405", size(20_000), "rustc 1.96.0"), Verdict::Same);
        assert!(matches!(verdict(&recorded, "f446", size(10_201), "rustc 1.96.0"), Verdict::Other(_)));
        assert!(matches!(verdict(&recorded, "f411", size(10_000), "rustc 1.96.0"), Verdict::Other(_)));
        assert_eq!(verdict(&recorded, "f446", size(10_201), "rustc 1.97.0"), Verdict::OtherCompiler);
        assert_eq!(with(&recorded, "f446", size(1), "rustc 1.97.0").lines().count(), 3, "no mixture of compilers");
    }
}
