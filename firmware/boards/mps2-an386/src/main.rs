//! The whole model in `f32` on a Cortex-M4F: what it answers, and what each answer costs.
//!
//! Prints one line of tab-separated fields a question: name, actuator, counts of the system timer, iterations, status, the answer and a
//! digest of all its parts, the last two as bits. On a computer with an operating system the same program prints the same answers,
//! without counts: their bits must be equal.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod actuators;
mod answer;
#[cfg(target_os = "none")]
mod board;
mod questions;
mod series;
mod tables;

use answer::Answer;

/// Where questions are put and their answers go.
trait Desk {
    /// Puts the question and notes the answer.
    fn put<A: Answer>(&mut self, question: &str, actuator: &str, ask: impl FnOnce() -> A) -> A;
}

/// Puts every question; whether each was answered.
fn put_all(desk: &mut impl Desk) -> bool {
    let solved = [questions::put_all(desk), series::put_all(desk), tables::put_all(desk)];
    solved.into_iter().all(|well| well)
}

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;

    use crate::answer::{Answer, Note};
    use crate::board::{self, Counter};
    use crate::{Desk, put_all};

    struct Bench {
        counter: Counter,
    }

    impl Desk for Bench {
        #[inline(never)]
        fn put<A: Answer>(&mut self, question: &str, actuator: &str, ask: impl FnOnce() -> A) -> A {
            let begin = self.counter.begin();
            let answer = black_box(ask());
            let counts = self.counter.end(begin);
            let Note { iterations, status, value, digest } = answer.note();
            board::print(format_args!(
                "{question}\t{actuator}\t{counts}\t{iterations}\t{status}\t{value:08x}\t{digest:08x}\n"
            ));
            answer
        }
    }

    /// Loops of two instructions a round, and nothing at all.
    fn calibrate(bench: &mut Bench) {
        bench.put("nothing", "-", || ());
        bench.put("1000 rounds", "-", || cortex_m::asm::delay(999));
        bench.put("51000 rounds", "-", || cortex_m::asm::delay(50_999));
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let Some(counter) = Counter::start() else { board::leave(false) };
        let mut bench = Bench { counter };
        calibrate(&mut bench);
        let answered = put_all(&mut bench);
        board::leave(answered)
    }
}

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    struct Paper;

    impl Desk for Paper {
        fn put<A: Answer>(&mut self, question: &str, actuator: &str, ask: impl FnOnce() -> A) -> A {
            let answer = ask();
            let answer::Note { iterations, status, value, digest } = answer.note();
            println!("{question}\t{actuator}\t-\t{iterations}\t{status}\t{value:08x}\t{digest:08x}");
            answer
        }
    }

    if put_all(&mut Paper) { std::process::ExitCode::SUCCESS } else { std::process::ExitCode::FAILURE }
}
