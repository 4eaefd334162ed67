//! Ties: displacements that others determine.

use std::collections::HashMap;
use std::f64::consts::TAU;

use super::mesh::tube::Tube;
use super::mesh::{Mesh, Weights};

/// One displacement: a node from 0, a direction 1 to 3.
pub(crate) type Freedom = (usize, u8);
/// A weighted sum of displacements.
pub(crate) type Terms = Vec<(usize, u8, f64)>;

/// A displacement as a weighted sum of others.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tie {
    pub(crate) dependent: Freedom,
    pub(crate) terms: Terms,
}

/// All ties of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ties {
    pub(crate) all: Vec<Tie>,
    /// Displacements that the repetition of sectors determines.
    repeated: HashMap<Freedom, Terms>,
}

impl Ties {
    /// Ties the last plane of one of `count` sectors to its first. At height index 0 all is held, or with `half` what runs along the axis.
    pub(crate) fn repeat(&mut self, tube: &Tube, count: u32, half: bool) {
        let (sin, cos) = (TAU / f64::from(count)).sin_cos();
        let grid = &tube.grid;
        for k in 0..2 * grid.heights.len() - 1 {
            for i in 1..2 * grid.radii.len() - 1 {
                let pair = tube.node([i, 0, k]).zip(tube.node([i, 2 * grid.around, k]));
                let Some((first, last)) = pair.filter(|_| half || k > 0) else { continue };
                let mut tie = |direction, terms: Terms| {
                    self.repeated.insert((last, direction), terms.clone());
                    self.all.push(Tie { dependent: (last, direction), terms });
                };
                tie(1, vec![(first, 1, cos), (first, 2, -sin)]);
                tie(2, vec![(first, 1, sin), (first, 2, cos)]);
                if !(half && k == 0) {
                    tie(3, vec![(first, 3, 1.0)]);
                }
            }
        }
    }

    /// Ties a node to weighted others. Some programs refuse a tie to what another tie determines, so that such terms are replaced by
    /// their own.
    pub(crate) fn tie(&mut self, node: usize, weights: &Weights) {
        for direction in 1..=3 {
            let mut terms = Terms::new();
            for &(master, weight) in weights {
                let own = [(master, direction, 1.0)];
                for &(node, direction, factor) in
                    self.repeated.get(&(master, direction)).map_or(&own[..], Vec::as_slice)
                {
                    match terms.iter_mut().find(|term| (term.0, term.1) == (node, direction)) {
                        Some(term) => term.2 += weight * factor,
                        None => terms.push((node, direction, weight * factor)),
                    }
                }
            }
            self.all.push(Tie { dependent: (node, direction), terms });
        }
    }

    /// A node that follows weighted others: a new one, or the one that has all the weight.
    pub(crate) fn follow(&mut self, mesh: &mut Mesh, weights: &Weights) -> usize {
        if let [(node, _)] = weights[..] {
            return node;
        }
        mesh.nodes.push(mesh.place(weights));
        self.tie(mesh.nodes.len() - 1, weights);
        mesh.nodes.len() - 1
    }
}
