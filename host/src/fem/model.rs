//! Mesh, ties, loads and gauges of one deck.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::ops::Range;

use fra_model::Material;

use super::gauge::{Gauges, Ring, Section};
use super::mesh::plate::Plate;
use super::mesh::tube::Tube;
use super::mesh::{Face, Mesh, Weights};
use super::options::range;
use super::plan::{Around, Plan, Smeared, Symmetry};
use super::threads::cuts;
use super::{FemError, Options, Subject};

/// Caps and connectors are so many times as stiff as the elastomer.
const CAP_STIFFNESS: f64 = 200.0;
/// Their bulk modulus over their shear modulus: stiff, but without the trouble of near-incompressible wedges.
const CAP_BULK: f64 = 10.0;

/// A tie: one displacement as a weighted sum of others. Nodes from 0, directions 1 to 3.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tie {
    pub(crate) dependent: (usize, u8),
    pub(crate) terms: Vec<(usize, u8, f64)>,
}

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

/// Everything a deck says before its first step.
#[derive(Clone, Debug)]
pub struct Model {
    pub(crate) mesh: Mesh,
    pub(crate) plan: Plan,
    pub(crate) holds: Vec<Hold>,
    pub(crate) ties: Vec<Tie>,
    pub(crate) trusses: Vec<Trusses>,
    pub(crate) lumen: Vec<Face>,
    pub(crate) wall: Elastomer,
    /// The elastomer in the layer.
    pub(crate) matrix: Elastomer,
    pub(crate) cap: Elastomer,
    pub(crate) gauges: Gauges,
    /// The elements of each tube and its axis, mm.
    pub(crate) tubes: Vec<(Range<usize>, [f64; 2])>,
    /// Whether all nodes are printed.
    pub(crate) all_nodes: bool,
    /// What a user should know about it.
    warnings: Vec<String>,
}

impl Model {
    /// Builds the model of one actuator or of a bundle.
    ///
    /// # Errors
    /// [`FemError::Invalid`] or [`FemError::Parameters`] with field, value and range; also for more nodes than the options allow.
    pub fn new(subject: &Subject, options: &Options) -> Result<Self, FemError> {
        let plan = Plan::new(subject, options)?;
        let estimate = plan.grid.nodes_estimate() * usize::from(subject.actuators);
        let what = "nodes of the mesh (estimate; coarser with radial, around, along, or allow more with nodes_max)";
        range(what, estimate as f64, 1.0, f64::from(options.nodes_max))?;
        let overlay = plan.smeared.is_some_and(|smeared| smeared.overlay);
        let mut mesh = Mesh::default();
        let places = places(subject);
        let mut ranges = Vec::new();
        let add = |center: &[f64; 2]| {
            let first = mesh.elements.len();
            let tube = Tube::add(&mut mesh, plan.grid.clone(), *center, overlay);
            ranges.push((first..mesh.elements.len(), *center));
            tube
        };
        let tubes: Vec<Tube> = places.iter().map(add).collect();
        let (wall, matrix, cap) = elastomers(subject, options, plan.smeared);
        let mut model = Self {
            gauges: gauges(&plan, &tubes, &places),
            lumen: tubes.iter().flat_map(|tube| tube.lumen_faces(&mesh)).collect(),
            holds: Vec::new(),
            ties: Vec::new(),
            trusses: Vec::new(),
            warnings: warnings(&plan, subject),
            all_nodes: options.all_nodes,
            tubes: ranges,
            mesh,
            plan,
            wall,
            matrix,
            cap,
        };
        for tube in &tubes {
            model.hold(tube);
        }
        let repeated = model.repeat(&tubes[0]);
        for tube in &tubes {
            model.thread(tube, &repeated);
        }
        if tubes.len() > 1 {
            model.connect(&tubes, subject, &places);
        }
        Ok(model)
    }

    /// Number of nodes of solid elements, which come first.
    pub(crate) fn solid_nodes(&self) -> usize {
        let nodes = self.mesh.elements.iter().flat_map(|element| element.nodes.iter());
        nodes.max().map_or(0, |last| last + 1)
    }

    /// Nodes whose displacements are printed, in order.
    pub(crate) fn printed(&self) -> Vec<usize> {
        if self.all_nodes { (0..self.solid_nodes()).collect() } else { self.gauges.nodes() }
    }

    /// Largest share of the load in one increment.
    pub(crate) fn increment(&self) -> f64 {
        self.plan.increment
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.mesh.nodes.len()
    }

    /// The mesh, mm.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The symmetry it uses.
    pub fn symmetry(&self) -> Symmetry {
        self.plan.symmetry
    }

    /// Distance between neighbouring threads of one family, m; `None` where fibers are smeared.
    pub fn thread_spacing_m(&self) -> Option<f64> {
        self.plan.threads.map(|threads| threads.winding.spacing_mm * 1e-3)
    }

    /// What a user should know before trusting the figures.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Holds the fixed end and the planes of symmetry.
    fn hold(&mut self, tube: &Tube) {
        let (grid, symmetry) = (&tube.grid, self.plan.symmetry);
        let mut hold = |nodes: Vec<usize>, from: u8, to: u8| self.holds.push(Hold { nodes, from, to });
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
    }

    /// Ties the last plane of a sector to its first. Returns the tied displacements.
    fn repeat(&mut self, tube: &Tube) -> HashMap<(usize, u8), Vec<(usize, u8, f64)>> {
        let Around::Sector(count) = self.plan.symmetry.around else { return HashMap::new() };
        let (sin, cos) = (TAU / f64::from(count)).sin_cos();
        let grid = &tube.grid;
        let half = self.plan.symmetry.half_length;
        for k in 0..2 * grid.heights.len() - 1 {
            for i in 1..2 * grid.radii.len() - 1 {
                let pair = tube.node([i, 0, k]).zip(tube.node([i, 2 * grid.around, k]));
                let Some((first, last)) = pair.filter(|_| half || k > 0) else { continue };
                let mut tie = |direction, terms| self.ties.push(Tie { dependent: (last, direction), terms });
                tie(1, vec![(first, 1, cos), (first, 2, -sin)]);
                tie(2, vec![(first, 1, sin), (first, 2, cos)]);
                if !(half && k == 0) {
                    tie(3, vec![(first, 3, 1.0)]);
                }
            }
        }
        self.ties.iter().map(|tie| (tie.dependent, tie.terms.clone())).collect()
    }

    /// Adds the threads of a tube and its line that limits strain.
    fn thread(&mut self, tube: &Tube, repeated: &HashMap<(usize, u8), Vec<(usize, u8, f64)>>) {
        let grid = &tube.grid;
        if let Some(threads) = self.plan.threads {
            let lines = threads.winding.lines(grid);
            let modulus = threads.stiffness / threads.area;
            self.trusses("THREADS", threads.area, modulus, tube, threads.radius, &lines, repeated);
        }
        if let Some(stiffness) = self.plan.line {
            let ends = [grid.heights[grid.wall.start], grid.heights[grid.wall.end]];
            let line = ends.map(|height| [0.0, height]);
            self.trusses("LINE", 1.0, stiffness, tube, grid.outside, &[line], repeated);
        }
    }

    #[allow(clippy::too_many_arguments, reason = "a group of trusses has that many properties")]
    fn trusses(
        &mut self,
        name: &'static str,
        area: f64,
        modulus: f64,
        tube: &Tube,
        radius: usize,
        lines: &[[[f64; 2]; 2]],
        repeated: &HashMap<(usize, u8), Vec<(usize, u8, f64)>>,
    ) {
        let mut pairs = Vec::new();
        for line in lines {
            let places = cuts(&tube.grid, *line);
            let nodes: Vec<usize> = places
                .into_iter()
                .map(|[angle, height]| {
                    let weights = tube.weights(&self.mesh, radius, angle, height);
                    self.follow(&weights, repeated)
                })
                .collect();
            pairs.extend(nodes.windows(2).map(|ends| [ends[0], ends[1]]));
        }
        match self.trusses.iter_mut().find(|trusses| trusses.name == name) {
            Some(trusses) => trusses.pairs.extend(pairs),
            None => self.trusses.push(Trusses { name, pairs, area, modulus }),
        }
    }

    /// A node that follows weighted nodes: a new one with its ties, or the one node that has all the weight.
    fn follow(&mut self, weights: &Weights, repeated: &HashMap<(usize, u8), Vec<(usize, u8, f64)>>) -> usize {
        if let [(node, _)] = weights[..] {
            return node;
        }
        self.mesh.nodes.push(self.mesh.place(weights));
        let node = self.mesh.nodes.len() - 1;
        for direction in 1..=3 {
            // Some programs refuse a tie to what another tie determines.
            let mut terms: Vec<(usize, u8, f64)> = Vec::new();
            for &(master, weight) in weights {
                let own = [(master, direction, 1.0)];
                for &(node, direction, factor) in repeated.get(&(master, direction)).map_or(&own[..], Vec::as_slice) {
                    match terms.iter_mut().find(|term| (term.0, term.1) == (node, direction)) {
                        Some(term) => term.2 += weight * factor,
                        None => terms.push((node, direction, weight * factor)),
                    }
                }
            }
            self.ties.push(Tie { dependent: (node, direction), terms });
        }
        node
    }

    /// Adds the connector at the far end and ties the caps to it.
    fn connect(&mut self, tubes: &[Tube], subject: &Subject, places: &[[f64; 2]]) {
        let grid = &self.plan.grid;
        let (outer, thickness) = (grid.radii[grid.radii.len() - 1], grid.heights[1] - grid.heights[0]);
        let top = grid.heights[grid.heights.len() - 1];
        let ends = |axis: usize| {
            let low = places.iter().map(|place| place[axis]).fold(f64::INFINITY, f64::min);
            let high = places.iter().map(|place| place[axis]).fold(f64::NEG_INFINITY, f64::max);
            [low - 1.02 * outer, high + 1.02 * outer]
        };
        let (x, y) = (ends(0), ends(1));
        let size = subject.parameters.outer_radius_m * 1e3;
        let count = [x, y].map(|[low, high]| ((high - low) / size).ceil() as usize);
        let plate = Plate::add(&mut self.mesh, [x[0], y[0]], [x[1], y[1]], top, thickness, count);
        for tube in tubes {
            let last = 2 * (tube.grid.heights.len() - 1);
            for node in tube.nodes_where(|[_, _, k]| k == last) {
                let weights = plate.weights(&self.mesh, self.mesh.nodes[node]);
                for direction in 1..=3 {
                    let terms = weights.iter().map(|&(master, weight)| (master, direction, weight)).collect();
                    self.ties.push(Tie { dependent: (node, direction), terms });
                }
            }
        }
    }
}

/// The axes of the actuators, mm: evenly on their circle, the first on the side to which modules bend.
fn places(subject: &Subject) -> Vec<[f64; 2]> {
    let count = u32::from(subject.actuators);
    let radius = if count == 1 { 0.0 } else { subject.circle_radius_m * 1e3 };
    let angle = |n: u32| TAU * f64::from(n) / f64::from(count);
    (0..count).map(|n| [radius * angle(n).cos(), radius * angle(n).sin()]).collect()
}

fn elastomers(subject: &Subject, options: &Options, smeared: Option<Smeared>) -> (Elastomer, Elastomer, Elastomer) {
    let material = subject.parameters.material;
    let mu = material.shear_modulus_pa() * 1e-6;
    let bulk = options.bulk_ratio * mu;
    let c = match material {
        Material::NeoHookean { .. } => [0.5 * mu, 0.0, 0.0],
        Material::Yeoh { c_pa } => c_pa.map(|c| c * 1e-6),
    };
    // What lies on top of the wall brings next to no stiffness of its own but its fibers'.
    let share = smeared.map_or(1.0, |smeared| if smeared.overlay { 1e-3 } else { smeared.matrix });
    // The fiber law sees the stretch without the change of volume. Fibers carry the hoop stress P R/t of a thin layer, under which one of
    // the wall's bulk modulus would swell and let them lengthen unseen; a quarter of R/t is enough and converges more easily than all of it.
    let thinness = smeared.map_or(1.0, |smeared| 0.25 * subject.parameters.outer_radius_m * 1e3 / smeared.thickness);
    let matrix = Elastomer { c: [0.5 * mu * share, 0.0, 0.0], bulk: bulk * thinness.max(1.0) };
    let stiff = CAP_STIFFNESS * mu;
    (Elastomer { c, bulk }, matrix, Elastomer { c: [0.5 * stiff, 0.0, 0.0], bulk: CAP_BULK * stiff })
}

fn gauges(plan: &Plan, tubes: &[Tube], places: &[[f64; 2]]) -> Gauges {
    let grid = &plan.grid;
    let rings = |i: usize, k: usize| -> Vec<Ring> {
        let ring = |(tube, center): (&Tube, &[f64; 2])| Ring {
            nodes: tube.ring(i, k),
            center: *center,
            radius: grid.radius(i),
        };
        tubes.iter().zip(places).map(ring).collect()
    };
    let section =
        |k: usize| Section { height: grid.height(k), outer: rings(grid.outside, k), inner: rings(2 * grid.lumen, k) };
    Gauges {
        middle: plan.gauges.map(section),
        ends: [2 * grid.wall.start, 2 * grid.wall.end].map(section),
        symmetry: plan.symmetry,
    }
}

fn warnings(plan: &Plan, subject: &Subject) -> Vec<String> {
    let mut warnings = Vec::new();
    let outer = subject.parameters.outer_radius_m * 1e3;
    let room = 0.5 * plan.length - plan.grid.height(plan.gauges[1]);
    if room < 2.5 * outer {
        warnings.push(format!(
            "the middle is measured {room:.1} mm from the caps, less than 2.5 outer radii: expect end effects in it"
        ));
    }
    if let Some(threads) = plan.threads {
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
