//! How runs are judged that go well, badly, or nowhere. Scripts stand for CalculiX.

use std::fs;

use softlimb_fea::solid::{End, FemError, Options, PointStatus, Run, Runner};

use crate::fem::fake::{Fake, dat, dat_for, good, is_running};

const COPY: &str = "cp \"$HERE/out.dat\" actuator.dat; cp \"$HERE/out.sta\" actuator.sta 2> /dev/null || true";

fn statuses(run: &Run) -> Vec<&'static str> {
    run.points.iter().map(|point| point.status.word()).collect()
}

fn message(fake: &Fake) -> String {
    fake.run().expect_err("no result").to_string()
}

#[test]
fn run_that_goes_well_is_reduced_to_its_strains() {
    let sta = "  STEP INC ATT ITRS TIME\n  1 1 1 4 0.5 0.5 0.5\n  1 2 1 3 1.0 1.0 0.5\n  2 1 1 5 2.0 1.0 1.0\n";
    let run = Fake::new(COPY).with("out.dat", good(&[0.5, 1.0, 2.0])).with("out.sta", sta).run().unwrap();
    assert_eq!((run.end.clone(), run.increments, run.iterations), (End::Finished, 3, 12));
    assert_eq!(statuses(&run), ["converged", "converged"]);
    for (point, time) in run.points.iter().zip([1.0, 2.0]) {
        let (middle, ends) = (point.middle.unwrap(), point.ends.unwrap());
        // Six digits are printed.
        assert!((middle.axial_stretch - (1.0 + 0.1 * time)).abs() < 1e-6, "{middle:?}");
        assert!((middle.outer_radius_m / (8e-3 * (1.0 + 0.05 * time)) - 1.0).abs() < 1e-6, "{middle:?}");
        assert!((middle.inner_radius_m / (6e-3 * (1.0 + 0.05 * time)) - 1.0).abs() < 1e-6, "{middle:?}");
        assert!(middle.bend_rate_rad_per_m.abs() < 1e-6 && middle.twist_rate_rad_per_m.abs() < 1e-3);
        assert!((ends.axial_stretch - middle.axial_stretch).abs() < 1e-6, "{ends:?}");
    }
    assert!(run.tsv().lines().count() == 3 && run.table().contains("1.20000"), "{}", run.table());
}

#[test]
fn program_that_is_not_there_is_named_with_its_package() {
    let fake = Fake::new("");
    fs::remove_file(fake.path("ccx")).unwrap();
    let text = message(&fake);
    assert!(text.contains("CalculiX is not installed") && text.contains("apt-get install calculix-ccx"), "{text}");
}

#[test]
fn program_that_cannot_be_started_says_why() {
    let fake = Fake::new("").with("ccx", "no program");
    assert!(matches!(fake.run(), Err(FemError::Program { .. })));
}

#[test]
fn exit_201_keeps_what_converged_and_no_more() {
    let body = format!("{COPY}; echo ' *ERROR: increment size smaller than minimum'; exit 201");
    let run = Fake::new(&body).with("out.dat", good(&[0.5, 1.0, 1.25])).run().unwrap();
    let End::Diverged { diagnosis, overstretched: false } = &run.end else { panic!("{:?}", run.end) };
    assert!(diagnosis.contains("limit point"), "{diagnosis}");
    assert_eq!(statuses(&run), ["converged", "not_reached"]);
    // A quarter of the way from 20 to 30 kPa.
    assert_eq!(run.points[1].status, PointStatus::NotReached { reached_pa: 22.5e3 });
    assert!(run.points[1].middle.is_none() && run.points[1].ends.is_none());
    assert!(run.table().contains("ended at 22.500 kPa"), "{}", run.table());
}

#[test]
fn exit_201_before_the_first_increment_is_a_failure() {
    let text = message(&Fake::new("echo ' *ERROR reading *SOLID SECTION: no such set'; exit 201"));
    assert!(text.contains("201") && text.contains("no such set"), "{text}");
}

#[test]
fn results_of_a_killed_run_are_not_used() {
    let fake = Fake::new(&format!("{COPY}; kill -9 $$")).with("out.dat", good(&[1.0, 2.0]));
    let text = message(&fake);
    assert!(text.contains("killed by signal 9") && text.contains("memory"), "{text}");
}

#[test]
fn run_that_takes_too_long_is_ended_and_what_converged_stands() {
    let whole = good(&[1.0, 1.5]);
    for out in [whole.clone(), whole[..whole.len() - 30].to_owned()] {
        let body = "cp \"$HERE/out.dat\" actuator.dat; echo $$ > \"$HERE/id\"; : > \"$HERE/go\"; exec sleep 600";
        let fake = Fake::new(body).with("out.dat", out);
        // The clock of these tests advances ten seconds at each look; the run is looked at twenty times a second.
        let run = fake.run_with(Runner { timeout_s: 400.0, ..Runner::default() }).unwrap();
        assert_eq!((run.end.clone(), statuses(&run)), (End::TimedOut, vec!["converged", "not_reached"]));
        assert!(!is_running(&fs::read_to_string(fake.path("id")).unwrap()), "it still runs");
    }
}

#[test]
fn half_written_and_foreign_output_is_no_result() {
    let whole = good(&[1.0, 2.0]);
    for (out, words) in [
        (whole.as_bytes()[..whole.len() - 40].to_vec(), "ends in the middle of a block"),
        (good(&[1.0]).into_bytes(), "printed up to step 1.000 of 2"),
        (vec![0xff; 4096], "printed up to step 0.000 of 2"),
        ([whole.as_bytes(), b"\xff\xfe\x00 and so on\n"].concat(), "is no displacement"),
        (whole.replacen("E-", "E-O", 1).into_bytes(), "is no displacement"),
        (good(&[1.0, 1.5, 1.2, 2.0]).into_bytes(), "not after the one before"),
    ] {
        let fake = Fake::new(COPY).with("out.dat", &out);
        match fake.run() {
            Err(error @ FemError::Garbage { .. }) => {
                let text = error.to_string();
                assert!(text.contains(words), "{words}: {text}");
                assert!(text.contains(".dat file, line") && text.contains("nothing of this run is used"), "{text}");
            }
            other => panic!("{words}: {:?}", other.map(|run| statuses(&run))),
        }
    }
}

#[test]
fn missing_output_is_reported() {
    for fake in [Fake::new("exit 0"), Fake::new(COPY).with("out.dat", "")] {
        let text = message(&fake);
        assert!(text.contains("wrote no .dat file") && !text.contains("line"), "{text}");
    }
}

#[test]
fn full_disk_is_named_whatever_the_exit_code() {
    // /dev/full refuses every byte, as a full disk does.
    for end in ["exit 2", "exit 201", "exit 0"] {
        let body = format!("cat \"$HERE/out.dat\" > /dev/full; head -c 3000 \"$HERE/out.dat\" > actuator.dat; {end}");
        let text = message(&Fake::new(&body).with("out.dat", good(&[1.0, 2.0])));
        assert!(text.contains("the disk is full") && text.contains("TMPDIR"), "{end}: {text}");
    }
}

#[test]
fn results_of_an_earlier_run_are_not_used() {
    let kept = tempfile::tempdir().unwrap();
    fs::write(kept.path().join("actuator.dat"), good(&[1.0, 2.0])).unwrap();
    fs::write(kept.path().join("actuator.sta"), "1 1 1 4 2.0 1.0 1.0\n").unwrap();
    let runner = Runner { keep: Some(kept.path().to_owned()), ..Runner::default() };
    let run = Fake::new("exit 0").run_with(runner);
    assert!(matches!(run, Err(FemError::NoOutput)));
    assert!(kept.path().join("actuator.inp").is_file(), "the deck is kept");
}

#[test]
fn overstretched_fiber_is_tried_again_with_half_the_increment() {
    let body =
        "[ -f \"$HERE/again\" ] && cp actuator.inp \"$HERE/second.inp\" && cp \"$HERE/out.dat\" actuator.dat && exit 0
: > \"$HERE/again\"; cp actuator.inp \"$HERE/first.inp\"; echo '*ERROR: fiber extension is too large'; exit 201";
    let fake = Fake::new(body).with("out.dat", good(&[1.0, 2.0]));
    assert_eq!(statuses(&fake.run().unwrap()), ["converged", "converged"]);
    let largest = |file: &str| -> f64 {
        let text = fs::read_to_string(fake.path(file)).unwrap();
        let line = text.split_once("*STATIC\n").unwrap().1.lines().next().unwrap().to_owned();
        line.rsplit(',').next().unwrap().trim().parse().unwrap()
    };
    assert!((largest("second.inp") / largest("first.inp") - 0.5).abs() < 1e-9);
}

#[test]
fn jump_of_the_lumen_is_seen_and_what_follows_is_not_used() {
    let times = [0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0];
    let jumping = |t: f64| 1.0 + 0.1 * t + if t > 1.4 { 1.0 } else { 0.0 };
    let run = Fake::new(COPY).with("out.dat", dat(&times, jumping, |_| 1.0)).run().unwrap();
    assert_eq!(statuses(&run), ["converged", "beyond_jump"]);
    assert_eq!(run.points[1].status, PointStatus::BeyondJump { between_pa: [22.5e3, 25e3] });
    assert!(run.points[1].middle.is_none() && run.table().contains("limit point"), "{}", run.table());
    // Fast but even growth is none.
    let smooth = |t: f64| (0.5 * t).exp();
    let run = Fake::new(COPY).with("out.dat", dat(&times, smooth, |_| 1.0)).run().unwrap();
    assert_eq!(statuses(&run), ["converged", "converged"]);
}

#[test]
fn numbers_of_a_runner_are_checked() {
    let fake = Fake::new("");
    for (runner, words) in [
        (Runner { timeout_s: 0.0, ..Runner::default() }, "timeout_s = 0"),
        (Runner { timeout_s: f64::NAN, ..Runner::default() }, "timeout_s = NaN"),
        (Runner { threads: 0, ..Runner::default() }, "threads = 0"),
    ] {
        let text = fake.run_with(runner).unwrap_err().to_string();
        assert!(text.contains(words), "{text}");
    }
}

/// The numbers between the tags of a data array whose head has `name`.
fn array(text: &str, name: &str) -> Vec<f64> {
    let rest = text.split_once(name).unwrap_or_else(|| panic!("no {name}")).1;
    let body = rest.split_once('>').unwrap().1.split_once('<').unwrap().0;
    body.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

#[test]
fn deformed_meshes_are_written_for_each_pressure() {
    let options = Options { all_nodes: true, ..Options::default() };
    let out = dat_for(&options, &[1.0, 2.0], |t| 1.0 + 0.05 * t, |t| 1.0 + 0.1 * t);
    let run = Fake::new(COPY).with("out.dat", out).run_for(Runner::default(), options).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let list = fs::read_to_string(run.write_vtu(&folder.path().join("vtu"), "tube").unwrap()).unwrap();
    assert!(
        list.contains("timestep=\"20\" file=\"tube-001.vtu\"")
            && list.contains("timestep=\"30\" file=\"tube-002.vtu\"")
    );
    let text = fs::read_to_string(folder.path().join("vtu/tube-002.vtu")).unwrap();
    let mesh = run.model.mesh();
    let points = array(&text, "<Points>\n<DataArray");
    assert_eq!(points.len(), 3 * mesh.nodes.len());
    for (point, rest) in points.chunks(3).zip(&mesh.nodes) {
        let expected = [1.1 * rest[0], 1.1 * rest[1], 1.2 * rest[2]];
        assert!((0..3).all(|n| (point[n] - expected[n]).abs() < 1e-5), "{point:?} {rest:?}");
    }
    let ends = array(&text, "Name=\"offsets");
    let nodes = array(&text, "Name=\"connectivity");
    assert_eq!((ends.len(), *ends.last().unwrap() as usize), (mesh.elements.len(), nodes.len()));
    let first: Vec<f64> = mesh.elements[0].nodes.iter().map(|node| *node as f64).collect();
    assert_eq!((array(&text, "Name=\"types")[0], &nodes[..20]), (25.0, &first[..]));
    // Gauges alone are not enough for a picture.
    let run = Fake::new(COPY).with("out.dat", good(&[1.0, 2.0])).run().unwrap();
    assert!(run.write_vtu(folder.path(), "tube").unwrap_err().to_string().contains("all_nodes"));
}
