//! The parts of the mold: a core for the chamber, two half shells whose ridges leave the groove for the thread, and a smooth half shell for
//! the cover over the winding.
//!
//! Every part is a closed surface of triangles: each edge belongs to exactly two, which run along it in opposite directions. Corners lie on
//! the surface itself, chords within the given distance of it; so a core is too thin and a shell too wide by at most that. The bore of a
//! grooved shell is meshed along the threads of both hands ([`lattice`]), so that grooves and their crossings are edges of the mesh.

mod clip;
mod lattice;
mod mesh;
mod shell;

use std::f64::consts::{PI, TAU};

pub use mesh::Mesh;

use super::path::step_rad;
use super::{Piece, Settings};
use lattice::{Lattice, Profile};
use shell::half_shell;
use softlimb_files::range::{OutOfRange, require};

/// How far the core reaches beyond the actuator on either side, m.
pub const HOLD_M: f64 = 0.02;
/// Thickness of a shell, m, or as a share of its bore's radius, whichever is more.
const SHELL: (f64, f64) = (5e-3, 0.2);
/// Most triangles a part may have.
const MOST_TRIANGLES: f64 = 4e6;

/// A part of the mold.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its name, as in [`names`].
    pub name: &'static str,
    /// Its surface.
    pub mesh: Mesh,
}

/// The parts for one kind of actuator, and how many of each are needed.
pub fn names(piece: &Piece) -> Vec<(&'static str, u32)> {
    let mut names = vec![("core", 1), ("shell-a", 1), ("shell-b", 1)];
    names.extend(has_cover(piece).then_some(("cover", 2)));
    names
}

/// All parts for one kind of actuator.
///
/// # Errors
/// [`OutOfRange`] for `chord_m` where a part would have more than four million triangles.
pub fn parts(piece: &Piece, settings: &Settings) -> Result<Vec<Part>, OutOfRange> {
    let chord_m = settings.chord_m;
    let [a, b] = shells(piece, chord_m)?;
    let meshes = [core(piece, chord_m), a, b].into_iter().chain(has_cover(piece).then(|| cover(piece, chord_m)));
    Ok(names(piece).into_iter().zip(meshes).map(|((name, _), mesh)| Part { name, mesh }).collect())
}

/// Whether there is a second cast.
fn has_cover(piece: &Piece) -> bool {
    piece.cover_m() > 1e-9
}

/// The core of the chamber: a rod of the inner radius, [`HOLD_M`] longer than the actuator on either side, from `z = -HOLD_M` up.
pub fn core(piece: &Piece, chord_m: f64) -> Mesh {
    let radius_m = piece.parameters.inner_radius_m;
    let sides = (TAU / step_rad(radius_m, chord_m)).ceil().max(8.0) as u32;
    let mut mesh = Mesh::default();
    let heights = [-HOLD_M, piece.parameters.length_m + HOLD_M];
    let [bottom, top] = heights.map(|height| mesh.add([0.0, 0.0, height]));
    let angle = |side: u32| TAU * f64::from(side % sides) / f64::from(sides);
    let rims = heights.map(|height| -> Vec<u32> {
        (0..sides).map(|side| mesh.add(mesh::at(radius_m, angle(side), height))).collect()
    });
    for side in 0..sides as usize {
        let next = (side + 1) % sides as usize;
        let [[a, b], [c, d]] = [[rims[0][side], rims[0][next]], [rims[1][side], rims[1][next]]];
        mesh.triangles.extend([[a, b, d], [a, d, c], [bottom, b, a], [top, c, d]]);
    }
    mesh
}

/// The two halves of the shell of the first cast, with a ridge where the thread will lie; parted at the direction of bending and opposite
/// to it, over the length of the actuator.
///
/// # Errors
/// [`OutOfRange`] for `chord_m` where a half would have more than four million triangles.
pub fn shells(piece: &Piece, chord_m: f64) -> Result<[Mesh; 2], OutOfRange> {
    let lattice = Lattice::new(&Profile::of(piece), piece.cast_radius_m, chord_m);
    let length_m = piece.parameters.length_m;
    let triangles = lattice.triangles(PI, length_m);
    let allowed = format!("larger: a part would have {:.0} million triangles, 4 are allowed", triangles * 1e-6);
    require(triangles <= MOST_TRIANGLES, "chord_m", chord_m, allowed)?;
    Ok([[0.0, PI], [PI, TAU]].map(|range| half(&lattice, range, length_m, chord_m)))
}

/// Half of the smooth shell of the second cast, over the length of the actuator; both halves are equal.
pub fn cover(piece: &Piece, chord_m: f64) -> Mesh {
    let lattice = Lattice::new(&Profile::plain(), piece.parameters.outer_radius_m, chord_m);
    half(&lattice, [0.0, PI], piece.parameters.length_m, chord_m)
}

fn half(lattice: &Lattice, range: [f64; 2], length_m: f64, chord_m: f64) -> Mesh {
    let radius_m = lattice.surface_m();
    let outer_m = shell_radius_m(radius_m);
    half_shell(lattice.patch(range, length_m), range, length_m, [radius_m, outer_m], chord_m)
}

/// Outer radius of a shell around a bore of the radius, m.
pub fn shell_radius_m(bore_m: f64) -> f64 {
    bore_m + f64::max(SHELL.0, SHELL.1 * bore_m)
}
