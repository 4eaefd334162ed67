//! The interface as data, for `SPEC.md` and diagnostics.

/// Delivery of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delivery {
    /// Acknowledged; sent again with the same sequence number until then; applied once.
    Reliable,
    /// Acknowledged and ordered by its own index; the sender goes back to the index the receiver expects.
    Indexed,
    /// Sent once.
    Unacknowledged,
}

/// One field of a message or record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldLayout {
    /// Name, with its unit.
    pub name: &'static str,
    /// Type as the schema text spells it.
    pub wire_type: &'static str,
    /// Bytes that are always there (the count byte of a list).
    pub fixed_len: usize,
    /// Bytes per element of a list, 0 otherwise.
    pub element_len: usize,
    /// Meaning, unit and range.
    pub meaning: &'static str,
}

/// One message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageLayout {
    /// The type byte.
    pub message_type: u8,
    /// Name.
    pub name: &'static str,
    /// Its delivery.
    pub delivery: Delivery,
    /// Purpose.
    pub meaning: &'static str,
    /// Fields in wire order.
    pub fields: &'static [FieldLayout],
}

/// One enumeration or set of flags.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CodeLayout {
    /// Name.
    pub name: &'static str,
    /// Purpose.
    pub meaning: &'static str,
    /// Name, code (or bit number) and meaning of each member.
    pub members: &'static [(&'static str, u8, &'static str)],
}

/// Position of the field called `name` among all, counted from 0.
pub(crate) const fn position(names: &[&str], name: &str) -> Option<u32> {
    let mut rest = names;
    let mut number = 0;
    while let [field, others @ ..] = rest {
        if same(field.as_bytes(), name.as_bytes()) {
            return Some(number);
        }
        number += 1;
        rest = others;
    }
    None
}

const fn same(mut left: &[u8], mut right: &[u8]) -> bool {
    while let ([a, left_rest @ ..], [b, right_rest @ ..]) = (left, right) {
        if *a != *b {
            return false;
        }
        (left, right) = (left_rest, right_rest);
    }
    left.is_empty() && right.is_empty()
}
