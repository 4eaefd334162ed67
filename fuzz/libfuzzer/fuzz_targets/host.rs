//! Faults on the way to the host, drawn by the fuzzer.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| softlimb_fuzz::host::host(&mut softlimb_fuzz::Draw::bytes(data), u64::MAX));
