//! Reports in a browser: `browser/report.py` opens them and uses them as a reader would.

#[path = "browser/driver.rs"]
mod driver;

use std::path::Path;
use std::sync::atomic::AtomicBool;

use driver::{browser, in_browsers, script};
use softlimb_rig::record::RunLog;
use softlimb_rig::report;
use softlimb_rig::run::{Mcu, RunOptions, run};
use softlimb_scene::parse;

/// The run of a scene of the repository.
fn log_of(name: &str) -> RunLog {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name).with_extension("toml");
    let scene = parse(&std::fs::read_to_string(file).unwrap(), name).unwrap();
    let out = tempfile::tempdir().unwrap();
    let options =
        RunOptions { seed: 1, out: out.path().to_owned(), mcu: Mcu::Here, link_faults: None, faults: Vec::new() };
    run(&scene, &options, &AtomicBool::new(false), |_| ()).unwrap().run
}

/// A run again and again: 5 min at 50 Hz, its channels three times.
fn long(run: &RunLog) -> RunLog {
    let mut long = run.clone();
    let (period_s, duration_s) = (run.samples.last().unwrap().time_s + 0.02, 300.0);
    let rounds = (duration_s / period_s).ceil() as usize;
    let shifts = (0..rounds).map(|round| period_s * round as f64);
    fn again<T: Clone>(items: &[T], shifts: impl Iterator<Item = f64>, shift: impl Fn(&mut T, f64)) -> Vec<T> {
        let shifted = shifts.flat_map(|shift_s| items.iter().cloned().map(move |item| (item, shift_s)));
        shifted
            .map(|(mut item, shift_s)| {
                shift(&mut item, shift_s);
                item
            })
            .collect()
    }
    long.samples = again(&run.samples, shifts.clone(), |sample, shift_s| {
        sample.time_s += shift_s;
        sample.channels = [&sample.channels[..]; 3].concat();
        sample.modules = [&sample.modules[..]; 3].concat();
    });
    long.bodies = again(&run.bodies, shifts.clone(), |body, shift_s| body.time_s += shift_s);
    long.shapes = again(&run.shapes, shifts.clone(), |shape, shift_s| shape.time_s += shift_s);
    long.info.phases = again(&run.info.phases, shifts, |phase, shift_s| {
        phase.start_s += shift_s;
        phase.nearest.iter_mut().for_each(|nearest| nearest.time_s += shift_s);
    });
    let channels = run.info.channel_count();
    long.info.modules = (0..3)
        .flat_map(|copy| {
            run.info.modules.iter().cloned().map(move |mut module| {
                module.name = format!("{}-{copy}", module.name);
                module.channels = module.channels.start + copy * channels..module.channels.end + copy * channels;
                module
            })
        })
        .collect();
    long
}

#[test]
fn reports_are_read_in_a_browser() {
    let Some(browser) = browser("reports in a browser") else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = |name: &str, log: &RunLog| {
        let file = folder.path().join(name);
        std::fs::write(&file, report::html(log)).unwrap();
        file
    };
    let post = log_of("reach-past-post");
    let carried = log_of("pick-and-place-a");
    let pages = [
        page("reach-past-post.html", &post),
        page("pick-and-place-a.html", &carried),
        page("five-minutes.html", &long(&post)),
    ];
    for page in pages {
        in_browsers(|more| {
            let mut command = script("report.py", browser);
            (command.arg(&page).args(more).output().unwrap(), String::new())
        });
    }
}
