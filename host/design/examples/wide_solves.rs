//! Model solves of single searches on wide supply lines, to be counted by valgrind:
//!
//! `valgrind --tool=callgrind target/release/examples/wide_solves PROBLEM...`
//!
//! prints instructions, the program solves; their quotient are the instructions per solve, those of the search included.

#![allow(clippy::print_stdout)]

use softlimb_design::actuators::kinds::wide_line;
use softlimb_design::actuators::{Budget, solve};

fn main() {
    println!("problem  model solves  derivatives  evaluations");
    for problem in std::env::args().skip(1).filter_map(|text| text.parse().ok()) {
        let Ok(answer) = solve(&wide_line(problem), &Budget::default()) else { continue };
        let counts = answer.cost;
        println!("{problem:>7}  {:>12}  {:>11}  {:>11}", counts.solves, counts.derivatives, counts.evaluations);
    }
}
