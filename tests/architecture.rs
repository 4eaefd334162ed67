//! The shape of the workspace: who may depend on whom, and which words belong to one room only.
//!
//! `ARCHITECTURE.md` says why. A rule that has become wrong is changed here and there, together.

#[path = "architecture/dependencies.rs"]
mod dependencies;
#[path = "architecture/graph.rs"]
mod graph;
#[path = "architecture/rooms.rs"]
mod rooms;
#[path = "architecture/source.rs"]
mod source;
#[path = "architecture/words.rs"]
mod words;
#[path = "architecture/workspace.rs"]
mod workspace;

use std::collections::BTreeSet;
use std::path::PathBuf;

use workspace::{arrows, packages, read, rust_files};

/// Every arrow between our packages; the host's wing from its lowest floor upwards.
const ARROWS: &[(&str, &str)] = &[
    ("softlimb-files", "fra-model"),
    ("softlimb-scene", "fra-model"),
    ("softlimb-scene", "softlimb-files"),
    ("softlimb-fea", "fra-model"),
    ("softlimb-fea", "softlimb-files"),
    ("softlimb-fea", "softlimb-numerics"),
    ("softlimb-limb", "fra-model"),
    ("softlimb-limb", "softlimb-chart"),
    ("softlimb-limb", "softlimb-fea"),
    ("softlimb-limb", "softlimb-files"),
    ("softlimb-limb", "softlimb-numerics"),
    ("softlimb-limb", "softlimb-scene"),
    ("softlimb-design", "fra-model"),
    ("softlimb-design", "softlimb-chart"),
    ("softlimb-design", "softlimb-fea"),
    ("softlimb-design", "softlimb-files"),
    ("softlimb-design", "softlimb-limb"),
    ("softlimb-design", "softlimb-numerics"),
    ("softlimb-design", "softlimb-scene"),
    ("softlimb-motion", "fra-model"),
    ("softlimb-motion", "softlimb-fea"),
    ("softlimb-motion", "softlimb-limb"),
    ("softlimb-motion", "softlimb-numerics"),
    ("softlimb-motion", "softlimb-protocol"),
    ("softlimb-motion", "softlimb-scene"),
    ("softlimb-rig", "fra-model"),
    ("softlimb-rig", "softlimb-body"),
    ("softlimb-rig", "softlimb-chart"),
    ("softlimb-rig", "softlimb-fea"),
    ("softlimb-rig", "softlimb-files"),
    ("softlimb-rig", "softlimb-firmware"),
    ("softlimb-rig", "softlimb-limb"),
    ("softlimb-rig", "softlimb-motion"),
    ("softlimb-rig", "softlimb-numerics"),
    ("softlimb-rig", "softlimb-protocol"),
    ("softlimb-rig", "softlimb-scene"),
    ("softlimb-rig", "softlimb-sim"),
    ("softlimb", "fra-model"),
    ("softlimb", "softlimb-chart"),
    ("softlimb", "softlimb-console"),
    ("softlimb", "softlimb-design"),
    ("softlimb", "softlimb-fea"),
    ("softlimb", "softlimb-files"),
    ("softlimb", "softlimb-limb"),
    ("softlimb", "softlimb-motion"),
    ("softlimb", "softlimb-rig"),
    ("softlimb", "softlimb-scene"),
    ("softlimb-lab", "fra-model"),
    ("softlimb-lab", "softlimb"),
    ("softlimb-lab", "softlimb-chart"),
    ("softlimb-lab", "softlimb-design"),
    ("softlimb-lab", "softlimb-fea"),
    ("softlimb-lab", "softlimb-files"),
    ("softlimb-lab", "softlimb-limb"),
    ("softlimb-lab", "softlimb-motion"),
    ("softlimb-lab", "softlimb-numerics"),
    ("softlimb-lab", "softlimb-protocol"),
    ("softlimb-lab", "softlimb-rig"),
    ("softlimb-lab", "softlimb-scene"),
    ("softlimb-lab", "softlimb-sim"),
    ("softlimb-python", "fra-model"),
    ("softlimb-python", "softlimb"),
    ("softlimb-python", "softlimb-fea"),
    ("softlimb-python", "softlimb-limb"),
    ("softlimb-python", "softlimb-scene"),
    ("softlimb-fuzz", "softlimb-firmware"),
    ("softlimb-fuzz", "softlimb-protocol"),
    ("softlimb-fuzz", "softlimb-rig"),
    ("softlimb-firmware", "fra-model"),
    ("softlimb-firmware", "softlimb-protocol"),
    ("softlimb-image-mps2-an386", "fra-model"),
    ("softlimb-image-mps2-an386", "softlimb-firmware"),
    ("softlimb-image-mps2-an386", "softlimb-protocol"),
    ("softlimb-image-stm32f4", "softlimb-firmware"),
    ("softlimb-image-stm32f4", "softlimb-protocol"),
    ("softlimb-body", "softlimb-numerics"),
    ("softlimb-plant", "fra-model"),
    ("softlimb-sim", "softlimb-firmware"),
    ("softlimb-sim", "softlimb-image-stm32f4"),
    ("softlimb-sim", "softlimb-plant"),
    ("softlimb-sim", "softlimb-protocol"),
];

/// Foreign crates that only these packages may use in the product.
const ONLY: &[(&str, &[&str])] = &[
    ("toml", &["softlimb-scene"]),
    ("toml_edit", &["softlimb-scene"]),
    ("annotate-snippets", &["softlimb-scene"]),
    ("mcap", &["softlimb-rig"]),
    ("clarabel", &["softlimb-limb"]),
    ("clap", &["softlimb", "softlimb-lab"]),
    ("indicatif", &["softlimb", "softlimb-lab"]),
    ("tempfile", &["softlimb-fea", "softlimb-files"]),
    ("qd", &["softlimb-lab"]),
    ("pyo3", &["softlimb-python"]),
    ("numpy", &["softlimb-python"]),
];

/// The package that may write unsafe code, and where in it: registers and faults have no safe names.
const UNSAFE: (&str, &[&str]) = (
    "softlimb-image-stm32f4",
    &[
        "firmware/boards/stm32f4/src/hardware",
        "firmware/boards/stm32f4/src/bin/flash/fault.rs",
        "firmware/boards/stm32f4/src/bin/cosim/fault.rs",
    ],
);

/// Packages that use none of ours, their tests included.
const ALONE: &[&str] = &["fra-model", "softlimb-chart", "softlimb-numerics", "softlimb-protocol", "xtask"];

/// Packages that run on the MCU.
const NO_STD: &[&str] = &["fra-model", "softlimb-protocol", "softlimb-firmware", "softlimb-image-stm32f4"];

#[test]
fn packages_use_each_other_along_the_arrows_only() {
    let packages = packages();
    let (found, expected) = (arrows(&packages), ARROWS.iter().copied().collect::<BTreeSet<_>>());
    let new: Vec<_> = found.difference(&expected).collect();
    let gone: Vec<_> = expected.difference(&found).collect();
    assert!(new.is_empty(), "arrows that the floor plan does not have: {new:?}");
    assert!(gone.is_empty(), "arrows of the floor plan that no manifest has: {gone:?}");
    for package in packages.iter().filter(|package| ALONE.contains(&package.name.as_str())) {
        let ours: Vec<_> = package.dependencies.iter().filter(|used| used.ours).map(|used| &used.name).collect();
        assert!(ours.is_empty(), "{} stands alone, its tests included, but uses {ours:?}", package.name);
    }
}

#[test]
fn foreign_crates_stay_in_their_packages() {
    let packages = packages();
    for (name, owners) in ONLY {
        let uses =
            |package: &&workspace::Package| package.dependencies.iter().any(|used| used.name == *name && !used.dev);
        let users: Vec<_> = packages.iter().filter(uses).map(|package| package.name.as_str()).collect();
        let strangers: Vec<_> = users.iter().filter(|user| !owners.contains(user)).collect();
        assert!(strangers.is_empty(), "{name} is for {owners:?}, and {strangers:?} depend on it");
        assert!(!users.is_empty(), "nobody depends on {name}: drop the rule");
    }
}

#[test]
fn modules_form_no_circle() {
    let packages = packages();
    let sources = packages.iter().map(|package| package.folder.join("src"));
    let graphs: Vec<_> = sources.map(|source| (graph::graph(&source), source)).collect();
    assert!(graphs.iter().map(|(graph, _)| graph.len()).sum::<usize>() > 20, "the source was not read");
    let of = |(graph, source): &(graph::Graph, PathBuf)| {
        graph::circle(graph).or(graph::circle(&graph::rooms(graph, source)))
    };
    let circles: Vec<_> = graphs.iter().filter_map(of).collect();
    assert!(circles.is_empty(), "folders that need each other: {circles:?}");
}

#[test]
fn unsafe_code_stays_where_registers_are() {
    assert!(read("Cargo.toml").contains("[workspace.lints.rust]\nunsafe_code = \"forbid\"\n"));
    let (owner, places) = UNSAFE;
    for package in packages() {
        if package.name == owner {
            let manifest = read(package.folder.join("Cargo.toml"));
            assert!(manifest.contains("[lints.rust]\nunsafe_code = \"deny\"\n"), "{owner} denies unsafe code");
            let elsewhere = |file: &PathBuf| !places.iter().any(|place| file.starts_with(place));
            let files = rust_files(&package.folder).into_iter().filter(elsewhere);
            let allows: Vec<_> = files.filter(|file| read(file).contains("(unsafe_code")).collect();
            assert!(allows.is_empty(), "unsafe code outside {places:?}: {allows:?}");
            continue;
        }
        let manifest = package.folder.join("Cargo.toml");
        let inherits = read(&manifest).contains("[lints]\nworkspace = true\n");
        assert!(inherits, "{}: inherit the lints: `[lints]`, `workspace = true`", manifest.display());
    }
}

#[test]
fn packages_of_the_mcu_are_no_std() {
    let packages = packages();
    for name in NO_STD {
        let package = packages.iter().find(|package| package.name == *name).expect("a package of the workspace");
        let library = package.folder.join("src/lib.rs");
        let code = source::product_code(&read(&library));
        // With std in unit tests only, or nowhere.
        let declared = |line: &str| matches!(line, "#![no_std]" | "#![cfg_attr(not(test), no_std)]");
        assert!(code.lines().any(declared), "{}: `#![no_std]` is missing", library.display());
    }
}

#[test]
fn words_stay_in_their_rooms() {
    let files: Vec<_> = packages().iter().flat_map(|package| rust_files(&package.folder.join("src"))).collect();
    assert!(files.len() > 100, "only {} files were looked at", files.len());
    let breaches: Vec<_> = files.iter().flat_map(|file| rooms::breaches(file, &read(file))).collect();
    assert!(breaches.is_empty(), "words outside their room:\n{}", breaches.join("\n"));
}

#[test]
fn dependencies_are_explained_and_explanations_needed() {
    let documented =
        dependencies::documented(&read("docs/reference/dependencies.md")).expect("docs/reference/dependencies.md");
    let declared = dependencies::declared(&packages());
    let missing: Vec<_> = declared.difference(&documented).collect();
    let stale: Vec<_> = documented.difference(&declared).collect();
    assert!(missing.is_empty(), "docs/reference/dependencies.md lacks (crate, package, only its tests): {missing:?}");
    assert!(
        stale.is_empty(),
        "docs/reference/dependencies.md lists (crate, package, only its tests) in vain: {stale:?}"
    );
}
