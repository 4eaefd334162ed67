//! The targets with seeded faults, and with the corpus of the fuzzer.

use std::fs;
use std::path::Path;

use softlimb_fuzz::{Draw, bytes, device, host};

/// Faults on the way to the device and on the way to the host; together a million.
const FAULTS: u64 = 500_000;
/// Blocks of bytes that no sender meant.
const BLOCKS: usize = 20_000;

#[test]
fn half_a_million_faults_on_the_way_to_the_device_apply_nothing_wrong() {
    device::device(&mut Draw::random(1), FAULTS);
}

#[test]
fn half_a_million_faults_on_the_way_to_the_host_show_nothing_wrong() {
    host::host(&mut Draw::random(2), FAULTS);
}

#[test]
fn any_bytes_are_counted_and_the_next_frame_is_not_lost() {
    let mut draw = Draw::random(3);
    for _ in 0..BLOCKS {
        let noise: Vec<u8> = (0..draw.below(700)).map(|_| draw.number() as u8).collect();
        bytes::bytes(&noise);
    }
}

/// Runs a target with every file of its corpus.
fn corpus(name: &str, target: impl Fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(name);
    let files: Vec<_> = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
    assert!(files.len() >= 3, "{name}: {files:?}");
    files.iter().for_each(|file| target(&fs::read(file).unwrap()));
}

#[test]
fn corpus_passes() {
    corpus("bytes", bytes::bytes);
    corpus("device", |data| device::device(&mut Draw::bytes(data), u64::MAX));
    corpus("host", |data| host::host(&mut Draw::bytes(data), u64::MAX));
}
