//! The image asks the model everything: what no image calls is neither searched for double precision nor counted.

use std::fs;
use std::path::Path;

/// What only a host has a use for: vector registers, queries about actuators that come but once, a second winding, properties of
/// bends for statics and warnings, names and units of quantities.
const HOST_ONLY: [&str; 20] = [
    "in_series",
    "forward_many",
    "forward_prepared",
    "inverse_many",
    "atanh_series",
    "forward_once",
    "second_fiber",
    "with_second_fiber",
    "volume_by_bend",
    "shrinks_bends",
    "natural",
    "fits",
    "of",
    "at_rest",
    "name",
    "label",
    "si_unit",
    "display_unit",
    "display_scale",
    "display_decimals",
];

/// The text of all Rust files below a folder.
fn source(folder: &Path) -> String {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let paths = entries.map(|entry| entry.unwrap().path());
    paths.fold(String::new(), |text, path| {
        text + &match path.extension() {
            _ if path.is_dir() => source(&path),
            Some(extension) if extension == "rs" => fs::read_to_string(&path).unwrap(),
            _ => String::new(),
        }
    })
}

/// Names of the public functions, of those for the inside of the crate none.
fn public_functions(source: &str) -> Vec<&str> {
    let names = source.lines().filter_map(|line| {
        let line = line.trim_start();
        let declared = line.strip_prefix("pub fn ").or_else(|| line.strip_prefix("pub const fn "))?;
        declared.split(['(', '<']).next()
    });
    names.collect()
}

/// Whether a function is called by this name.
fn is_called(name: &str, source: &str) -> bool {
    let in_name = |c: char| c.is_alphanumeric() || c == '_';
    source.match_indices(&format!("{name}(")).any(|(at, _)| !source[..at].ends_with(in_name))
}

#[test]
fn every_public_function_of_the_model_is_in_the_image() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (model, image) = (source(&here.join("../../../fra-model/src")), source(&here.join("src")));
    let functions = public_functions(&model);
    assert!(functions.len() > 30, "only {} functions were found", functions.len());
    let unused = |name: &&str| !is_called(name, &image) && !HOST_ONLY.contains(name);
    let missing: Vec<_> = functions.into_iter().filter(unused).collect();
    assert!(missing.is_empty(), "put a query for each of these into `src/`: {missing:?}");
}

#[test]
fn function_that_is_not_called_is_noticed() {
    let functions = public_functions(
        "    pub fn blocked(&self) {}\npub(crate) fn block() {}\n// pub fn no() {}\npub fn a<T>(b: T) {}",
    );
    assert_eq!(functions, ["blocked", "a"]);
    assert!(
        is_called("blocked", "x.blocked(1)")
            && !is_called("blocked", "x.unblocked(1)")
            && !is_called("blocked", "blocked")
    );
}
