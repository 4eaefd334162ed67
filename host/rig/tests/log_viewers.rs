//! Logs for viewers: `viewers/log.py` reads them with mcap-ros2-support, rosbags and rerun, which share no code with the recorder.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicBool;

use softlimb_rig::run::{Mcu, RunOptions, run};
use softlimb_scene::parse;

const CURE: &str = "a reader is missing (pip install mcap-ros2-support rosbags rerun-sdk)";

/// Whether the readers are installed. Continuous integration must have them: else the test would be skipped unnoticed.
fn has_readers() -> bool {
    let mut command = Command::new("python3");
    command.args(["-c", "import mcap_ros2, rosbags, rerun"]).stdout(Stdio::null()).stderr(Stdio::null());
    let found = command.status().is_ok_and(|status| status.success());
    let ci = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty());
    assert!(found || !ci, "CI is set: {CURE}");
    if !found {
        // The harness captures what `eprintln!` writes.
        let _ = writeln!(std::io::stderr(), "skipped: logs for viewers; {CURE}");
    }
    found
}

/// The text of a scene of the repository.
fn scene(name: &str) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name).with_extension("toml");
    std::fs::read_to_string(file).unwrap()
}

/// The log of a run of a scene, in a folder of its name.
fn log(folder: &Path, name: &str, text: &str) -> PathBuf {
    let scene = parse(text, name).unwrap();
    let options = RunOptions { seed: 1, out: folder.join(name), mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
    run(&scene, &options, &AtomicBool::new(false), |_| ()).unwrap().log
}

/// A scene whose base is beside the origin and leans, with a ball, a leaning and a hanging capsule, and IMUs without errors.
fn leaning() -> String {
    let text = scene("weightless-b");
    let base = "base_position = [\"0 m\", \"0 m\", \"1.1 m\"]   # at the wearer's waist
base_direction = [1, 0, 0]        # forward
base_up = [0, 0, 1]";
    assert!(text.contains(base), "the scene has another base");
    let leaning = "base_position = [\"20 cm\", \"-30 cm\", \"0.9 m\"]
base_direction = [0.6, 0, 0.8]
base_up = [-0.8, 0, 0.6]";
    let solids = r#"
[[obstacle]]
name = "ball"
shape = "sphere"
center = [3, 1, 2]
radius = "7 cm"

[[obstacle]]
name = "rail"
shape = "capsule"
from = [3, 0, 0.5]
to = [3.1, 0.4, 0.2]
radius = "2 cm"

[[obstacle]]
name = "rope"
shape = "capsule"
from = [3, 2, 2]
to = [3, 2, 1]
radius = "1 cm"

[imu]
tilt_error = 0
heading_error = 0
noise = 0
rate_noise = 0
"#;
    text.replace(base, leaning) + solids
}

#[test]
fn viewers_draw_the_limb_its_obstacles_and_its_load() {
    if !has_readers() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let logs =
        [log(folder.path(), "leaning", &leaning()), log(folder.path(), "pick-and-place-a", &scene("pick-and-place-a"))];
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/viewers/log.py");
    let output = Command::new("python3").arg(script).args(&logs).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    print!("{text}");
}
