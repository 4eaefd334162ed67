//! Faults on the way to the device, drawn by the fuzzer.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| softlimb_fuzz::device::device(&mut softlimb_fuzz::Draw::bytes(data), u64::MAX));
