//! The lines of the table: a method for a motion in a scalar.

use std::hint::black_box;

use fra_model::Motion;

use super::measure::{self, Accuracy, Bench};
use super::method::{Method, methods};
use super::question::{Question, Scalar};
use super::set::MOTIONS;

/// Questions that cost is measured with: the first of the set, as many of each motion.
pub(super) const COST_QUESTIONS: usize = 32 * MOTIONS.len();

/// One line.
pub(super) struct Entry {
    method: Method,
    motion: Motion,
    single: bool,
}

/// All lines, in the order of the table.
pub(super) fn entries() -> Vec<Entry> {
    let of_method = |method: Method| {
        MOTIONS.into_iter().flat_map(move |motion| [false, true].map(|single| Entry { method, motion, single }))
    };
    methods().into_iter().flat_map(of_method).collect()
}

impl Entry {
    /// Problem, method, motion and scalar by name.
    pub(super) fn names(&self) -> [String; 4] {
        let scalar = if self.single { f32::NAME } else { f64::NAME };
        let words = [self.method.problem.name(), self.motion.name(), scalar].map(str::to_owned);
        let [problem, motion, scalar] = words;
        [problem, self.method.name(), motion, scalar]
    }

    /// How far off; `None` where the method does not apply.
    pub(super) fn accuracy(&self, questions: &[Question]) -> Option<Accuracy> {
        match self.single {
            true => measure::accuracy::<f32>(&self.method, questions, self.motion),
            false => measure::accuracy::<f64>(&self.method, questions, self.motion),
        }
    }

    /// The work whose cost is measured; `None` where the method does not apply to any of the first questions.
    pub(super) fn work(&self, questions: &[Question]) -> Option<Box<dyn Work>> {
        let (method, motion) = (&self.method, self.motion);
        let questions = &questions[..questions.len().min(COST_QUESTIONS)];
        match self.single {
            true => Bench::<f32>::new(method, questions, motion).map(|bench| Box::new(bench) as Box<dyn Work>),
            false => Bench::<f64>::new(method, questions, motion).map(|bench| Box::new(bench) as Box<dyn Work>),
        }
    }
}

/// Something that answers so many questions at a time.
pub(super) trait Work {
    fn answers(&self) -> usize;
    fn run(&self);
}

impl<T: Scalar> Work for Bench<T> {
    fn answers(&self) -> usize {
        self.len()
    }

    fn run(&self) {
        Bench::run(self);
    }
}

/// Work of known size, to tell whether the instruments count right: a polynomial of degree 8 takes 8 products and 8 sums.
pub(super) struct Polynomial;

impl Work for Polynomial {
    fn answers(&self) -> usize {
        1000
    }

    fn run(&self) {
        for _ in 0..self.answers() {
            let (x, mut value) = (black_box(0.3), black_box(1.0));
            for c in [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8] {
                value = value * x + c;
            }
            black_box(value);
        }
    }
}

/// Nanoseconds an answer takes: the least of several repetitions, each long enough for the clock (seconds).
pub(super) fn nanoseconds(work: &dyn Work, clock: &dyn Fn() -> f64) -> f64 {
    const REPETITIONS: u32 = 5;
    const LONG_ENOUGH_S: f64 = 1e-3;
    let once = |rounds: u32| {
        let begin = clock();
        for _ in 0..rounds {
            work.run();
        }
        clock() - begin
    };
    let mut rounds = 1;
    while once(rounds) < LONG_ENOUGH_S && rounds < 1 << 20 {
        rounds *= 2;
    }
    let least = (0..REPETITIONS).map(|_| once(rounds)).fold(f64::INFINITY, f64::min);
    least * 1e9 / (f64::from(rounds) * work.answers() as f64)
}
