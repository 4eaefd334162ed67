//! Parts of a model beside its mesh: what holds it, trusses, elastomers, gauges.

use fra_model::Material;

use super::gauge::{Gauges, Ring, Section};
use super::layers::Smeared;
use super::mesh::Mesh;
use super::mesh::plate::Plate;
use super::mesh::tube::Tube;
use super::plan::{Around, Plan};
use super::threads::cuts;
use super::ties::Ties;
use super::{Options, Subject};

/// Caps and connectors are so many times as stiff as the elastomer.
const CAP_STIFFNESS: f64 = 200.0;
/// Their bulk modulus over their shear modulus: stiff, but without the trouble of near-incompressible wedges.
const CAP_BULK: f64 = 10.0;

/// Displacements held at zero.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hold {
    pub(crate) nodes: Vec<usize>,
    pub(crate) from: u8,
    pub(crate) to: u8,
}

/// Trusses of one stiffness.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Trusses {
    pub(crate) name: &'static str,
    pub(crate) pairs: Vec<[usize; 2]>,
    /// mm2.
    pub(crate) area: f64,
    /// MPa.
    pub(crate) modulus: f64,
}

/// An elastomer in MPa: `C10, C20, C30` and the bulk modulus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Elastomer {
    pub(crate) c: [f64; 3],
    pub(crate) bulk: f64,
}

/// The elastomers of the wall, of the layer and of the caps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Elastomers {
    pub(crate) wall: Elastomer,
    pub(crate) layer: Elastomer,
    pub(crate) cap: Elastomer,
}

impl Elastomers {
    pub(crate) fn new(subject: &Subject, options: &Options, smeared: Option<Smeared>) -> Self {
        let material = subject.parameters.material;
        let mu = material.shear_modulus_pa() * 1e-6;
        let bulk = options.bulk_ratio * mu;
        let c = match material {
            Material::NeoHookean { .. } => [0.5 * mu, 0.0, 0.0],
            Material::Yeoh { c_pa } => c_pa.map(|c| c * 1e-6),
        };
        // What lies on top of the wall brings next to no stiffness of its own but its fibers'.
        let share = smeared.map_or(1.0, |smeared| if smeared.overlay { 1e-3 } else { smeared.matrix });
        // The fiber law sees the stretch without the change of volume. Fibers carry the hoop stress P R/t of a thin layer, under which one
        // of the wall's bulk modulus would swell and let them lengthen unseen; a quarter of R/t is enough and converges more easily than
        // all of it.
        let thinness =
            smeared.map_or(1.0, |smeared| 0.25 * subject.parameters.outer_radius_m * 1e3 / smeared.thickness);
        let stiff = CAP_STIFFNESS * mu;
        Self {
            wall: Elastomer { c, bulk },
            layer: Elastomer { c: [0.5 * mu * share, 0.0, 0.0], bulk: bulk * thinness.max(1.0) },
            cap: Elastomer { c: [0.5 * stiff, 0.0, 0.0], bulk: CAP_BULK * stiff },
        }
    }
}

/// Supports of the fixed end of a tube and of its planes of symmetry.
pub(crate) fn holds(plan: &Plan, tube: &Tube) -> Vec<Hold> {
    let (grid, symmetry) = (&tube.grid, plan.symmetry);
    let mut holds = Vec::new();
    let mut hold = |nodes: Vec<usize>, from: u8, to: u8| holds.push(Hold { nodes, from, to });
    let last = 2 * grid.around;
    let free = |k: usize| symmetry.half_length || k > 0;
    if symmetry.half_length {
        hold(tube.nodes_where(|[_, _, k]| k == 0), 3, 3);
        // One node against what is left: a shift in the plane of a half, a turn of a sector.
        let along = if symmetry.around == Around::Half { 1 } else { 2 };
        hold(tube.node([grid.outside, 0, 0]).into_iter().collect(), along, along);
    } else {
        hold(tube.nodes_where(|[_, _, k]| k == 0), 1, 3);
    }
    match symmetry.around {
        Around::Whole => {}
        Around::Half => hold(tube.nodes_where(|[i, j, k]| free(k) && (i == 0 || j == 0 || j == last)), 2, 2),
        Around::Sector(_) => hold(tube.nodes_where(|[i, _, k]| free(k) && i == 0), 1, 2),
    }
    holds
}

/// The threads of a tube and its line that limits strain.
pub(crate) fn trusses(plan: &Plan, tube: &Tube, mesh: &mut Mesh, ties: &mut Ties) -> Vec<Trusses> {
    let grid = &tube.grid;
    let mut found = Vec::new();
    let mut wind = |radius: usize, lines: &[[[f64; 2]; 2]]| {
        let mut pairs = Vec::new();
        for line in lines {
            let follow = |[angle, height]: [f64; 2]| {
                let weights = tube.weights(mesh, radius, angle, height);
                ties.follow(mesh, &weights)
            };
            let nodes: Vec<usize> = cuts(grid, *line).into_iter().map(follow).collect();
            pairs.extend(nodes.windows(2).map(|ends| [ends[0], ends[1]]));
        }
        pairs
    };
    for (threads, name) in plan.threads.iter().zip(["THREADS", "SECOND_THREADS"]) {
        let pairs = wind(threads.radius, &threads.winding.lines(grid));
        let modulus = threads.stiffness / threads.area;
        found.push(Trusses { name, pairs, area: threads.area, modulus });
    }
    if let Some(stiffness) = plan.line {
        let line = [grid.heights[grid.wall.start], grid.heights[grid.wall.end]].map(|height| [0.0, height]);
        found.push(Trusses { name: "LINE", pairs: wind(grid.outside, &[line]), area: 1.0, modulus: stiffness });
    }
    found
}

/// The connector at the far end of a bundle, to which the caps are tied.
pub(crate) fn connect(mesh: &mut Mesh, ties: &mut Ties, tubes: &[Tube], subject: &Subject) {
    let grid = &tubes[0].grid;
    let (outer, thickness) = (grid.radii[grid.radii.len() - 1], grid.heights[1] - grid.heights[0]);
    let top = grid.heights[grid.heights.len() - 1];
    let places = places(subject);
    let ends = |axis: usize| {
        let low = places.iter().map(|place| place[axis]).fold(f64::INFINITY, f64::min);
        let high = places.iter().map(|place| place[axis]).fold(f64::NEG_INFINITY, f64::max);
        [low - 1.02 * outer, high + 1.02 * outer]
    };
    let (x, y) = (ends(0), ends(1));
    let size = subject.parameters.outer_radius_m * 1e3;
    let count = [x, y].map(|[low, high]| ((high - low) / size).ceil() as usize);
    let plate = Plate::add(mesh, [x[0], y[0]], [x[1], y[1]], top, thickness, count);
    for tube in tubes {
        let last = 2 * (tube.grid.heights.len() - 1);
        for node in tube.nodes_where(|[_, _, k]| k == last) {
            ties.tie(node, &plate.weights(mesh, mesh.nodes[node]));
        }
    }
}

/// The axes of the actuators, mm; modules bend towards the first coordinate.
pub(crate) fn places(subject: &Subject) -> Vec<[f64; 2]> {
    if subject.actuators == 1 {
        return vec![[0.0; 2]];
    }
    subject.arrangement.positions_m(subject.actuators).map(|place| place.map(|m| m * 1e3)).collect()
}

/// The sections that are measured.
pub(crate) fn gauges(plan: &Plan, tubes: &[Tube], places: &[[f64; 2]]) -> Gauges {
    let grid = &plan.grid;
    let rings = |i: usize, k: usize| -> Vec<Ring> {
        let pairs = tubes.iter().zip(places);
        pairs.map(|(tube, center)| Ring { nodes: tube.ring(i, k), center: *center, radius: grid.radius(i) }).collect()
    };
    let section =
        |k: usize| Section { height: grid.height(k), outer: rings(grid.outside, k), inner: rings(2 * grid.lumen, k) };
    Gauges {
        middle: plan.gauges.map(section),
        ends: [2 * grid.wall.start, 2 * grid.wall.end].map(section),
        symmetry: plan.symmetry,
    }
}

/// Limits of the figures.
pub(crate) fn warnings(plan: &Plan, subject: &Subject) -> Vec<String> {
    let mut warnings = Vec::new();
    let outer = subject.parameters.outer_radius_m * 1e3;
    let room = 0.5 * plan.length - plan.grid.height(plan.gauges[1]);
    if room < 2.5 * outer {
        warnings.push(format!(
            "the middle is measured {room:.1} mm from the caps, less than 2.5 outer radii: expect end effects in it"
        ));
    }
    for threads in &plan.threads {
        let wall = plan.grid.radius(threads.radius) - subject.parameters.inner_radius_m * 1e3;
        let spacing = threads.winding.spacing_mm;
        if spacing > 0.75 * wall * (1.0 + 1e-9) {
            warnings.push(format!(
                "threads {spacing:.2} mm apart on a wall of {wall:.2} mm: beyond three quarters of the wall it bulges between them"
            ));
        }
    }
    warnings
}
