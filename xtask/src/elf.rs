//! Symbols and contents of an ELF file: 32 bits, little-endian, as Arm's linkers write it.

use std::ops::Range;

/// Type of the section that holds the symbols.
const SYMBOL_TABLE: usize = 2;
const SYMBOL_BYTES: usize = 16;

/// Kind of a segment that is loaded.
const LOAD: usize = 1;

/// A part of the image in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Segment<'a> {
    /// Its address while the program runs.
    pub(crate) address: usize,
    /// Address of its bytes before that.
    pub(crate) load_address: usize,
    /// Place of its bytes in the file.
    pub(crate) start: usize,
    /// Its bytes.
    pub(crate) bytes: &'a [u8],
    /// Its length in memory, what is loaded and what is not.
    pub(crate) length: usize,
}

/// Names of all symbols.
///
/// # Errors
/// What is wrong with the file, or that its symbols were stripped.
pub(crate) fn symbols(file: &[u8]) -> Result<Vec<String>, String> {
    Ok(all(file)?.into_iter().map(|symbol| symbol.name).collect())
}

/// Value of a symbol, where there is one of this name.
///
/// # Errors
/// As [`symbols`].
pub(crate) fn value(file: &[u8], wanted: &str) -> Result<Option<usize>, String> {
    Ok(all(file)?.into_iter().find(|symbol| symbol.name == wanted).map(|symbol| symbol.value))
}

/// Addresses of the code of the one function that has this in its name, which a compiler adds to.
///
/// # Errors
/// As [`symbols`]; no such function, or several.
pub(crate) fn code(file: &[u8], part: &str) -> Result<Range<usize>, String> {
    let found: Vec<Symbol> =
        all(file)?.into_iter().filter(|symbol| symbol.name.contains(part) && symbol.length > 0).collect();
    let [Symbol { value, length, .. }] = found[..] else {
        return Err(format!("{} functions are called `{part}`", found.len()));
    };
    // The lowest bit says which instructions the code has.
    Ok(value & !1..(value & !1) + length)
}

/// The file without its table of sections, and so without symbols; the program is the same.
#[must_use]
pub(crate) fn anonymous(file: &[u8]) -> Vec<u8> {
    let mut file = file.to_vec();
    for field in [0x20..0x24, 0x30..0x34] {
        if let Some(bytes) = file.get_mut(field) {
            bytes.fill(0);
        }
    }
    file
}

/// All segments that are loaded.
///
/// # Errors
/// What is wrong with the file.
pub(crate) fn segments(file: &[u8]) -> Result<Vec<Segment<'_>>, String> {
    check(file)?;
    loaded(file).ok_or_else(|| "its segments are broken".to_owned())
}

fn loaded(file: &[u8]) -> Option<Vec<Segment<'_>>> {
    let (table, size, count) = (word(file, 0x1c)?, half(file, 0x2a)?, half(file, 0x2c)?);
    let mut segments = Vec::new();
    for index in 0..count {
        let at = table.checked_add(index.checked_mul(size)?)?;
        if word(file, at)? != LOAD {
            continue;
        }
        let [start, address, load_address, length, in_memory] =
            [4, 8, 0xc, 0x10, 0x14].map(|offset| word(file, at + offset));
        let (start, length) = (start?, length?);
        let bytes = file.get(start..start.checked_add(length)?)?;
        segments.push(Segment { address: address?, load_address: load_address?, start, bytes, length: in_memory? });
    }
    Some(segments)
}

fn check(file: &[u8]) -> Result<(), String> {
    let is_one = file.get(..6) == Some(&b"\x7fELF\x01\x01"[..]);
    if is_one { Ok(()) } else { Err("no ELF file of 32 bits, little-endian".to_owned()) }
}

/// A name in the file.
struct Symbol {
    name: String,
    value: usize,
    length: usize,
}

/// All symbols.
fn all(file: &[u8]) -> Result<Vec<Symbol>, String> {
    check(file)?;
    names(file).ok_or_else(|| "its symbol table is missing or broken".to_owned())
}

fn names(file: &[u8]) -> Option<Vec<Symbol>> {
    let (table, size, count) = (word(file, 0x20)?, half(file, 0x2e)?, half(file, 0x30)?);
    let header = |index: usize| -> Option<usize> {
        let at = table.checked_add(index.checked_mul(size)?)?;
        file.get(at..at.checked_add(size)?).map(|_| at)
    };
    for index in 0..count {
        let at = header(index)?;
        if word(file, at + 4)? != SYMBOL_TABLE {
            continue;
        }
        let (symbols, text) = (section(file, at)?, section(file, header(word(file, at + 0x18)?)?)?);
        let named = |symbol: &[u8]| {
            let name = name(text, word(symbol, 0)?)?;
            Some(Symbol { name, value: word(symbol, 4)?, length: word(symbol, 8)? })
        };
        return symbols.chunks_exact(SYMBOL_BYTES).map(named).collect();
    }
    None
}

/// The bytes of a section, from its header.
fn section(file: &[u8], header: usize) -> Option<&[u8]> {
    let (start, length) = (word(file, header + 0x10)?, word(file, header + 0x14)?);
    file.get(start..start.checked_add(length)?)
}

/// The text that starts at `at` and ends before a zero.
fn name(text: &[u8], at: usize) -> Option<String> {
    let bytes = text.get(at..)?.split(|&byte| byte == 0).next()?;
    Some(String::from_utf8_lossy(bytes).into_owned())
}

fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let bytes = bytes.get(at..at.checked_add(4)?)?;
    usize::try_from(u32::from_le_bytes(bytes.try_into().ok()?)).ok()
}

fn half(bytes: &[u8], at: usize) -> Option<usize> {
    let bytes = bytes.get(at..at.checked_add(2)?)?;
    Some(usize::from(u16::from_le_bytes(bytes.try_into().ok()?)))
}

#[cfg(test)]
mod tests {
    use super::{Segment, anonymous, code, segments, symbols, value};

    /// A file of three sections: none, the symbols, their names.
    fn file() -> Vec<u8> {
        let (text, names) = (b"\0main\0__aeabi_dmul\0", [0_u32, 1, 6]);
        let mut file = b"\x7fELF\x01\x01".to_vec();
        file.resize(52, 0);
        let symbols_at = file.len();
        for name in names {
            file.extend(name.to_le_bytes());
            file.extend((100 * name + 1).to_le_bytes());
            file.extend((2 * name).to_le_bytes());
            file.extend([0; 4]);
        }
        let text_at = file.len();
        file.extend(text);
        let sections_at = file.len();
        file.extend([0; 40]);
        for (kind, start, length, link) in [(2, symbols_at, 48, 2_u32), (3, text_at, text.len(), 0)] {
            let start_and_length = [u32::try_from(start).unwrap(), u32::try_from(length).unwrap()];
            let words = [0, kind, 0, 0, start_and_length[0], start_and_length[1], link, 0, 0, 0];
            file.extend(words.into_iter().flat_map(u32::to_le_bytes));
        }
        file[0x20..0x24].copy_from_slice(&u32::try_from(sections_at).unwrap().to_le_bytes());
        file[0x2e..0x30].copy_from_slice(&40_u16.to_le_bytes());
        file[0x30..0x32].copy_from_slice(&3_u16.to_le_bytes());
        file
    }

    #[test]
    fn names_and_values_are_read() {
        assert_eq!(symbols(&file()).unwrap(), ["", "main", "__aeabi_dmul"]);
        assert_eq!(value(&file(), "main"), Ok(Some(101)));
        assert_eq!(value(&file(), "main2"), Ok(None));
    }

    #[test]
    fn the_code_of_a_function_is_found_by_a_part_of_its_name() {
        assert_eq!(code(&file(), "ai"), Ok(100..102));
        assert_eq!(code(&file(), "dmul"), Ok(600..612));
        assert!(code(&file(), "m").is_err() && code(&file(), "x").is_err());
        assert!(symbols(&anonymous(&file())).is_err());
    }

    #[test]
    fn segments_that_are_loaded_are_read() {
        let mut file = b"\x7fELF\x01\x01".to_vec();
        file.resize(52, 0);
        (file[0x1c], file[0x2a], file[0x2c]) = (52, 32, 2);
        for (kind, start, length) in [(4_u32, 0_u32, 9_u32), (1, 116, 3)] {
            let words = [kind, start, 0x2000_0000, 0x0800_0000, length, 8, 0, 0];
            file.extend(words.into_iter().flat_map(u32::to_le_bytes));
        }
        file.extend([7, 8, 9]);
        let segment =
            Segment { address: 0x2000_0000, load_address: 0x0800_0000, start: 116, bytes: &[7, 8, 9], length: 8 };
        assert_eq!(segments(&file), Ok(vec![segment]));
        for length in 0..file.len() {
            assert!(segments(&file[..length]).is_err(), "{length} bytes");
        }
    }

    #[test]
    fn a_cut_or_foreign_file_is_an_error() {
        let whole = file();
        for length in 0..whole.len() {
            assert!(symbols(&whole[..length]).is_err(), "{length} bytes");
        }
        assert!(symbols(b"MZ and so on").is_err());
    }
}
