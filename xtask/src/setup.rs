//! Tools of the tests beside Rust: which are there, which are missing, and their installation where that is possible.

use std::process::{Command, Stdio};

use crate::emulator;
use crate::toolchain::Toolchain;

/// Something that tests need, of which a Rust toolchain knows nothing.
#[derive(Debug, PartialEq, Eq)]
struct Part {
    /// Packages of Debian and what descends from it.
    packages: &'static [&'static str],
    /// Modules of Python, by pip.
    modules: &'static [&'static str],
    /// Its purpose.
    why: &'static str,
    /// Advice without `apt-get`.
    elsewhere: &'static str,
}

const PARTS: [Part; 8] = [
    Part {
        packages: &["rustc-web", "cargo-web", "rust-web-src", "lld"],
        modules: &[],
        why: "a compiler for thumbv7em-none-eabihf: images for the microcontroller",
        elsewhere: "`rustup target add thumbv7em-none-eabihf`",
    },
    Part {
        packages: &["qemu-system-arm"],
        modules: &[],
        why: "the emulator that those images run in",
        elsewhere: "qemu: https://www.qemu.org/download, `dnf install qemu-system-arm`, `brew install qemu`",
    },
    Part {
        packages: &["calculix-ccx"],
        modules: &[],
        why: "CalculiX, which solves the finite element decks",
        elsewhere: "CalculiX: http://www.calculix.de, `dnf install calculix`",
    },
    Part {
        packages: &["valgrind", "binutils"],
        modules: &[],
        why: "what counts the instructions of the model",
        elsewhere: "valgrind: https://valgrind.org, `dnf install valgrind binutils`",
    },
    Part {
        packages: &["python3", "python3-venv"],
        modules: &[],
        why: "the Python package, and the client of the link in Python, which shares no code with the host",
        elsewhere: "Python 3.10 or newer: https://www.python.org, `dnf install python3`",
    },
    Part {
        packages: &["tmux"],
        modules: &[],
        why: "a terminal, in which keys move a limb",
        elsewhere: "tmux 3: https://github.com/tmux/tmux, `dnf install tmux`, `brew install tmux`",
    },
    Part {
        packages: &["chromium", "python3-pip"],
        modules: &["playwright"],
        why: "a browser, in which reports are used, and its driver",
        elsewhere: "Chromium: https://www.chromium.org, `dnf install chromium`; `pip install playwright`",
    },
    Part {
        packages: &["python3-pip"],
        modules: &["mcap-ros2-support", "rosbags", "rerun-sdk"],
        why: "readers of ROS 2 logs and a viewer, which share no code with the recorder",
        elsewhere: "`pip install mcap-ros2-support rosbags rerun-sdk`",
    },
];

/// Permitted ways to a missing part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Means {
    /// There is `apt-get`, and the right to use it.
    Apt,
    /// There is `apt-get`, for somebody else.
    AptOfRoot,
    /// There is no `apt-get`.
    None,
    /// Nothing may be installed.
    Forbidden,
}

/// Next step.
#[derive(Debug, PartialEq, Eq)]
enum Step {
    /// To install these parts, each by itself, so that one which cannot be had costs no other.
    Install(Vec<&'static Part>),
    /// To name these parts and go on.
    Name(Vec<&'static Part>, Means),
}

/// Makes what the tests need available where that is possible, saying so before; else names it.
pub(crate) fn prepare(may_install: bool) {
    match step(present(), means(may_install)) {
        Step::Install(parts) if parts.is_empty() => {}
        Step::Install(parts) => {
            print!("{}", announcement(&parts));
            install(&parts);
        }
        Step::Name(parts, means) => print!("{}", advice(&parts, means)),
    }
}

/// Which of the parts are there.
fn present() -> [bool; PARTS.len()] {
    // That they run is enough: CalculiX prints its version and ends with a failure.
    let runs = |program: &str, option: &str| {
        Command::new(program).arg(option).stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
    };
    let counters = runs("valgrind", "--version") && runs("objdump", "--version");
    // Debian's interpreter comes without what makes virtual environments.
    let (python, terminal) = (has_module("ensurepip"), runs("tmux", "-V"));
    let browser = runs("chromium", "--version") && has_module("playwright");
    let readers = has_module("mcap_ros2, rosbags, rerun");
    let images = [Toolchain::find().is_ok(), emulator::find().is_ok()];
    [images[0], images[1], runs("ccx", "-v"), counters, python, terminal, browser, readers]
}

/// Whether Python finds a module, or several that commas part.
fn has_module(name: &str) -> bool {
    let mut command = Command::new("python3");
    command.args(["-c", &format!("import {name}")]).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

fn means(may_install: bool) -> Means {
    let apt = Command::new("apt-get").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    match apt.is_ok_and(|status| status.success()) {
        _ if !may_install => Means::Forbidden,
        false => Means::None,
        true if is_root() => Means::Apt,
        true => Means::AptOfRoot,
    }
}

/// Whether this process may do everything, by the system's own word.
fn is_root() -> bool {
    let id = Command::new("id").arg("-u").stderr(Stdio::null()).output();
    id.is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

/// Next step, by the parts that are there and the permitted ways.
fn step(present: [bool; PARTS.len()], means: Means) -> Step {
    let lacking: Vec<_> = PARTS.iter().zip(present).filter_map(|(part, there)| (!there).then_some(part)).collect();
    if lacking.is_empty() || means == Means::Apt { Step::Install(lacking) } else { Step::Name(lacking, means) }
}

/// Announcement of an installation, with its reason.
fn announcement(parts: &[&Part]) -> String {
    let names = |part: &Part| [part.packages, part.modules].concat().join(" ");
    let lines: String = parts.iter().map(|part| line(&names(part), part)).collect();
    format!("xtask: tests need what is not here; about to install by apt-get and pip (not with --no-install):\n{lines}")
}

/// Advice on parts that this program cannot install.
fn advice(parts: &[&Part], means: Means) -> String {
    let apt = |part: &Part| match part.modules {
        [] => format!("apt-get install {}", part.packages.join(" ")),
        modules => format!("apt-get install {}; pip install {}", part.packages.join(" "), modules.join(" ")),
    };
    let how = |part: &Part| match means {
        Means::None => part.elsewhere.to_owned(),
        Means::Apt | Means::AptOfRoot => apt(part),
        Means::Forbidden => format!("{}; where there is no apt-get {}", apt(part), part.elsewhere),
    };
    let lines: String = parts.iter().map(|part| line(&how(part), part)).collect();
    let title = match means {
        Means::AptOfRoot => "this is not root, which could install it; the tests that need it are skipped",
        _ => "the tests that need it are skipped",
    };
    format!("xtask: some tests need what is not here; {title}:\n{lines}")
}

fn line(how: &str, part: &Part) -> String {
    format!("  {how}\n      {}\n", part.why)
}

/// Installs; where that fails, the step that needs the part says what it lacks.
fn install(parts: &[&Part]) {
    apt(&["-qq", "update"]);
    for part in parts {
        let options = ["-qq", "--yes", "--no-install-recommends", "install"];
        apt(&[&options, part.packages].concat());
        if !part.modules.is_empty() {
            pip(part.modules);
        }
    }
}

fn pip(modules: &[&str]) {
    println!("xtask: pip install {}", modules.join(" "));
    let mut command = Command::new("python3");
    command.args(["-m", "pip", "install", "--quiet"]).args(modules);
    // Debian marks its Python as its own; root, who installs here, may add to it.
    command.env("PIP_BREAK_SYSTEM_PACKAGES", "1").stdin(Stdio::null()).stdout(Stdio::null());
    if !command.status().is_ok_and(|status| status.success()) {
        println!("xtask: pip did not succeed; going on without");
    }
}

fn apt(arguments: &[&str]) {
    println!("xtask: apt-get {}", arguments.join(" "));
    let mut command = Command::new("apt-get");
    command.args(arguments).env("DEBIAN_FRONTEND", "noninteractive").stdin(Stdio::null()).stdout(Stdio::null());
    if !command.status().is_ok_and(|status| status.success()) {
        println!("xtask: apt-get did not succeed; going on without");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packages(step: &Step) -> Vec<&'static str> {
        let (Step::Install(parts) | Step::Name(parts, _)) = step;
        parts.iter().flat_map(|part| part.packages).copied().collect()
    }

    #[test]
    fn what_is_there_is_not_installed_again() {
        for means in [Means::Apt, Means::AptOfRoot, Means::None, Means::Forbidden] {
            assert_eq!(
                step([true; PARTS.len()], means),
                Step::Install(Vec::new()),
                "{means:?}: nothing to do, nothing to say"
            );
        }
        assert_eq!(packages(&step([true, false, true, true, true, true, true, true], Means::Apt)), ["qemu-system-arm"]);
        assert_eq!(packages(&step([true, true, false, true, true, true, true, true], Means::Apt)), ["calculix-ccx"]);
        let compiler = step([false, true, true, true, true, true, true, true], Means::Apt);
        assert_eq!(packages(&compiler), ["rustc-web", "cargo-web", "rust-web-src", "lld"]);
    }

    #[test]
    fn only_root_with_apt_installs() {
        let few = [true, false, false, true, true, false, true, true];
        let others = [false, true, false, false, false, true, false, false];
        for present in [[false; PARTS.len()], few, others] {
            assert!(matches!(step(present, Means::Apt), Step::Install(_)));
            for means in [Means::AptOfRoot, Means::None, Means::Forbidden] {
                let named = step(present, means);
                assert!(matches!(named, Step::Name(_, told) if told == means), "{present:?}, {means:?}");
                assert_eq!(packages(&named), packages(&step(present, Means::Apt)));
            }
        }
    }

    #[test]
    fn what_and_why_is_said_before() {
        let parts: Vec<&Part> = PARTS.iter().collect();
        let (told, elsewhere) = (announcement(&parts), advice(&parts, Means::None));
        for part in parts {
            let names = [part.packages, part.modules].concat();
            assert!(names.iter().all(|name| told.contains(name)) && told.contains(part.why), "{told}");
            assert!(elsewhere.contains(part.elsewhere) && elsewhere.contains(part.why), "{elsewhere}");
        }
        assert!(told.contains("--no-install") && elsewhere.contains("skipped"));
    }

    #[test]
    fn nothing_may_mean_nothing() {
        assert_eq!(means(false), Means::Forbidden);
    }
}
