//! One tube with its caps.

use std::collections::HashMap;

use super::grid::Grid;
use super::shape::{BRICK_EDGES, WEDGE_EDGES};
use super::{Element, Face, Kind, Mesh, Part, Weights};

/// Lattice indices of a node: radial, around, along.
type Lattice = [usize; 3];

/// The tube's lattice in a mesh that may hold more.
#[derive(Clone, Debug)]
pub(crate) struct Tube {
    pub(crate) grid: Grid,
    center: [f64; 2],
    nodes: HashMap<Lattice, usize>,
    bricks: HashMap<Lattice, usize>,
}

impl Tube {
    /// Adds a tube whose axis passes through `center`, mm. Where `overlay` is set, the winding's elements carry fibers alone and lie on
    /// top of the wall's.
    pub(crate) fn add(mesh: &mut Mesh, grid: Grid, center: [f64; 2], overlay: bool) -> Self {
        let mut tube = Self { grid, center, nodes: HashMap::new(), bricks: HashMap::new() };
        for q in 0..tube.grid.heights.len() - 1 {
            for n in 0..tube.grid.around {
                for m in (0..tube.grid.radii.len() - 1).filter(|m| tube.grid.is_solid(*m, q)).collect::<Vec<_>>() {
                    tube.element(mesh, m, n, q, overlay);
                }
            }
        }
        tube
    }

    fn element(&mut self, mesh: &mut Mesh, m: usize, n: usize, q: usize, overlay: bool) {
        let (i, j, k) = (2 * m, 2 * n, 2 * q);
        let wound = self.grid.wall.contains(&q) && self.grid.layer.contains(&m);
        let part = match (self.grid.wall.contains(&q), wound && !overlay) {
            (false, _) => Part::Cap,
            (true, true) => Part::Layer,
            (true, false) => Part::Wall,
        };
        let (kind, lattice) = if m == 0 {
            let corners = [[0, j, k], [2, j, k], [2, j + 2, k], [0, j, k + 2], [2, j, k + 2], [2, j + 2, k + 2]];
            (Kind::Wedge, with_midpoints(&corners, &WEDGE_EDGES))
        } else {
            let square = |k| [[i, j, k], [i + 2, j, k], [i + 2, j + 2, k], [i, j + 2, k]];
            let corners = [square(k), square(k + 2)].concat();
            (Kind::Brick, with_midpoints(&corners, &BRICK_EDGES))
        };
        let nodes: Vec<_> = lattice.iter().map(|at| self.make(mesh, *at)).collect();
        if kind == Kind::Brick {
            self.bricks.insert([m, n, q], mesh.elements.len());
        }
        if wound && overlay {
            mesh.elements.push(Element { kind, part, nodes: nodes.clone() });
            mesh.elements.push(Element { kind, part: Part::Layer, nodes });
        } else {
            mesh.elements.push(Element { kind, part, nodes });
        }
    }

    /// The lattice index as nodes are kept: one on the axis, and the last around is the first where the circle closes.
    fn key(&self, [i, j, k]: Lattice) -> Lattice {
        let j = if self.grid.closed { j % (2 * self.grid.around) } else { j };
        [i, if i == 0 { 0 } else { j }, k]
    }

    fn make(&mut self, mesh: &mut Mesh, at: Lattice) -> usize {
        let key = self.key(at);
        *self.nodes.entry(key).or_insert_with(|| {
            let (r, angle) = (self.grid.radius(key[0]), self.grid.angle(key[1]));
            let z = self.grid.height(key[2]);
            // Exactly on the planes of symmetry, which a sine would miss by rounding.
            let y = if angle == std::f64::consts::PI { 0.0 } else { r * angle.sin() };
            mesh.nodes.push([self.center[0] + r * angle.cos(), self.center[1] + y, z]);
            mesh.nodes.len() - 1
        })
    }

    /// The node at a lattice place, where there is one.
    pub(crate) fn node(&self, at: Lattice) -> Option<usize> {
        self.nodes.get(&self.key(at)).copied()
    }

    /// All nodes whose lattice place is accepted, in order.
    pub(crate) fn nodes_where(&self, accept: impl Fn(Lattice) -> bool) -> Vec<usize> {
        let mut found: Vec<_> = self.nodes.iter().filter(|(at, _)| accept(**at)).map(|(_, node)| *node).collect();
        found.sort_unstable();
        found
    }

    /// Corner nodes around at a lattice radius and height, from angle 0 on.
    pub(crate) fn ring(&self, i: usize, k: usize) -> Vec<usize> {
        let last = if self.grid.closed { self.grid.around } else { self.grid.around + 1 };
        (0..last).filter_map(|n| self.node([i, 2 * n, k])).collect()
    }

    /// The faces that the air presses on, as (element, face).
    pub(crate) fn lumen_faces(&self, mesh: &Mesh) -> Vec<Face> {
        let (lumen, wall) = (self.grid.lumen, &self.grid.wall);
        let mut faces = Vec::new();
        for n in 0..self.grid.around {
            for q in wall.clone() {
                faces.extend(self.bricks.get(&[lumen, n, q]).map(|element| (*element, 6)));
            }
            for m in 0..lumen {
                // The cap below shows its top, the one above its bottom.
                let below = wall.start.checked_sub(1).map(|q| (q, 2));
                let above = (wall.end < self.grid.heights.len() - 1).then_some((wall.end, 1));
                for (q, face) in below.into_iter().chain(above) {
                    faces.extend(self.cap_element(mesh, m, n, q).map(|element| (element, face)));
                }
            }
        }
        faces
    }

    fn cap_element(&self, mesh: &Mesh, m: usize, n: usize, q: usize) -> Option<usize> {
        if m > 0 {
            return self.bricks.get(&[m, n, q]).copied();
        }
        let corners = [self.node([0, 0, 2 * q])?, self.node([2, 2 * n, 2 * q])?, self.node([2, 2 * n + 2, 2 * q])?];
        mesh.elements.iter().position(|element| element.kind == Kind::Wedge && element.nodes[..3] == corners)
    }

    /// Weights of the nodes for a point of the wall: at a lattice radius, an angle in the domain, rad, and a height, mm.
    pub(crate) fn weights(&self, mesh: &Mesh, i: usize, angle: f64, height: f64) -> Weights {
        // A radius on a line belongs to the element within, or to the innermost.
        let m = (i.saturating_sub(1) / 2).max(self.grid.lumen);
        let radial = i as f64 - 2.0 * m as f64 - 1.0;
        let turn = (angle / self.grid.sweep * self.grid.around as f64).clamp(0.0, self.grid.around as f64);
        let n = (turn as usize).min(self.grid.around - 1);
        let wall = &self.grid.wall;
        let above = |q: &usize| self.grid.heights[q + 1] >= height;
        let q = wall.clone().find(above).unwrap_or(wall.end - 1);
        let (low, high) = (self.grid.heights[q], self.grid.heights[q + 1]);
        let along = (2.0 * (height - low) / (high - low) - 1.0).clamp(-1.0, 1.0);
        mesh.weights(self.bricks[&[m, n, q]], [radial, 2.0 * (turn - n as f64) - 1.0, along])
    }
}

/// Corners and behind them the midpoints of the edges.
fn with_midpoints(corners: &[Lattice], edges: &[[usize; 2]]) -> Vec<Lattice> {
    let between = |[a, b]: &[usize; 2]| {
        let (a, b) = (corners[*a], corners[*b]);
        // Towards the axis the place around is that of the end that has one.
        let around = if a[0] == 0 && b[0] != 0 {
            b[1]
        } else if b[0] == 0 && a[0] != 0 {
            a[1]
        } else {
            (a[1] + b[1]) / 2
        };
        [(a[0] + b[0]) / 2, around, (a[2] + b[2]) / 2]
    };
    corners.iter().copied().chain(edges.iter().map(between)).collect()
}
