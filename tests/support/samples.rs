//! Sizes of random samples: the environment variable `SOFTLIMB_SAMPLES` chooses between a tenth and the whole.

/// Number of samples to draw where the whole sample has `full`: all with `SOFTLIMB_SAMPLES=full`, else the first tenth.
///
/// Seeds are the same for both, so that the tenth is the beginning of the whole.
///
/// # Panics
/// For any other value of the variable.
pub(crate) fn samples(full: u32) -> u32 {
    match std::env::var_os("SOFTLIMB_SAMPLES") {
        None => full.div_ceil(10),
        Some(value) if value == "full" => full,
        Some(value) => panic!("SOFTLIMB_SAMPLES is {value:?}: leave it unset or set it to `full`"),
    }
}
