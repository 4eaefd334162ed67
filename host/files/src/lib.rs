//! Files that several rooms read and write: tables of numbers, JSON problems, and output that is there whole or not at all.
//!
//! It must not know the meaning of a number: columns, fields and ranges are the caller's.

mod json_line;
pub mod object;
pub mod problem;
pub mod range;
pub mod table;
mod whole;

pub use whole::{FileError, make_folder, write_whole};
