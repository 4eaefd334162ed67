//! `softlimb fea` as its user meets it.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, SystemTime};

use crate::fake::{Fake, is_running};

struct Answer {
    code: Option<i32>,
    out: String,
    err: String,
}

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name)
}

/// The program with its temporary files in a folder of the test's.
fn softlimb_in(temporary: &Path, folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
    command.args(line.split_whitespace()).current_dir(folder).env("TMPDIR", temporary);
    command
}

fn softlimb(folder: &Path, line: &str) -> Answer {
    let output = Command::new(env!("CARGO_BIN_EXE_softlimb"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .output()
        .expect("the binary was built with the tests");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    Answer { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
}

#[test]
fn export_writes_a_deck_for_both_programs() {
    let folder = tempfile::tempdir().unwrap();
    let line = format!("fea export {} --module shoulder --out decks --points 2", scene("weightless-a.toml").display());
    let answer = softlimb(folder.path(), &line);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    for name in ["weightless-a-shoulder.inp", "weightless-a-shoulder-abaqus.inp", "weightless-a-shoulder-model.inc"] {
        assert!(folder.path().join("decks").join(name).is_file(), "{name}: {}", answer.out);
        assert!(answer.out.contains(name));
    }
    assert!(answer.out.contains("nodes") && answer.out.contains("half the length"), "{}", answer.out);
}

#[test]
fn export_of_a_bundle_has_all_its_actuators() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene("weightless-a.toml");
    let line = format!("fea export {} --module elbow --bundle --around 8 --along 20", scene.display());
    let answer = softlimb(folder.path(), &line);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let text = std::fs::read_to_string(folder.path().join("out/fea/weightless-a-elbow-bundle-model.inc")).unwrap();
    for set in ["LAYER_1", "LAYER_2", "LAYER_3", "PLATE", "LINE"] {
        assert!(text.contains(&format!("ELSET={set}")), "{set}");
    }
}

#[test]
fn wrong_wishes_are_failures_with_reasons_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene("single-bending.toml");
    for (options, code, words) in [
        // Wrong whatever the scene.
        ("--radial 99", 2, vec!["--radial", "1..=12"]),
        ("--around 13", 2, vec!["--around", "13 is not an even number of 8 to 96"]),
        ("--along 900", 2, vec!["--along", "900 is not an even number of 4 to 800"]),
        ("--nodes-max 20", 2, vec!["--nodes-max", "100..=400000"]),
        ("--pressure -5", 2, vec!["'-5' for '--pressure <KPA>'", "the range is > 0 kPa, at most 100000 kPa"]),
        ("--pressure -0.1bar", 2, vec!["'-0.1bar' for '--pressure <KPA>'", "the range is > 0 bar, at most 1000 bar"]),
        ("--bulk-ratio 1e9", 2, vec!["'1e9' for '--bulk-ratio <RATIO>'", "the range is 100 to 10000"]),
        ("--increment NaN", 2, vec!["--increment", "starts with a finite number"]),
        ("--increment 0.6", 2, vec!["'0.6' for '--increment <SHARE>'", "the range is 0.001 to 0.5"]),
        ("--layer 0", 2, vec!["'0' for '--layer <MM>'", "the range is > 0 mm"]),
        ("--spacing x", 2, vec!["--spacing", "a length starts with a finite number"]),
        ("--layer 0.1 --spacing 2", 2, vec!["--layer is for smeared fibers", "with --spacing"]),
        ("--fibers smeared --spacing 2", 2, vec!["--spacing is for threads", "with --fibers smeared"]),
        ("--fibers threads --layer 0.1", 2, vec!["--layer is for smeared fibers", "with --fibers threads"]),
        // Wrong for this one.
        ("--module tail", 1, vec!["no module `tail`", "only"]),
        ("--nodes-max 200", 1, vec!["about", "nodes, and --nodes-max allows 200", "--radial, --around and --along"]),
        ("--layer 99.3", 1, vec!["--layer 99.3 is not allowed", " mm, a thousandth to one half of the wall"]),
        ("--spacing 999.7", 1, vec!["--spacing 999.7 is not allowed", " mm"]),
    ] {
        let answer = softlimb(folder.path(), &format!("fea export {} {options}", scene.display()));
        assert_eq!(answer.code, Some(code), "{options}: {}", answer.err);
        assert!(words.iter().all(|word| answer.err.contains(word)), "{options}: {}", answer.err);
        assert_eq!((answer.out.as_str(), std::fs::read_dir(folder.path()).unwrap().count()), ("", 0), "{options}");
    }
}

#[test]
fn run_without_calculix_says_what_to_install() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene("single-bending.toml");
    let answer = softlimb(folder.path(), &format!("fea run {} --ccx ./none", scene.display()));
    assert_eq!((answer.code, answer.out.as_str()), (Some(1), ""));
    assert!(answer.err.contains("apt-get install calculix-ccx"), "{}", answer.err);
}

#[test]
fn run_that_gives_nothing_fails_and_writes_no_file() {
    let fake = Fake::new("echo ' *ERROR: too many cutbacks'; echo '1 1 1U 9 0.1 0.1 0.1' > actuator.sta; exit 201");
    let scene = scene("single-bending.toml");
    let line = format!("fea run {} --ccx {} --tsv figures.tsv", scene.display(), fake.path("ccx").display());
    let folder = tempfile::tempdir().unwrap();
    let answer = softlimb(folder.path(), &line);
    assert_eq!((answer.code, answer.out.as_str()), (Some(1), ""), "{}", answer.err);
    assert!(answer.err.contains("error: "), "{}", answer.err);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "{}", answer.err);
}

/// A script that leaves the gauges of the deck that it is given as they are, at one time, and then goes on.
fn at_rest(time: &str, then: &str) -> Fake {
    Fake::new(&format!(
        "awk -v RS='*' '/^NSET, NSET=GAUGES/ {{ gsub(/[^0-9]+/, \" \"); n = split($0, node, \" \");
           print \"\\n displacements (vx,vy,vz) for set GAUGES and time  {time}\\n\";
           for (i = 1; i <= n; i++) print node[i], \"0.0E+00 0.0E+00 0.0E+00\" }}' actuator-model.inc > actuator.dat
         {then}"
    ))
}

/// What took minutes is shown before a file is tried.
#[test]
fn figures_are_shown_even_if_their_file_cannot_be_written() {
    let fake = at_rest("0.1000000E+01", "exit 0");
    let line = format!(
        "fea run {} --pressure 10kPa --points 1 --tsv none/figures.tsv --ccx {}",
        scene("single-bending.toml").display(),
        fake.path("ccx").display()
    );
    let answer = softlimb(fake.folder.path(), &line);
    assert_eq!(answer.code, Some(1), "{}", answer.err);
    assert!(answer.out.contains("10.000    1.00000"), "{}", answer.out);
    assert!(answer.err.contains("cannot write none/figures.tsv"), "{}", answer.err);
}

#[test]
fn run_that_ends_before_its_first_pressure_says_how_far_it_came_and_why() {
    let scene = scene("single-bending.toml");
    let options = "--fibers threads --spacing 4mm --around 8 --along 8";
    let fake = at_rest("0.9990000E+00", "echo ' *ERROR: too many cutbacks'; exit 201");
    let line = format!(
        "fea run {} {options} --pressure 10kPa --points 1 --ccx {}",
        scene.display(),
        fake.path("ccx").display()
    );
    let answer = softlimb(fake.folder.path(), &line);
    assert_eq!((answer.code, answer.out.as_str()), (Some(1), ""), "{}", answer.err);
    let error = answer.err.lines().find(|line| line.starts_with("error: ")).expect("an error");
    assert!(error.contains("ended at 9.990 kPa, before the first pressure asked for, 10.000 kPa"), "{error}");
    assert!(error.contains("no equilibrium") && !error.contains("no pressure was reached"), "{error}");
    // What is said of the mesh is no cause.
    assert!(!error.contains("threads"), "{error}");
}

/// A folder such as a run leaves behind: its lock, as old as told.
fn left_behind(parent: &Path, name: &str, age_s: u64) -> File {
    std::fs::create_dir(parent.join(name)).unwrap();
    let lock = File::create(parent.join(name).join("lock")).unwrap();
    lock.set_modified(SystemTime::now() - Duration::from_secs(age_s)).unwrap();
    lock
}

#[test]
fn run_removes_what_killed_ones_left() {
    let temporary = tempfile::tempdir().unwrap();
    let names = ["softlimb-fem-1-0", "softlimb-fem-1-1", "softlimb-fem-1-2", "another-1-3"];
    let locks: Vec<File> =
        names.iter().zip([3600, 3600, 0, 3600]).map(|(name, age)| left_behind(temporary.path(), name, age)).collect();
    // One is old and somebody works in it, one may not be locked yet, one is somebody else's.
    locks[1].lock().unwrap();
    let fake = Fake::new("exit 201");
    let line = format!("fea run {} --ccx {}", scene("single-bending.toml").display(), fake.path("ccx").display());
    let answer = softlimb_in(temporary.path(), fake.folder.path(), &line).output().unwrap();
    assert_eq!(answer.status.code(), Some(1));
    let left: Vec<bool> = names.iter().map(|name| temporary.path().join(name).is_dir()).collect();
    assert_eq!(left, [false, true, true, true]);
    assert_eq!(std::fs::read_dir(temporary.path()).unwrap().count(), 3);
}

#[test]
fn calculix_ends_with_the_run_that_is_killed() {
    let temporary = tempfile::tempdir().unwrap();
    // It writes its process number after the run has had time to start the guarding shell.
    let fake = Fake::new("sleep 1; echo $$ > \"$HERE/draft-id\"; mv \"$HERE/draft-id\" \"$HERE/id\"; exec sleep 600");
    let line = format!("fea run {} --ccx {}", scene("single-bending.toml").display(), fake.path("ccx").display());
    let mut run = softlimb_in(temporary.path(), fake.folder.path(), &line);
    let mut run = run.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let wait_for = |done: &dyn Fn() -> bool| (0..1200).any(|_| done() || (sleep(Duration::from_millis(50)), false).1);
    assert!(wait_for(&|| fake.path("id").is_file()), "it was not started");
    let id = std::fs::read_to_string(fake.path("id")).unwrap();
    assert!(is_running(&id));
    run.kill().unwrap();
    run.wait().unwrap();
    assert!(wait_for(&|| !is_running(&id)), "it still runs");
}

#[test]
fn relative_path_to_the_program_is_meant_from_where_the_user_is() {
    let fake = Fake::new("echo ' *ERROR reading: it was started'; exit 201");
    let line = format!("fea run {} --ccx ./ccx", scene("single-bending.toml").display());
    let answer = softlimb(fake.folder.path(), &line);
    assert!(answer.err.contains("it was started"), "{}", answer.err);
}
