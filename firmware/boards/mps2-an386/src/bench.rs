//! Bench of the queries: prints a table, one line an answer.
//!
//! Fields separated by tabs: name, actuator, counts of the system timer, iterations, status, the answer and a digest of all its parts,
//! the last two as bits. On a computer with an operating system the same program prints the same answers, without counts.

use crate::answer::Answer;

/// Bench of the queries.
pub(crate) trait Bench {
    /// Puts the query and notes the answer.
    fn put<A: Answer>(&mut self, query: &str, actuator: &str, ask: impl FnOnce() -> A) -> A;
}

#[cfg(target_os = "none")]
mod here {
    use core::hint::black_box;

    use super::Bench;
    use crate::answer::{Answer, Note};
    use crate::board::{self, Counter, stretch_begins, stretch_ends};

    /// Counts the cost of each answer.
    pub(crate) struct CountingBench {
        counter: Counter,
    }

    impl Bench for CountingBench {
        #[inline(never)]
        fn put<A: Answer>(&mut self, query: &str, actuator: &str, ask: impl FnOnce() -> A) -> A {
            let begin = self.counter.begin();
            stretch_begins();
            let answer = black_box(ask());
            stretch_ends();
            let counts = self.counter.end(begin);
            let Note { iterations, status, value, digest } = answer.note();
            board::print(format_args!(
                "{query}\t{actuator}\t{counts}\t{iterations}\t{status}\t{value:08x}\t{digest:08x}\n"
            ));
            answer
        }
    }

    /// Loops of two instructions a round, and nothing at all.
    fn calibrate(bench: &mut CountingBench) {
        bench.put("nothing", "-", || ());
        bench.put("1000 rounds", "-", || cortex_m::asm::delay(999));
        bench.put("51000 rounds", "-", || cortex_m::asm::delay(50_999));
    }

    /// Puts all queries and leaves the emulator, well if all were answered.
    pub(crate) fn run(put_all: impl FnOnce(&mut CountingBench) -> bool) -> ! {
        let Some(counter) = Counter::start() else { board::leave(false) };
        let mut bench = CountingBench { counter };
        calibrate(&mut bench);
        let answered = put_all(&mut bench);
        board::leave(answered)
    }
}

#[cfg(not(target_os = "none"))]
mod here {
    use std::process::ExitCode;

    use super::Bench;
    use crate::answer::{Answer, Note};

    /// Counts nothing.
    pub(crate) struct PrintingBench;

    impl Bench for PrintingBench {
        fn put<A: Answer>(&mut self, query: &str, actuator: &str, ask: impl FnOnce() -> A) -> A {
            let answer = ask();
            let Note { iterations, status, value, digest } = answer.note();
            println!("{query}\t{actuator}\t-\t{iterations}\t{status}\t{value:08x}\t{digest:08x}");
            answer
        }
    }

    /// Puts all queries; the exit code says whether all were answered.
    pub(crate) fn run(put_all: impl FnOnce(&mut PrintingBench) -> bool) -> ExitCode {
        if put_all(&mut PrintingBench) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
    }
}

pub(crate) use here::run;
