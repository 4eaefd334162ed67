//! The setpoints of a run, checked for form.

use softlimb_protocol::{KnotStep, List, Outputs};

use super::error::LinkError;

/// One point of a trajectory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Knot {
    /// Time from the start of the run, us, by the device's clock; strictly increasing.
    pub time_us: u64,
    /// State of the digital outputs from then on.
    pub outputs: Outputs,
    /// One value per channel, in the wire unit of the channel's setpoint.
    pub values: Vec<i32>,
}

/// A knot that fits on the wire.
#[derive(Clone, Debug)]
pub(super) struct Checked {
    pub(super) time_us: u64,
    pub(super) outputs: Outputs,
    pub(super) values: List<i32>,
}

/// Knots that fit on the wire.
#[derive(Clone, Debug, Default)]
pub(super) struct Trajectory {
    knots: Vec<Checked>,
}

impl Trajectory {
    /// Checks the knots for `channels` channels and repeats the last one after `tail_us`, so that the device still has a setpoint when it
    /// learns what comes after the end.
    ///
    /// # Errors
    /// [`LinkError::EmptyTrajectory`], [`LinkError::KnotValues`] or [`LinkError::KnotTime`].
    pub(super) fn new(knots: &[Knot], channels: usize, tail_us: u64) -> Result<Self, LinkError> {
        let mut checked = Vec::with_capacity(knots.len() + 1);
        let mut before_us = None;
        for (index, knot) in knots.iter().enumerate() {
            let count = knot.values.len();
            let wrong_count = || LinkError::KnotValues { index, count, channels };
            if before_us.is_some_and(|before_us| knot.time_us <= before_us) {
                return Err(LinkError::KnotTime { index });
            }
            if count != channels {
                return Err(wrong_count());
            }
            before_us = Some(knot.time_us);
            let values = List::from_slice(&knot.values).map_err(|_| wrong_count())?;
            checked.push(Checked { time_us: knot.time_us, outputs: knot.outputs, values });
        }
        let last: Checked = checked.last().cloned().ok_or(LinkError::EmptyTrajectory)?;
        checked.push(Checked { time_us: last.time_us.saturating_add(tail_us), ..last });
        Ok(Self { knots: checked })
    }

    /// Adds a knot behind the last one.
    ///
    /// # Errors
    /// [`LinkError::KnotValues`] or [`LinkError::KnotTime`].
    pub(super) fn push(&mut self, knot: &Knot) -> Result<(), LinkError> {
        let (index, channels) = (self.knots.len(), self.knots.last().map_or(0, |last| last.values.len()));
        if self.knots.last().is_some_and(|last| knot.time_us <= last.time_us) {
            return Err(LinkError::KnotTime { index });
        }
        let values = List::from_slice(&knot.values).ok().filter(|values| values.len() == channels);
        let values = values.ok_or(LinkError::KnotValues { index, count: knot.values.len(), channels })?;
        self.knots.push(Checked { time_us: knot.time_us, outputs: knot.outputs, values });
        Ok(())
    }

    /// A knot by its number.
    pub(super) fn knot(&self, index: u32) -> Option<&Checked> {
        self.knots.get(index as usize)
    }

    /// A knot as its step from the preceding one; `None` for the first, and if the step is too large for the wire.
    pub(super) fn step(&self, index: u32) -> Option<KnotStep> {
        let (before, knot) = (self.knot(index.checked_sub(1)?)?, self.knot(index)?);
        let step =
            |(&value, &before): (&i32, &i32)| value.checked_sub(before).and_then(|step| i16::try_from(step).ok());
        let steps: Option<Vec<_>> = knot.values.iter().zip(before.values.iter()).map(step).collect();
        Some(KnotStep {
            step_us: u16::try_from(knot.time_us - before.time_us).ok()?,
            outputs: knot.outputs,
            steps: List::from_slice(&steps?).ok()?,
        })
    }

    /// Channels of each knot.
    pub(super) fn channels(&self) -> usize {
        self.knots.first().map_or(0, |knot| knot.values.len())
    }

    /// Knots, the repeated last one included.
    pub(super) fn len(&self) -> u32 {
        u32::try_from(self.knots.len()).unwrap_or(u32::MAX)
    }

    /// The shortest time that `capacity` knots in a row cover, us; `None` when all fit at once.
    pub(super) fn shortest_span_us(&self, capacity: usize) -> Option<u64> {
        self.knots.windows(capacity.max(1)).skip(1).map(|knots| knots[knots.len() - 1].time_us - knots[0].time_us).min()
    }

    #[cfg(test)]
    pub(super) fn from_pairs(knots: &[(u64, Vec<i32>)]) -> Self {
        let checked = |(time_us, values): &(u64, Vec<i32>)| Checked {
            time_us: *time_us,
            outputs: Outputs::default(),
            values: List::from_slice(values).unwrap(),
        };
        Self { knots: knots.iter().map(checked).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knots(times_us: &[u64]) -> Vec<Knot> {
        times_us.iter().map(|&time_us| Knot { time_us, outputs: Outputs::GRIPPER, values: vec![1, 2] }).collect()
    }

    #[test]
    fn last_knot_is_repeated() {
        let trajectory = Trajectory::new(&knots(&[0, 20_000]), 2, 500_000).unwrap();
        assert_eq!(trajectory.len(), 3);
        let Checked { time_us, outputs, values } = trajectory.knot(2).unwrap();
        assert_eq!((*time_us, *outputs, &values[..]), (520_000, Outputs::GRIPPER, &[1, 2][..]));
        assert!(trajectory.knot(3).is_none());
    }

    #[test]
    fn offending_knot_is_named() {
        assert!(matches!(Trajectory::new(&[], 2, 0), Err(LinkError::EmptyTrajectory)));
        let error = Trajectory::new(&knots(&[0, 20, 20]), 2, 0).unwrap_err();
        assert!(matches!(error, LinkError::KnotTime { index: 2 }));
        let error = Trajectory::new(&knots(&[0]), 3, 0).unwrap_err();
        assert!(matches!(error, LinkError::KnotValues { index: 0, count: 2, channels: 3 }));
    }

    #[test]
    fn knots_are_added_behind_the_last_one() {
        let mut trajectory = Trajectory::new(&knots(&[0]), 2, 10).unwrap();
        let knot = |time_us, values: &[i32]| Knot { time_us, outputs: Outputs::GRIPPER, values: values.to_vec() };
        trajectory.push(&knot(11, &[3, 4])).unwrap();
        assert_eq!((trajectory.len(), &trajectory.knot(2).unwrap().values[..]), (3, &[3, 4][..]));
        assert!(matches!(trajectory.push(&knot(11, &[3, 4])), Err(LinkError::KnotTime { index: 3 })));
        let error = trajectory.push(&knot(12, &[3])).unwrap_err();
        assert!(matches!(error, LinkError::KnotValues { index: 3, count: 1, channels: 2 }));
    }

    #[test]
    fn step_leads_from_knot_to_knot_where_it_fits() {
        let pairs =
            [(0, vec![5, -5]), (65_535, vec![32_772, -32_773]), (65_536, vec![65_540, 0]), (200_000, vec![65_540, 0])];
        let trajectory = Trajectory::from_pairs(&pairs);
        let step = trajectory.step(1).unwrap();
        assert_eq!((step.step_us, &step.steps[..]), (65_535, &[32_767, -32_768][..]));
        assert!([0, 2, 3, 4].iter().all(|&index| trajectory.step(index).is_none()), "first, far, late, behind the end");
        let far = Trajectory::from_pairs(&[(0, vec![i32::MIN]), (1, vec![i32::MAX])]);
        assert!(far.step(1).is_none());
    }

    #[test]
    fn densest_stretch_counts() {
        let trajectory = Trajectory::new(&knots(&[0, 10, 20, 25, 30, 100]), 2, 1_000).unwrap();
        assert_eq!(trajectory.shortest_span_us(3), Some(10));
        assert_eq!(trajectory.shortest_span_us(7), None);
    }
}
