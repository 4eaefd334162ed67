//! `console` in a browser: `browser/console.py` uses it as its user would.

#[path = "../../rig/tests/browser/driver.rs"]
pub(crate) mod driver;

use std::path::{Path, PathBuf};
use std::process::Command;

use driver::browser;

use crate::cli::desk::Desk;
use crate::cli::program::Program;

/// Browsers to try, each with its own console: Chromium 156 sometimes draws one frame a second, or none, until it ends.
const BROWSERS: usize = 4;

/// Exit code of the script for such a browser.
const SLOW: i32 = 3;

#[test]
fn console_is_used_in_a_browser() {
    let Some(browser) = browser("the console in a browser") else { return };
    let mut has_hung = false;
    for spare in (0..BROWSERS).rev() {
        let desk = Desk::new();
        let mut console = Program::start(&desk, "console --out console");
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/console.py");
        let mut command = Command::new("python3");
        command.arg(script).args([browser, &console.first_line()]);
        // The last browser may be slow: on busy cores all of them are.
        if spare > 0 {
            command.arg("--must-keep-pace");
        }
        // Pictures of every page, width and scheme, for eyes.
        if let Some(pictures) = std::env::var_os("SOFTLIMB_PICTURES") {
            command.arg("--pictures").arg(PathBuf::from(pictures));
        }
        let output = command.output().unwrap();
        let (code, told) = console.interrupted();
        let text =
            String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr) + &told;
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
        assert_eq!(code, Some(0), "{text}");
        assert!(desk.path("console/run.mcap").is_file() && desk.path("console/run.html").is_file());
        print!("{text}");
        return;
    }
}
