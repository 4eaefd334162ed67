//! Pictures of the commands and of the evidence in a browser: `browser/pictures.py` looks at their texts.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::cli::console::driver::{browser, script};
use crate::cli::desk::Desk;

/// Commands that draw, with the files that they draw; `~` is a space in a word.
const DRAWN: [(&str, &[&str]); 8] = [
    (
        "payload capacity scenes/pick-and-place-a.toml --svg OUT/push.svg --polar OUT/loads.svg",
        &["push.svg", "loads.svg"],
    ),
    ("workspace scenes/pick-and-place-a.toml --samples 20000 --svg OUT/workspace.svg", &["workspace.svg"]),
    ("workspace scenes/pick-and-place-a.toml --loaded --samples 300 --svg OUT/loaded.svg", &["loaded.svg"]),
    ("tolerance scenes/pick-and-place-a.toml --svg OUT/tolerance.svg", &["tolerance.svg"]),
    ("materials Dragon~Skin~30 --svg OUT/elastomer.svg", &["elastomer.svg"]),
    ("run scenes/reach-past-post.toml --out OUT/run", &[]),
    ("report OUT/run/run.mcap --static --out OUT/static.html --motion OUT/motion.svg", &["static.html", "motion.svg"]),
    ("fabricate scenes/finger.toml --no-mold --out OUT/workshop", &["workshop/sheet.html"]),
];

#[test]
fn pictures_are_legible_in_a_browser() {
    let Some(browser) = browser("pictures in a browser") else { return };
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let desk = Desk::new();
    let out = desk.path("");
    let mut files: Vec<PathBuf> = Vec::new();
    for (line, drawn) in DRAWN {
        let words = line.split(' ').map(|word| word.replace('~', " ").replace("OUT", out.to_str().unwrap()));
        let output =
            Command::new(env!("CARGO_BIN_EXE_softlimb")).args(words).current_dir(&repository).output().unwrap();
        assert!(matches!(output.status.code(), Some(0 | 3)), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        files.extend(drawn.iter().map(|file| desk.path(file)));
    }
    let evidence = std::fs::read_dir(repository.join("docs/evidence")).unwrap().map(|entry| entry.unwrap().path());
    files.extend(evidence.filter(|file| file.extension().is_some_and(|name| name == "svg")));
    let output = script("pictures.py", browser).args(&files).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
}
