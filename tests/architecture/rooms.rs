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
/// Host crates that compute: time, files and the terminal are their callers'.
const PURE: &[&str] = &[
    "host/numerics/src",
    "host/chart/src",
    "host/fea/src/cross_section",
    "host/fea/src/axisymmetric",
    "host/limb/src",
    "host/design/src",
    "host/motion/src",
];

pub(crate) const RULES: &[Rule] = &[
    Rule {
        words: &["mcap"],
        within: &["host/rig/src"],
        owners: &["host/rig/src/record"],
        law: "rig::record alone knows MCAP",
    },
    Rule {
        words: &["clarabel"],
        within: &["host/limb/src"],
        owners: &["host/limb/src/payload"],
        law: "limb::payload alone knows the conic solver",
    },
    Rule {
        words: &["softlimb_scene", "softlimb_limb", "softlimb_motion"],
        within: &["host/rig/src/link", "host/rig/src/record", "host/rig/src/report"],
        owners: &[],
        law: "link, record and report know neither scenes nor limbs",
    },
    Rule {
        words: &["Scene"],
        within: &["host/design/src"],
        owners: &["host/design/src/from_scene"],
        law: "design::from_scene alone knows scenes; the searches take problems",
    },
    Rule {
        words: &["print!", "println!", "eprint!", "eprintln!", "dbg!", "process::exit"],
        within: &[],
        owners: &["host/src/cli", "host/src/main", "host/lab/src/main", "xtask/src", "firmware/boards"],
        law: "the command alone prints and chooses exit codes, beside xtask and the images",
    },
    Rule {
        words: &["stdout"],
        within: &[],
        owners: &[
            "host/src/cli",
            "host/src/main",
            "xtask/src",
            "firmware/boards",
            "host/lab/src/accuracy/callgrind",
            "host/lab/src/design/judge",
            "host/fea/src/solid/ccx",
            "firmware/sim/src/emulated/qemu",
        ],
        law: "the command alone prints, beside xtask and the images; three rooms read the output of other programs",
    },
    Rule {
        words: &["Instant", "SystemTime"],
        within: &[],
        owners: &[
            "host/src/cli",
            "host/lab/src",
            "host/rig/src/run",
            "host/rig/src/link",
            "host/console/src/server",
            "xtask/src/pool.rs",
        ],
        law: "time is an argument: only the command, the laboratory, the console's server, rig::run, rig::link and the pool of jobs read a clock",
    },
    Rule { words: &["std::fs"], within: PURE, owners: &[], law: "files are the caller's" },
    Rule {
        words: &["Actuator"],
        within: &["host/fea/src/cross_section", "host/fea/src/solid"],
        owners: &[],
        law: "finite elements judge the model: they take its parameters and none of its solvers",
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
        // `host/rig/src/run` owns both `host/rig/src/run.rs` and `host/rig/src/run/...`.
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
fn words_are_caught_outside_their_room_and_free_inside() {
    for rule in RULES {
        let abroad = rule.within.first().unwrap_or(&"firmware/plant/src");
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
fn room_is_not_its_namesake() {
    assert_eq!(breaches(Path::new("host/rig/src/records.rs"), "use mcap::Writer;\n").len(), 1);
    assert_eq!(breaches(Path::new("host/scene/src/unit/tests.rs"), "println!()").len(), 0);
}
