//! Where the thread lies, point by point.
//!
//! By its arc length `s`, from the actuator's base: turned by `s cos a/R` about the axis, and at the height `s sin a`.

use std::f64::consts::TAU;

use softlimb_files::table;

use super::winding::{Hand, Winding};

/// A point of a thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Which of the threads side by side, from 0.
    pub start: u32,
    /// Angle about the axis from the direction of bending (`x`), rad, counted on over the turns.
    pub turn_rad: f64,
    /// Place, m; `z` along the axis from the base.
    pub place_m: [f64; 3],
    /// Length of thread from the base, m.
    pub arc_m: f64,
}

/// The points of all threads of one hand, in order, so close that chords stay within `chord_m` of the helix.
pub fn points(winding: &Winding, hand: Hand, chord_m: f64) -> Vec<Point> {
    let (sin, cos) = winding.angle_rad.sin_cos();
    let whole_turn = if hand == Hand::Straight { 0.0 } else { winding.thread_m() * cos / winding.radius_m };
    let steps = (whole_turn / step_rad(winding.radius_m, chord_m)).ceil().max(1.0) as u32;
    let sign = if hand == Hand::Left { -1.0 } else { 1.0 };
    let threads = (0..winding.starts).flat_map(|start| (0..=steps).map(move |step| (start, step)));
    threads
        .map(|(start, step)| {
            let share = f64::from(step) / f64::from(steps);
            let arc_m = winding.thread_m() * share;
            let turn_rad = TAU * f64::from(start) / f64::from(winding.starts) + sign * whole_turn * share;
            let (y, x) = turn_rad.sin_cos();
            let height_m = if hand == Hand::Straight { arc_m } else { arc_m * sin };
            Point { start, turn_rad, place_m: [winding.radius_m * x, winding.radius_m * y, height_m], arc_m }
        })
        .collect()
}

/// The points as comma-separated values with a line of names.
pub fn csv(points: &[Point]) -> String {
    let row = |point: &Point| {
        let [x, y, z] = point.place_m;
        [f64::from(point.start + 1), point.turn_rad.to_degrees(), x, y, z, point.arc_m].map(|value| value.to_string())
    };
    table::written(&["start", "turn_deg", "x_m", "y_m", "z_m", "arc_m"], points.iter().map(row))
}

/// Largest angle between points on a circle whose chord stays within a distance of it, rad.
pub(super) fn step_rad(radius_m: f64, chord_m: f64) -> f64 {
    2.0 * (1.0 - (chord_m / radius_m).min(1.0)).acos()
}
