//! Corrections of setpoints that take an error of the tip away, by the model's derivatives.

use std::ops::Range;

use fra_model::Motion;
use nalgebra::{DMatrix, DVector, Vector3};
use softlimb_limb::{Drive, Limb};

/// Least damping, m: below the camera's resolution.
const DAMPING_M: f64 = 0.1e-3;

/// What is corrected, and how the tip moves with it at a pose.
pub(crate) struct Columns<'a> {
    pub(crate) limb: &'a Limb,
    /// Drive and channels of all that is corrected alike.
    pub(crate) groups: &'a [(usize, Range<usize>)],
    /// Motion of the tip, m, with the whole range of each group.
    pub(crate) columns: &'a [Vector3<f64>],
}

impl Columns<'_> {
    /// Changes of the corrections of setpoints, one a group, with which a share `gain` of an error of the tip, m, goes away; setpoints end with
    /// their range.
    pub(crate) fn changes(&self, planned: &[f64], values: &[f64], error: &Vector3<f64>, gain: f64) -> Vec<f64> {
        let ranges: Vec<(f64, f64)> = self.groups.iter().map(|(drive, _)| self.range(*drive)).collect();
        // What a group has left towards both ends of its range, as a share of it.
        let left = planned.iter().zip(values).zip(&ranges).map(|((planned, value), (low, high))| {
            let wanted = (planned + value).clamp(*low, *high);
            [low - wanted, high - wanted].map(|left| left / (gain * (high - low)))
        });
        let shares = step(self.columns, &left.collect::<Vec<_>>(), error);
        shares.iter().zip(&ranges).map(|(share, (low, high))| gain * share * (high - low)).collect()
    }

    /// Least and largest setpoint of a drive.
    pub(crate) fn range(&self, drive: usize) -> (f64, f64) {
        let (rest, last) = self.limb.drive(drive).range();
        (rest.min(last), rest.max(last))
    }
}

/// Channels that are corrected alike, with their drive: single ones of extending actuators under weight, else those of a drive.
pub(crate) fn groups(limb: &Limb, weighed: bool) -> Vec<(usize, Range<usize>)> {
    let of_drive = |(index, drive): (usize, Drive<'_>)| {
        let channels = drive.channels.clone();
        let width = if weighed && drive.motion == Motion::Extension { 1 } else { channels.len() };
        channels.step_by(width).map(move |at| (index, at..at + width))
    };
    limb.drives().enumerate().flat_map(of_drive).collect()
}

/// Motion of the tip, m, with the whole range of each group, by its slopes and those of the setpoints with single actuators' pressures.
pub(crate) fn columns(
    limb: &Limb,
    groups: &[(usize, Range<usize>)],
    slopes: &[(Vector3<f64>, f64)],
) -> Vec<Vector3<f64>> {
    let column = |(drive, channels): &(usize, Range<usize>)| {
        let (rest, last) = limb.drive(*drive).range();
        let own = &slopes[channels.clone()];
        let slope = own[0].1;
        if slope == 0.0 {
            return Vector3::zeros();
        }
        own.iter().map(|(velocity, _)| velocity).sum::<Vector3<f64>>() * ((last - rest).abs() / slope)
    };
    groups.iter().map(column).collect()
}

/// The change of the setpoints, as shares of their ranges, that takes an error of the tip away, m; within what is left of each. A group
/// at the end of what is left stays there, and the others do what they can.
fn step(columns: &[Vector3<f64>], left: &[[f64; 2]], error: &Vector3<f64>) -> Vec<f64> {
    let mut shares = vec![None; columns.len()];
    loop {
        let done = columns.iter().zip(&shares).filter_map(|(column, share)| Some(column * share.as_ref().copied()?));
        let wanted = -error - done.sum::<Vector3<f64>>();
        let free: Vec<usize> = (0..columns.len()).filter(|group| shares[*group].is_none()).collect();
        if free.is_empty() {
            return shares.into_iter().map(Option::unwrap_or_default).collect();
        }
        let found = damped(&free.iter().map(|group| columns[*group]).collect::<Vec<_>>(), &wanted);
        let beyond = free.iter().zip(&found).filter_map(|(group, share)| {
            let [low, high] = left[*group];
            (*share < low || *share > high).then(|| (*group, share.clamp(low, high)))
        });
        let ended: Vec<(usize, f64)> = beyond.collect();
        let settled = if ended.is_empty() { free.into_iter().zip(found).collect() } else { ended };
        settled.into_iter().for_each(|(group, share)| shares[group] = Some(share));
    }
}

/// The shares whose sum of columns is `wanted`, m, as nearly as what hardly moves the tip is left alone.
fn damped(columns: &[Vector3<f64>], wanted: &Vector3<f64>) -> Vec<f64> {
    let count = columns.len();
    let mut matrix = DMatrix::zeros(3 + count, count);
    let damping = wanted.norm().max(DAMPING_M);
    for (index, column) in columns.iter().enumerate() {
        matrix.fixed_view_mut::<3, 1>(0, index).copy_from(column);
        matrix[(3 + index, index)] = damping;
    }
    let mut right = DVector::zeros(3 + count);
    right.fixed_rows_mut::<3>(0).copy_from(wanted);
    // Of full rank by its lower half.
    let shares = matrix.svd(true, true).solve(&right, 0.0);
    shares.map_or_else(|_| vec![0.0; count], |shares| shares.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FREE: [f64; 2] = [-1.0, 1.0];

    #[test]
    fn error_is_taken_away_by_who_can() {
        let (across, up) = (Vector3::x() * 0.1, Vector3::z() * 0.2);
        let error = Vector3::new(1e-3, 0.0, -2e-3);
        let found = step(&[across, up], &[FREE, FREE], &error);
        // Of 0.1 and 0.2 m by a whole range; damping by the error takes 0.05 % of the first and less of the second.
        assert!((found[0] + 0.01).abs() < 1e-5 && (found[1] - 0.01).abs() < 1e-5, "{found:?}");
        let ended = step(&[across, across, up], &[[0.0, 1.0], FREE, FREE], &error);
        assert_eq!(ended[0], 0.0, "it has nothing left that way");
        assert!((ended[1] + 0.01).abs() < 1e-5 && (ended[2] - 0.01).abs() < 1e-5, "{ended:?}");
        assert_eq!(step(&[across], &[[0.0, 0.0]], &error), [0.0]);
        assert_eq!(step(&[Vector3::zeros()], &[FREE], &Vector3::zeros()), [0.0]);
    }
}
