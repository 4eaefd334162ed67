//! Loaded scenes by a program that shares no code with the product: shooting, with springs derived anew.

mod command;

pub(crate) use command::Statics;
