//! The programs that hold the tests, built once and named by Cargo's own account of the build.

use std::path::{Path, PathBuf};
use std::process::Stdio;

use crate::cargo::{Cargo, code, root};

/// Sources of the programs that take longest, in this order: a folder stands for all programs in it.
const LONGEST: [&str; 7] =
    ["host/fea/tests", "tests/emulated.rs", "host/rig/tests", "host/design/tests", "host", "tests", "fra-model"];

/// Files of a build of the tests.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Built {
    pub(crate) tests: Vec<Program>,
    /// The folder of the programs that tests run.
    pub(crate) programs: Option<PathBuf>,
}

/// A program that holds tests.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Program {
    /// The file it was compiled from, relative to the workspace: `host/tests/cli.rs`.
    pub(crate) source: String,
    /// The folder of its package, in which it runs.
    pub(crate) folder: PathBuf,
    pub(crate) file: PathBuf,
}

impl Program {
    /// Its place in the order of start: the longest first, so that none runs alone at the end.
    pub(crate) fn place(&self) -> usize {
        let source = Path::new(&self.source);
        LONGEST.iter().position(|prefix| source.starts_with(prefix)).unwrap_or(LONGEST.len())
    }
}

/// Builds all tests and runs none; the exit code where one does not build, which the compiler explains.
pub(crate) fn build() -> Result<Built, u8> {
    // The Python extension, which is no default member, has no tests in Rust.
    let arguments = ["test", "--tests", "--no-run", "--message-format=json-render-diagnostics"];
    let output = Cargo::announce(&arguments).output(Stdio::inherit())?;
    code(output.status)?;
    Ok(read(&String::from_utf8_lossy(&output.stdout), &root()))
}

/// Reads Cargo's messages, one JSON object a line.
fn read(messages: &str, root: &Path) -> Built {
    let mut built = Built::default();
    for line in messages.lines().filter(|line| line.starts_with(r#"{"reason":"compiler-artifact""#)) {
        let Some(file) = text(line, "executable").map(PathBuf::from) else { continue };
        let is_test = object(line, "profile").is_some_and(|profile| profile.contains(r#""test":true"#));
        let (Some(source), Some(manifest)) = (text(line, "src_path"), text(line, "manifest_path")) else { continue };
        if !is_test {
            built.programs = file.parent().map(Path::to_path_buf);
            continue;
        }
        let source = Path::new(&source);
        let source = source.strip_prefix(root).unwrap_or(source).to_string_lossy().replace('\\', "/");
        let manifest = PathBuf::from(manifest);
        let folder = manifest.parent().unwrap_or(root).to_path_buf();
        built.tests.push(Program { source, folder, file });
    }
    built
}

/// The text behind the first `"key":`, where there is one and it is text.
fn text(json: &str, key: &str) -> Option<String> {
    let mut letters = value(json, key)?.strip_prefix('"')?.chars();
    let mut text = String::new();
    loop {
        match letters.next()? {
            '"' => return Some(text),
            // Paths hold no other escapes than of themselves.
            '\\' => text.push(letters.next()?),
            letter => text.push(letter),
        }
    }
}

/// The object behind the first `"key":`, which holds no other object.
fn object<'a>(json: &'a str, key: &str) -> Option<&'a str> {
    value(json, key)?.strip_prefix('{')?.split('}').next()
}

fn value<'a>(json: &'a str, key: &str) -> Option<&'a str> {
    let mark = format!("\"{key}\":");
    json.find(&mark).map(|at| &json[at + mark.len()..])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(folder: &str, target: &str, is_test: bool, executable: &str) -> String {
        format!(
            r#"{{"reason":"compiler-artifact","package_id":"path+file:///w#0.1.0","manifest_path":"/w/{folder}Cargo.toml","target":{{"kind":["bin"],"crate_types":["bin"],"name":"x","src_path":"/w/{folder}{target}","edition":"2024","doc":false,"doctest":false,"test":true}},"profile":{{"opt_level":"2","debuginfo":"line-tables-only","debug_assertions":true,"overflow_checks":true,"test":{is_test}}},"features":[],"filenames":["/w/t/x"],"executable":{executable},"fresh":false}}"#
        )
    }

    fn program(source: &str) -> Program {
        Program { source: source.to_owned(), folder: PathBuf::new(), file: PathBuf::new() }
    }

    #[test]
    fn programs_with_tests_are_told_from_others_and_from_libraries() {
        let messages = [
            message("host/", "tests/cli.rs", true, r#""/w/target/debug/deps/cli-1""#),
            message("host/", "src/main.rs", false, r#""/w/target/de\"bug/softlimb""#),
            message("host/", "src/lib.rs", false, "null"),
            r#"{"reason":"build-finished","success":true}"#.to_owned(),
            message("", "tests/replay.rs", true, r#""/w/target/debug/deps/replay-2""#),
            "not JSON".to_owned(),
        ]
        .join("\n");
        let built = read(&messages, Path::new("/w"));
        let found: Vec<_> = built.tests.iter().map(|test| (test.source.as_str(), test.folder.as_path())).collect();
        assert_eq!(found, [("host/tests/cli.rs", Path::new("/w/host")), ("tests/replay.rs", Path::new("/w"))]);
        assert_eq!(built.tests[1].file, Path::new("/w/target/debug/deps/replay-2"));
        assert_eq!(built.programs.as_deref(), Some(Path::new(r#"/w/target/de"bug"#)));
    }

    #[test]
    fn values_are_read_up_to_their_end_and_none_else() {
        let json = r#"{"a":"C:\\x","b":null,"c":{"d":"e"},"f":"cut"#;
        assert_eq!(text(json, "a").as_deref(), Some(r"C:\x"));
        assert_eq!((text(json, "b"), text(json, "c"), text(json, "f"), text(json, "g")), (None, None, None, None));
        assert_eq!(object(json, "c"), Some(r#""d":"e""#));
        assert_eq!(object(json, "a"), None);
    }

    #[test]
    fn the_longest_programs_exist_and_start_first() {
        for source in LONGEST {
            assert!(root().join(source).exists(), "{source} is gone: which programs take longest now?");
        }
        let places = LONGEST.map(|source| program(&format!("{source}/x.rs")).place());
        assert!(places.is_sorted() && places[0] == 0, "{places:?}");
        assert_eq!(program("xtask/src/main.rs").place(), LONGEST.len());
        assert!(program("host/tests/cli.rs").place() < program("tests/replay.rs").place());
    }
}
