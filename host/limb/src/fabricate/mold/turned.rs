//! Parts of revolution: a profile turned about the axis.

use std::f64::consts::TAU;

use super::super::path::step_rad;
use super::mesh::{Mesh, at};

/// The surface of a profile of radii and heights, m, with the part on the left of its line. It begins and ends on the axis, or is closed; other
/// points of it are off the axis. Corners lie on the surface itself, chords within `chord_m`.
pub(super) fn turned(profile: &[[f64; 2]], chord_m: f64) -> Mesh {
    let largest_m = profile.iter().map(|[radius_m, _]| *radius_m).fold(0.0, f64::max);
    let sides = (TAU / step_rad(largest_m, chord_m)).ceil().max(8.0) as usize;
    let mut mesh = Mesh::default();
    let rims: Vec<Vec<u32>> = profile
        .iter()
        .map(|[radius_m, height_m]| {
            let angle = |side: usize| TAU * side as f64 / sides as f64;
            let corners = if *radius_m == 0.0 { 1 } else { sides };
            (0..corners).map(|side| mesh.add(at(*radius_m, angle(side), *height_m))).collect()
        })
        .collect();
    let is_open = rims[0].len() == 1;
    let pairs = if is_open { rims.len() - 1 } else { rims.len() };
    for index in 0..pairs {
        let (from, to) = (&rims[index], &rims[(index + 1) % rims.len()]);
        for side in 0..sides {
            let corner = |rim: &[u32], side: usize| rim[side % rim.len()];
            let [a, b] = [corner(from, side), corner(from, side + 1)];
            let [c, d] = [corner(to, side), corner(to, side + 1)];
            if a != b {
                mesh.triangles.push([a, b, d]);
            }
            if c != d {
                mesh.triangles.push([a, d, c]);
            }
        }
    }
    mesh
}
