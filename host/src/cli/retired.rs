//! Verbs and options of earlier versions: each is answered with its present form.

use std::ffi::OsString;

use super::Failure;

/// Verb, word on its line (none: the verb itself), and the present form.
const RETIRED: &[(&str, &str, &str)] = &[
    ("trials", "", "softlimb learn SCENE"),
    ("fem", "", "softlimb fea"),
    ("bench", "", "cargo xtask lab accuracy"),
    ("design", "--problem", "softlimb design actuators FILE.json"),
    ("payload", "--problem", "softlimb design bundle FILE.json"),
    ("payload", "--track", "softlimb payload track SCENE --loads 5,10"),
    ("payload", "--estimate", "softlimb payload estimate SCENE --data FILE.csv"),
    ("design", "SCENE", "softlimb design limb SCENE"),
    ("payload", "SCENE", "softlimb payload capacity SCENE"),
    ("calibrate", "--tension", "softlimb calibrate tension FILE.csv"),
    ("calibrate", "--creep", "softlimb calibrate creep FILE.csv --scene SCENE"),
    ("calibrate", "--data", "softlimb calibrate pressure FILE.csv --scene SCENE --fit WHAT"),
    ("calibrate", "--run", "softlimb calibrate run run.mcap --fit WHAT"),
    ("calibrate", "--section-m2", "--section \"6 mm2\""),
    ("learn", "--rehearsals", "--iterations"),
    ("payload", "--rehearsals", "--iterations"),
    ("fea", "--pressure-kpa", "--pressure 60kPa"),
    ("fea", "--layer-mm", "--layer 0.05mm"),
    ("fea", "--spacing-mm", "--spacing 3mm"),
    ("fea", "--timeout-s", "--timeout 60s"),
];

/// The failure of a command line of an earlier version.
pub(super) fn answer(words: &[OsString]) -> Option<Failure> {
    let words: Vec<_> = words.iter().skip(1).map(|word| word.to_string_lossy()).collect();
    let verb: &str = words.first()?;
    let has = |option: &str| match option {
        "SCENE" => words.get(1).is_some_and(|word| word.ends_with(".toml")),
        _ => words.iter().any(|word| word.split('=').next() == Some(option)),
    };
    let (of, option, now) = RETIRED.iter().find(|(of, option, _)| *of == verb && (option.is_empty() || has(option)))?;
    let before = [*of, *option].join(" ");
    Some(Failure::wrong_line(format!("`softlimb {}` is now `{now}`", before.trim_end())))
}
