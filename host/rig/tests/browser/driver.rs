//! The browser that pages are tried in.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Names under which systems install the browser.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
const CURE: &str = "chromium or its driver is missing (Debian: apt-get install chromium; pip install playwright)";

/// Browsers to try: Chromium 156 sometimes draws one frame a second, or none, until it ends.
const BROWSERS: usize = 4;
/// Exit code of a script for such a browser.
const SLOW: i32 = 3;

/// The browser with its driver. Continuous integration must have both: else the test would be skipped unnoticed.
pub(crate) fn browser(test: &str) -> Option<&'static str> {
    let runs = |program: &str, arguments: &[&str]| {
        let status = Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
        status.is_ok_and(|status| status.success())
    };
    let found = NAMES.into_iter().find(|browser| runs(browser, &["--version"]));
    let found = found.filter(|_| runs("python3", &["-c", "import playwright"]));
    let ci = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty());
    assert!(found.is_some() || !ci, "CI is set: {CURE}");
    if found.is_none() {
        // The harness captures what `eprintln!` writes.
        let _ = writeln!(std::io::stderr(), "skipped: {test}; {CURE}");
    }
    found
}

/// A script of the package's tests in a browser, with a folder for pictures of every page, width and scheme, for eyes.
pub(crate) fn script(name: &str, browser: &str) -> Command {
    let mut command = Command::new("python3");
    command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser").join(name)).arg(browser);
    if let Some(pictures) = std::env::var_os("SOFTLIMB_PICTURES") {
        command.arg("--pictures").arg(pictures);
    }
    command
}

/// Calls `run` with more arguments for its script until a browser keeps pace, and expects that the script finds nothing wrong. `run` gives the end
/// of the script, and more words for whoever reads that it has failed.
pub(crate) fn in_browsers(mut run: impl FnMut(&[&str]) -> (Output, String)) {
    let mut has_hung = false;
    for spare in (0..BROWSERS).rev() {
        // The last browser may be slow: on busy cores all of them are.
        let (output, more) = run(if spare > 0 { &["--must-keep-pace"] } else { &[] });
        let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
        let text = format!("{out}{err}{more}");
        // Without any frame the alarm ends the script. Two such browsers have no time for a third.
        let is_slow = match output.status.code() {
            Some(code) => code == SLOW,
            None => !std::mem::replace(&mut has_hung, true),
        };
        if spare > 0 && is_slow {
            println!("another browser is started: {text}");
            continue;
        }
        assert!(output.status.success(), "{text}");
        print!("{text}");
        return;
    }
}
