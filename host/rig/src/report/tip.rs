//! Errors of the tip: where it rests, and beside the plane that it is meant to stay in.

use nalgebra::{Matrix3, Vector3};

use super::stats::ErrorStats;
use crate::record::{PhaseInfo, RunLog, Sample};

/// Time at the end of a hold over which the tip's position counts, s, and the shortest hold: the tip has settled by then.
const WINDOW_S: f64 = 0.2;
const REST_S: f64 = 0.5;
/// Distance from a plane of a setpoint that lies in it, m.
const PLANAR_M: f64 = 1e-3;
/// Extent of setpoints along a second direction, RMS, m, from which they determine a plane.
const WIDE_M: f64 = 1e-2;

/// Mean error of the tip at the end of each hold of 0.5 s or more: over its last 0.2 s.
pub(super) fn at_holds_m(log: &RunLog) -> Option<ErrorStats> {
    let holds = log.info.phases.iter().filter(|phase| phase.hold_s >= REST_S);
    let at_end = |phase: &PhaseInfo| {
        let within = |sample: &&Sample| sample.time_s > phase.end_s() - WINDOW_S && sample.time_s <= phase.end_s();
        let errors: Option<Vec<_>> = log.samples.iter().filter(within).map(error_m).collect();
        let errors = errors.filter(|errors| !errors.is_empty())?;
        Some((errors.iter().sum::<Vector3<f64>>() / errors.len() as f64).norm())
    };
    ErrorStats::of(holds.filter_map(at_end))
}

/// Error of the tip across the plane of the setpoints' centre lines; `None` where these lie in no plane, or in more than one.
pub(super) fn across_m(log: &RunLog, samples: &[&Sample]) -> Option<ErrorStats> {
    let points: Vec<Vector3<f64>> =
        log.shapes.iter().flat_map(|shape| &shape.setpoint).map(|point| (*point).into()).collect();
    let normal = normal(&points)?;
    ErrorStats::of(samples.iter().filter_map(|sample| Some(error_m(sample)?.dot(&normal))))
}

/// Achieved less setpoint.
fn error_m(sample: &Sample) -> Option<Vector3<f64>> {
    Some(Vector3::from(sample.tip_achieved_m?) - Vector3::from(sample.tip_setpoint_m))
}

/// The normal of the plane that points lie in.
fn normal(points: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    let count = points.len().max(1) as f64;
    let middle = points.iter().sum::<Vector3<f64>>() / count;
    let spread = |point: &Vector3<f64>| (point - middle) * (point - middle).transpose() / count;
    let spread: Matrix3<f64> = points.iter().map(spread).sum();
    if !spread.iter().all(|value| value.is_finite()) {
        return None;
    }
    let eigen = spread.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let normal: Vector3<f64> = eigen.eigenvectors.column(least).into();
    let wide = (0..3).all(|axis| axis == least || eigen.eigenvalues[axis].max(0.0).sqrt() >= WIDE_M);
    (wide && points.iter().all(|point| (point - middle).dot(&normal).abs() <= PLANAR_M)).then_some(normal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_plane_have_its_normal_and_those_of_a_line_or_of_space_none() {
        let along = |u: f64, v: f64| Vector3::new(0.1, 0.2, 0.3) + u * Vector3::new(0.6, 0.8, 0.0) + v * Vector3::z();
        let of = |points: &[[f64; 2]]| points.iter().map(|[u, v]| along(*u, *v)).collect::<Vec<_>>();
        let plane = of(&[[0.0, 0.0], [0.3, 0.0], [0.1, 0.2], [0.2, 0.4]]);
        let found = normal(&plane).unwrap();
        assert!((found.dot(&Vector3::new(0.8, -0.6, 0.0)).abs() - 1.0).abs() < 1e-12, "{found}");
        assert_eq!(normal(&of(&[[0.0, 0.0], [0.3, 0.0], [0.5, 0.001]])), None, "a line");
        let mut space = plane;
        space.push(Vector3::new(0.8, -0.6, 0.0) * 0.01 + along(0.1, 0.1));
        assert_eq!(normal(&space), None);
        assert_eq!(normal(&[]), None);
    }
}
