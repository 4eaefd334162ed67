//! Answers as columns, filled piece by piece on all processors.

use std::mem;
use std::num::NonZero;
use std::sync::{Mutex, OnceLock};
use std::thread;

use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use super::refused::Refusal;

/// Answers that a processor takes at a time where each is solved by itself.
pub(crate) const FEW: usize = 64;

/// Columns of whole and of floating-point numbers, one row an answer.
pub(crate) struct Table<const CODES: usize, const NUMBERS: usize> {
    codes: [Vec<i8>; CODES],
    counts: Vec<i32>,
    numbers: [Vec<f64>; NUMBERS],
}

/// Adjacent rows of a [`Table`].
pub(crate) struct Piece<'a, const CODES: usize, const NUMBERS: usize> {
    /// Index of the first row.
    pub(crate) from: usize,
    pub(crate) codes: [&'a mut [i8]; CODES],
    pub(crate) counts: &'a mut [i32],
    pub(crate) numbers: [&'a mut [f64]; NUMBERS],
}

impl<const CODES: usize, const NUMBERS: usize> Piece<'_, CODES, NUMBERS> {
    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.counts.len()
    }

    /// Writes one row; `row` counts from the piece's first.
    #[inline(always)]
    pub(crate) fn set(&mut self, row: usize, codes: [i8; CODES], count: u32, numbers: [f64; NUMBERS]) {
        for (column, code) in self.codes.iter_mut().zip(codes) {
            column[row] = code;
        }
        self.counts[row] = i32::try_from(count).unwrap_or(i32::MAX);
        for (column, number) in self.numbers.iter_mut().zip(numbers) {
            column[row] = number;
        }
    }
}

/// Columns as Python receives them: codes, counts, numbers.
pub(crate) type Arrays<'py> =
    (Vec<Bound<'py, PyArray1<i8>>>, Bound<'py, PyArray1<i32>>, Vec<Bound<'py, PyArray1<f64>>>);

impl<const CODES: usize, const NUMBERS: usize> Table<CODES, NUMBERS> {
    /// Fills `rows` rows by `work`, in pieces that begin at multiples of `group` and have at most `group` rows, each of them cut into parts of
    /// at most `part` rows.
    ///
    /// # Errors
    /// That of the first row that is refused.
    pub(crate) fn filled(
        rows: usize,
        group: usize,
        part: usize,
        work: impl Fn(&mut Piece<'_, CODES, NUMBERS>) -> Result<(), Refusal> + Sync,
    ) -> Result<Self, Refusal> {
        let mut table = Self {
            codes: [(); CODES].map(|()| vec![0; rows]),
            counts: vec![0; rows],
            numbers: [(); NUMBERS].map(|()| vec![0.0; rows]),
        };
        let pieces = table.pieces(group.max(1), part.max(1));
        on_processors(pieces, work)?;
        Ok(table)
    }

    fn pieces(&mut self, group: usize, part: usize) -> Vec<Piece<'_, CODES, NUMBERS>> {
        let rows = self.counts.len();
        let mut codes = self.codes.each_mut().map(Vec::as_mut_slice);
        let mut counts = self.counts.as_mut_slice();
        let mut numbers = self.numbers.each_mut().map(Vec::as_mut_slice);
        let (mut pieces, mut from) = (Vec::new(), 0);
        while from < rows {
            let end_of_group = (from / group + 1) * group;
            let length = part.min(end_of_group - from).min(rows - from);
            pieces.push(Piece {
                from,
                codes: codes.each_mut().map(|rest| first(rest, length)),
                counts: first(&mut counts, length),
                numbers: numbers.each_mut().map(|rest| first(rest, length)),
            });
            from += length;
        }
        pieces
    }

    /// The columns, moved to Python.
    pub(crate) fn into_arrays(self, py: Python<'_>) -> Arrays<'_> {
        let Self { codes, counts, numbers } = self;
        (
            codes.into_iter().map(|column| column.into_pyarray(py)).collect(),
            counts.into_pyarray(py),
            numbers.into_iter().map(|column| column.into_pyarray(py)).collect(),
        )
    }
}

/// The first values of the rest, which begins behind them from then on.
fn first<'a, T>(rest: &mut &'a mut [T], length: usize) -> &'a mut [T] {
    let (first, others) = mem::take(rest).split_at_mut(length);
    *rest = others;
    first
}

/// Asked once: to find out takes as long as many answers.
pub(crate) fn processors() -> usize {
    static PROCESSORS: OnceLock<usize> = OnceLock::new();
    *PROCESSORS.get_or_init(|| thread::available_parallelism().map_or(1, NonZero::get))
}

/// Works on every piece, each processor taking one when it is done with one.
fn on_processors<P: Send>(pieces: Vec<P>, work: impl Fn(&mut P) -> Result<(), Refusal> + Sync) -> Result<(), Refusal> {
    let threads = processors().min(pieces.len());
    let queue = Mutex::new(pieces.into_iter());
    let next = || queue.lock().ok().and_then(|mut pieces| pieces.next());
    // Pieces are taken in turn: the first refusal of the table is among the first ones of the threads.
    let run = || {
        while let Some(mut piece) = next() {
            work(&mut piece)?;
        }
        Ok(())
    };
    if threads < 2 {
        return run();
    }
    let outcomes = thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(run)).collect();
        let own = run();
        let others = others.into_iter().map(|other| other.join().expect("no panic in a solver"));
        others.chain([own]).collect::<Vec<_>>()
    });
    let refused = outcomes.into_iter().filter_map(Result::err);
    refused.min_by_key(|refusal| refusal.index).map_or(Ok(()), Err)
}

/// Fewest rows that are worth a thread.
const SHARE: usize = 256;

/// The results of `make` for every row, in order.
///
/// # Errors
/// That of the first row that is refused.
pub(crate) fn in_order<T: Send>(
    rows: usize,
    make: impl Fn(usize) -> Result<T, Refusal> + Sync,
) -> Result<Vec<T>, Refusal> {
    let threads = processors().min(rows / SHARE).max(1);
    if threads == 1 {
        return (0..rows).map(make).collect();
    }
    let share = rows.div_ceil(threads);
    let of = |from: usize| (from..rows.min(from + share)).map(&make).collect::<Result<Vec<T>, Refusal>>();
    let parts = thread::scope(|scope| {
        let others: Vec<_> = (1..threads)
            .map(|part| {
                let of = &of;
                scope.spawn(move || of(part * share))
            })
            .collect();
        let own = of(0);
        let others = others.into_iter().map(|other| other.join().expect("no panic while it builds"));
        [own].into_iter().chain(others).collect::<Result<Vec<_>, _>>()
    })?;
    let mut made = Vec::with_capacity(rows);
    parts.into_iter().for_each(|part| made.extend(part));
    Ok(made)
}
