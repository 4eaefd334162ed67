//! Any bytes at the decoders of both directions.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| softlimb_fuzz::bytes::bytes(data));
