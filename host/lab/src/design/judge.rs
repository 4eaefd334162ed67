//! Limbs judged for a search in another program.

use std::ffi::OsString;
use std::io::BufRead;
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use softlimb::cli::{Failure, say};
use softlimb_design::loaded::{Evaluation, Judgement, confirmed, evaluate};

use super::loaded::{Loaded, processor_s};

/// Threads that share a block of points.
const THREADS: usize = 2;

/// Judges limbs for a search in another program, by the lines on the standard input: `reserve R`, `confirm X1 X2 ...`, and blocks of points of the unit box
/// that an empty line ends. Answers are `1` or `0` for a confirmation; for each point the sum of squares of what it lacks, and the largest lack. Each
/// answer ends with the processor time, s. The first line is the search's first guess.
pub(super) fn judge(scene: &Loaded) -> Result<(), Failure> {
    let (task, space) = (&scene.design.task, &scene.design.space);
    let mut by = Judgement { moves: true, ..Judgement::default() };
    let guess: Vec<String> = space.first_guess().iter().map(f64::to_string).collect();
    let width = guess.len();
    say(&guess.join(" "))?;
    let numbers = |line: &str| point(line, width);
    let mut block: Vec<Vec<f64>> = Vec::new();
    for line in std::io::stdin().lock().lines() {
        let line = line.map_err(Failure::new)?;
        if let Some(reserve) = line.strip_prefix("reserve ") {
            by.reserve = reserve.parse().map_err(Failure::new)?;
        } else if let Some(point) = line.strip_prefix("confirm ") {
            let poses = confirmed(task, space, &numbers(point)?);
            let kept = !poses.is_empty() && poses.iter().all(|pose| pose.lacks.is_empty());
            say(&format!("{} {}", u8::from(kept), processor_s()))?;
        } else if !line.is_empty() {
            block.push(numbers(&line)?);
        } else {
            let values = judged(&block, |point| {
                let limb = evaluate(task, space, &space.sizes(point), &by);
                let largest = |limb: &Evaluation| limb.lacks.iter().map(|lack| lack.value.abs()).fold(0.0, f64::max);
                limb.map_or([f64::INFINITY; 2], |limb| [limb.objective(), largest(&limb)])
            });
            let lines: Vec<String> =
                values.iter().map(|[objective, largest]| format!("{objective:e} {largest:e}")).collect();
            say(&format!("{}\n{}", lines.join("\n"), processor_s()))?;
            block.clear();
        }
    }
    Ok(())
}

/// A point of the box: a number that is missing would silently be the middle of its bounds.
fn point(line: &str, width: usize) -> Result<Vec<f64>, Failure> {
    let numbers: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>().map_err(Failure::new)?;
    match numbers.len() {
        count if count == width => Ok(numbers),
        count => Err(Failure::new(format!("a point has {count} numbers, not {width}"))),
    }
}

/// Values of points, which threads share.
fn judged(points: &[Vec<f64>], value: impl Fn(&[f64]) -> [f64; 2] + Sync) -> Vec<[f64; 2]> {
    let next = AtomicUsize::new(0);
    let values = Mutex::new(vec![[f64::INFINITY; 2]; points.len()]);
    std::thread::scope(|scope| {
        for _ in 0..THREADS {
            scope.spawn(|| {
                while let Some((index, point)) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, points.get(i)?)))
                {
                    let value = value(point);
                    if let Ok(mut values) = values.lock() {
                        values[index] = value;
                    }
                }
            });
        }
    });
    values.into_inner().unwrap_or_default()
}

/// The line that a search in another program prints: a script of `python` with arguments.
pub(super) fn answer(python: &Path, script: &Path, arguments: &[OsString]) -> Result<String, Failure> {
    let output = Command::new(python).arg(script).args(arguments).output().map_err(Failure::new)?;
    if !output.status.success() {
        let file = script.display();
        return Err(Failure::new(format!("{file}: {}", String::from_utf8_lossy(&output.stderr))));
    }
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn point_with_another_number_of_coordinates_is_refused() {
        assert_eq!(point("0.5 1 0", 3).ok(), Some(vec![0.5, 1.0, 0.0]));
        for wrong in ["0.5 1", "0.5 1 0 0", "", "0.5 x 0"] {
            assert!(point(wrong, 3).is_err(), "{wrong}");
        }
    }
}
