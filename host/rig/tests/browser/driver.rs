//! The browser that pages are tried in.

use std::io::Write;
use std::process::{Command, Stdio};

/// Names under which systems install the browser.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
const CURE: &str = "chromium or its driver is missing (Debian: apt-get install chromium; pip install playwright)";

/// The browser with its driver. Continuous integration must have both: else the test would be skipped unnoticed.
pub(crate) fn browser(test: &str) -> Option<&'static str> {
    let runs = |program: &str, arguments: &[&str]| {
        let status = Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
        status.is_ok_and(|status| status.success())
    };
    let found = BROWSERS.into_iter().find(|browser| runs(browser, &["--version"]));
    let found = found.filter(|_| runs("python3", &["-c", "import playwright"]));
    let ci = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty());
    assert!(found.is_some() || !ci, "CI is set: {CURE}");
    if found.is_none() {
        // The harness captures what `eprintln!` writes.
        let _ = writeln!(std::io::stderr(), "skipped: {test}; {CURE}");
    }
    found
}
