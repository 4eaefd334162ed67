//! README and first tutorial show what the first command prints. After a change that is meant to change it:
//! `UPDATE_README=1 cargo test -p softlimb readme`.

use std::process::Command;

fn repository(path: &str) -> String {
    format!("{}/../{path}", env!("CARGO_MANIFEST_DIR"))
}

/// Pages whose first block of text is the table.
const PAGES: [&str; 2] = ["README.md", "docs/tutorial/first-run.md"];

/// Everything but the second line, which holds the time the run took.
fn timeless(table: &str) -> Vec<&str> {
    let lines = table.trim().lines().map(str::trim_end);
    lines.enumerate().filter(|(index, _)| *index != 1).map(|(_, line)| line).collect()
}

#[test]
fn table_of_the_readme_is_the_table_of_the_run() {
    let out = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
    let output = command.arg("run").arg(repository("scenes/pick-and-place-a.toml")).current_dir(out.path()).output();
    let output = output.expect("the binary was built with the tests");
    assert!(matches!(output.status.code(), Some(0 | 3)), "{output:?}");
    let table = String::from_utf8(output.stdout).expect("UTF-8");
    for path in PAGES {
        let page = std::fs::read_to_string(repository(path)).unwrap();
        let shown =
            page.split("```text\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a block of output");
        if std::env::var_os("UPDATE_README").is_some() {
            std::fs::write(repository(path), page.replacen(shown, &format!("{}\n", table.trim()), 1)).unwrap();
        } else {
            assert_eq!(timeless(shown), timeless(&table), "{path}: see the head of this test");
        }
    }
}
