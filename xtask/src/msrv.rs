//! The oldest Rust that the workspace supports: `rust-version` of its manifest.

use std::process::Command;

use crate::cargo::{root, target_folder};
use crate::trouble::Trouble;

const VERSION: &str = env!("CARGO_PKG_RUST_VERSION");

/// Compiles the workspace, tests aside, by that compiler.
///
/// # Errors
/// It does not compile; rustup does not have that compiler.
pub(crate) fn check() -> Result<(), Trouble> {
    let installed = Command::new("rustup").args(["toolchain", "list"]).output();
    let installed = installed.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    let toolchain = toolchain(&installed, VERSION).ok_or_else(|| {
        Trouble::Missing(format!(
            "rustup has no Rust {VERSION}: `rustup toolchain install {VERSION} --profile minimal`"
        ))
    })?;
    println!("xtask: cargo +{toolchain} check --workspace");
    let status = Command::new("rustup")
        .args(["run", toolchain, "cargo", "check", "--workspace", "--target-dir"])
        .arg(target_folder().join("msrv"))
        .current_dir(root())
        .status();
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(Trouble::Failed(format!("the workspace does not compile with Rust {VERSION}"))),
        Err(error) => Err(Trouble::Failed(format!("cannot run rustup: {error}"))),
    }
}

/// The toolchain of a version among the lines of `rustup toolchain list`.
fn toolchain<'a>(installed: &'a str, version: &str) -> Option<&'a str> {
    let mut names = installed.lines().filter_map(|line| line.split_whitespace().next());
    names.find(|name| name.strip_prefix(version).is_some_and(|rest| rest.starts_with(['.', '-'])))
}

#[cfg(test)]
mod tests {
    use super::toolchain;

    #[test]
    fn a_toolchain_is_found_by_its_version_and_not_by_a_part_of_it() {
        let installed = "stable-x86_64-unknown-linux-gnu (active, default)\n\
                         1.890.0-x86_64-unknown-linux-gnu\n\
                         1.89.0-x86_64-unknown-linux-gnu (override)\n\
                         1.90-aarch64-apple-darwin\n";
        assert_eq!(toolchain(installed, "1.89"), Some("1.89.0-x86_64-unknown-linux-gnu"));
        assert_eq!(toolchain(installed, "1.90"), Some("1.90-aarch64-apple-darwin"));
        assert_eq!(toolchain(installed, "1.8"), None);
        assert_eq!(toolchain("no installed toolchains\n", "1.89"), None);
    }
}
