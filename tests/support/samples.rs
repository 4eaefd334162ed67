//! Sizes of samples: a tenth by default, whole with `SOFTLIMB_SAMPLES=full`. Seeds are the same: the tenth is the beginning of the whole.

/// Size of a sample whose whole size is `full`.
pub(crate) fn samples(full: usize) -> usize {
    let is_whole = std::env::var_os("SOFTLIMB_SAMPLES").is_some_and(|size| size == "full");
    if is_whole { full } else { full.div_ceil(10) }
}
