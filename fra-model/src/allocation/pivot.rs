//! Block pivoting: all limits that are wrong are exchanged at once.

use crate::number::real::Real;

use super::solve::Place;
use super::{Allocation, within};

/// Most exchanges of limits, and how many may go by without fewer wrong ones than ever before.
const PIVOTS: u32 = 16;
const PATIENCE: u32 = 3;

impl<T: Real, const R: usize, const N: usize> Allocation<T, R, N> {
    /// The minimum by exchanging all limits that are wrong at once, from those that the shares are at; `None` where that goes astray.
    /// `most`: how far beyond a limit a share may be, and how steep a gradient, to count as there and as none.
    pub(super) fn pivot(
        &self,
        mut place: Place<T, N>,
        linear: &[T; N],
        most: [T; 2],
        iterations: &mut u32,
    ) -> Option<Place<T, N>> {
        let (zero, one) = (T::zero(), T::one());
        for i in 0..self.count {
            place.held[i] = place.shares[i] <= zero || place.shares[i] >= one;
        }
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        for _ in 0..PIVOTS {
            *iterations += 1;
            let direction = self.direction(&place);
            for (share, by) in place.shares.iter_mut().zip(&direction.by).take(self.count) {
                *share += *by;
            }
            place.gradient = self.gradient(&place.shares, linear);
            let wrong = self.exchange(&mut place, most);
            place.gradient = self.gradient(&place.shares, linear);
            if wrong == 0 {
                return Some(place);
            }
            if wrong < fewest {
                (fewest, patience) = (wrong, PATIENCE);
            } else if patience == 0 {
                return None;
            } else {
                patience -= 1;
            }
        }
        None
    }

    /// Holds shares that are beyond a limit there, and frees those that their gradient pushes inwards; how many there were.
    fn exchange(&self, place: &mut Place<T, N>, most: [T; 2]) -> usize {
        let (zero, one) = (T::zero(), T::one());
        let [far, steep] = most;
        let mut wrong = 0;
        for i in 0..self.count {
            let (s, g) = (place.shares[i], place.gradient[i]);
            if place.held[i] {
                let inwards = if s <= zero { g < -steep } else { g > steep };
                place.held[i] = !inwards;
                wrong += usize::from(inwards);
            } else {
                let beyond = s < -far || s > one + far;
                place.held[i] = beyond;
                place.shares[i] = within(s);
                wrong += usize::from(beyond);
            }
        }
        wrong
    }
}
