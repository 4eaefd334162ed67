//! `console` in a browser: `browser/console.py` uses it as its user would.

#[path = "../../rig/tests/browser/driver.rs"]
pub(crate) mod driver;

use driver::{browser, in_browsers, script};

use crate::cli::desk::Desk;
use crate::cli::program::Program;

#[test]
fn console_is_used_in_a_browser() {
    let Some(browser) = browser("the console in a browser") else { return };
    in_browsers(|more| {
        let desk = Desk::new();
        let mut console = Program::start(&desk, "console --out console");
        let mut command = script("console.py", browser);
        let output = command.arg(console.first_line()).args(more).output().unwrap();
        let (code, told) = console.interrupted();
        if output.status.success() {
            assert_eq!(code, Some(0), "{told}");
            assert!(desk.path("console/run.mcap").is_file() && desk.path("console/run.html").is_file());
        }
        (output, told)
    });
}
