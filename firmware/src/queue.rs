//! The buffer of setpoint knots between link and control: accepts in order, interpolates linearly, never skips or repeats.

use heapless::{Deque, Vec};
use softlimb_protocol::{MAX_CHANNELS, Outputs};

/// Places in the buffer: 1.28 s at 50 knots a second.
pub const KNOTS: usize = 64;

/// One knot: the setpoints of all channels at one time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Knot<const N: usize> {
    pub(crate) time_us: u64,
    outputs: Outputs,
    pub(crate) values: Vec<i32, N>,
}

/// Why a knot was not accepted. Nothing of a refused knot is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueueError {
    /// Not the next index.
    UnexpectedIndex {
        /// The next index.
        expected: u32,
    },
    /// No free place.
    Full,
    /// Not in the future, or not after the previous knot.
    Late,
}

impl core::fmt::Display for QueueError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::UnexpectedIndex { expected } => write!(f, "knot {expected} is expected next"),
            Self::Full => f.write_str("no free place in the setpoint buffer"),
            Self::Late => f.write_str("the knot is not in the future or not after the previous one"),
        }
    }
}

impl core::error::Error for QueueError {}

/// The buffer.
#[derive(Clone, Debug)]
pub struct KnotQueue<const N: usize = MAX_CHANNELS> {
    knots: Deque<Knot<N>, KNOTS>,
    /// The knot passed last: the left end of the interpolation.
    passed: Option<Knot<N>>,
    next_index: u32,
    last_time_us: u64,
}

impl<const N: usize> KnotQueue<N> {
    /// Empty; the next index is 0.
    pub const fn new() -> Self {
        Self { knots: Deque::new(), passed: None, next_index: 0, last_time_us: 0 }
    }

    /// Takes a knot for a time in the future of `now_us`.
    ///
    /// # Errors
    /// [`QueueError`]; the buffer is then as before.
    pub fn push(
        &mut self,
        now_us: u64,
        index: u32,
        time_us: u64,
        (outputs, values): (Outputs, Vec<i32, N>),
    ) -> Result<(), QueueError> {
        if index != self.next_index {
            return Err(QueueError::UnexpectedIndex { expected: self.next_index });
        }
        if self.knots.is_full() {
            return Err(QueueError::Full);
        }
        if time_us <= now_us || time_us <= self.last_time_us {
            return Err(QueueError::Late);
        }
        self.knots.push_back(Knot { time_us, outputs, values }).map_err(|_| QueueError::Full)?;
        self.next_index = index.wrapping_add(1);
        self.last_time_us = time_us;
        Ok(())
    }

    /// The knot accepted last, passed or not; `None` after a flush.
    pub(crate) fn last(&self) -> Option<&Knot<N>> {
        self.knots.back().or(self.passed.as_ref())
    }

    /// Forgets the `count` knots accepted last, none of which was passed.
    pub(crate) fn take_back(&mut self, count: u32) {
        for _ in 0..count {
            self.knots.pop_back();
        }
        self.next_index = self.next_index.wrapping_sub(count);
        self.last_time_us = self.last().map_or(0, |knot| knot.time_us);
    }

    /// Drops everything; the next index is 0.
    pub fn flush(&mut self) {
        self.knots.clear();
        self.passed = None;
        self.next_index = 0;
        self.last_time_us = 0;
    }

    /// Forgets the knot passed last: nothing is interpolated from before a pause.
    pub fn resume(&mut self) {
        self.passed = None;
    }

    /// Moves on to `now_us`: knots whose time has come are passed. The outputs of the last of them, if there is one.
    pub fn advance(&mut self, now_us: u64) -> Option<Outputs> {
        let mut outputs = None;
        while self.knots.front().is_some_and(|knot| knot.time_us <= now_us) {
            self.passed = self.knots.pop_front();
            outputs = self.passed.as_ref().map(|knot| knot.outputs);
        }
        outputs
    }

    /// Value of one channel at `time_us`, in the unit of its setpoint: linear between two knots, the last value after the last
    /// knot, `None` before the first.
    pub fn value(&self, channel: usize, time_us: u64) -> Option<f32> {
        let mut before = self.passed.as_ref();
        for knot in &self.knots {
            if knot.time_us > time_us {
                return interpolate(before?, knot, channel, time_us);
            }
            before = Some(knot);
        }
        before?.values.get(channel).map(|&value| value as f32)
    }

    /// Time of the first knot that was not passed yet, us.
    pub fn first_time_us(&self) -> Option<u64> {
        self.knots.front().map(|knot| knot.time_us)
    }

    /// Whether no knot is left to go to.
    pub fn is_exhausted(&self) -> bool {
        self.knots.is_empty()
    }

    /// Free places.
    pub fn free(&self) -> u16 {
        // At most KNOTS.
        (KNOTS - self.knots.len()) as u16
    }

    /// The index that is accepted next.
    pub fn next_index(&self) -> u32 {
        self.next_index
    }
}

impl<const N: usize> Default for KnotQueue<N> {
    fn default() -> Self {
        Self::new()
    }
}

fn interpolate<const N: usize>(before: &Knot<N>, after: &Knot<N>, channel: usize, time_us: u64) -> Option<f32> {
    let (from, to) = (*before.values.get(channel)? as f32, *after.values.get(channel)? as f32);
    let span = after.time_us.saturating_sub(before.time_us).max(1) as f32;
    let share = time_us.saturating_sub(before.time_us) as f32 / span;
    Some(from + (to - from) * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values<const N: usize, const COUNT: usize>(values: [i32; COUNT]) -> Vec<i32, N> {
        Vec::from_slice(&values).unwrap()
    }

    const OFF: Outputs = Outputs::from_bits(0);

    fn filled(times_and_values: &[(u64, i32)]) -> KnotQueue {
        let mut queue = KnotQueue::new();
        for (index, &(time_us, value)) in times_and_values.iter().enumerate() {
            queue.push(0, index as u32, time_us, (OFF, values([value, -value]))).unwrap();
        }
        queue
    }

    #[test]
    fn values_are_linear_between_knots_and_constant_after_the_last() {
        let mut queue = filled(&[(100, 0), (200, 1_000), (300, 500)]);
        assert_eq!(queue.value(0, 99), None);
        assert_eq!(queue.value(0, 100), Some(0.0));
        queue.advance(120);
        for (time_us, value) in [(150, 500.0), (200, 1_000.0), (275, 625.0), (300, 500.0), (9_999, 500.0)] {
            assert_eq!(queue.value(0, time_us), Some(value), "{time_us}");
            assert_eq!(queue.value(1, time_us), Some(-value), "{time_us}");
        }
        assert_eq!(queue.value(2, 150), None, "no such channel");
    }

    #[test]
    fn knot_is_passed_when_its_time_comes_and_the_last_one_exhausts_the_buffer() {
        let mut queue = filled(&[(100, 1), (200, 2)]);
        queue.advance(99);
        assert_eq!(queue.free(), 62);
        queue.advance(100);
        assert_eq!(queue.free(), 63);
        assert!(!queue.is_exhausted());
        queue.advance(200);
        assert!(queue.is_exhausted());
        assert_eq!(queue.value(0, 250), Some(2.0));
    }

    #[test]
    fn outputs_are_those_of_the_last_knot_passed() {
        let mut queue = KnotQueue::<1>::new();
        let all = [(100, Outputs::GRIPPER), (200, OFF), (300, Outputs::GRIPPER)];
        for (index, (time_us, outputs)) in (0..).zip(all) {
            queue.push(0, index, time_us, (outputs, values([0]))).unwrap();
        }
        assert_eq!(queue.advance(99), None);
        assert_eq!(queue.advance(100), Some(Outputs::GRIPPER));
        assert_eq!(queue.advance(199), None, "nothing new");
        assert_eq!(queue.advance(250), Some(OFF));
        queue.push(250, 3, 301, (OFF, values([0]))).unwrap();
        assert_eq!(queue.advance(400), Some(OFF), "two at once");
    }

    #[test]
    fn duplicates_and_gaps_name_the_expected_index() {
        let mut queue = filled(&[(100, 1)]);
        for index in [0, 2, u32::MAX] {
            assert_eq!(queue.push(0, index, 500, (OFF, values([1]))), Err(QueueError::UnexpectedIndex { expected: 1 }));
        }
        assert_eq!(queue.push(0, 1, 500, (OFF, values([1]))), Ok(()));
    }

    #[test]
    fn late_knots_are_refused_and_can_be_sent_again_in_time() {
        let mut queue = filled(&[(100, 1)]);
        assert_eq!(queue.push(50, 1, 100, (OFF, values([1]))), Err(QueueError::Late), "not after the previous one");
        assert_eq!(queue.push(300, 1, 300, (OFF, values([1]))), Err(QueueError::Late), "not in the future");
        assert_eq!(queue.push(300, 1, 301, (OFF, values([1]))), Ok(()));
    }

    #[test]
    fn full_buffer_refuses_and_keeps_what_it_has() {
        let mut queue = KnotQueue::<1>::new();
        for index in 0..KNOTS as u32 {
            queue.push(0, index, 1_000 + u64::from(index), (OFF, values([index as i32]))).unwrap();
        }
        assert_eq!(queue.free(), 0);
        assert_eq!(queue.push(0, 64, 9_000, (OFF, values([0]))), Err(QueueError::Full));
        assert_eq!(queue.value(0, 1_000), Some(0.0));
        queue.advance(1_000);
        assert_eq!(queue.push(0, 64, 9_000, (OFF, values([0]))), Ok(()));
    }

    #[test]
    fn flushing_restarts_the_index_and_the_time() {
        let mut queue = filled(&[(1_000, 1), (2_000, 2)]);
        queue.flush();
        assert_eq!((queue.free(), queue.next_index()), (64, 0));
        assert_eq!(queue.push(0, 0, 10, (OFF, values([5]))), Ok(()));
    }

    #[test]
    fn after_a_pause_nothing_is_interpolated_from_before_it() {
        let mut queue = filled(&[(100, 0)]);
        queue.advance(100);
        queue.push(100, 1, 1_000, (OFF, values([900]))).unwrap();
        assert_eq!(queue.value(0, 550), Some(450.0));
        queue.resume();
        assert_eq!(queue.value(0, 550), None);
        assert_eq!(queue.value(0, 1_000), Some(900.0));
    }
}
