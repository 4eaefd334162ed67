//! The streams of the emulator that this program runs in, by semihosting: nothing that a chip on a board could do.

use cortex_m_semihosting::{nr, syscall};

/// Modes of the C library: "rb" and "wb".
const READ: usize = 1;
const WRITE: usize = 5;

/// Standard input and output of the emulator.
pub struct Streams {
    input: usize,
    output: usize,
}

/// The other side is gone, or there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gone;

impl Streams {
    /// Opens both.
    ///
    /// # Errors
    /// [`Gone`] where the emulator does not let it.
    pub fn open() -> Result<Self, Gone> {
        Ok(Self { input: open("/dev/stdin\0", READ)?, output: open("/dev/stdout\0", WRITE)? })
    }

    /// Reads exactly as many bytes as there is room for, however long it takes.
    ///
    /// # Errors
    /// [`Gone`].
    pub fn read(&self, mut into: &mut [u8]) -> Result<(), Gone> {
        while !into.is_empty() {
            let arguments = [self.input, into.as_mut_ptr() as usize, into.len()];
            // SAFETY: the three words that this call reads, and memory that is ours to be written.
            let left = unsafe { syscall(nr::READ, &arguments) };
            if left >= into.len() {
                return Err(Gone);
            }
            let done = into.len() - left;
            into = into.get_mut(done..).ok_or(Gone)?;
        }
        Ok(())
    }

    /// Writes all bytes.
    ///
    /// # Errors
    /// [`Gone`].
    pub fn write(&self, mut bytes: &[u8]) -> Result<(), Gone> {
        while !bytes.is_empty() {
            let arguments = [self.output, bytes.as_ptr() as usize, bytes.len()];
            // SAFETY: the three words that this call reads, and memory that it only reads.
            let left = unsafe { syscall(nr::WRITE, &arguments) };
            if left >= bytes.len() {
                return Err(Gone);
            }
            let done = bytes.len() - left;
            bytes = bytes.get(done..).ok_or(Gone)?;
        }
        Ok(())
    }
}

/// Opens a file by a name that ends with a zero.
fn open(name: &str, mode: usize) -> Result<usize, Gone> {
    let arguments = [name.as_ptr() as usize, mode, name.len() - 1];
    // SAFETY: the three words that this call reads; the name ends with a zero.
    let handle = unsafe { syscall(nr::OPEN, &arguments) };
    if handle == usize::MAX { Err(Gone) } else { Ok(handle) }
}
