//! Small enumerations on the wire that may grow in a later version.

use core::fmt;

use crate::error::{EncodeError, PayloadError};
use crate::wire::{Reader, Wire, Writer};

/// An enumeration whose members have fixed one-byte codes.
pub trait CodeSet: Copy + Eq + fmt::Debug + 'static {
    /// The member with this code, if this version knows one.
    fn from_code(code: u8) -> Option<Self>;

    /// The code of the member.
    fn code(self) -> u8;
}

/// A received code: a member of `E`, or a number that this version does not know.
///
/// Unknown codes decode without an error, so that the receiver can answer them by name of the offending field.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Code<E: CodeSet> {
    raw: u8,
    set: core::marker::PhantomData<E>,
}

impl<E: CodeSet> Code<E> {
    /// A code as it stands on the wire.
    #[must_use]
    pub const fn from_raw(raw: u8) -> Self {
        Self { raw, set: core::marker::PhantomData }
    }

    /// The code as it stands on the wire.
    #[must_use]
    pub const fn raw(self) -> u8 {
        self.raw
    }

    /// The member, or `None` for a code of a later version.
    #[must_use]
    pub fn known(self) -> Option<E> {
        E::from_code(self.raw)
    }
}

impl<E: CodeSet> From<E> for Code<E> {
    fn from(member: E) -> Self {
        Self::from_raw(member.code())
    }
}

impl<E: CodeSet> PartialEq<E> for Code<E> {
    fn eq(&self, member: &E) -> bool {
        self.raw == member.code()
    }
}

impl<E: CodeSet> fmt::Debug for Code<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.known() {
            Some(member) => member.fmt(f),
            None => write!(f, "unknown({})", self.raw),
        }
    }
}

impl<E: CodeSet> Wire for Code<E> {
    const FIXED_LEN: usize = 1;

    fn read(reader: &mut Reader<'_>) -> Result<Self, PayloadError> {
        u8::read(reader).map(Self::from_raw)
    }

    fn write(&self, writer: &mut Writer<'_>) -> Result<(), EncodeError> {
        self.raw.write(writer)
    }
}
