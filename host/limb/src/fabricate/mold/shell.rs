//! Half a shell around a bore.
//!
//! Beside the bore, whose edge is as fine as its grooves, all other faces are ruled: from the bore's edge straight out to a line with as many
//! corners, and from there to the coarse outer surface.

use super::super::path::step_rad;
use super::clip::{Axis, Patch};
use super::mesh::{Mesh, at};

/// Where the line with as many corners as the bore's edge lies, as a share of the way to the outer surface.
const BETWEEN: f64 = 0.3;

/// Corners along a line: coordinate and number.
type Chain = Vec<(f64, u32)>;

/// The half of a shell between two angles and from the height 0 up, with a patch as its bore and the given outer radius.
pub(super) fn half_shell(
    bore: Patch,
    angles: [f64; 2],
    length_m: f64,
    [bore_m, outer_m]: [f64; 2],
    chord_m: f64,
) -> Mesh {
    let mut mesh = Mesh::default();
    for spot in &bore.spots {
        mesh.add(at(spot.radius_m, spot.place[0], spot.place[1]));
    }
    // The bore is seen from inside the circle.
    mesh.triangles.extend(bore.triangles.iter().map(|[a, b, c]| [*a, *c, *b]));
    let heights = [0.0, length_m];
    let between_m = bore_m + BETWEEN * (outer_m - bore_m);
    let [bottom, top] = heights.map(|height| bore.chain(Axis::Height, height));
    let [first, last] = angles.map(|angle| bore.chain(Axis::Angle, angle));
    let [bottom_out, top_out] = [(&bottom, 0.0), (&top, length_m)].map(|(chain, height)| -> Chain {
        chain.iter().map(|(angle, _)| (*angle, mesh.add(at(between_m, *angle, height)))).collect()
    });
    let [first_out, last_out] =
        [(&first, angles[0], 0), (&last, angles[1], bottom.len() - 1)].map(|(chain, angle, corner)| -> Chain {
            let ends = [bottom_out[corner].1, top_out[if corner == 0 { 0 } else { top_out.len() - 1 }].1];
            let last = chain.len() - 1;
            let number = |(index, height): (usize, f64)| match index {
                0 => ends[0],
                _ if index == last => ends[1],
                _ => mesh.add(at(between_m, angle, height)),
            };
            let heights: Vec<f64> = chain.iter().map(|(height, _)| *height).collect();
            let numbers: Vec<u32> = heights.iter().copied().enumerate().map(number).collect();
            heights.into_iter().zip(numbers).collect()
        });
    let sweep = angles[1] - angles[0];
    let sides = (sweep / step_rad(outer_m, chord_m).min(0.3)).ceil() as u32;
    let [bottom_rim, top_rim] = heights.map(|height| -> Chain {
        let angle =
            |side: u32| if side == sides { angles[1] } else { angles[0] + sweep * f64::from(side) / f64::from(sides) };
        (0..=sides).map(|side| (angle(side), mesh.add(at(outer_m, angle(side), height)))).collect()
    });
    let ends = |side: usize| vec![(0.0, bottom_rim[side].1), (length_m, top_rim[side].1)];
    let [first_rim, last_rim] = [ends(0), ends(sides as usize)];
    for [from, to] in [
        [&bottom_out, &bottom],
        [&bottom_rim, &bottom_out],
        [&top, &top_out],
        [&top_out, &top_rim],
        [&first, &first_out],
        [&first_out, &first_rim],
        [&last_out, &last],
        [&last_rim, &last_out],
        [&top_rim, &bottom_rim],
    ] {
        strip(&mut mesh, from, to);
    }
    mesh
}

/// Triangles between two lines, both in order; their normal is that of (from one line to the other) x (along the lines).
fn strip(mesh: &mut Mesh, from: &Chain, to: &Chain) {
    let (mut a, mut b) = (0, 0);
    while a + 1 < from.len() || b + 1 < to.len() {
        let here = [from[a].1, to[b].1];
        let along_from = b + 1 == to.len() || (a + 1 < from.len() && from[a + 1].0 <= to[b + 1].0);
        if along_from {
            a += 1
        } else {
            b += 1
        }
        mesh.triangles.push([here[0], here[1], if along_from { from[a].1 } else { to[b].1 }]);
    }
}
