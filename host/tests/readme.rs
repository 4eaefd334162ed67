//! The README shows what its first command prints. After a change that is meant to change it:
//! `UPDATE_README=1 cargo test -p softlimb readme`.

use softlimb_rig::report;
use softlimb_rig::run::{Mcu, RunOptions, run};
use softlimb_scene as scene;
use std::sync::atomic::AtomicBool;

fn repository(path: &str) -> String {
    format!("{}/../{path}", env!("CARGO_MANIFEST_DIR"))
}

/// Everything but the second line, which holds the time the run took.
fn timeless(table: &str) -> Vec<&str> {
    let lines = table.trim().lines().map(str::trim_end);
    lines.enumerate().filter(|(index, _)| *index != 1).map(|(_, line)| line).collect()
}

#[test]
fn table_of_the_readme_is_the_table_of_the_run() {
    let readme = std::fs::read_to_string(repository("README.md")).unwrap();
    let shown = readme.split("```text\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a block of output");
    let scene = scene::load(repository("scenes/pick-and-place-a.toml")).unwrap();
    let out = tempfile::tempdir().unwrap();
    let options = RunOptions { seed: scene.seed(), out: out.path().join("run"), mcu: Mcu::Here };
    let files = run(&scene, &options, &AtomicBool::new(false), |_| ()).unwrap();
    let table = report::summary(&files.run).table();
    if std::env::var_os("UPDATE_README").is_some() {
        std::fs::write(repository("README.md"), readme.replacen(shown, &format!("{}\n", table.trim()), 1)).unwrap();
        return;
    }
    assert_eq!(timeless(shown), timeless(&table), "see the head of this test");
}
