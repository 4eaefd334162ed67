//! The label of figures of a limb without weight.

/// The word for a limb whose simulation leaves out its own weight and its payload, and for every figure of such a limb.
pub const WEIGHTLESS: &str = "weightless";

/// A title, followed by [`WEIGHTLESS`] where the limb is.
pub fn labelled(title: &str, weightless: bool) -> String {
    if weightless { format!("{title}, {WEIGHTLESS}") } else { title.to_owned() }
}
