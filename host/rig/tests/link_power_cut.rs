//! Power cut at every byte of an upload: the device holds a whole configuration or none, and the next upload works.

use std::io;

use softlimb_protocol::{Decoder, DeviceState, Frame, HostMessage};
use softlimb_rig::link::{DeviceConfiguration, Direct, LinkError, StreamOptions, Transport};
use softlimb_sim::{SimulatedMcu, here};

use crate::link_common::{SESSION, configuration, device, settings};

/// Time of a byte on the line at the default baud, us, rounded up, and that of the rest of a control tick.
const BYTE_US: u64 = 11;
const TICK_US: u64 = 1_000;

/// A port whose device loses its power once it has received so many more bytes.
struct Supplied {
    mcu: SimulatedMcu,
    sent: usize,
    /// Bytes up to the end of the last Hello.
    hello_bytes: usize,
    frames: Decoder<HostMessage>,
    cut_at: usize,
    /// Hash of the configuration right before the cut; `None` until then.
    held: Option<Option<u32>>,
}

impl Supplied {
    fn config_hash(&self) -> Option<u32> {
        self.mcu.controller().config().map(|config| config.hash)
    }

    /// Lets the bytes on the line arrive, cuts the power and switches it on again.
    fn cut(&mut self, bytes: usize) {
        let arrived_us = self.mcu.now_us() + bytes as u64 * BYTE_US + TICK_US;
        self.mcu.advance_to(arrived_us);
        self.held = Some(self.config_hash());
        *self.mcu.processor_mut() = here();
    }
}

impl Transport for Supplied {
    fn now_us(&self) -> u64 {
        self.mcu.now_us()
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let left = self.cut_at.saturating_sub(self.sent);
        for &byte in bytes {
            self.sent += 1;
            if let Some(Ok(Frame { message: HostMessage::Hello(_), .. })) = self.frames.push(byte) {
                self.hello_bytes = self.sent;
            }
        }
        if self.held.is_some() || left > bytes.len() {
            self.mcu.write(bytes);
            return Ok(());
        }
        let (before, behind) = bytes.split_at(left);
        self.mcu.write(before);
        self.cut(left);
        // The host does not know: it goes on.
        self.mcu.write(behind);
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) -> io::Result<()> {
        self.mcu.read(into);
        Ok(())
    }

    fn wait_until(&mut self, deadline_us: u64) {
        Transport::wait_until(&mut self.mcu, deadline_us);
    }
}

/// Configures the device in a new session.
fn configure(port: &mut Supplied, session: u16, configuration: &DeviceConfiguration) -> Result<u32, LinkError> {
    let options = StreamOptions { occupied_max_us: 1_000_000, ..StreamOptions::new(session) };
    let mut on_event = |_: &mut Supplied, _| {};
    Direct::open(port, &options, &mut on_event)?.configure(configuration)
}

/// A device with the old configuration, whose power is cut after `cut_at` bytes of the upload of the new one, and what its host says.
fn interrupted(old: Option<&DeviceConfiguration>, cut_at: usize) -> (Supplied, Option<u32>, Result<u32, LinkError>) {
    let mut port = Supplied {
        mcu: device(&settings(2)),
        sent: 0,
        hello_bytes: 0,
        frames: Decoder::new(),
        cut_at: usize::MAX,
        held: None,
    };
    let old_hash = old.map(|old| configure(&mut port, SESSION, old).unwrap());
    (port.sent, port.hello_bytes, port.cut_at) = (0, 0, cut_at);
    let outcome = configure(&mut port, SESSION + 1, &configuration(2));
    (port, old_hash, outcome)
}

/// Cuts the power after every byte.
fn every_byte(old: Option<&DeviceConfiguration>) {
    let (whole, old_hash, outcome) = interrupted(old, usize::MAX);
    let new_hash = outcome.unwrap();
    assert!(whole.held.is_none() && Some(new_hash) != old_hash && whole.config_hash() == Some(new_hash));
    let mut held = Vec::new();
    for cut_at in 1..=whole.sent {
        let (mut port, _, outcome) = interrupted(old, cut_at);
        held.push(port.held.expect("the power was cut"));
        // Nothing survives a reset, so that no part of an upload can; bytes that follow it belong to no session. A host whose upload is over
        // notices at its next message. A device that has only missed a Hello gets it again, and the upload after it.
        let was_over = port.held == Some(Some(new_hash));
        let is_new = outcome.is_ok() && !was_over;
        assert_eq!(port.config_hash(), is_new.then_some(new_hash), "cut at byte {cut_at}: {outcome:?}");
        assert!(!is_new || cut_at <= whole.hello_bytes, "cut at byte {cut_at}: the host must notice");
        assert_eq!(configure(&mut port, SESSION + 2, &configuration(2)).unwrap(), new_hash, "cut at byte {cut_at}");
        assert_eq!(port.config_hash(), Some(new_hash), "cut at byte {cut_at}");
        assert_eq!(port.mcu.controller().state(), DeviceState::Ready, "cut at byte {cut_at}");
    }
    // Before the cut it is the old one up to the last byte of the commit, and the new one from there on.
    let swapped =
        held.iter().position(|held| *held == Some(new_hash)).expect("the upload was whole before the last cut");
    println!(
        "{} bytes, {} of Hello; the new configuration counts from byte {}",
        whole.sent,
        whole.hello_bytes,
        swapped + 1
    );
    assert!(whole.hello_bytes < 100 && whole.sent > 450, "most cuts hit the upload");
    assert!(held[..swapped].iter().all(|held| *held == old_hash));
    assert!(held[swapped..].iter().all(|held| *held == Some(new_hash)));
}

#[test]
fn first_upload_is_whole_or_gone() {
    every_byte(None);
}

#[test]
fn upload_over_another_one_is_whole_or_gone() {
    every_byte(Some(&configuration(1)));
}
