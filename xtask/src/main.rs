//! `cargo xtask <command>`: the developer's commands of the workspace.

mod cargo;
mod double;
mod elf;
mod emulator;
mod firmware;
mod image;
mod lab;
mod msrv;
mod pool;
mod programs;
mod python;
mod setup;
mod steps;
mod table;
mod tally;
mod toolchain;
mod trouble;

use std::path::Path;
use std::process::ExitCode;

use firmware::{Board, Sizes};
use image::Counts;
use python::Sources;
use steps::{Options, installed};

const HELP: &str = "\
Developer commands of the workspace

Usage: cargo xtask <command>

  test         formatting, lints, every test of the workspace, the images in the emulator; what CI runs. What it needs beside
               Rust it names, and installs by apt-get where it may; with --no-install it installs nothing. With --full the
               tests take whole samples in place of a tenth (SOFTLIMB_SAMPLES=full)
  lint         formatting and lints alone
  wheel        builds the wheel of the Python package into target/python/wheels; with --sdist the source distribution into
               target/python/sdist, and the wheel from that; with --test behind it installs the wheel into a fresh environment and
               runs its tests
  msrv         compiles the workspace with the oldest Rust that it supports, where rustup has that
  lab          runs the laboratory (package softlimb-lab), which compares methods and makes pages; arguments are its own
  model-image  builds the model and the controller for a microcontroller, looks for double precision in them, runs them in an
               emulator: the same bits as here, as many instructions and estimated cycles as recorded, and no more than a
               device has for them; with --record it records them; with --here FOLDER it takes the programs of this computer
               from there and builds none
  firmware     builds the images for both boards, or for one, --board f446 (NUCLEO-F446RE) or f405, as .elf, .bin and .hex, and
               their twin for the emulator; says how large they are, compared with what is recorded, that nothing is in them
               that must not be, and which file is for what; with --record it records the sizes
  flash        builds the image for one board, --board f446 (the default) or f405, and writes it into the one that is connected
  help         this text

Formatting needs rustfmt and the lints need clippy; images need a toolchain for the microcontroller and qemu-system-arm, finite
element decks CalculiX, the wheel Python and a package index. What `test` skips without them it names at the end; where CI is set that is a failure.
Exit codes: 0; 1 where a step fails; 2 for a wrong command line, and where a command lacks a tool; those of the laboratory.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match words[..] {
        ["test", ref options @ ..] => match Options::read(options) {
            Some(options) => steps::test(options),
            None => return usage(),
        },
        ["lint"] => steps::lint(),
        ["wheel"] => installed(python::wheel(Sources::Here).map(drop)),
        ["wheel", "--sdist"] => installed(python::wheel(Sources::Distribution).map(drop)),
        ["wheel", "--test"] => installed(python::test(Sources::Here)),
        ["wheel", "--sdist", "--test"] => installed(python::test(Sources::Distribution)),
        ["msrv"] => installed(msrv::check()),
        ["lab", ref arguments @ ..] => lab::run(arguments),
        ["model-image"] => installed(image::check(Counts::Compare, None)),
        ["model-image", "--record"] => installed(image::check(Counts::Record, None)),
        ["model-image", "--here", folder] => installed(image::check(Counts::Compare, Some(Path::new(folder)))),
        ["firmware", ref options @ ..] => match board(options) {
            Some((board, sizes)) => installed(firmware::build_all(board, sizes)),
            None => return usage(),
        },
        ["flash", ref options @ ..] => match board(options) {
            Some((board, Sizes::Compare)) => installed(firmware::flash(board.unwrap_or(Board::F446))),
            _ => return usage(),
        },
        ["help" | "--help" | "-h"] => {
            println!("{HELP}");
            Ok(())
        }
        _ => return usage(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(code) => ExitCode::from(code),
    }
}

fn usage() -> ExitCode {
    eprintln!("{HELP}");
    ExitCode::from(2)
}

/// The options of `firmware`, in any order: the board, where one is named; `None` for other options.
fn board(options: &[&str]) -> Option<(Option<Board>, Sizes)> {
    match *options {
        [] => Some((None, Sizes::Compare)),
        ["--record"] => Some((None, Sizes::Record)),
        ["--board", name] => Some((Some(Board::named(name)?), Sizes::Compare)),
        ["--board", name, "--record"] | ["--record", "--board", name] => {
            Some((Some(Board::named(name)?), Sizes::Record))
        }
        _ => None,
    }
}
