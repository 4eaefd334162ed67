//! The parts to print. Of the mold: a core for the chamber, two half shells whose ridges leave the groove for the thread, a smooth half shell for
//! the cover over the winding, and bases that hold core and shells in line. Of the limb: caps, one with a port for the hose, and plates that take
//! the actuators of a module, which are glued back to back to those of the next.
//!
//! Every part is a closed surface of triangles: each edge belongs to exactly two, which run along it in opposite directions. Corners lie on
//! the surface itself, chords within the given distance of it; so a core is too thin and a shell too wide by at most that. The bore of a
//! grooved shell is meshed along the threads of both hands ([`lattice`]), so that grooves and their crossings are edges of the mesh.

mod clip;
mod lattice;
mod mesh;
mod plate;
mod shell;
mod turned;

use std::f64::consts::{PI, TAU};

pub use mesh::Mesh;

use super::{Piece, Settings};
use lattice::{Lattice, Profile};
use plate::Plate;
use shell::half_shell;
use softlimb_files::range::{OutOfRange, require};
use turned::turned;

/// How far the core reaches beyond the actuator on either side, m.
pub const HOLD_M: f64 = 0.02;
/// Thickness of a shell, m, or as a share of its bore's radius, whichever is more.
const SHELL: (f64, f64) = (5e-3, 0.2);
/// Gap between parts that go into each other, m.
pub const FIT_M: f64 = 1e-4;
/// Depth of the recess for the shells in a base, m.
pub const RECESS_M: f64 = 5e-3;
/// Thickness of the rim around it, m.
const RIM_M: f64 = 4e-3;
/// Thickness of a cap, m.
pub const CAP_M: f64 = 3e-3;
/// Length of the spigot of a cap that is glued into the chamber, m.
pub const SPIGOT_M: f64 = 6e-3;
/// Inner diameter of the hose where none is given, m, and over that of the chamber at most.
const HOSE: (f64, f64) = (3e-3, 0.75);
/// Length of the nipple for the hose, m, and radii of its bore and its barb over that of the hose.
pub const NIPPLE_M: f64 = 1e-2;
const BORE: f64 = 0.55;
const BARB: f64 = 1.15;
/// Depth of the sockets for the actuators in a plate, m, and least thickness of the plate behind them and without them.
pub const SOCKET_M: f64 = 5e-3;
const FLOOR_M: f64 = 2e-3;
const FLAT_M: f64 = 3e-3;
/// Least wall between two sockets, and between them and the edge of the plate, m.
const WALL_M: f64 = 8e-4;
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
    let copies = piece.copies.len() as u32;
    let all = [
        ("core", 1),
        ("shell-a", 1),
        ("shell-b", 1),
        ("base", 1),
        ("cover", 2),
        ("cover-base", 1),
        ("cap", copies),
        ("port", copies),
        ("connector", 2),
    ];
    all.into_iter().filter(|(name, _)| has(piece, name)).collect()
}

/// All parts for one kind of actuator.
///
/// # Errors
/// [`OutOfRange`] for `chord_m` where a part would have more than four million triangles, and for `hose_m` where the hose is wider than the
/// chamber.
pub fn parts(piece: &Piece, settings: &Settings) -> Result<Vec<Part>, OutOfRange> {
    let chord_m = settings.chord_m;
    let [a, b] = shells(piece, chord_m)?;
    let ends = piece.has_ends();
    let mut meshes = Vec::from_iter(ends.then(|| core(piece, chord_m)));
    meshes.extend([a, b]);
    meshes.extend(ends.then(|| base(piece, piece.cast_radius_m, chord_m)));
    if has_cover(piece) {
        meshes.push(cover(piece, chord_m));
        meshes.extend(ends.then(|| base(piece, piece.parameters.outer_radius_m, chord_m)));
    }
    if ends {
        meshes.extend([cap(piece, chord_m), port(piece, settings)?, connector(piece, settings)]);
    }
    Ok(names(piece).into_iter().zip(meshes).map(|((name, _), mesh)| Part { name, mesh }).collect())
}

/// Whether a part is among those of a piece: the shells of a segment stand on those of the one below.
fn has(piece: &Piece, name: &str) -> bool {
    let is_shell = ["shell-a", "shell-b", "cover"].contains(&name);
    (is_shell || piece.has_ends()) && (has_cover(piece) || !name.starts_with("cover"))
}

/// Whether there is a second cast.
fn has_cover(piece: &Piece) -> bool {
    piece.cover_m() > 1e-9
}

/// The core of the chamber: a rod of the inner radius, [`HOLD_M`] longer than the whole actuator on either side, from `z = -HOLD_M` up.
pub fn core(piece: &Piece, chord_m: f64) -> Mesh {
    let (radius_m, top_m) = (piece.parameters.inner_radius_m, piece.tube_m() + HOLD_M);
    turned(&[[0.0, -HOLD_M], [radius_m, -HOLD_M], [radius_m, top_m], [0.0, top_m]], chord_m)
}

/// Outer radius of the base of a mold whose bore is given, m.
pub fn base_radius_m(bore_m: f64) -> f64 {
    shell_radius_m(bore_m) + FIT_M + RIM_M
}

/// The base of a mold whose bore is given: a ring on the table that holds the core below the actuator, with a recess for the shells.
pub fn base(piece: &Piece, bore_m: f64, chord_m: f64) -> Mesh {
    let inner_m = piece.parameters.inner_radius_m + FIT_M;
    let recess_m = shell_radius_m(bore_m) + FIT_M;
    let outer_m = base_radius_m(bore_m);
    let profile = [
        [inner_m, -HOLD_M],
        [outer_m, -HOLD_M],
        [outer_m, RECESS_M],
        [recess_m, RECESS_M],
        [recess_m, 0.0],
        [inner_m, 0.0],
    ];
    turned(&profile, chord_m)
}

/// The cap of the far end: a disk of the actuator's radius, with a spigot that is glued into the chamber.
pub fn cap(piece: &Piece, chord_m: f64) -> Mesh {
    turned(&cap_profile(piece), chord_m)
}

/// Corners of that cap: radius and height, m.
pub(super) fn cap_profile(piece: &Piece) -> [[f64; 2]; 6] {
    let (inner_m, outer_m) = (piece.parameters.inner_radius_m, piece.parameters.outer_radius_m);
    let top_m = CAP_M + SPIGOT_M;
    [[0.0, 0.0], [outer_m, 0.0], [outer_m, CAP_M], [inner_m, CAP_M], [inner_m, top_m], [0.0, top_m]]
}

/// Inner diameter of the hose, m.
pub fn hose_m(piece: &Piece, settings: &Settings) -> f64 {
    settings.hose_m.unwrap_or(HOSE.0.min(2.0 * HOSE.1 * piece.parameters.inner_radius_m))
}

/// Radii of the nipple, of its barb and of its bore, m.
pub fn nipple_m(piece: &Piece, settings: &Settings) -> [f64; 3] {
    let radius_m = 0.5 * hose_m(piece, settings);
    [radius_m, BARB * radius_m, BORE * radius_m]
}

/// The cap of the near end: the same with a bore, and a nipple with a barb for the hose below it.
///
/// # Errors
/// [`OutOfRange`] for `hose_m` where the barb is wider than the chamber.
pub fn port(piece: &Piece, settings: &Settings) -> Result<Mesh, OutOfRange> {
    let barb_m = nipple_m(piece, settings)[1];
    let inner_m = piece.parameters.inner_radius_m;
    let most_m = 2.0 * inner_m / BARB;
    require(
        barb_m < inner_m,
        "hose_m",
        hose_m(piece, settings),
        format!("below {most_m:.5} for the chamber of `{}`", piece.name),
    )?;
    Ok(turned(&port_profile(piece, settings), settings.chord_m))
}

/// Corners of that cap: radius and height, m.
pub(super) fn port_profile(piece: &Piece, settings: &Settings) -> [[f64; 2]; 10] {
    let [nipple_m, barb_m, bore_m] = nipple_m(piece, settings);
    let (inner_m, outer_m) = (piece.parameters.inner_radius_m, piece.parameters.outer_radius_m);
    [
        [bore_m, -NIPPLE_M],
        [nipple_m, -NIPPLE_M],
        [barb_m, -0.8 * NIPPLE_M],
        [nipple_m, -0.75 * NIPPLE_M],
        [nipple_m, 0.0],
        [outer_m, 0.0],
        [outer_m, CAP_M],
        [inner_m, CAP_M],
        [inner_m, CAP_M + SPIGOT_M],
        [bore_m, CAP_M + SPIGOT_M],
    ]
}

/// The plate at each end of a module, with a socket for each actuator and a hole for its hose. Actuators that stand too close have no sockets.
pub fn connector(piece: &Piece, settings: &Settings) -> Mesh {
    plate(piece, settings).mesh(settings.chord_m)
}

/// Thickness of that plate, m: half of the scene's connector, but thick enough for the sockets.
pub fn connector_m(piece: &Piece) -> f64 {
    let least_m = if has_sockets(piece) { SOCKET_M + FLOOR_M } else { FLAT_M };
    least_m.max(0.5 * piece.connector_m)
}

/// Radius of that plate, m.
pub fn connector_radius_m(piece: &Piece) -> f64 {
    let reach_m = piece.copies.iter().map(|copy| copy.place_m[0].hypot(copy.place_m[1])).fold(0.0, f64::max);
    reach_m + piece.parameters.outer_radius_m + FIT_M + WALL_M
}

/// Whether the actuators stand far enough apart for sockets.
fn has_sockets(piece: &Piece) -> bool {
    let axes: Vec<[f64; 2]> = piece.copies.iter().map(|copy| copy.place_m).collect();
    let pairs = axes.iter().enumerate().flat_map(|(index, a)| axes[..index].iter().map(move |b| (a, b)));
    let least_m = pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(f64::INFINITY, f64::min);
    least_m >= 2.0 * (piece.parameters.outer_radius_m + FIT_M) + WALL_M
}

fn plate(piece: &Piece, settings: &Settings) -> Plate {
    Plate {
        radius_m: connector_radius_m(piece),
        thickness_m: connector_m(piece),
        axes_m: piece.copies.iter().map(|copy| copy.place_m).collect(),
        socket_m: has_sockets(piece).then_some([piece.parameters.outer_radius_m + FIT_M, SOCKET_M]),
        hole_m: nipple_m(piece, settings)[1] + FIT_M,
    }
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
