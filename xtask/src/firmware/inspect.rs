//! Code that must not be in an image.

use crate::double::is_double;
use crate::elf;

/// Parts of names of the code that turns floating-point numbers into text.
const FLOAT_TEXT: [&str; 3] = ["flt2dec", "float_to_decimal", "float_to_exponential"];

/// Looks for arithmetic in double precision, for text of floating-point numbers, and for names of places on this computer.
///
/// # Errors
/// What was found.
pub(super) fn check(file: &[u8], places: &[(String, &str)]) -> Result<(), String> {
    let symbols = elf::symbols(file)?;
    if !symbols.iter().any(|symbol| symbol == "main") {
        return Err("it has no `main`".to_owned());
    }
    let is_forbidden = |symbol: &&String| is_double(symbol) || FLOAT_TEXT.iter().any(|part| symbol.contains(part));
    let mut found: Vec<String> = symbols.iter().filter(is_forbidden).cloned().collect();
    let segments = elf::segments(file)?;
    for (place, _) in places {
        let holds = |bytes: &[u8]| bytes.windows(place.len()).any(|window| window == place.as_bytes());
        if segments.iter().any(|segment| holds(segment.bytes)) {
            found.push(format!("the text `{place}`"));
        }
    }
    if found.is_empty() {
        println!("xtask: no double precision, no text of floating-point numbers, no paths of the build computer in it");
        return Ok(());
    }
    Err(format!("the image must not hold\n  {}", found.join("\n  ")))
}
