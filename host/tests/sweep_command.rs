//! `softlimb sweep` as its user meets it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde_json::Value;

use crate::samples::samples;

const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes");

fn run(folder: &Path, words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
    command.args(words).current_dir(folder).output().expect("the binary was built with the tests")
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A folder with the finger, shortened to one phase, and a study of it.
fn desk(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = fs::read_to_string(format!("{SCENES}/finger.toml")).expect("the scene");
    let (start, end) = (scene.find("[[phase]]\nname = \"half\"").unwrap(), scene.find("[limits]").unwrap());
    fs::write(folder.path().join("finger.toml"), format!("{}{}", &scene[..start], &scene[end..])).unwrap();
    fs::write(folder.path().join("study.toml"), study).unwrap();
    folder
}

const STUDY: &str = "format = 1
scenes = [\"finger.toml\"]
limbs = 2
points = 2

[[parameter]]
key = \"module.finger.length\"
values = [\"60 mm\", \"55 mm\"]

[[parameter]]
key = \"plant.supply.pressure\"
range = [\"50 kPa\", \"70 kPa\"]
";

fn rows(table: &str) -> Vec<Vec<&str>> {
    table.lines().skip(2).map(|line| line.split(',').collect()).collect()
}

#[test]
fn table_is_the_same_for_threads_shards_and_an_interrupted_sweep() {
    let desk = desk(STUDY);
    let path = |name: &str| desk.path().join(name);
    let read = |name: &str| fs::read_to_string(path(name)).expect("a table");
    let output = run(desk.path(), &["sweep", "study.toml", "--threads", "2"]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    let whole = read("study.csv");
    let rows = rows(&whole);
    assert_eq!(rows.len(), 8);
    for (index, row) in rows.iter().enumerate() {
        assert_eq!((row[0], row[1], row[4]), (&*index.to_string(), "finger.toml", ["1", "2"][index % 2]));
        assert_eq!((row[2], row.last()), (["60", "55"][index / 4], Some(&"ok")));
        assert!((50.0..70.0).contains(&row[3].parse::<f64>().unwrap()), "{row:?}");
    }
    // The limbs of one design differ by the plant alone.
    assert!(rows[0][..4].iter().skip(1).eq(rows[1][..4].iter().skip(1)) && rows[0][5] != rows[1][5]);

    let threads = run(desk.path(), &["sweep", "study.toml", "--threads", "1", "--out", "one.csv"]);
    assert!(threads.status.success() && read("one.csv") == whole, "{}", errors(&threads));

    // Cut off within a row: the rows before it stay, that one is run again.
    let cut = whole.find("\n5,").unwrap() + 9;
    fs::write(path("rest.csv.part"), &whole[..cut]).unwrap();
    let rest = run(desk.path(), &["sweep", "study.toml", "--out", "rest.csv"]);
    assert!(rest.status.success() && read("rest.csv") == whole, "{}", errors(&rest));
    assert!(!path("rest.csv.part").exists());

    for part in ["1/3", "2/3", "3/3"] {
        let name = format!("part-{}.csv", &part[..1]);
        let output = run(desk.path(), &["sweep", "study.toml", "--shard", part, "--out", &name]);
        assert!(output.status.success(), "{}", errors(&output));
    }
    let merge = |parts: &[&str]| {
        let words = [&["sweep", "study.toml", "--out", "all.csv", "--merge"][..], parts].concat();
        run(desk.path(), &words)
    };
    let gaps = merge(&["part-3.csv", "part-1.csv"]);
    assert!(gaps.status.code() == Some(1) && errors(&gaps).contains("2 of 8 rows are missing, the first is row 2"));
    assert!(merge(&["part-3.csv", "part-1.csv", "part-2.csv"]).status.success() && read("all.csv") == whole);
    fs::write(path("false.csv"), whole.replacen("\n7,finger.toml,55,", "\n7,finger.toml,56,", 1)).unwrap();
    let false_row = merge(&["study.csv", "false.csv"]);
    assert!(errors(&false_row).contains("false.csv has another row 7"), "{}", errors(&false_row));

    // Killed between the two files: the same command succeeds, and leaves one.
    fs::write(path("study.csv.part"), &whole[..cut]).unwrap();
    let again = run(desk.path(), &["sweep", "study.toml"]);
    assert!(again.status.success() && errors(&again).contains("study.csv is complete: 8 rows"), "{}", errors(&again));
    assert!(read("study.csv") == whole && !path("study.csv.part").exists());
    let scene = fs::read_to_string(path("finger.toml")).unwrap();
    fs::write(path("finger.toml"), format!("{scene}# another version\n")).unwrap();
    let other = run(desk.path(), &["sweep", "study.toml"]);
    assert!(errors(&other).contains("study.csv is not a table of this study"), "{}", errors(&other));
}

/// Kills a sweep at random times until it ends by itself; how often it was killed.
fn killed(folder: &Path, words: &[&str], longest: Duration, random: &mut ChaCha8Rng) -> u32 {
    for kills in 0.. {
        let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
        let command = command.args(words).current_dir(folder).stdout(Stdio::null()).stderr(Stdio::null());
        let mut sweep = command.spawn().expect("the binary was built with the tests");
        // A sweep that is killed ever later makes progress in the end.
        sleep(longest.mul_f64(f64::from(random.next_u32()) / 4_294_967_296.0 * (0.5 + 0.2 * f64::from(kills))));
        sweep.kill().expect("a child");
        let status = sweep.wait().expect("a child");
        if status.success() {
            return kills;
        }
        assert!(!cfg!(unix) || status.code().is_none(), "it failed by itself: {status}");
    }
    unreachable!("the loop has no end")
}

#[test]
fn sweep_killed_at_random_times_and_resumed_makes_the_same_table() {
    let desk = desk(STUDY);
    let read = |name: &str| fs::read_to_string(desk.path().join(name)).expect("a table");
    let started = Instant::now();
    assert!(run(desk.path(), &["sweep", "study.toml", "--threads", "2"]).status.success());
    let (longest, mut random) = (started.elapsed(), ChaCha8Rng::seed_from_u64(21));
    let (mut kills, mut round) = (0, 0);
    while kills < samples(10) {
        for shards in [1, 2, 7] {
            let parts: Vec<String> = (1..=shards).map(|part| format!("{round}-{part}-of-{shards}.csv")).collect();
            for (part, name) in (1..).zip(&parts) {
                let shard = format!("{part}/{shards}");
                let words = ["sweep", "study.toml", "--threads", "2", "--shard", &shard, "--out", name];
                kills += killed(desk.path(), &words, longest.div_f64(f64::from(shards)), &mut random);
            }
            let words = ["sweep", "study.toml", "--out", &format!("{round}-all-{shards}.csv"), "--merge"];
            let parts: Vec<&str> = parts.iter().map(String::as_str).collect();
            assert!(run(desk.path(), &[&words[..], &parts].concat()).status.success());
            assert_eq!(read(&format!("{round}-all-{shards}.csv")), read("study.csv"));
        }
        round += 1;
    }
    println!("{kills} kills");
}

/// The job script, with the environment of an array of three jobs.
#[cfg(unix)]
#[test]
fn jobs_of_a_slurm_array_make_the_parts() {
    let desk = desk(STUDY);
    assert!(run(desk.path(), &["sweep", "study.toml"]).status.success());
    let folder = Path::new(env!("CARGO_BIN_EXE_softlimb")).parent().expect("a folder of programs");
    let path = format!("{}:{}", folder.display(), std::env::var("PATH").expect("a path"));
    for job in ["1", "2", "3"] {
        let mut shell = Command::new("sh");
        shell.args([&format!("{SCENES}/studies/slurm.sh"), "study.toml"]).current_dir(desk.path());
        shell.envs([("SLURM_ARRAY_TASK_ID", job), ("SLURM_ARRAY_TASK_COUNT", "3"), ("SLURM_CPUS_PER_TASK", "2")]);
        assert!(shell.env("PATH", &path).status().expect("a shell").success());
    }
    let words = ["sweep", "study.toml", "--out", "all.csv", "--merge", "part-1.csv", "part-2.csv", "part-3.csv"];
    assert!(run(desk.path(), &words).status.success());
    let read = |name: &str| fs::read_to_string(desk.path().join(name)).expect("a table");
    assert_eq!(read("all.csv"), read("study.csv"));
}

/// The figures are those that `run` prints for the scene with the value and the seed.
#[test]
fn row_is_a_run_with_a_seed() {
    let desk =
        desk(&STUDY.replace("points = 2\n", "").replace("range = [\"50 kPa\", \"70 kPa\"]", "values = [\"55 kPa\"]"));
    assert!(run(desk.path(), &["sweep", "study.toml"]).status.success());
    let table = fs::read_to_string(desk.path().join("study.csv")).unwrap();
    let scene = fs::read_to_string(desk.path().join("finger.toml")).unwrap();
    let scene = scene.replace("length = \"60 mm\"", "length = \"55 mm\"").replace("\"60 kPa\"", "\"55 kPa\"");
    fs::write(desk.path().join("other.toml"), scene).unwrap();
    let output = run(desk.path(), &["run", "other.toml", "--seed", "2", "--json"]);
    let summary: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let output = run(desk.path(), &["check", "other.toml", "--json"]);
    let checked: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let headings: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
    let rows = rows(&table);
    let cell = |heading: &str| -> f64 {
        let column = headings.iter().position(|found| *found == heading).expect("a column");
        rows[3][column].parse().expect("a number")
    };
    let tip = &summary["tip"];
    for (heading, value) in [
        ("tip_at_holds_rms [m]", &tip["at_holds_m"]["rmse"]),
        ("tip_max [m]", &tip["error_m"]["max"]),
        ("tip_tracking_rms [m]", &tip["tracking_error_m"]["rmse"]),
        ("pressure_rms [Pa]", &summary["pressure"]["true_error_pa"]["rmse"]),
        ("duration [s]", &summary["schedule_s"]),
        ("duration [s]", &checked["duration_s"]),
    ] {
        let value = value.as_f64().expect("a figure");
        assert!((cell(heading) / value - 1.0).abs() < 1e-8, "{heading}: {} {value}", cell(heading));
    }
    let share = summary["peak_chamber_pa"][0].as_f64().unwrap() / summary["pressure_limit_pa"][0].as_f64().unwrap();
    assert!((cell("peak_pressure_share [1]") / share - 1.0).abs() < 1e-8);
}

/// The figures are those of `learn` for the scene with the value and the limb.
#[test]
fn row_of_a_study_of_learning_is_what_learn_prints() {
    let study = STUDY
        .replace("points = 2", "experiment = \"learn\"\niterations = 3\ntrials = 2\ncamera = \"0.1 mm\"")
        .replace("range = [\"50 kPa\", \"70 kPa\"]", "values = [\"60 kPa\"]");
    let desk = desk(&study);
    let output = run(desk.path(), &["sweep", "study.toml", "--threads", "2"]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    let table = fs::read_to_string(desk.path().join("study.csv")).unwrap();
    let words =
        ["learn", "finger.toml", "--iterations", "3", "--trials", "2", "--camera", "0.1 mm", "--limb", "2", "--json"];
    let learned: Value = serde_json::from_slice(&run(desk.path(), &words).stdout).expect("JSON");
    let headings: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
    let rows = rows(&table);
    assert_eq!((rows.len(), rows[1][2], rows[1][4], *rows[1].last().unwrap()), (4, "60", "2", "ok"));
    for (when, score) in [("before", &learned["by_model"]), ("after", &learned["learned"])] {
        for (heading, value) in [
            (format!("tip_at_targets_{when}_rms [m]"), &score["at_targets"]["rmse_m"]),
            (format!("tip_at_targets_{when}_max [m]"), &score["at_targets"]["max_m"]),
            (format!("tip_systematic_{when} [m]"), &score["systematic_m"]),
            (format!("tip_{when}_rms [m]"), &score["whole_way"]["rmse_m"]),
        ] {
            let column = headings.iter().position(|found| *found == heading).expect("a column");
            let (cell, value): (f64, f64) = (rows[1][column].parse().unwrap(), value.as_f64().unwrap());
            assert!((cell - value).abs() <= 1e-8 * value, "{heading}: {cell} {value}");
        }
    }
    let parts = ["1/2", "2/2"].map(|part| {
        let name = format!("part-{}.csv", &part[..1]);
        assert!(run(desk.path(), &["sweep", "study.toml", "--shard", part, "--out", &name]).status.success());
        name
    });
    let words = ["sweep", "study.toml", "--out", "all.csv", "--merge", &parts[0], &parts[1]];
    assert!(run(desk.path(), &words).status.success());
    assert_eq!(fs::read_to_string(desk.path().join("all.csv")).unwrap(), table);

    fs::write(desk.path().join("study.toml"), study.replace("experiment = \"learn\"\n", "")).unwrap();
    let refused = errors(&run(desk.path(), &["sweep", "study.toml"]));
    assert!(refused.contains("`iterations` has no meaning without learning"), "{refused}");
}

#[test]
fn designs_that_are_refused_are_rows_without_figures() {
    let bends = STUDY
        .replace("module.finger.length", "limits.pressure_max")
        .replace("[\"60 mm\", \"55 mm\"]", "[\"20 kPa\", \"2 kPa\"]");
    let desk = desk(
        &bends
            .replace("limbs = 2\npoints = 2", "")
            .replace("range = [\"50 kPa\", \"70 kPa\"]", "values = [\"60 kPa\"]"),
    );
    let output = run(desk.path(), &["sweep", "study.toml"]);
    assert_eq!(output.status.code(), Some(3), "{}", errors(&output));
    assert!(errors(&output).contains("1 of 2 rows have no result"), "{}", errors(&output));
    let table = fs::read_to_string(desk.path().join("study.csv")).unwrap();
    let refused = table.lines().nth(3).unwrap();
    assert!(
        refused.starts_with("1,finger.toml,2,60,1,,,,,,,,,,,")
            && refused.contains("finger.toml as varied by study.toml:"),
        "{refused}"
    );
}

#[test]
fn wrong_studies_are_told_at_their_line() {
    for (from, to, words) in [
        ("\"finger.toml\"", "\"finger.tml\"", "there is no such file"),
        ("module.finger.length", "module.fingr.length", "finger.toml has no value at `module.fingr.length`"),
        ("module.finger.length", "module.finger.lenght", "unknown key `lenght`"),
        ("\"55 mm\"]", "\"5.5 cm\"]", "a parameter has one unit: `mm` and `cm`"),
        ("\"50 kPa\", \"70 kPa\"", "\"70 kPa\", \"50 kPa\"", "the lower value first"),
        ("range = [\"50 kPa\", \"70 kPa\"]", "", "missing key `values`"),
        ("points = 2", "points = 70000", "a whole number from 1 to 65536"),
        ("[\"60 mm\", \"55 mm\"]", "[]", "`values` needs a value"),
        ("limbs", "limps", "did you mean `limbs`?"),
        ("\"60 mm\", ", "\"60 kPa\", ", "a parameter has one unit"),
        ("[\"60 mm\", \"55 mm\"]", "[\"6 m\"]", "must be from"),
    ] {
        let desk = desk(&STUDY.replacen(from, to, 1));
        let output = run(desk.path(), &["sweep", "study.toml"]);
        let told = errors(&output);
        assert!(output.status.code() == Some(1) && told.contains(words), "{to}: {told}");
        assert!(!desk.path().join("study.csv").exists() && !desk.path().join("study.csv.part").exists());
    }
    let desk = desk(STUDY);
    let wrong = run(desk.path(), &["sweep", "study.toml", "--shard", "5/4"]);
    assert!(wrong.status.code() == Some(2) && errors(&wrong).contains("1/4 to 4/4"), "{}", errors(&wrong));
}
