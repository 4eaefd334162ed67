//! The connector at the far end of a bundle: a rectangular plate.

use std::collections::HashMap;

use super::shape::BRICK_EDGES;
use super::{Element, Kind, Mesh, Part, Weights};

/// A plate of equal bricks, one through its thickness.
#[derive(Clone, Debug)]
pub(crate) struct Plate {
    /// Corner with the least coordinates, mm, and the size of a brick.
    origin: [f64; 3],
    size: [f64; 3],
    count: [usize; 2],
    first: usize,
}

impl Plate {
    /// Adds a plate over the rectangle `low` to `high`, mm, of `count` bricks each way, from height `z` up.
    pub(crate) fn add(
        mesh: &mut Mesh,
        low: [f64; 2],
        high: [f64; 2],
        z: f64,
        thickness: f64,
        count: [usize; 2],
    ) -> Self {
        let size = [(high[0] - low[0]) / count[0] as f64, (high[1] - low[1]) / count[1] as f64, thickness];
        let plate = Self { origin: [low[0], low[1], z], size, count, first: mesh.elements.len() };
        let mut nodes = HashMap::new();
        for b in 0..count[1] {
            for a in 0..count[0] {
                let square = |c: usize| [[a, b, c], [a + 1, b, c], [a + 1, b + 1, c], [a, b + 1, c]];
                let corners = [square(0), square(1)].concat();
                let doubled = |[a, b, c]: [usize; 3]| [2 * a, 2 * b, 2 * c];
                let middle = |[p, q]: &[usize; 2]| [0, 1, 2].map(|n| corners[*p][n] + corners[*q][n]);
                let lattice = corners.iter().map(|at| doubled(*at)).chain(BRICK_EDGES.iter().map(middle));
                let nodes = lattice.map(|at| plate.make(mesh, &mut nodes, at)).collect();
                mesh.elements.push(Element { kind: Kind::Brick, part: Part::Plate, nodes });
            }
        }
        plate
    }

    fn make(&self, mesh: &mut Mesh, nodes: &mut HashMap<[usize; 3], usize>, at: [usize; 3]) -> usize {
        *nodes.entry(at).or_insert_with(|| {
            mesh.nodes.push([0, 1, 2].map(|n| self.origin[n] + 0.5 * self.size[n] * at[n] as f64));
            mesh.nodes.len() - 1
        })
    }

    /// Weights of the plate's nodes for a point of its lower face.
    pub(crate) fn weights(&self, mesh: &Mesh, point: [f64; 3]) -> Weights {
        let cell = |n: usize| {
            let turn = ((point[n] - self.origin[n]) / self.size[n]).clamp(0.0, self.count[n] as f64);
            let cell = (turn as usize).min(self.count[n] - 1);
            (cell, 2.0 * (turn - cell as f64) - 1.0)
        };
        let ((a, x), (b, y)) = (cell(0), cell(1));
        mesh.weights(self.first + b * self.count[0] + a, [x, y, -1.0])
    }
}
