//! Across the wall: mesh lines, and the layer that carries a smeared winding. Lengths in mm, stresses in MPa.

use std::ops::Range;

use fra_model::{ActuatorParameters, Material, Placement};

use super::plan::Wound;
use super::{FemError, FiberModel, Options};
use crate::spacing::evenly;
use softlimb_files::range::require;

/// Fibers as a material, per family.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Smeared {
    /// `mu2`, MPa.
    pub(crate) modulus: f64,
    /// Share of the elastomer in the layer: less than 1 where it straddles the surface.
    pub(crate) matrix: f64,
    /// Thickness of the layer, mm.
    pub(crate) thickness: f64,
    /// Fibers alone, on top of elements of the wall.
    pub(crate) overlay: bool,
}

type Radial = (Vec<f64>, usize, Range<usize>, Option<Smeared>);

/// Radii from the axis outwards, which of them is the lumen's, the elements of the winding, and its stiffness.
pub(crate) fn radial(
    p: &ActuatorParameters<f64>,
    options: &Options,
    wound: Option<&Wound>,
    threads: bool,
) -> Result<Radial, FemError> {
    let (inner, outer) = (p.inner_radius_m * 1e3, p.outer_radius_m * 1e3);
    let count = options.radial.unwrap_or(2) as usize;
    let wall = outer - inner;
    let stiff = matches!(p.material, Material::Yeoh { .. });
    let mut smeared = wound.filter(|_| !threads).map(|wound| Smeared {
        modulus: wound.modulus,
        matrix: 1.0,
        thickness: match wound.placement {
            Placement::Layer => outer - wound.radius,
            Placement::Smeared | Placement::Sheet => wall,
        },
        overlay: stiff,
    });
    let band = match (wound, &mut smeared) {
        (Some(wound), Some(smeared)) => match wound.placement {
            Placement::Smeared => [inner, outer],
            Placement::Layer => [wound.radius, outer],
            Placement::Sheet => {
                let (low, thickness) = straddle(wound.radius, [inner, outer], layer_thickness(options, wall)?);
                smeared.modulus *= wound.thickness / thickness;
                smeared.matrix = (outer.min(low + thickness) - low) / thickness;
                smeared.thickness = thickness;
                smeared.overlay = false;
                [low, low + thickness]
            }
        },
        (Some(wound), None) => [wound.radius, wound.radius],
        _ => [outer, outer],
    };
    let mut radii = vec![0.0, 0.5 * inner, inner];
    let lumen = 2;
    let thin = band[1] - band[0] < 0.5 * wall;
    let rest = (wall - if thin { band[1].min(outer) - band[0] } else { 0.0 }).max(1e-12);
    let parts = |from: f64, to: f64| ((count as f64 * (to - from) / rest).round() as usize).max(1);
    let mut layer = lumen..lumen;
    for (n, [from, to]) in [[inner, band[0]], band, [band[1], outer]].into_iter().enumerate() {
        if to - from <= 1e-9 * outer {
            continue;
        }
        let begin = radii.len() - 1;
        let elements = if n == 1 && thin { 1 } else { parts(from, to) };
        radii.extend(evenly(from, to, elements).skip(1));
        if n == 1 {
            layer = begin..radii.len() - 1;
        }
    }
    Ok((radii, lumen, layer, smeared))
}

fn layer_thickness(options: &Options, wall: f64) -> Result<f64, FemError> {
    let FiberModel::Smeared { layer_m } = options.fibers else { return Ok(wall) };
    let thickness = layer_m.map_or_else(|| f64::min(0.05, 0.02 * wall), |m| m * 1e3);
    require(
        thickness >= 1e-3 * wall && thickness <= 0.5 * wall,
        "layer_mm",
        thickness,
        format!("{:.4} to {:.4} mm, a thousandth to one half of the wall", 1e-3 * wall, 0.5 * wall),
    )?;
    Ok(thickness)
}

/// Start and thickness of a layer that is centred on a radius: on a face of the wall half of it sticks out, on the inner face
/// it lies within; next to a face it is as thin as it must be.
fn straddle(radius: f64, [inner, outer]: [f64; 2], thickness: f64) -> (f64, f64) {
    let (below, above) = (radius - inner, outer - radius);
    let least = 1e-3 * (outer - inner);
    if above < least {
        (outer - 0.5 * thickness, thickness)
    } else if below < least {
        (inner, thickness)
    } else {
        let thickness = thickness.min(2.0 * below).min(2.0 * above);
        (radius - 0.5 * thickness, thickness)
    }
}

/// The lattice index, of a line or of a midpoint, nearest to a radius.
pub(crate) fn nearest(radii: &[f64], radius: f64) -> usize {
    let at = |i: usize| 0.5 * (radii[i / 2] + radii[i.div_ceil(2)]);
    let off = |i: &usize| (at(*i) - radius).abs();
    (0..2 * radii.len() - 1).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
}
