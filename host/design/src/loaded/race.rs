//! Starts of a search that threads share: the first in order that leads to a limb wins, so that the answer does not depend on the threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::candidate::Candidate;

/// The starts, and the limbs that they have led to.
pub(super) struct Race {
    next: AtomicUsize,
    /// The start that ends the search, as far as it is known: starts behind it are given up, and none before it is.
    end: AtomicUsize,
    /// Refused limbs that end the search.
    refusals: usize,
    entered: Mutex<Entered>,
}

#[derive(Default)]
struct Entered {
    /// Limbs that keep every margin, with their starts.
    kept: Vec<(usize, Candidate)>,
    /// The best of the others.
    other: Option<(usize, Candidate)>,
}

impl Race {
    pub(super) fn new(refusals: usize) -> Self {
        let (next, end) = (AtomicUsize::new(0), AtomicUsize::new(usize::MAX));
        Self { next, end, refusals, entered: Mutex::default() }
    }

    /// The next of so many starts; `None` where there is none, or none that matters.
    pub(super) fn next(&self, starts: usize) -> Option<usize> {
        Some(self.next.fetch_add(1, Ordering::Relaxed)).filter(|index| *index < starts && !self.is_over_for(*index))
    }

    /// Whether a start matters no more.
    pub(super) fn is_over_for(&self, index: usize) -> bool {
        self.end.load(Ordering::Relaxed) < index
    }

    /// Takes the limb of a start.
    pub(super) fn enter(&self, index: usize, candidate: Candidate) {
        let mut entered = self.entered.lock().unwrap_or_else(PoisonError::into_inner);
        if candidate.keeps {
            entered.kept.push((index, candidate));
            entered.kept.sort_by_key(|(index, _)| *index);
            if let Some(end) = entered.end(self.refusals) {
                self.end.fetch_min(end, Ordering::Relaxed);
            }
            return;
        }
        let order = |(index, candidate): &(usize, Candidate)| (candidate.minimum.objective, *index);
        let own = (index, candidate);
        if entered.other.as_ref().is_none_or(|other| order(&own) < order(other)) {
            entered.other = Some(own);
        }
    }

    /// The limb of the first start that the planner does not refuse, or else the first refused one, or else the best other one; and how many refused ones
    /// are before it.
    pub(super) fn winner(self) -> Option<(Candidate, usize)> {
        let Entered { kept, other } = self.entered.into_inner().unwrap_or_else(PoisonError::into_inner);
        let end = self.end.into_inner();
        let mut kept: Vec<Candidate> =
            kept.into_iter().take_while(|(index, _)| *index <= end).map(|(_, limb)| limb).collect();
        let accepted = kept.iter().position(|limb| limb.refused.is_none());
        match (accepted, kept.is_empty()) {
            (Some(accepted), _) => Some((kept.swap_remove(accepted), accepted)),
            (None, false) => Some((kept.swap_remove(0), 0)),
            (None, true) => other.map(|(_, limb)| (limb, 0)),
        }
    }
}

impl Entered {
    /// The start that ends the search: the first accepted one, or the last of so many refused ones.
    fn end(&self, refusals: usize) -> Option<usize> {
        let accepted = self.kept.iter().position(|(_, limb)| limb.refused.is_none());
        let last = accepted.unwrap_or(usize::MAX).min(refusals - 1);
        self.kept.get(last).map(|(index, _)| *index)
    }
}
