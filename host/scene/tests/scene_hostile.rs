//! Files that are no scenes: each gives an answer of bounded size, and never a panic.

use std::fs::{self, File};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::scene_support::SCENE;
use softlimb_scene::{SceneError, Unreadable, load, parse};

fn file(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    path
}

/// The diagnostic with the temporary folder cut out.
fn picture(path: &Path) -> String {
    let folder = path.parent().unwrap().display().to_string() + "/";
    load(path).unwrap_err().render(false).replace(&folder, "")
}

#[test]
fn missing_file() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(
        picture(&folder.path().join("nope.toml")),
        "error: cannot read `nope.toml`: there is no such file\n |\n = help: check the spelling and the current directory"
    );
}

#[test]
fn directory_instead_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scenes");
    fs::create_dir(&path).unwrap();
    assert_eq!(
        picture(&path),
        "error: cannot read `scenes`: it is a directory\n |\n = help: give a scene file inside it, such as scene.toml"
    );
}

#[test]
fn empty_file() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("empty.toml", ""), ("blank.toml", " \n\n"), ("comment.toml", "# nothing yet\n")] {
        assert_eq!(
            picture(&file(folder.path(), name, text.as_bytes())),
            format!("error: the scene is empty\n--> {name}\n = help: start from one of the files in scenes/")
        );
    }
}

#[test]
fn not_utf8() {
    let folder = tempfile::tempdir().unwrap();
    // Latin-1: the degree sign is one byte, 0xB0, after 7 + 9 bytes.
    let path = file(folder.path(), "latin1.toml", b"a = 12\nangle = \"30\xb0\"\n");
    assert_eq!(
        picture(&path),
        "error: cannot read `latin1.toml`: it is not UTF-8 text at byte 18 (line 2)\n |\n = help: save the scene as UTF-8 text"
    );
}

#[test]
fn file_of_100_mb_is_refused_by_its_size() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("huge.toml");
    let mut huge = File::create(&path).unwrap();
    huge.seek(SeekFrom::Start(100_000_000)).unwrap();
    huge.write_all(b"\n").unwrap();
    drop(huge);
    assert_eq!(
        picture(&path),
        "error: cannot read `huge.toml`: it is too large\n |\n = help: a scene has at most 1024 KiB; is this a log or a mesh?"
    );
}

#[test]
#[cfg(unix)]
fn device_without_end_is_refused_too() {
    // Reading ends after a bounded number of bytes, or never.
    let error = load("/dev/zero").unwrap_err();
    assert!(matches!(error, SceneError::Unreadable { reason: Unreadable::TooLarge, .. }), "{error}");
}

#[test]
fn line_ends_and_byte_order_mark_do_not_matter() {
    let plain = parse(SCENE, "arm.toml").unwrap();
    for text in [SCENE.replace('\n', "\r\n"), format!("\u{feff}{SCENE}")] {
        let other = parse(&text, "arm.toml").unwrap();
        assert_eq!(other.limb(), plain.limb());
        assert_eq!(other.channels(), plain.channels());
        assert_ne!(other.source_hash(), plain.source_hash(), "the text is kept as it is");
    }
}

/// Neither outcome matters here, only that there is one and that it can be drawn.
fn answers(text: &str) -> bool {
    match parse(text, "x.toml") {
        Ok(_) => true,
        Err(error) => {
            assert!(error.render(true).contains("error"), "{text}");
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

#[test]
fn beginnings_and_gaps_of_a_scene_have_an_answer() {
    let mut wrong = 0;
    for at in 0..SCENE.len() {
        wrong += usize::from(!answers(&SCENE[..at]));
        wrong += usize::from(!answers(&format!("{}{}", &SCENE[..at], &SCENE[at + 1..])));
        wrong += usize::from(!answers(&format!("{}\u{1b}é{}", &SCENE[..at], &SCENE[at..])));
    }
    assert!(wrong > SCENE.len(), "{wrong} of {}", 3 * SCENE.len());
}

#[test]
fn values_replaced_by_any_type_have_an_answer() {
    let odd = [
        "-1",
        "0",
        "1e308",
        "-inf",
        "true",
        "\"\"",
        "\"x\"",
        "[]",
        "[1, 2, 3]",
        "{}",
        "{ a = {} }",
        "1979-05-27",
        "[{}]",
    ];
    for (i, line) in SCENE.lines().enumerate() {
        let Some((key, _)) = line.split_once(" = ") else { continue };
        for value in odd {
            let lines = SCENE
                .lines()
                .enumerate()
                .map(|(j, line)| if i == j { format!("{key} = {value}\n") } else { format!("{line}\n") });
            answers(&lines.collect::<String>());
        }
    }
}

#[test]
fn mebibyte_of_anything_has_a_short_answer() {
    let one = 1 << 20;
    let keys: String = (0..50_000).map(|i| format!("k{i} = {i}\n")).collect();
    let modules = "[[module]]\n".repeat(one / 11);
    for text in [
        "[".repeat(one),
        format!("a = {}", "[".repeat(one - 4)),
        "@#!\n".repeat(one / 4),
        "=".repeat(one),
        format!("{}é = 1", "a".repeat(one)),
        keys,
        format!("format = 1\nname = \"x\"\n{modules}"),
        format!("format = 1\nname = \"{}\"", "x".repeat(one)),
    ] {
        let error = parse(&text, "big.toml").unwrap_err();
        let picture = error.render(false);
        let (bytes, lines) = (picture.len(), picture.lines().count());
        assert!(bytes < 100_000 && lines < 200, "{bytes} bytes, {lines} lines for {}", &text[..20]);
    }
}
