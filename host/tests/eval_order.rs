//! Order and errors of batches that several threads answer.

use std::num::NonZero;

use crate::eval_lines::Lines;
use serde_json::Value;
use softlimb::query::{Scalar, batch, batch_on};

const LINES: usize = 3000;
/// The first so many lines are pressures of few tubes.
const SWEEP: usize = 1000;
/// One in so many lines is of any kind.
const ANY: usize = 20;

fn lines() -> Vec<Vec<u8>> {
    let mut lines = Lines::new(7);
    let line = |i| match i {
        _ if i % ANY == 1 => lines.any(i),
        ..SWEEP => lines.sweep(i),
        _ => lines.tube(i),
    };
    (0..LINES).map(line).collect()
}

fn answered(input: &[u8], threads: usize, scalar: Scalar) -> Vec<u8> {
    let mut out = vec![];
    batch_on(NonZero::new(threads).expect("not zero"), input, &mut out, scalar).expect("in memory");
    out
}

#[test]
fn answers_do_not_depend_on_the_number_of_threads() {
    let input = lines().join(&b'\n');
    for scalar in [Scalar::F64, Scalar::F32] {
        let alone = answered(&input, 1, scalar);
        for threads in [2, 5] {
            assert!(answered(&input, threads, scalar) == alone, "{threads} threads, {scalar:?}");
        }
        let mut default = vec![];
        batch(input.as_slice(), &mut default, scalar).expect("in memory");
        assert!(default == alone, "{scalar:?}");
    }
}

/// Each line alone, after as many empty lines as stand before it in the batch, has the answer that it has in the batch.
#[test]
fn answers_are_those_of_their_lines_with_their_numbers() {
    let lines = lines();
    let together = answered(&lines.join(&b'\n'), 3, Scalar::F64);
    let mut together = together.split_inclusive(|byte| *byte == b'\n');
    let mut ends = 0;
    let mut invalid = 0;
    for line in &lines {
        let alone = answered(&[&b"\n".repeat(ends)[..], line.as_slice()].concat(), 1, Scalar::F64);
        for answer in alone.split_inclusive(|byte| *byte == b'\n') {
            assert!(together.next() == Some(answer), "{}", String::from_utf8_lossy(answer));
            let answer: Value = serde_json::from_slice(answer).expect("JSON");
            if answer["status"] == "invalid" {
                invalid += 1;
                let message = answer["message"].as_str().expect("text");
                let (_, number) = message.split_once("line ").expect("a number");
                let (number, _) = number.split_once(':').expect("a number");
                assert!((ends + 1..).take(2).any(|at| number.parse() == Ok(at)), "{message}");
            }
        }
        ends += 1 + line.iter().filter(|byte| **byte == b'\n').count();
    }
    assert!(together.next().is_none() && invalid >= 10, "{invalid} lines that cannot be answered");
}
