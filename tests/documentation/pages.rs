//! Pages of the documentation, found by walking; their links and anchors.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Folders whose Markdown is no documentation: built files, and files of tools.
const SKIPPED: [&str; 3] = ["target", "out", "node_modules"];

/// All Markdown files below a folder, relative to it and in order.
pub(crate) fn markdown(root: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry")) {
            let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
            let is_folder = entry.file_type().expect("a type").is_dir();
            if is_folder && !name.starts_with('.') && !SKIPPED.contains(&name.as_str()) {
                folders.push(path);
            } else if !is_folder && name.ends_with(".md") {
                found.push(path.strip_prefix(root).expect("below the root").to_path_buf());
            }
        }
    }
    found.sort();
    found
}

/// The lines outside of fenced code.
fn prose(page: &str) -> impl Iterator<Item = &str> {
    let mut fenced = false;
    page.lines().filter(move |line| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    })
}

/// Targets of links and pictures, `[text](target)` and `src="target"`, outside of code.
pub(crate) fn links(page: &str) -> Vec<String> {
    let mut found = Vec::new();
    for line in prose(page) {
        // Text in backticks is code: every second piece.
        let line: String =
            line.split('`').enumerate().map(|(i, part)| if i % 2 == 0 { part } else { "code" }).collect();
        for (open, close) in [("](", ')'), ("src=\"", '"')] {
            let targets = line.split(open).skip(1).filter_map(|rest| rest.split_once(close));
            found.extend(targets.map(|(target, _)| target.to_owned()));
        }
    }
    found
}

/// Anchors of a page's headings, as forges and mdBook derive them.
pub(crate) fn anchors(page: &str) -> BTreeSet<String> {
    let headings = prose(page).filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    headings.map(anchor).collect()
}

fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    heading.to_lowercase().chars().filter(kept).map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// A path without `.` and `..`; `None` where it leaves the root.
pub(crate) fn normal(path: &Path) -> Option<PathBuf> {
    let mut normal = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir if !normal.pop() => return None,
            Component::ParentDir | Component::CurDir => (),
            other => normal.push(other),
        }
    }
    Some(normal)
}

/// What is wrong with a link of a page, if anything; paths are relative to the root of the repository.
pub(crate) fn broken(root: &Path, page: &Path, link: &str) -> Option<String> {
    if link.contains("://") || link.starts_with("mailto:") {
        return None;
    }
    let (file, anchor) = link.split_once('#').map_or((link, None), |(file, anchor)| (file, Some(anchor)));
    let target = if file.is_empty() { page.to_path_buf() } else { page.parent().expect("a folder").join(file) };
    let Some(target) = normal(&target).filter(|target| root.join(target).exists()) else {
        return Some(format!("{}: {link}: no such file", page.display()));
    };
    let anchor = anchor?;
    let text = fs::read_to_string(root.join(&target)).ok()?;
    let missing = !anchors(&text).contains(anchor);
    missing.then(|| format!("{}: {link}: no such heading", page.display()))
}

#[test]
fn links_and_anchors_are_found() {
    let page = "# A b: `c_d`, 1.2\n[x](y.md#z) ![p](q.svg) `[no](link)`\n```\n[no](code)\n# no heading\n```\n<img src=\"r.png\">\n";
    assert_eq!(links(page), ["y.md#z", "q.svg", "r.png"]);
    assert_eq!(anchors(page), BTreeSet::from(["a-b-c_d-12".to_owned()]));
    assert_eq!(normal(Path::new("docs/guide/../x.md")), Some(PathBuf::from("docs/x.md")));
    assert_eq!(normal(Path::new("../x.md")), None);
}

#[test]
fn broken_links_are_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("a.md"), "# One\n").expect("written");
    let check = |link| broken(folder.path(), Path::new("a.md"), link);
    for whole in ["a.md", "#one", "a.md#one", "https://example.org/#x"] {
        assert_eq!(check(whole), None);
    }
    for bad in ["b.md", "#two", "../a.md", "a.md#two"] {
        assert!(check(bad).is_some(), "{bad}");
    }
}
