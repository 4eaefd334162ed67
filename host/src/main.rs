//! softlimb
fn main() {}
