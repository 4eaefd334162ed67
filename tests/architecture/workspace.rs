//! The packages of the workspace as Cargo sees them.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// One package.
pub(crate) struct Package {
    pub(crate) name: String,
    /// Its folder, from the root of the workspace.
    pub(crate) folder: PathBuf,
    pub(crate) dependencies: Vec<Dependency>,
}

/// A direct dependency.
pub(crate) struct Dependency {
    pub(crate) name: String,
    /// Needed by tests and examples only.
    pub(crate) dev: bool,
    /// A package of this workspace.
    pub(crate) ours: bool,
}

/// The root of the workspace.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A file of the workspace as text.
pub(crate) fn read(file: impl AsRef<Path>) -> String {
    let path = root().join(file);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All packages, from `cargo metadata`.
pub(crate) fn packages() -> Vec<Package> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(root())
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    metadata["packages"].as_array().expect("packages").iter().map(package).collect()
}

fn package(value: &Value) -> Package {
    let manifest = Path::new(text(&value["manifest_path"]));
    let folder = manifest.parent().and_then(|folder| folder.strip_prefix(root()).ok()).expect("inside the workspace");
    let dependencies = value["dependencies"].as_array().expect("dependencies").iter().map(|dependency| Dependency {
        name: text(&dependency["name"]).to_owned(),
        dev: dependency["kind"] == "dev",
        ours: dependency["path"].is_string(),
    });
    Package { name: text(&value["name"]).to_owned(), folder: folder.to_owned(), dependencies: dependencies.collect() }
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a string")
}

/// Arrows between packages of the workspace in the product, tests and examples aside.
pub(crate) fn arrows(packages: &[Package]) -> BTreeSet<(&str, &str)> {
    let mut arrows = BTreeSet::new();
    for package in packages {
        let ours = package.dependencies.iter().filter(|dependency| dependency.ours && !dependency.dev);
        arrows.extend(ours.map(|dependency| (package.name.as_str(), dependency.name.as_str())));
    }
    arrows
}

/// All Rust files below a folder of the workspace, named from its root; none where there is no such folder.
pub(crate) fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(root().join(folder)) else { return Vec::new() };
    let mut files = Vec::new();
    for entry in entries.map(|entry| entry.expect("readable")) {
        let path = folder.join(entry.file_name());
        if entry.file_type().expect("readable").is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}
