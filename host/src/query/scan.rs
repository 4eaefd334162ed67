//! A fast reader of JSON as programs usually write it.
//!
//! It reads a part of what `serde_json` reads, with the same result: no `null`, no empty objects, strings without escapes. Of any other
//! text it says nothing, `None`, and `serde_json` decides.

use std::str;

use serde_json::Value;

/// Lines, as far as they are not read.
pub(super) struct Scan<'a> {
    rest: &'a [u8],
}

/// Powers of ten that a double holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];
/// Integers up to here are exact in a double.
const EXACT: u64 = 1 << f64::MANTISSA_DIGITS;
/// Digits that a `u64` holds, whatever they are.
const DIGITS: usize = 19;
/// A one in each byte.
const EACH: u64 = 0x0101_0101_0101_0101;

impl<'a> Scan<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { rest: text }
    }

    /// The text after the end of the line, if that is next.
    pub(super) fn after_line(mut self) -> Option<&'a [u8]> {
        self.space();
        match self.rest {
            [] => Some(&[]),
            [b'\n', rest @ ..] => Some(rest),
            _ => None,
        }
    }

    /// An object: `field` reads the value of each name, and refuses names that it does not know.
    #[inline(always)]
    pub(super) fn object(&mut self, mut field: impl FnMut(&mut Self, &'a [u8]) -> Option<()>) -> Option<()> {
        self.token(b'{')?;
        loop {
            let name = self.word()?;
            self.token(b':')?;
            field(self, name)?;
            self.space();
            if !self.skip(b',') {
                return self.token(b'}');
            }
        }
    }

    /// Three numbers.
    pub(super) fn numbers<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        for (index, number) in numbers.iter_mut().enumerate() {
            self.token(if index == 0 { b'[' } else { b',' })?;
            *number = self.number()?;
        }
        self.token(b']')?;
        Some(numbers)
    }

    /// A string or a natural number.
    pub(super) fn id(&mut self) -> Option<Value> {
        self.space();
        if self.rest.first() != Some(&b'"') {
            return self.natural().map(Value::from);
        }
        let word = self.word()?;
        let is_plain = word.iter().all(|byte| *byte >= b' ' && *byte != b'\\');
        is_plain.then_some(Value::from(str::from_utf8(word).ok()?))
    }

    /// The text between two quotes, as it stands there: with a quote that is escaped it ends too early, behind a backslash.
    #[inline(always)]
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        self.token(b'"')?;
        let end = first_quote(self.rest)?;
        let word = self.rest.get(..end)?;
        self.rest = self.rest.get(end + 1..)?;
        Some(word)
    }

    pub(super) fn natural(&mut self) -> Option<u64> {
        self.space();
        let mut value = 0;
        let digits = self.whole(&mut value)?;
        (digits <= DIGITS).then_some(value)
    }

    pub(super) fn number(&mut self) -> Option<f64> {
        self.space();
        // A copy, which stays in registers.
        let mut scan = Scan { rest: self.rest };
        let is_negative = scan.skip(b'-');
        let mut mantissa = 0;
        let mut digits = scan.whole(&mut mantissa)?;
        let mut exponent = 0;
        if scan.skip(b'.') {
            let fraction = scan.digits(&mut mantissa)?;
            digits += fraction;
            exponent = -i32::try_from(fraction).ok()?;
        }
        if scan.skip(b'e') || scan.skip(b'E') {
            exponent += scan.exponent()?;
        }
        let value = if digits <= DIGITS { decimal(mantissa, exponent) } else { None };
        let text = self.rest.get(..self.rest.len() - scan.rest.len())?;
        self.rest = scan.rest;
        match value {
            Some(value) => Some(if is_negative { -value } else { value }),
            None => other_number(text),
        }
    }

    fn exponent(&mut self) -> Option<i32> {
        let is_negative = self.skip(b'-');
        if !is_negative {
            self.skip(b'+');
        }
        let mut value = 0;
        // Any larger one leaves the powers of the table, and is read again by another reader.
        let value = if self.digits(&mut value)? <= DIGITS { value.min(1 << 20) as i32 } else { 1 << 20 };
        Some(if is_negative { -value } else { value })
    }

    /// The digits in front of a point: nothing but the point follows a zero.
    #[inline(always)]
    fn whole(&mut self, value: &mut u64) -> Option<usize> {
        if self.skip(b'0') { Some(0) } else { self.digits(value) }
    }

    /// Appends digits, one at least, to a number, and counts them. The number is of no use where there are more than a `u64` holds.
    #[inline(always)]
    fn digits(&mut self, value: &mut u64) -> Option<usize> {
        let length = self.rest.len();
        while let Some((text, rest)) = self.rest.split_first_chunk()
            && let Some(eight) = eight_digits(u64::from_le_bytes(*text))
        {
            *value = value.wrapping_mul(100_000_000).wrapping_add(eight);
            self.rest = rest;
        }
        while let [digit @ b'0'..=b'9', rest @ ..] = self.rest {
            *value = value.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
            self.rest = rest;
        }
        let count = length - self.rest.len();
        (count > 0).then_some(count)
    }

    #[inline(always)]
    fn token(&mut self, token: u8) -> Option<()> {
        self.space();
        self.skip(token).then_some(())
    }

    /// White space, but for the end of the line.
    #[inline(always)]
    fn space(&mut self) {
        while let [b' ' | b'\t' | b'\r', rest @ ..] = self.rest {
            self.rest = rest;
        }
    }

    /// Passes over a byte, if it is next.
    #[inline(always)]
    fn skip(&mut self, byte: u8) -> bool {
        match self.rest {
            [first, rest @ ..] if *first == byte => {
                self.rest = rest;
                true
            }
            _ => false,
        }
    }
}

/// The double nearest to `mantissa 10^exponent`, in one rounding; `None` where that takes more.
#[inline(always)]
fn decimal(mantissa: u64, exponent: i32) -> Option<f64> {
    let power = *POWERS.get(exponent.unsigned_abs() as usize)?;
    if mantissa <= EXACT {
        // Both are exact, and the one operation rounds.
        return Some(if exponent < 0 { mantissa as f64 / power } else { mantissa as f64 * power });
    }
    if !(-18..0).contains(&exponent) {
        return None;
    }
    // More than 56 bits of the quotient: the last is below the rounding, and stands for all after it. The conversion rounds.
    let (dividend, divisor) = (u128::from(mantissa) << 64, u128::from(power as u64));
    let (quotient, is_exact) = (dividend / divisor, dividend.is_multiple_of(divisor));
    Some((quotient | u128::from(!is_exact)) as f64 * (1.0 / 18_446_744_073_709_551_616.0))
}

/// A number too large is none of `serde_json`.
#[cold]
fn other_number(text: &[u8]) -> Option<f64> {
    str::from_utf8(text).ok()?.parse().ok().filter(|number: &f64| number.is_finite())
}

/// The place of the first quote.
#[inline(always)]
fn first_quote(text: &[u8]) -> Option<usize> {
    let mut rest = text;
    while let Some((eight, after)) = rest.split_first_chunk() {
        // The lowest byte that is zero borrows from its highest bit; those above it may, too.
        let other = u64::from_le_bytes(*eight) ^ (u64::from(b'"') * EACH);
        let zeros = other.wrapping_sub(EACH) & !other & (0x80 * EACH);
        if zeros != 0 {
            return Some(text.len() - rest.len() + (zeros.trailing_zeros() / 8) as usize);
        }
        rest = after;
    }
    let end = rest.iter().position(|byte| *byte == b'"')?;
    Some(text.len() - rest.len() + end)
}

/// The number that eight digits make, added up side by side: pairs, then fours, then all; `None` where one is no digit.
#[inline(always)]
fn eight_digits(text: u64) -> Option<u64> {
    const LOW: u64 = 0x0000_00ff_0000_00ff;
    // A digit has a high half of 3, and keeps it with 6 added.
    let high = (text & (0xf0 * EACH)) | ((text.wrapping_add(6 * EACH) & (0xf0 * EACH)) >> 4);
    if high != 0x33 * EACH {
        return None;
    }
    let ones = text - u64::from(b'0') * EACH;
    let pairs = ones * 10 + (ones >> 8);
    let fours = (pairs & LOW).wrapping_mul(100 + (1_000_000 << 32));
    let others = ((pairs >> 16) & LOW).wrapping_mul(1 + (10_000 << 32));
    Some(fours.wrapping_add(others) >> 32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read<'a, T>(text: &'a [u8], value: impl FnOnce(&mut Scan<'a>) -> Option<T>) -> Option<T> {
        let mut scan = Scan::new(text);
        let value = value(&mut scan)?;
        scan.after_line().filter(|rest| rest.is_empty()).map(|_| value)
    }

    fn number(text: &str) -> Option<f64> {
        read(text.as_bytes(), Scan::number)
    }

    fn id(text: &str) -> Option<Value> {
        read(text.as_bytes(), Scan::id)
    }

    #[test]
    fn usual_text_is_read_as_by_serde_json() {
        for text in
            ["12", "0", "\"a b\"", "\"\u{e9}\"", "\"\"", " \"x\" ", "9999999999999999999", "12345678", "123456789"]
        {
            assert_eq!(id(text), Some(serde_json::from_str(text).expect("JSON")), "{text}");
        }
        assert_eq!(read(b" [1, 2.5 ,\t3]", Scan::numbers::<3>), Some([1.0, 2.5, 3.0]));
    }

    /// The bits of the standard library, by all ways: eight digits at a time and one, exact powers of ten and others.
    #[test]
    fn numbers_are_rounded_as_by_the_standard_library() {
        let some =
            ["0", "-0", "12", "0.1", "-1.50e-7", "1E+3", "2e0", " 18446744073709551615\r\n", "4.9e-324", "-0.0e5"];
        let far = ["1e-9999999999999999999999", "0e99999999999999999999", "1.7976931348623157e308", "5e-324", "2e-324"];
        let long =
            ["0.00000000000000000000001", "123456789012345678901234567890", "9007199254740993", "9007199254740993e-3"];
        for text in some.into_iter().chain(far).chain(long) {
            let expected: f64 = text.trim().parse().expect("a number");
            assert_eq!(number(text).map(f64::to_bits), Some(expected.to_bits()), "{text}");
        }
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        for i in 0..20_000_usize {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let share = (bits >> 11) as f64 / (1_u64 << 53) as f64;
            let value = (share - 0.5) * 10_f64.powi(i32::try_from(i % 50).expect("small") - 25);
            for text in [
                format!("{value}"),
                format!("{value:e}"),
                format!("{value:.*}", i % 23),
                format!("{value:.*e}", i % 19),
            ] {
                let expected: f64 = text.parse().expect("a number");
                assert_eq!(number(&text).map(f64::to_bits), Some(expected.to_bits()), "{text}");
            }
        }
    }

    #[test]
    fn other_text_is_left_to_serde_json() {
        for text in [
            "", "-", "+1", "01", "-00", ".5", "1.", "1.e3", "1e", "1e+", "1e999", "NaN", "inf", "1 2", "0x1", "1_0",
            "1e5e5",
        ] {
            assert_eq!(number(text), None, "{text}");
        }
        for text in [
            "null",
            "true",
            "-1",
            "1.0",
            "\"\\n\"",
            "\"a\\\"b\"",
            "\"a\nb\"",
            "\"a",
            "{}",
            "[]",
            "1,",
            "18446744073709551616",
        ] {
            assert_eq!(id(text), None, "{text}");
        }
        for text in ["[1,2]", "[1,2,3,4]", "[1,2,3", "[1,2,3,]", "[,1,2,3]", "[1 2,3,4]", "{1,2,3}"] {
            assert_eq!(read(text.as_bytes(), Scan::numbers::<3>), None, "{text}");
        }
        assert_eq!(read(b"\"\xff\"", Scan::id), None);
    }

    #[test]
    fn first_quote_is_found_at_any_place() {
        for length in 0..40_usize {
            // Neighbours of a quote in value and sign, and quotes behind it.
            let other = |i: usize| [b'!', b'#', 0xa2, 0, b'a'][i % 5];
            let text: Vec<u8> = (0..length).map(other).collect();
            assert_eq!(first_quote(&text), None);
            for place in 0..length {
                let mut text = text.clone();
                text[place..].iter_mut().step_by(1 + place % 3).for_each(|byte| *byte = b'"');
                assert_eq!(first_quote(&text), Some(place), "{length}");
            }
        }
    }

    #[test]
    fn eight_digits_are_no_other_bytes() {
        assert_eq!(eight_digits(u64::from_le_bytes(*b"12345678")), Some(12_345_678));
        assert_eq!(eight_digits(u64::from_le_bytes(*b"00000009")), Some(9));
        for byte in (0..=255_u8).filter(|byte| !byte.is_ascii_digit()) {
            for place in 0..8 {
                let mut text = *b"12345678";
                text[place] = byte;
                assert_eq!(eight_digits(u64::from_le_bytes(text)), None, "{byte} at {place}");
            }
        }
    }
}
