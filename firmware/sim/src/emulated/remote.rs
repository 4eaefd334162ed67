//! The emulator's debugger interface, as far as it is needed here: run to a place, look at memory, change it.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::thread;
use std::time::Duration;

use crate::error::EmulatorError;

/// An answer takes less than a millisecond; an emulator that takes this long hangs.
const PATIENCE: Duration = Duration::from_secs(30);
/// Longest wait for a socket to appear, and the number of looks.
const LOOKS: u32 = 1_000;
const PAUSE: Duration = Duration::from_millis(10);

/// Connects to a socket that the emulator is about to open.
pub(super) fn connect(path: &Path) -> io::Result<UnixStream> {
    for _ in 0..LOOKS {
        if let Ok(stream) = UnixStream::connect(path) {
            return Ok(stream);
        }
        thread::sleep(PAUSE);
    }
    UnixStream::connect(path)
}

/// A connection to the debugger interface.
#[derive(Debug)]
pub(super) struct Remote {
    stream: UnixStream,
    /// Bytes that have arrived and are not yet part of an answer.
    pending: Vec<u8>,
}

impl Remote {
    pub(super) fn connect(path: &Path) -> Result<Self, EmulatorError> {
        let stream = connect(path)?;
        stream.set_read_timeout(Some(PATIENCE))?;
        let mut remote = Self { stream, pending: Vec::new() };
        // Registers can be set one by one once somebody has asked what they are; the answer is known.
        remote.ask("qXfer:features:read:target.xml:0,ffb")?;
        Ok(remote)
    }

    /// Stops the processor whenever it comes to an address.
    pub(super) fn stop_at(&mut self, address: u32) -> Result<(), EmulatorError> {
        self.demand(&format!("Z0,{address:x},2"))
    }

    /// Runs to the next stop, from an address of Thumb code or from where it is: there it would stop again if it is a place to stop at.
    pub(super) fn resume(&mut self, from: Option<u32>) -> Result<(), EmulatorError> {
        self.go("c", from)
    }

    /// Runs one instruction, at an address of Thumb code or where it is.
    pub(super) fn step(&mut self, from: Option<u32>) -> Result<(), EmulatorError> {
        self.go("s", from)
    }

    fn go(&mut self, how: &str, from: Option<u32>) -> Result<(), EmulatorError> {
        let question = from.map_or_else(|| how.to_owned(), |address| format!("{how}{:x}", address | 1));
        let answer = self.ask(&question)?;
        if answer.starts_with("T05") { Ok(()) } else { Err(strange(&question, answer)) }
    }

    /// Reads memory.
    pub(super) fn read(&mut self, address: u32, length: usize) -> Result<Vec<u8>, EmulatorError> {
        let question = format!("m{address:x},{length:x}");
        let answer = self.ask(&question)?;
        let bytes: Option<Vec<u8>> = answer.as_bytes().chunks(2).map(byte).collect();
        bytes.filter(|bytes| bytes.len() == length).ok_or_else(|| strange(&question, answer))
    }

    /// Writes memory.
    pub(super) fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), EmulatorError> {
        self.demand(&format!("M{address:x},{:x}:{}", bytes.len(), hex(bytes)))
    }

    /// Sets a register of the core: 13 is the stack pointer, 15 the program counter.
    pub(super) fn set_register(&mut self, number: u32, value: u32) -> Result<(), EmulatorError> {
        self.demand(&format!("P{number:x}={}", hex(&value.to_le_bytes())))
    }

    fn demand(&mut self, question: &str) -> Result<(), EmulatorError> {
        let answer = self.ask(question)?;
        if answer == "OK" { Ok(()) } else { Err(strange(question, answer)) }
    }

    fn ask(&mut self, question: &str) -> Result<String, EmulatorError> {
        let sum = question.bytes().fold(0_u8, u8::wrapping_add);
        self.stream.write_all(format!("${question}#{sum:02x}").as_bytes())?;
        loop {
            if let Some(answer) = take_answer(&mut self.pending) {
                return Ok(answer);
            }
            let mut chunk = [0; 1024];
            let count = self.stream.read(&mut chunk)?;
            if count == 0 {
                return Err(io::Error::from(io::ErrorKind::UnexpectedEof).into());
            }
            self.pending.extend(chunk.get(..count).unwrap_or(&chunk));
        }
    }
}

fn strange(question: &str, answer: String) -> EmulatorError {
    EmulatorError::Strange { question: question.to_owned(), answer }
}

/// The first answer among the bytes, `$answer#nn`, which is then no longer there; what comes before it acknowledges the question.
fn take_answer(bytes: &mut Vec<u8>) -> Option<String> {
    let start = bytes.iter().position(|&byte| byte == b'$')?;
    let end = start + bytes.iter().skip(start).position(|&byte| byte == b'#')?;
    if bytes.len() < end + 3 {
        return None;
    }
    let answer = String::from_utf8_lossy(bytes.get(start + 1..end)?).into_owned();
    bytes.drain(..end + 3);
    Some(answer)
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn byte(digits: &[u8]) -> Option<u8> {
    u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_cut_out_of_the_stream() {
        let mut bytes = b"+$OK#9a$T05thr".to_vec();
        assert_eq!(take_answer(&mut bytes), Some("OK".to_owned()));
        assert_eq!(take_answer(&mut bytes), None);
        bytes.extend(b"ead:01;#0");
        assert_eq!(take_answer(&mut bytes), None);
        bytes.push(b'7');
        assert_eq!(take_answer(&mut bytes), Some("T05thread:01;".to_owned()));
        assert_eq!(bytes, b"");
    }

    #[test]
    fn bytes_are_two_digits() {
        assert_eq!(hex(&[0, 0x7f, 0xff]), "007fff");
        assert_eq!([b"00", b"7f", b"fF"].map(|digits| byte(digits)), [Some(0), Some(0x7f), Some(0xff)]);
        assert_eq!(byte(b"g0"), None);
    }
}
