//! `softlimb fem` as its user meets it.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::fake::Fake;

struct Answer {
    code: Option<i32>,
    out: String,
    err: String,
}

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name)
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
    let line =
        format!("fem export {} --module shoulder --out decks --points 2", scene("pick-and-place-a.toml").display());
    let answer = softlimb(folder.path(), &line);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    for name in
        ["pick-and-place-a-shoulder.inp", "pick-and-place-a-shoulder-abaqus.inp", "pick-and-place-a-shoulder-model.inc"]
    {
        assert!(folder.path().join("decks").join(name).is_file(), "{name}: {}", answer.out);
        assert!(answer.out.contains(name));
    }
    assert!(answer.out.contains("nodes") && answer.out.contains("half the length"), "{}", answer.out);
}

#[test]
fn export_of_a_bundle_has_all_its_actuators() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene("pick-and-place-a.toml");
    let line = format!("fem export {} --module elbow --bundle --around 8 --along 20", scene.display());
    let answer = softlimb(folder.path(), &line);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    let text = std::fs::read_to_string(folder.path().join("out/fem/pick-and-place-a-elbow-bundle-model.inc")).unwrap();
    for set in ["LAYER_1", "LAYER_2", "LAYER_3", "PLATE", "LINE"] {
        assert!(text.contains(&format!("ELSET={set}")), "{set}");
    }
}

#[test]
fn wrong_wishes_are_failures_with_reasons_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene("single-bending.toml");
    for (options, words) in [
        ("--module tail", vec!["no module `tail`", "only"]),
        ("--radial 99", vec!["radial = 99", "1 to 12"]),
        ("--nodes-max 200", vec!["nodes of the mesh (estimate", "1 to 200"]),
        ("--pressure-kpa -5", vec!["pressure_pa", "rise from zero"]),
        ("--bulk-ratio 1e9", vec!["bulk_ratio", "100 to 10000"]),
    ] {
        let answer = softlimb(folder.path(), &format!("fem export {} {options}", scene.display()));
        assert!(matches!(answer.code, Some(1 | 2)), "{options}: {}", answer.err);
        let wrong_line = answer.code == Some(2);
        assert!(wrong_line || words.iter().all(|word| answer.err.contains(word)), "{options}: {}", answer.err);
        assert_eq!((answer.out.as_str(), std::fs::read_dir(folder.path()).unwrap().count()), ("", 0), "{options}");
    }
}

#[test]
fn run_without_calculix_says_what_to_install() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene("single-bending.toml");
    let answer = softlimb(folder.path(), &format!("fem run {} --ccx ./none", scene.display()));
    assert_eq!((answer.code, answer.out.as_str()), (Some(1), ""));
    assert!(answer.err.contains("apt-get install calculix-ccx"), "{}", answer.err);
}

#[test]
fn a_run_that_gives_nothing_fails_and_writes_no_file() {
    let fake = Fake::new("echo ' *ERROR: too many cutbacks'; echo '1 1 1U 9 0.1 0.1 0.1' > actuator.sta; exit 201");
    let scene = scene("single-bending.toml");
    let line = format!("fem run {} --ccx {} --tsv figures.tsv", scene.display(), fake.path("ccx").display());
    let folder = tempfile::tempdir().unwrap();
    let answer = softlimb(folder.path(), &line);
    assert_eq!((answer.code, answer.out.as_str()), (Some(1), ""), "{}", answer.err);
    assert!(answer.err.contains("error: "), "{}", answer.err);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "{}", answer.err);
}

#[test]
fn a_relative_path_to_the_program_is_meant_from_where_the_user_is() {
    let fake = Fake::new("echo ' *ERROR reading: it was started'; exit 201");
    let line = format!("fem run {} --ccx ./ccx", scene("single-bending.toml").display());
    let answer = softlimb(fake.folder.path(), &line);
    assert!(answer.err.contains("it was started"), "{}", answer.err);
}
