//! `console` in a browser: `browser/console.py` uses it as its user would.

#[path = "../../rig/tests/browser/driver.rs"]
pub(crate) mod driver;

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;

use driver::browser;

use crate::cli::desk::Desk;

/// A console without a scene, and the address of its page.
fn console(desk: &Desk) -> (Child, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_softlimb"));
    command.arg("console").arg("--out").arg(desk.path("console"));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut address = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut address).unwrap();
    (child, address.trim().to_owned())
}

#[test]
fn console_is_used_in_a_browser() {
    let Some(browser) = browser("the console in a browser") else { return };
    let desk = Desk::new();
    let (mut child, address) = console(&desk);
    let mut errors = child.stderr.take().unwrap();
    let told = thread::spawn(move || {
        let mut text = String::new();
        errors.read_to_string(&mut text).unwrap();
        text
    });
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/console.py");
    let mut command = Command::new("python3");
    command.arg(script).args([browser, &address]);
    // Pictures of every page, width and scheme, for eyes.
    if let Some(pictures) = std::env::var_os("SOFTLIMB_PICTURES") {
        command.arg("--pictures").arg(PathBuf::from(pictures));
    }
    let output = command.output().unwrap();
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let status = child.wait().unwrap();
    let told = told.join().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr) + &told;
    assert!(output.status.success(), "{text}");
    assert!(killed.success() && status.success(), "{status}: {text}");
    assert!(desk.path("console/run.mcap").is_file() && desk.path("console/run.html").is_file());
    print!("{text}");
}
