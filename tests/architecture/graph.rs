//! The modules of a package as a graph: its nodes are folders, its edges come from the paths in the source.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::source::product_code;
use crate::workspace::{read, root, rust_files};

/// Folders, each with the folders that its files name.
pub(crate) type Graph = BTreeMap<PathBuf, BTreeSet<PathBuf>>;

/// The graph of a source folder. A folder and the one it lies in are one room to each other: no edge.
pub(crate) fn graph(source: &Path) -> Graph {
    let mut graph = Graph::new();
    for file in rust_files(source) {
        let module = module(source, &file);
        let from = folder(source, &module);
        for path in paths(&product_code(&read(&file))) {
            let Some(target) = resolved(&module, &path) else { continue };
            let to = folder(source, &target);
            if !to.starts_with(&from) && !from.starts_with(&to) {
                graph.entry(from.clone()).or_default().insert(to);
            }
        }
    }
    graph
}

/// The graph of the rooms, which are the folders right below the source folder: an edge wherever some folder of one names one of the other.
pub(crate) fn rooms(graph: &Graph, source: &Path) -> Graph {
    let room = |folder: &Path| Some(PathBuf::from(folder.strip_prefix(source).ok()?.components().next()?.as_os_str()));
    let mut rooms = Graph::new();
    let edges = graph.iter().flat_map(|(from, targets)| targets.iter().map(move |to| (from, to)));
    for (from, to) in edges.filter_map(|(from, to)| Some((room(from)?, room(to)?))).filter(|(from, to)| from != to) {
        rooms.entry(from).or_default().insert(to);
    }
    rooms
}

/// A circle of the graph, as the folders along it; `None` where there is none.
pub(crate) fn circle(graph: &Graph) -> Option<Vec<PathBuf>> {
    let mut done = BTreeSet::new();
    graph.keys().find_map(|start| walk(graph, start, &mut Vec::new(), &mut done))
}

fn walk(graph: &Graph, at: &Path, way: &mut Vec<PathBuf>, done: &mut BTreeSet<PathBuf>) -> Option<Vec<PathBuf>> {
    if let Some(begin) = way.iter().position(|folder| folder == at) {
        return Some(way[begin..].to_vec());
    }
    if !done.insert(at.to_owned()) {
        return None;
    }
    way.push(at.to_owned());
    let found = graph.get(at).into_iter().flatten().find_map(|next| walk(graph, next, way, done));
    way.pop();
    found
}

/// The path of a file's module, from the root of its package.
fn module(source: &Path, file: &Path) -> Vec<String> {
    let inside = file.strip_prefix(source).expect("a file of the package").with_extension("");
    let mut module: Vec<String> = inside.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if module.last().is_some_and(|name| ["mod", "lib", "main"].contains(&name.as_str())) {
        module.pop();
    }
    module
}

/// The deepest folder that a module path leads into.
fn folder(source: &Path, module: &[String]) -> PathBuf {
    let mut folder = source.to_owned();
    for name in module {
        if !root().join(&folder).join(name).is_dir() {
            break;
        }
        folder.push(name);
    }
    folder
}

/// A path that begins with `crate`, `self` or `super`, from the root of the package; `None` for a path above it.
fn resolved(module: &[String], path: &[String]) -> Option<Vec<String>> {
    let mut at = if path[0] == "crate" { Vec::new() } else { module.to_vec() };
    for part in path {
        match part.as_str() {
            "crate" | "self" => {}
            "super" => drop(at.pop()?),
            name => at.push(name.to_owned()),
        }
    }
    Some(at)
}

/// Every path of the code that begins with `crate`, `self` or `super`; groups in braces are taken apart.
fn paths(code: &str) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    for head in ["crate::", "super::", "self::"] {
        for (at, _) in code.match_indices(head) {
            let before = code[..at].chars().next_back();
            if before.is_none_or(|c| !c.is_alphanumeric() && !matches!(c, '_' | ':' | '$')) {
                tree(&code[at..], &mut Vec::new(), &mut found);
            }
        }
    }
    found
}

/// Reads one path or group at the beginning of the code, behind `prefix`; the code behind it.
fn tree<'a>(code: &'a str, prefix: &mut Vec<String>, found: &mut Vec<Vec<String>>) -> &'a str {
    let depth = prefix.len();
    let mut rest = code.trim_start();
    loop {
        let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        if length == 0 {
            if let Some(mut inside) = rest.strip_prefix('{') {
                while !inside.trim_start().starts_with('}') {
                    let behind = tree(inside, prefix, found).trim_start();
                    let next = behind.strip_prefix(',').unwrap_or(behind);
                    if next.len() == inside.len() || next.is_empty() {
                        break;
                    }
                    inside = next;
                }
                rest = inside.trim_start().strip_prefix('}').unwrap_or("");
            }
            break;
        }
        prefix.push(rest[..length].to_owned());
        rest = &rest[length..];
        match rest.strip_prefix("::") {
            Some(more) => rest = more,
            None => {
                found.push(prefix.clone());
                break;
            }
        }
    }
    prefix.truncate(depth);
    // `as name` behind a path.
    let behind = rest.trim_start();
    match behind.strip_prefix("as ") {
        Some(name) => name.trim_start().trim_start_matches(|c: char| c.is_alphanumeric() || c == '_'),
        None => rest,
    }
}

#[test]
fn paths_are_taken_apart() {
    let words = |path: &[&str]| path.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
    let code = "use crate::a::{self, b::{C, D as E}, F};\nlet x = super::g::h(self::i);\nmy_crate::j();";
    let found = paths(code);
    for path in
        [&["crate", "a", "self"][..], &["crate", "a", "b", "C"], &["crate", "a", "b", "D"], &["crate", "a", "F"]]
    {
        assert!(found.contains(&words(path)), "{path:?} in {found:?}");
    }
    assert!(found.contains(&words(&["super", "g", "h"])) && found.contains(&words(&["self", "i"])));
    assert_eq!(found.len(), 6, "{found:?}");
    assert_eq!(resolved(&words(&["m", "n"]), &words(&["super", "g"])), Some(words(&["m", "g"])));
}

#[test]
fn circle_is_found() {
    let graph = |edges: &[(&str, &str)]| {
        let mut graph = Graph::new();
        for (from, to) in edges {
            graph.entry(from.into()).or_default().insert(to.into());
        }
        graph
    };
    assert_eq!(circle(&graph(&[("a", "b"), ("b", "c"), ("a", "c")])), None);
    // Folders without a circle in rooms with one.
    let folders = graph(&[("src/a", "src/b/c"), ("src/b", "src/a")]);
    assert!(circle(&folders).is_none() && circle(&rooms(&folders, Path::new("src"))).is_some());
    let found = circle(&graph(&[("a", "b"), ("b", "c"), ("c", "b")])).expect("a circle");
    assert_eq!(found, [PathBuf::from("b"), PathBuf::from("c")]);
}
