//! The names in the symbol table of an ELF file: 32 bits, little-endian, as Arm's linkers write it.

/// Type of the section that holds the symbols.
const SYMBOL_TABLE: usize = 2;
const SYMBOL_BYTES: usize = 16;

/// Names of all symbols.
///
/// # Errors
/// What is wrong with the file, or that its symbols were stripped.
pub(crate) fn symbols(file: &[u8]) -> Result<Vec<String>, String> {
    if file.get(..6) != Some(&b"\x7fELF\x01\x01"[..]) {
        return Err("no ELF file of 32 bits, little-endian".to_owned());
    }
    names(file).ok_or_else(|| "its symbol table is missing or broken".to_owned())
}

fn names(file: &[u8]) -> Option<Vec<String>> {
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
        return symbols.chunks_exact(SYMBOL_BYTES).map(|symbol| name(text, word(symbol, 0)?)).collect();
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
    use super::symbols;

    /// A file of three sections: none, the symbols, their names.
    fn file() -> Vec<u8> {
        let (text, names) = (b"\0main\0__aeabi_dmul\0", [0_u32, 1, 6]);
        let mut file = b"\x7fELF\x01\x01".to_vec();
        file.resize(52, 0);
        let symbols_at = file.len();
        for name in names {
            file.extend(name.to_le_bytes());
            file.extend([0; 12]);
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
    fn names_are_read() {
        assert_eq!(symbols(&file()).unwrap(), ["", "main", "__aeabi_dmul"]);
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
