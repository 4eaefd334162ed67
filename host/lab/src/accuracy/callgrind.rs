//! Instructions and floating-point operations as valgrind's callgrind counts them.
//!
//! The program runs itself under callgrind, which writes a part where one function is entered and where another is left. Instructions
//! are summed; those of them that add, multiply, divide or take a root are told from the program's own disassembly (`objdump`), so that
//! what mathematical functions compute inside counts like everything else.

mod parts;

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Mean counts of one answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Count {
    /// Instructions executed.
    pub instructions: f64,
    /// Sums, differences, products, quotients and roots of floats, every lane of a vector counted; `None` off x86-64 or without
    /// `objdump`.
    pub flops: Option<f64>,
}

/// The function before and the one after which a part is written, as their names appear in the program's symbols.
const REGION: &str = "measured_region";
const WORK: &str = "measured_work";

/// Which of the instruments is missing, by name.
pub fn missing_instruments() -> Vec<&'static str> {
    let works = |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    ["valgrind", "objdump"].into_iter().filter(|name| !works(name)).collect()
}

/// Runs `program arguments`, which must print what [`workload`](super::workload) says, and counts every part.
///
/// # Errors
/// A sentence that names what failed.
pub(super) fn counts(program: &Path, arguments: &[String]) -> Result<HashMap<usize, Count>, String> {
    let folder = Folder::new()?;
    let out = folder.0.join("out");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--dump-instr=yes", "--compress-pos=no"])
        .args([format!("--dump-before=*{REGION}*"), format!("--dump-after=*{WORK}*")])
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(program)
        .args(arguments)
        .output()
        .map_err(|error| format!("cannot run valgrind: {error}"))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        return Err(format!("valgrind failed: {}", text.lines().last().unwrap_or("without a word")));
    }
    let said = read(&String::from_utf8_lossy(&output.stdout))?;
    let operations = if cfg!(target_arch = "x86_64") { operations(program) } else { None };
    let mut counts = HashMap::new();
    for (part, (entry, answers)) in said.iter().enumerate() {
        // Every second part is what lies between.
        let file = out.with_extension((2 * part + 2).to_string());
        let text = fs::read_to_string(&file).map_err(|error| format!("cannot read {}: {error}", file.display()))?;
        let (instructions, flops) = parts::sum(&text, &program.to_string_lossy(), operations.as_ref());
        let per_answer = |count: u64| count as f64 / *answers as f64;
        let flops = operations.is_some().then(|| per_answer(flops));
        counts.insert(*entry, Count { instructions: per_answer(instructions), flops });
    }
    Ok(counts)
}

/// What the counted program prints: entry and answers of each part.
fn read(text: &str) -> Result<Vec<(usize, usize)>, String> {
    let part = |line: &str| {
        let (entry, answers) = line.split_once(' ')?;
        Some((entry.parse().ok()?, answers.parse().ok().filter(|answers| *answers > 0)?))
    };
    text.lines().map(|line| part(line).ok_or_else(|| format!("the counted program printed: {line}"))).collect()
}

/// Floating-point operations of the instruction at each address of the program; `None` without `objdump`.
fn operations(program: &Path) -> Option<HashMap<u64, u64>> {
    let output = Command::new("objdump").args(["-d", "--no-show-raw-insn"]).arg(program).output().ok()?;
    Some(parts::operations(&String::from_utf8_lossy(&output.stdout)).collect())
}

/// A folder of its own that goes away again.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self, String> {
        let path = std::env::temp_dir().join(format!("softlimb-callgrind-{}", std::process::id()));
        fs::create_dir_all(&path).map_err(|error| format!("cannot create {}: {error}", path.display()))?;
        Ok(Self(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Nothing is lost if it stays.
        let _ = fs::remove_dir_all(&self.0);
    }
}
