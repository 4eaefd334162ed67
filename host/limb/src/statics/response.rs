//! What one tube that is not like the others does to the free shape of its bundle, to first order.
//!
//! The free shape is `K^-1 sum K_i x_i` with `K = sum K_i`, where `K_i` is the square form of a tube and `x_i` its own free shape. In a
//! bundle of equal tubes all `x_i` are the same, so that a change of a `K_i` moves nothing, and a change of an `x_i` moves `K^-1 K_i dx_i`.

use fra_model::Motion;
use nalgebra::{Matrix4, Vector4};

use super::bundle::energy;
use super::tube::Tangent;

/// Derivative of the free shape of a bundle of equal tubes, which plates do not hold back, by that of each tube, in its order: stretch, bends (rad/m) and twist (rad/m).
///
/// `None` where the bundle has no free shape.
pub(crate) fn responses(motion: Motion, places_m: &[[f64; 2]], tube: &Tangent) -> Option<Vec<Matrix4<f64>>> {
    let each: Vec<Matrix4<f64>> = places_m.iter().map(|place| energy(motion, *place, tube).0).collect();
    let whole = each.iter().sum::<Matrix4<f64>>().cholesky()?;
    Some(each.iter().map(|own| whole.solve(own)).collect())
}

/// Change of the free shape of a bundle's tube with a change of its own stretch, bend and twist rates.
pub(crate) fn shape_change(motion: Motion, [stretch, bend_rad_per_m, twist_rad_per_m]: [f64; 3]) -> Vector4<f64> {
    let twist_rad_per_m = if motion == Motion::Twisting { twist_rad_per_m } else { 0.0 };
    Vector4::new(stretch, bend_rad_per_m, 0.0, twist_rad_per_m)
}
