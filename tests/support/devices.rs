//! The images that tests run in an emulator: the controller's twin in lock-step, and the file that is flashed.

use std::io::Write as _;
use std::path::PathBuf;

use softlimb_sim::emulated::is_installed;

/// Where `cargo xtask test` puts the images.
const IMAGES: &str = "SOFTLIMB_IMAGES";

const CURE: &str = "run `cargo xtask test`, which builds the images and installs what that needs where it may; by hand: \
                    `rustup target add thumbv7em-none-eabihf`, or on Debian `apt-get install rustc-web cargo-web rust-web-src lld`, \
                    and `apt-get install qemu-system-arm`";

/// The images for the emulator.
pub(crate) struct Images {
    folder: PathBuf,
}

impl Images {
    /// The images, where there are some and an emulator; else the test is skipped and says so, but in continuous integration fails.
    pub(crate) fn find(test: &str) -> Option<Self> {
        if let Some(folder) = std::env::var_os(IMAGES)
            && is_installed()
        {
            return Some(Self { folder: folder.into() });
        }
        let is_required = std::env::var_os("CI").is_some_and(|ci| !ci.is_empty());
        assert!(!is_required, "{test} cannot run: {CURE}");
        // Not by the macro, whose output a test that passes does not show.
        let _ = writeln!(std::io::stderr(), "skipped: {test}; {CURE}");
        None
    }

    pub(crate) fn twin(&self) -> PathBuf {
        self.folder.join("softlimb-cosim.elf")
    }

    pub(crate) fn flashed(&self) -> PathBuf {
        self.folder.join("softlimb-stm32f405.elf")
    }
}
