//! The bytes of the link and the ticks of a run in its log, and re-runs of the controller on them.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use softlimb_protocol::{Decoder, DeviceMessage, HostMessage, Message};
use softlimb_rig::record::{Capture, Direction, read_capture};
use softlimb_rig::run::{Mcu, RunFiles, RunOptions, run};
use softlimb_scene::parse;

const ONE_FINGER: &str = r#"
format = 1
name = "minimal"
weight.simulated = false
materials.silicone = { law = "neo-hookean", shear_modulus = "0.2 MPa" }
limb.connector = { length = 0, mass = 0 }
module = [{ name = "a", motion = "bending", actuators = 1, inner_radius = 0.010, outer_radius = 0.014, length = 0.2, material = "silicone" }]
phase = [{ name = "p", duration = 0.4, targets = { a = { pressure = "20 kPa" } }, gripper = "close" }]
"#;

fn ran(folder: &Path) -> RunFiles {
    let scene = parse(ONE_FINGER, "minimal.toml").unwrap();
    let options = RunOptions { seed: 3, out: folder.to_owned(), mcu: Mcu::Here, link_faults: None };
    run(&scene, &options, &AtomicBool::new(false), |_| ()).unwrap()
}

/// The messages of one direction; none is hurt.
fn messages<D: Message>(capture: &Capture, direction: Direction) -> Vec<D> {
    let mut decoder = Decoder::<D>::new();
    let bytes = capture.bytes(direction).flat_map(|(_, bytes)| bytes);
    bytes.filter_map(|&byte| decoder.push(byte)).map(|frame| frame.unwrap().message).collect()
}

#[test]
fn log_holds_every_byte_of_the_link_and_every_tick() {
    let folder = tempfile::tempdir().unwrap();
    let files = ran(folder.path());
    let capture = read_capture(&files.log).unwrap();
    let count = |direction| capture.bytes(direction).map(|(_, bytes)| bytes.len() as u64).sum::<u64>();
    let link = files.run.link;
    assert_eq!((count(Direction::ToDevice), count(Direction::ToHost)), (link.bytes_sent, link.bytes_received));

    let told = messages::<HostMessage>(&capture, Direction::ToDevice);
    assert!(matches!(told.first(), Some(HostMessage::Hello(_))), "{:?}", told.first());
    assert!(told.iter().any(|message| matches!(message, HostMessage::ConfigCommit(_))));
    let answered = messages::<DeviceMessage>(&capture, Direction::ToHost);
    assert!(matches!(answered.first(), Some(DeviceMessage::HelloReply(_))), "{:?}", answered.first());
    assert_eq!((told.len() as u64, answered.len() as u64), (link.frames_sent, link.frames_received));
    assert!(capture.wire.windows(2).all(|pair| pair[0].host_us <= pair[1].host_us));

    assert!(!capture.at_pins && capture.ticks.len() > 2_000, "{}", capture.ticks.len());
    assert!((0..).step_by(1_000).zip(&capture.ticks).all(|(us, tick)| tick.device_us == us && tick.codes.len() == 2));
    assert!(capture.ticks.iter().any(|tick| tick.pulses.iter().any(|pulse| pulse.fill_us > 0)));
    assert!(capture.ticks.iter().any(|tick| tick.supply_open && tick.outputs == 1));
}
