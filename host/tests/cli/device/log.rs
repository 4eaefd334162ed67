//! Logs of a device whose host is killed, whose disk is full, or that runs no scene.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use softlimb::rig::record::{Direction, read, read_capture};

use super::desk;
use crate::cli::desk::{Desk, SCENE};
use crate::cli::program::Program;
use crate::samples::samples;

/// A motion of 1 s, a hold of 2 s, and a device that soon has let go of a killed host's pressures.
const LONG: [(&str, &str); 2] = [
    ("hold = \"0.2 s\"", "hold = \"2 s\""),
    (
        "[weight]",
        "[controller]\ntelemetry_period = \"2 ms\"\nhold_time = \"0.3 s\"\nvent_ramp = \"200 kPa/s\"\n\n[weight]",
    ),
];

/// What a full disk may add to the pause between two messages of the host.
const GAP: Duration = Duration::from_millis(10);

/// Runs until the host's longest pause is short: a busy computer makes some long, and nothing makes one too short.
const ATTEMPTS: usize = 5;

/// Uniform in 0..1.
fn uniform(random: &mut ChaCha8Rng) -> f64 {
    f64::from(random.next_u32()) / 4_294_967_296.0
}

#[test]
fn host_killed_at_any_time_loses_half_a_second_of_its_log_and_the_next_runs() {
    let desk = Desk::new();
    desk.put("scene.toml", LONG.iter().fold(SCENE.to_owned(), |scene, (from, to)| scene.replace(from, to)));
    let mut device = Program::start(&desk, "device serve scene.toml --tcp 127.0.0.1:0");
    let address = device.first_line();
    let mut random = ChaCha8Rng::seed_from_u64(17);
    let (mut worst_s, mut worst_left_s): (f64, f64) = (0.0, 0.0);
    for round in 0..samples(50) {
        let mut host = Program::start(&desk, &format!("run scene.toml --out killed --port {address}"));
        let running_s = device.until("Running");
        thread::sleep(Duration::from_secs_f64(0.05 + 2.4 * uniform(&mut random)));
        host.kill();
        // The operating system closes the connection of a dead program at once.
        let killed_s = device.until(" left") - running_s;
        device.until("fault: link lost");
        let holding_s = device.until("Holding");
        let venting_s = device.until("Venting");
        assert!((venting_s - holding_s - 0.3).abs() < 0.1, "round {round}: held for {} s", venting_s - holding_s);
        device.until("Ready");

        let kept = desk.path("killed/run.mcap.partial");
        let closed_s = read(&kept).unwrap().samples.last().map_or(0.0, |sample| sample.time_s);
        let _ = std::fs::remove_file(desk.path("recovered.mcap"));
        let recovered = desk.softlimb("recover killed/run.mcap.partial -o recovered.mcap");
        assert_eq!(recovered.code, Some(3), "{recovered:?}");
        let log = read(desk.path("recovered.mcap")).unwrap();
        let last_s = log.samples.last().map_or(0.0, |sample| sample.time_s);
        assert!(last_s >= closed_s);
        let lost_s = killed_s - last_s;
        (worst_s, worst_left_s) = (worst_s.max(lost_s), worst_left_s.max(killed_s - closed_s));
        assert!(lost_s <= 0.5, "round {round}: killed {killed_s:.3} s into the run, the log ends at {last_s:.3} s");
        assert!(last_s < killed_s + 0.05, "round {round}: the log ends at {last_s} s, killed at {killed_s} s");
        let capture = read_capture(desk.path("recovered.mcap")).unwrap();
        assert!(capture.bytes(Direction::ToDevice).count() > 10 && capture.bytes(Direction::ToHost).count() > 10);
    }
    println!("{} kills: at most {worst_s:.3} s lost, {worst_left_s:.3} s of the file that was left", samples(50));
    desk.softlimb(&format!("run scene.toml --out whole --port {address}")).done();
    // Of a device that was configured before, the run alone is run again.
    let again = desk.softlimb("replay whole/run.mcap").done().out;
    assert!(again.contains("from its start on") && again.ends_with("no difference\n"), "{again}");
}

/// Hands bytes on between a host and a device, and measures the longest pause of the host.
fn proxy(device: &str) -> (String, thread::JoinHandle<Duration>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    let mut device = TcpStream::connect(device.trim_start_matches("tcp:")).unwrap();
    device.set_nodelay(true).unwrap();
    let pauses = thread::spawn(move || {
        let (mut host, _) = listener.accept().unwrap();
        host.set_nodelay(true).unwrap();
        let (mut from_device, mut to_host) = (device.try_clone().unwrap(), host.try_clone().unwrap());
        thread::spawn(move || std::io::copy(&mut from_device, &mut to_host));
        let (mut bytes, mut last, mut longest) = ([0; 4096], None, Duration::ZERO);
        while let Ok(count @ 1..) = host.read(&mut bytes) {
            let now = Instant::now();
            longest = last.map_or(longest, |last| longest.max(now - last));
            last = Some(now);
            device.write_all(&bytes[..count]).unwrap();
        }
        let _ = device.shutdown(std::net::Shutdown::Both);
        longest
    });
    (address, pauses)
}

#[test]
fn full_disk_is_told_with_file_and_cause_and_does_not_disturb_the_limb() {
    let desk = desk("");
    let longest = |line: &str, code: i32, words: &[&str]| {
        // A new device each time: one that was in a session lets the next host wait, which is a pause too.
        let mut device = Program::start(&desk, "device serve scene.toml --tcp 127.0.0.1:0");
        let (port, pauses) = proxy(&device.first_line());
        // A limit to the size of files is the full disk that needs no privileges: the shell ignores the signal, and so does its program.
        let line = format!(
            "trap '' XFSZ; {line} exec {} run scene.toml --out results --port {port}",
            env!("CARGO_BIN_EXE_softlimb")
        );
        let answer = Command::new("sh").args(["-c", &line]).current_dir(desk.path("")).output().unwrap();
        let told = String::from_utf8_lossy(&answer.stderr).into_owned();
        assert_eq!(answer.status.code(), Some(code), "{told}");
        words.iter().for_each(|word| assert!(told.contains(word), "`{word}` is missing: {told}"));
        let running_s = device.until("Running");
        // To the end of the motion, and not as after a lost link.
        let venting_s = device.until("Venting");
        assert!((1.1..2.0).contains(&(venting_s - running_s)), "vented after {} s", venting_s - running_s);
        pauses.join().unwrap()
    };
    let mut undisturbed = longest("", 0, &["run.mcap"]);
    let file = "cannot write results/run.mcap.partial: ";
    // A third of the log, which ends in the middle of the motion; in blocks of 512 bytes.
    let half = format!("ulimit -f {};", std::fs::metadata(desk.path("results/run.mcap")).unwrap().len() / 3 / 512);
    let words = [file, "File too large", "went on to its end", "softlimb recover"];
    let mut cut = longest(&half, 1, &words);
    for _ in 1..ATTEMPTS {
        if cut >= undisturbed + GAP {
            println!("pause of {cut:?}, undisturbed {undisturbed:?}");
            // Both anew: the computer may have been less busy then.
            undisturbed = longest("", 0, &["run.mcap"]);
            cut = longest(&half, 1, &words);
        }
    }
    let log = read(desk.path("results/run.mcap.partial")).unwrap();
    let last_s = log.samples.last().unwrap().time_s;
    assert!((0.1..1.1).contains(&last_s), "the log ends {last_s} s into the run");
    assert_eq!(desk.softlimb("recover results/run.mcap.partial -o saved.mcap").code, Some(3));
    assert!(read(desk.path("saved.mcap")).unwrap().samples.len() >= log.samples.len());
    println!("longest pause of the host: {undisturbed:?}, with a full disk {cut:?}");
    assert!(cut < undisturbed + GAP, "{cut:?}, undisturbed {undisturbed:?}");
    // From the first byte on.
    #[cfg(target_os = "linux")]
    {
        std::fs::remove_file(desk.path("results/run.mcap.partial")).unwrap();
        std::os::unix::fs::symlink("/dev/full", desk.path("results/run.mcap.partial")).unwrap();
        longest("", 1, &[file, "No space left on device", "no sample", "went on to its end"]);
    }
}

#[test]
fn device_is_recorded_without_a_scene() {
    let desk = desk("");
    let mut device = Program::start(&desk, "device serve scene.toml --tcp 127.0.0.1:0");
    let port = format!("--port {}", device.first_line());
    // A port that cannot be opened is an error before recording begins.
    let closed = desk.softlimb("record --port /dev/no-such-port -o none.mcap");
    assert!(closed.code == Some(1) && !closed.err.contains("recording"), "{}", closed.err);
    // Without a configuration it is silent.
    let host = Program::start(&desk, &format!("record {port} -o silent.mcap"));
    host.until("recording tcp:");
    thread::sleep(Duration::from_millis(500));
    assert_eq!(host.interrupt(), Some(3));
    assert_eq!(read(desk.path("silent.mcap")).unwrap().samples.len(), 0);
    desk.softlimb(&format!("run scene.toml --out results {port}")).done();
    let again = desk.softlimb("replay results/run.mcap").done().out;
    assert!(again.contains("without what depends on converter codes") && again.ends_with("no difference\n"), "{again}");
    let host = Program::start(&desk, &format!("record {port} -o board.mcap"));
    host.until("recording tcp:");
    thread::sleep(Duration::from_millis(700));
    assert_eq!(host.interrupt(), Some(0));
    let log = read(desk.path("board.mcap")).unwrap();
    assert_eq!((log.incomplete, log.info.simulated, log.info.modules.len()), (None, false, 1));
    let (count, [first_s, last_s]) =
        (log.samples.len(), [log.samples.first(), log.samples.last()].map(|sample| sample.unwrap().time_s));
    let expected = 1e3 * (last_s - first_s) + 1.0;
    assert!(count >= 300, "{count} samples");
    assert!((count as f64 / expected - 1.0).abs() < 0.01, "a sample each millisecond: {count} in place of {expected}");
    let info = desk.softlimb(&format!("device info {port} --json")).done().json();
    assert_eq!(info["firmware"], log.info.firmware_version.as_str());
    assert_eq!(info["config_hash"], format!("{:08x}", log.info.config_hash).as_str());
    let capture = read_capture(desk.path("board.mcap")).unwrap();
    assert_eq!(capture.bytes(Direction::ToDevice).count(), 0, "nothing is said while it records");
    let bytes: usize = capture.bytes(Direction::ToHost).map(|(_, bytes)| bytes.len()).sum();
    assert_eq!(bytes as u64, log.link.bytes_received);
    desk.softlimb("report board.mcap").done();
    desk.softlimb("export board.mcap --csv tables").done();
    assert_eq!(device.interrupt(), Some(0));
    desk.softlimb("record --port sim -o board.mcap").failed(2, &["sim", "device serve"]);
}
