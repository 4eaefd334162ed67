//! The images for the board: built, looked at, written in the forms that tools take.

mod flash;
mod forms;
mod inspect;
mod seal;
mod sizes;

use std::fs;
use std::path::{Path, PathBuf};

use crate::cargo::{root, target_folder};
use crate::toolchain::{PROFILE, TARGET, Toolchain};
use crate::trouble::Trouble;

pub(crate) use flash::flash;

/// The package of the images for boards.
pub(crate) const PACKAGE: &str = "softlimb-image-stm32f4";
/// The flashed program, and its twin for the emulator.
const FLASHED: &str = "softlimb-stm32f4";
const TWIN: &str = "softlimb-cosim";

/// A board that there is an image for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Board {
    /// NUCLEO-F446RE.
    F446,
    /// Boards with an STM32F405RG; the one that the emulator has.
    F405,
}

impl Board {
    /// The board of an argument.
    pub(crate) fn named(name: &str) -> Option<Self> {
        match name {
            "f446" => Some(Self::F446),
            "f405" => Some(Self::F405),
            _ => None,
        }
    }

    /// What its image is for.
    fn uses(self) -> &'static str {
        match self {
            Self::F446 => "NUCLEO-F446RE; `cargo xtask flash --board f446` writes it",
            Self::F405 => {
                "STM32F405RG with 12 MHz; `cargo xtask flash --board f405` writes it, `softlimb run --mcu qemu` runs it"
            }
        }
    }

    fn feature(self) -> &'static str {
        match self {
            Self::F446 => "f446",
            Self::F405 => "f405",
        }
    }
}

/// Use of the sizes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sizes {
    /// Compare them with the recorded ones.
    Compare,
    /// Record them.
    Record,
}

/// The files of an image.
pub(crate) struct Files {
    pub(crate) elf: PathBuf,
    pub(crate) bin: PathBuf,
}

/// The folder that the files are put into.
pub(crate) fn folder() -> PathBuf {
    target_folder().join("firmware")
}

/// Builds the image of the board, or of all boards, and their twin; says which file is for what.
///
/// # Errors
/// As [`build`].
pub(crate) fn build_all(board: Option<Board>, what: Sizes) -> Result<(), Trouble> {
    let boards = board.map_or_else(|| vec![Board::F446, Board::F405], |board| vec![board]);
    let built: Vec<(PathBuf, &str)> =
        boards.into_iter().map(|board| Ok((build(board, what)?.elf, board.uses()))).collect::<Result<_, Trouble>>()?;
    let twin = (folder().join(format!("{TWIN}.elf")), "the twin; `softlimb run --mcu cosim` runs it");
    for (path, uses) in built.iter().chain([&twin]) {
        println!("xtask: {}: {uses}", path.display());
    }
    Ok(())
}

/// Builds the image of a board and its twin, looks at them and writes their files.
///
/// # Errors
/// No toolchain; an image that does not build, holds what it must not, or is larger than recorded.
pub(crate) fn build(board: Board, what: Sizes) -> Result<Files, Trouble> {
    let toolchain = Toolchain::find().map_err(Trouble::Missing)?;
    let built = built(&toolchain, board).map_err(Trouble::Failed)?;
    let name = format!("softlimb-stm32{}", board.feature());
    let files = written(&built.join(FLASHED), &name, seal::seal).map_err(Trouble::Failed)?;
    written(&built.join(TWIN), TWIN, |_| Ok(())).map_err(Trouble::Failed)?;
    let elf = fs::read(&files.elf).map_err(|error| Trouble::Failed(format!("{}: {error}", files.elf.display())))?;
    inspect::check(&elf, &places(&toolchain)).map_err(Trouble::Failed)?;
    sizes::report(board.feature(), &elf, &toolchain.version, what).map_err(Trouble::Failed)?;
    Ok(files)
}

/// The folder of what Cargo has built.
fn built(toolchain: &Toolchain, board: Board) -> Result<PathBuf, String> {
    let folder = folder();
    println!("xtask: {PACKAGE} for {}, {}", board.feature(), toolchain.version);
    let mut command = toolchain.build(PACKAGE, PROFILE, &folder);
    command.args(["--no-default-features", "--features", board.feature()]).current_dir(root());
    // Where something is on this computer is nothing that an image should hold, or depend on.
    let renamed: Vec<String> =
        places(toolchain).iter().map(|(place, name)| format!("--remap-path-prefix={place}={name}")).collect();
    command.env("CARGO_ENCODED_RUSTFLAGS", renamed.join("\x1f"));
    let status = command.status().map_err(|error| format!("cannot run cargo: {error}"))?;
    if status.success() { Ok(folder.join(TARGET).join(PROFILE)) } else { Err("the image does not build".to_owned()) }
}

/// Places on this computer whose names could come into an image, and what they are called instead.
fn places(toolchain: &Toolchain) -> Vec<(String, &'static str)> {
    let home = std::env::home_dir();
    let cargo_home = std::env::var_os("CARGO_HOME").map(PathBuf::from).or_else(|| Some(home?.join(".cargo")));
    let places = [(Some(root()), "softlimb"), (cargo_home, "cargo"), (toolchain.sysroot(), "rust")];
    places.into_iter().filter_map(|(place, name)| Some((place?.to_str()?.to_owned(), name))).collect()
}

/// Copies an image, finished, under its name and writes it in the other forms.
fn written(image: &Path, name: &str, finish: impl Fn(&mut [u8]) -> Result<(), String>) -> Result<Files, String> {
    let to_text = |error: std::io::Error| format!("{}: {error}", image.display());
    let mut elf = fs::read(image).map_err(to_text)?;
    finish(&mut elf)?;
    let binary = forms::binary(&elf)?;
    let path = |extension: &str| folder().join(format!("{name}.{extension}"));
    let files = Files { elf: path("elf"), bin: path("bin") };
    fs::write(&files.elf, &elf).map_err(to_text)?;
    fs::write(&files.bin, &binary.bytes).map_err(to_text)?;
    fs::write(path("hex"), forms::hex(&binary)).map_err(to_text)?;
    println!("xtask: {}, .bin and .hex; hash of the .bin {:016x}", files.elf.display(), forms::hash(&binary.bytes));
    Ok(files)
}
