//! What one tube that is not like the others does to the free shape of its bundle, to first order.
//!
//! The free shape is `K^-1 sum K_i x_i` with `K = sum K_i`, where `K_i` is the square form of a tube and `x_i` its own free shape. In a
//! bundle of equal tubes all `x_i` are the same, so that a change of a `K_i` moves nothing, and a change of an `x_i` moves `K^-1 K_i dx_i`.

use fra_model::Motion;
use nalgebra::{Matrix4, Vector4};

use super::bundle::energy;
use super::tube::Tangent;

/// Derivative of the free shape of a bundle of equal tubes by that of each tube, in its order: stretch, bends (rad/m) and twist (rad/m).
///
/// `None` where the bundle has no free shape.
pub(crate) fn responses(motion: Motion, places_m: &[[f64; 2]], tube: &Tangent) -> Option<Vec<Matrix4<f64>>> {
    let own = |place: &[f64; 2]| energy(motion, *place, tube).map(|(own, _)| own);
    let each: Vec<Matrix4<f64>> = places_m.iter().map(own).collect::<Option<_>>()?;
    let whole = each.iter().sum::<Matrix4<f64>>().cholesky()?;
    Some(each.iter().map(|own| whole.solve(own)).collect())
}

/// Change of the free shape of a tube at a distance from the axis of its bundle, m, with a change of its own stretch, bend and twist
/// rates. A tube of a twisting bundle is a helix, which takes up length.
pub(crate) fn shape_change(
    motion: Motion,
    distance_m: f64,
    tube: &Tangent,
    [stretch, bend_rad_per_m, twist_rad_per_m]: [f64; 3],
) -> Vector4<f64> {
    if motion != Motion::Twisting {
        return Vector4::new(stretch, bend_rad_per_m, 0.0, 0.0);
    }
    let around = distance_m * tube.twist_rad_per_m;
    let along = (tube.stretch * tube.stretch - around * around).sqrt();
    let change = (tube.stretch * stretch - distance_m * around * twist_rad_per_m) / along;
    Vector4::new(change, bend_rad_per_m, 0.0, twist_rad_per_m)
}
