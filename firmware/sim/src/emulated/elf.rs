//! Addresses by name, from the symbol table of an image: 32 bits, little-endian.

/// Type of the section that holds the symbols, and the bytes of one.
const SYMBOL_TABLE: u32 = 2;
const SYMBOL_BYTES: usize = 16;

/// Address of the first symbol of this name, plain or at the end of a mangled path, of a function without the bit that says Thumb.
///
/// # Errors
/// What is wrong with the file, or that it has no such symbol.
pub(super) fn address(file: &[u8], name: &str) -> Result<u32, String> {
    if file.get(..6) != Some(&b"\x7fELF\x01\x01"[..]) {
        return Err("it is no ELF file of 32 bits, little-endian".to_owned());
    }
    find(file, name).ok_or_else(|| format!("it has no `{name}`"))
}

fn find(file: &[u8], wanted: &str) -> Option<u32> {
    let (table, size, count) = (word(file, 0x20)? as usize, half(file, 0x2e)?, half(file, 0x30)?);
    let header = |index: usize| {
        let start = table.checked_add(index.checked_mul(size)?)?;
        file.get(start..start.checked_add(size)?)
    };
    let symbols = (0..count).filter_map(header).find(|header| word(header, 4) == Some(SYMBOL_TABLE))?;
    let names = section(file, header(word(symbols, 0x18)? as usize)?)?;
    let named = |symbol: &[u8]| word(symbol, 0).and_then(|at| name(names, at as usize));
    // A mangled path says the length of each name before it.
    let mangled = format!("{}{wanted}", wanted.len());
    let is = |name: &[u8]| name == wanted.as_bytes() || name.ends_with(mangled.as_bytes());
    let is_wanted = |symbol: &&[u8]| named(symbol).is_some_and(is);
    let symbol = section(file, symbols)?.chunks_exact(SYMBOL_BYTES).find(is_wanted)?;
    let (value, kind) = (word(symbol, 4)?, symbol.get(12)? & 0xf);
    // Functions are type 2; their lowest bit is no part of the address.
    Some(if kind == 2 { value & !1 } else { value })
}

/// The bytes of a section, from its header on.
fn section<'a>(file: &'a [u8], header: &[u8]) -> Option<&'a [u8]> {
    let (start, length) = (word(header, 0x10)? as usize, word(header, 0x14)? as usize);
    file.get(start..start.checked_add(length)?)
}

/// The text that starts at `at` and ends before a zero.
fn name(names: &[u8], at: usize) -> Option<&[u8]> {
    names.get(at..)?.split(|&byte| byte == 0).next()
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
}

fn half(bytes: &[u8], at: usize) -> Option<usize> {
    Some(usize::from(u16::from_le_bytes(bytes.get(at..at.checked_add(2)?)?.try_into().ok()?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of three sections: none, two symbols (a variable, a function), their names.
    fn file() -> Vec<u8> {
        let mut file = b"\x7fELF\x01\x01".to_vec();
        file.resize(52, 0);
        let symbols_at = file.len();
        for (name, value, kind) in [(0, 0, 0), (1, 0x2000_0004_u32, 1_u8), (17, 0x0800_0101, 2)] {
            file.extend((name as u32).to_le_bytes());
            file.extend(value.to_le_bytes());
            file.extend([0, 0, 0, 0, kind, 0, 0, 0]);
        }
        let names_at = file.len();
        let names = b"\0_RNv4main5COILS\0EXTI0\0";
        file.extend(names);
        let sections_at = file.len();
        file.extend([0; 40]);
        for (kind, start, length, link) in [(2, symbols_at, 48, 2), (3, names_at, names.len(), 0)] {
            let words = [0, kind, 0, 0, start as u32, length as u32, link, 0, 0, 0];
            file.extend(words.into_iter().flat_map(u32::to_le_bytes));
        }
        file[0x20..0x24].copy_from_slice(&(sections_at as u32).to_le_bytes());
        file[0x2e] = 40;
        file[0x30] = 3;
        file
    }

    #[test]
    fn symbols_are_found_by_name_and_functions_without_their_mode() {
        assert_eq!(address(&file(), "COILS"), Ok(0x2000_0004));
        assert_eq!(address(&file(), "EXTI0"), Ok(0x0800_0100));
        for part in ["XTI0", "OILS", "COIL"] {
            assert_eq!(address(&file(), part), Err(format!("it has no `{part}`")));
        }
    }

    #[test]
    fn a_cut_or_foreign_file_is_an_error() {
        let whole = file();
        for length in 0..whole.len() {
            assert!(address(&whole[..length], "COILS").is_err(), "{length} bytes");
        }
        assert!(address(b"MZ and so on", "COILS").is_err());
    }
}
