//! Output of CalculiX: the displacements in `.dat`, the increments in `.sta`.

use super::FemError;
use super::gauge::Displacements;

/// Displacements at one time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Block {
    /// Total time: the number of steps done, and the share of the one under way.
    pub(crate) time: f64,
    /// By node, from 0, mm.
    pub(crate) moved: Displacements,
}

/// The blocks of a `.dat` file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Blocks {
    /// The whole ones, in order of time.
    pub(crate) whole: Vec<Block>,
    /// The line, from 1, on which the file ends in the middle of a block.
    pub(crate) torn: Option<usize>,
}

/// Reads a `.dat` file in which each block has `count` nodes. A last block that lacks some is torn off; anything else that is not as
/// CalculiX writes it is an error.
pub(crate) fn blocks(text: &str, count: usize) -> Result<Blocks, FemError> {
    let garbage = |line: usize, what: String| FemError::Garbage { file: "the .dat file", line, what };
    let mut found: Vec<Block> = Vec::new();
    let mut lines = 0;
    for (n, line) in text.split_inclusive('\n').enumerate() {
        let number = n + 1;
        lines = number;
        let words: Vec<&str> = line.split_whitespace().collect();
        let torn = !line.ends_with('\n');
        match words[..] {
            [] => {}
            ["displacements", .., "time", time] if !torn => {
                if let Some(block) = found.last().filter(|block| block.moved.len() != count) {
                    return Err(garbage(
                        number,
                        format!("a block begins after {} of {count} nodes", block.moved.len()),
                    ));
                }
                let time: Option<f64> = time.parse().ok().filter(|time: &f64| time.is_finite());
                let time = time.ok_or_else(|| garbage(number, "the time is no number".to_owned()))?;
                let later = found.last().is_none_or(|block| block.time < time);
                if !later {
                    return Err(garbage(number, format!("time {time} is not after the one before")));
                }
                found.push(Block { time, moved: Displacements::with_capacity(count) });
            }
            // A last line without its end may lack digits.
            _ if torn => break,
            [node, x, y, z] => {
                let block = found.last_mut().ok_or_else(|| garbage(number, "no time stands before it".to_owned()))?;
                let (node, shift) = row(node, [x, y, z])
                    .ok_or_else(|| garbage(number, format!("`{}` is no displacement of a node", line.trim())))?;
                if block.moved.insert(node, shift).is_some() {
                    return Err(garbage(number, format!("node {} is there twice", node + 1)));
                }
            }
            _ => return Err(garbage(number, format!("`{}` is no displacement of a node", line.trim()))),
        }
    }
    let torn = found.pop_if(|block| block.moved.len() != count).map(|_| lines);
    Ok(Blocks { whole: found, torn })
}

fn row(node: &str, shift: [&str; 3]) -> Option<(usize, [f64; 3])> {
    let node: usize = node.parse().ok()?;
    let mut values = [0.0; 3];
    for (value, word) in values.iter_mut().zip(shift) {
        *value = word.parse().ok().filter(|value: &f64| value.is_finite())?;
    }
    Some((node.checked_sub(1)?, values))
}

/// Progress by the `.sta` file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Progress {
    /// Total time of the last increment that converged.
    pub(crate) time: f64,
    /// Increments that converged.
    pub(crate) increments: u32,
    /// Iterations of all attempts, as far as they are listed.
    pub(crate) iterations: u32,
}

/// Reads a `.sta` file, which may still be growing: lines that are not whole are left for later.
pub(crate) fn progress(text: &str) -> Progress {
    let mut progress = Progress::default();
    for line in text.split_inclusive('\n').filter(|line| line.ends_with('\n')) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [_, _, attempt, iterations, time, ..] = words[..] else { continue };
        let (Ok(iterations), Ok(time)) = (iterations.parse::<u32>(), time.parse::<f64>()) else { continue };
        progress.iterations += iterations;
        // An attempt that did not converge has a letter.
        if attempt.parse::<u32>().is_ok() && time.is_finite() {
            progress.increments += 1;
            progress.time = progress.time.max(time);
        }
    }
    progress
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two blocks of two nodes, laid out as CalculiX 2.20 does.
    const TEXT: &str = "
 displacements (vx,vy,vz) for set GAUGES and time  0.5000000E+00

         3  1.000000E-01 -2.000000E-02  0.000000E+00
        12  1.100000E-01  3.000000E-02  4.000000E-02

 displacements (vx,vy,vz) for set GAUGES and time  0.1000000E+01

         3  2.000000E-01 -4.000000E-02  0.000000E+00
        12  2.200000E-01  6.000000E-02  8.000000E-02
";

    #[test]
    fn whole_blocks_are_read() {
        let blocks = blocks(TEXT, 2).unwrap();
        assert_eq!(blocks.torn, None);
        let times: Vec<f64> = blocks.whole.iter().map(|block| block.time).collect();
        assert_eq!(times, [0.5, 1.0]);
        assert_eq!(blocks.whole[0].moved[&2], [0.1, -0.02, 0.0]);
        assert_eq!(blocks.whole[1].moved[&11], [0.22, 0.06, 0.08]);
    }

    #[test]
    fn file_cut_anywhere_gives_only_whole_blocks() {
        let whole = blocks(TEXT, 2).unwrap().whole;
        for end in 0..TEXT.len() {
            let cut = blocks(&TEXT[..end], 2).unwrap_or_else(|error| panic!("{end}: {error}"));
            assert!(cut.whole.len() < 2 && cut.whole[..] == whole[..cut.whole.len()], "{end}: {cut:?}");
        }
        assert_eq!(blocks(&TEXT[..TEXT.len() - 5], 2).unwrap().torn, Some(10));
    }

    #[test]
    fn garbage_is_named_with_its_line() {
        for (from, to, line) in [
            ("-2.000000E-02", "NaN", 4),
            ("-2.000000E-02", "************", 4),
            ("-2.000000E-02", "-2.00E-02 7.0", 4),
            ("12  1.1", "0  1.1", 5),
            ("12  1.1", "3  1.1", 5),
            ("0.1000000E+01", "0.4000000E+00", 7),
            ("0.1000000E+01", "never", 7),
            ("         3  1.000000E-01 -2.000000E-02  0.000000E+00\n", "", 6),
            ("displacements (vx", "forces (vx", 2),
        ] {
            let text = TEXT.replacen(from, to, 1);
            assert_ne!(text, TEXT);
            match blocks(&text, 2) {
                Err(FemError::Garbage { line: found, .. }) => assert_eq!(found, line, "{to}"),
                other => panic!("{to}: {other:?}"),
            }
        }
    }

    #[test]
    fn progress_counts_what_converged() {
        let text = "SUMMARY OF JOB INFORMATION
  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME
     1        1       1     4  0.050000E+00  0.050000E+00  0.050000E+00
     1        2      1U     9  0.150000E+00  0.150000E+00  0.100000E+00
     1        2       2     5  0.100000E+00  0.100000E+00  0.050000E+00
     1        3       1     3  0.2";
        assert_eq!(progress(text), Progress { time: 0.1, increments: 2, iterations: 18 });
        assert_eq!(progress("no table at all\n"), Progress::default());
    }
}
