//! Prints random lines for `softlimb eval --batch`, the same for a seed.
//!
//! `cargo run --release -p softlimb-lab --example eval_lines -- any|sweep|tubes COUNT SEED`
//!
//! `tubes` prints forward questions of straight neo-Hookean tubes, `sweep` the same with 100 pressures a tube, `any` questions of all kinds,
//! with and without answers, and damaged lines.

use std::io::{self, BufWriter, Write};

#[path = "../../tests/eval_lines/mod.rs"]
mod eval_lines;

use eval_lines::Lines;

fn main() -> io::Result<()> {
    const USAGE: &str = "give a kind (any, sweep, tubes), a number of lines and a seed";
    let wrong = || io::Error::new(io::ErrorKind::InvalidInput, USAGE);
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [kind, count, seed] = arguments.as_slice() else { return Err(wrong()) };
    let count: usize = count.parse().map_err(|_| wrong())?;
    let mut lines = Lines::new(seed.parse().map_err(|_| wrong())?);
    let line = match kind.as_str() {
        "any" => Lines::any,
        "sweep" => Lines::sweep,
        "tubes" => Lines::tube,
        _ => return Err(wrong()),
    };
    let mut out = BufWriter::new(io::stdout().lock());
    for number in 0..count {
        out.write_all(&line(&mut lines, number))?;
        out.write_all(b"\n")?;
    }
    out.flush()
}
