//! Which words belong to which room.

use std::path::Path;

use crate::source::{lines_with, product_code};

/// Words that only one room may use.
pub(crate) struct Rule {
    /// The words.
    words: &'static [&'static str],
    /// Folders the rule holds in; the whole workspace where there is none.
    within: &'static [&'static str],
    /// Modules and folders that own the words.
    owners: &'static [&'static str],
    /// Why, as whoever breaks the rule reads it.
    law: &'static str,
}

const NO_STD: &[&str] = &["fra-model/src", "protocol/src", "firmware/src"];
const CONSOLE: &[&str] = &["host/src/cli", "host/src/main", "xtask/src", "firmware/boards"];
const OUTPUT: &[&str] = &[
    "host/src/cli",
    "host/src/main",
    "xtask/src",
    "firmware/boards",
    "host/src/bench/callgrind",
    "host/src/fem/ccx",
    "firmware/sim/src/emulated/qemu",
];

pub(crate) const RULES: &[Rule] = &[
    Rule { words: &["toml"], within: &[], owners: &["host/src/scene"], law: "host::scene alone knows TOML" },
    Rule { words: &["mcap"], within: &[], owners: &["host/src/record"], law: "host::record alone knows MCAP" },
    Rule {
        words: &["clarabel"],
        within: &[],
        owners: &["host/src/payload"],
        law: "host::payload alone knows the conic solver",
    },
    Rule { words: &["serialport"], within: &[], owners: &["host/src/link"], law: "host::link alone knows ports" },
    Rule {
        words: &["clap", "indicatif"],
        within: &[],
        owners: &["host/src/cli"],
        law: "host::cli alone knows the command line and the terminal",
    },
    Rule {
        words: &["print!", "println!", "eprint!", "eprintln!", "dbg!", "process::exit"],
        within: &[],
        owners: CONSOLE,
        law: "host::cli alone prints and chooses exit codes, beside xtask and the images",
    },
    Rule {
        words: &["stdout"],
        within: &[],
        owners: OUTPUT,
        law: "host::cli alone prints, beside xtask and the images; host::bench, host::fem and the emulated devices read what others print",
    },
    Rule {
        words: &["Instant", "SystemTime"],
        within: &[],
        owners: &["host/src/cli", "host/src/run", "host/src/link"],
        law: "time is an argument: only host::cli, host::run and host::link read a clock",
    },
    Rule { words: &["std", "alloc"], within: NO_STD, owners: &[], law: "what runs on the MCU has no std and no heap" },
    Rule {
        words: &[".unwrap(", ".expect(", "panic!", "todo!", "unimplemented!", "unreachable!"],
        within: NO_STD,
        owners: &[],
        law: "what runs on the MCU does not panic",
    },
    Rule { words: &["f64"], within: &["firmware/src"], owners: &[], law: "the controller computes in f32" },
];

impl Rule {
    fn holds_in(&self, file: &Path) -> bool {
        let within = self.within.is_empty() || self.within.iter().any(|folder| file.starts_with(folder));
        // `host/src/run` owns both `host/src/run.rs` and `host/src/run/...`.
        let owned =
            self.owners.iter().any(|owner| file.starts_with(owner) || file.with_extension("") == Path::new(owner));
        within && !owned
    }
}

/// Every breach of a rule in one file, as `file:line: word: law`. Files of tests are exempt.
pub(crate) fn breaches(file: &Path, text: &str) -> Vec<String> {
    if file.file_stem().is_some_and(|name| name == "tests") {
        return Vec::new();
    }
    let code = product_code(text);
    let rules = RULES.iter().filter(|rule| rule.holds_in(file));
    let words = rules.flat_map(|rule| rule.words.iter().map(move |word| (rule.law, word)));
    let places = words.flat_map(|(law, word)| lines_with(&code, word).into_iter().map(move |line| (line, law, word)));
    places.map(|(line, law, word)| format!("{}:{line}: `{word}`: {law}", file.display())).collect()
}

#[test]
fn every_word_is_caught_outside_its_room_and_free_inside() {
    for rule in RULES {
        let abroad = rule.within.first().unwrap_or(&"host/src/design");
        for word in rule.words {
            let text = format!("// {word}\nuse {word};\n");
            let found = breaches(&Path::new(abroad).join("limb.rs"), &text);
            assert_eq!(found, [format!("{abroad}/limb.rs:2: `{word}`: {}", rule.law)]);
            for owner in rule.owners {
                assert_eq!(breaches(&Path::new(owner).join("part.rs"), &text), [""; 0], "{word} in {owner}");
                assert_eq!(breaches(&Path::new(owner).with_extension("rs"), &text), [""; 0], "{word} in {owner}.rs");
            }
        }
    }
}

#[test]
fn a_room_is_not_its_namesake() {
    let text = "use toml::Spanned;\n";
    assert_eq!(breaches(Path::new("host/src/scenery.rs"), text).len(), 1);
    assert_eq!(breaches(Path::new("host/src/scene/unit/tests.rs"), "println!()").len(), 0);
}
