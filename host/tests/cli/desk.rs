//! A folder of its own for each test, and the command run in it.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// The smallest scene that moves: one weightless bending actuator, one move of 1 s and a short rest.
pub(crate) const SCENE: &str = r#"format = 1
name = "small"
seed = 1

[materials.silicone]
law = "neo-hookean"
shear_modulus = "0.223 MPa"

[limb]
connector = { length = "15 mm", mass = "50 g" }

[[module]]
name = "finger"
motion = "bending"
actuators = 1
inner_radius = "10 mm"
outer_radius = "14 mm"
length = "240 mm"
material = "silicone"

[weight]
simulated = false

[[phase]]
name = "bend"
duration = "1 s"
hold = "0.2 s"
targets = { finger = { bend_angle = "30 deg" } }
"#;

/// An empty folder that goes away with the test.
pub(crate) struct Desk(TempDir);

impl Desk {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder for temporary files"))
    }

    /// A desk with [`SCENE`] on it, as `scene.toml`, after one replacement.
    pub(crate) fn with_scene(from: &str, to: &str) -> Self {
        assert!(SCENE.contains(from), "{from:?} is not in the scene");
        let desk = Self::new();
        desk.put("scene.toml", SCENE.replace(from, to));
        desk
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn put(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    /// Every file and folder, by its path on the desk, sorted.
    pub(crate) fn content(&self) -> Vec<String> {
        let mut found = Vec::new();
        collect(self.0.path(), self.0.path(), &mut found);
        found.sort();
        found
    }

    /// Runs `softlimb` with the words of a line, on this desk, with nothing to read.
    pub(crate) fn softlimb(&self, line: &str) -> Answer {
        self.softlimb_reading(line, b"")
    }

    /// Runs `softlimb` with the words of a line and something on its standard input.
    pub(crate) fn softlimb_reading(&self, line: &str, input: &[u8]) -> Answer {
        let mut child = Command::new(env!("CARGO_BIN_EXE_softlimb"))
            .args(words(line))
            .current_dir(self.0.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary was built with the tests");
        // A command that does not read its input closes it; that is its right.
        let _ = child.stdin.take().expect("is piped").write_all(input);
        let output = child.wait_with_output().unwrap();
        Answer {
            line: line.to_owned(),
            code: output.status.code(),
            out: String::from_utf8(output.stdout).expect("standard output is UTF-8"),
            err: String::from_utf8(output.stderr).expect("standard error is UTF-8"),
        }
    }
}

/// The words of a line; quotes keep blanks together.
pub(crate) fn words(line: &str) -> impl Iterator<Item = &str> {
    let is_quoted = |index: usize| index % 2 == 1;
    line.split('"').enumerate().flat_map(move |(index, part)| {
        let plain = if is_quoted(index) { "" } else { part };
        is_quoted(index).then_some(part).into_iter().chain(plain.split_whitespace())
    })
}

fn collect(root: &Path, folder: &Path, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        found.push(path.strip_prefix(root).unwrap().display().to_string());
        if path.is_dir() {
            collect(root, &path, found);
        }
    }
}

/// How the command ended.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) line: String,
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Answer {
    #[track_caller]
    pub(crate) fn done(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }

    /// Failed with one message on standard error, nothing on standard output, and every one of `words` in the message.
    #[track_caller]
    pub(crate) fn failed(self, code: i32, words: &[&str]) -> Self {
        assert_eq!(self.code, Some(code), "{self:?}");
        assert_eq!(self.out, "", "{}", self.line);
        assert!(self.err.starts_with("error: "), "{self:?}");
        assert_eq!(self.err.matches("error: ").count(), 1, "more than one message: {}", self.err);
        for trace in ["panicked", "RUST_BACKTRACE", "\u{1b}["] {
            assert!(!self.err.contains(trace), "{}", self.err);
        }
        for word in words {
            assert!(self.err.contains(word), "`{word}` is missing: {}", self.err);
        }
        self
    }

    /// The one JSON value that standard output holds.
    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}
