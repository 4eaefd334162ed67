//! One tube between two plates: a chain of beams whose inner nodes are eliminated, so that only the plates are unknowns of the limb.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Dyn, Isometry3, OMatrix, SMatrix, SVector, U12, Vector3};

use crate::beam::{Beam, Node, Strain};
use crate::law::Law;
use crate::memory::{Memory, MemoryParameters};

/// Step of the difference that gives the memory's slope, of the range of the deformation.
const MEMORY_STEP: f64 = 1e-6;

/// A tube between two plates, or a stretch of one between two spacers.
#[derive(Clone, Debug)]
pub struct Tube {
    law: Arc<Law>,
    /// Index of its pressure.
    channel: usize,
    /// Its ends in the frames of the plates below and above.
    seats: [Isometry3<f64>; 2],
    /// Length at rest of a beam, m.
    beam_m: f64,
    /// Memory of each beam.
    memory: Vec<Memory>,
    /// Nodes between its ends.
    inner: Vec<Node>,
}

/// A tube's forces on its plates, and how its inner nodes follow them.
pub(crate) struct Condensed {
    /// Forces and moments that hold the plates, at their origins.
    pub(crate) forces: SVector<f64, 12>,
    pub(crate) stiffness: SMatrix<f64, 12, 12>,
    /// Inner steps: with the plates at rest, and by a step of them.
    still: DVector<f64>,
    following: OMatrix<f64, Dyn, U12>,
}

impl Tube {
    /// A straight tube that was never loaded. It has as many beams as `beams` >= 1.
    pub fn new(
        law: Arc<Law>,
        channel: usize,
        seats: [Isometry3<f64>; 2],
        (length_m, beams): (f64, usize),
        memory: MemoryParameters,
    ) -> Self {
        let memory = vec![Memory::new(&law.elastic, memory); beams.max(1)];
        Self { law, channel, seats, beam_m: length_m / memory.len() as f64, memory, inner: Vec::new() }
    }

    /// Index of its pressure.
    pub fn channel(&self) -> usize {
        self.channel
    }

    /// Puts the inner nodes on the line between the ends.
    pub(crate) fn straighten(&mut self, plates: [&Node; 2]) {
        let [a, b] = self.ends(plates);
        let count = self.memory.len();
        let node = |index: usize| Node { place: a.place.lerp(&b.place, index as f64 / count as f64), turn: a.turn };
        self.inner = (1..count).map(node).collect();
    }

    fn ends(&self, plates: [&Node; 2]) -> [Node; 2] {
        [0, 1].map(|end: usize| {
            let (plate, seat) = (plates[end], &self.seats[end]);
            Node {
                place: plate.place + plate.turn * seat.translation.vector,
                turn: plate.turn * seat.rotation.to_rotation_matrix().matrix(),
            }
        })
    }

    fn nodes(&self, plates: [&Node; 2]) -> Vec<Node> {
        let [first, last] = self.ends(plates);
        std::iter::once(first).chain(self.inner.iter().copied()).chain([last]).collect()
    }

    fn beam(&self, pressures_pa: &[f64]) -> Beam<'_> {
        let pressure_pa = pressures_pa[self.channel];
        Beam { law: &self.law, length_m: self.beam_m, pressure_pa, springs: self.law.springs(pressure_pa) }
    }

    /// Its forces on the plates at pressures, and their slopes, `span_s` after the last instant.
    ///
    /// `None` where the inner nodes have no unique place.
    pub(crate) fn condensed(&self, plates: [&Node; 2], pressures_pa: &[f64], span_s: f64) -> Option<Condensed> {
        let (nodes, beam) = (self.nodes(plates), self.beam(pressures_pa));
        let size = 6 * nodes.len();
        let (mut forces, mut stiffness) = (DVector::<f64>::zeros(size), DMatrix::<f64>::zeros(size, size));
        for (index, memory) in self.memory.iter().enumerate() {
            let ends = [&nodes[index], &nodes[index + 1]];
            // Value and slope of the memory serve all differences.
            let at = self.law.deformation(beam.strain(ends).of(self.law.main), beam.pressure_pa);
            let excess_pa = |deformation: f64| memory.excess_pa(&self.law.elastic, deformation, span_s);
            let step = MEMORY_STEP * self.law.elastic.end()[0];
            let value_pa = excess_pa(at);
            let slope = (excess_pa(at + step) - value_pa) / step;
            let (own, slopes) = beam.stiffness(ends, &|deformation| value_pa + slope * (deformation - at));
            let mut rows = forces.fixed_rows_mut::<12>(6 * index);
            rows += own;
            let mut block = stiffness.fixed_view_mut::<12, 12>(6 * index, 6 * index);
            block += slopes;
        }
        let inner = size - 12;
        let pick = |rows: [usize; 2], columns: [usize; 2]| {
            stiffness.fixed_view::<6, 6>(rows[0] + rows[1], columns[0] + columns[1]).into_owned()
        };
        let outer = [0, size - 6];
        let mut held = SMatrix::<f64, 12, 12>::zeros();
        let mut loads = SVector::<f64, 12>::zeros();
        for (i, row) in outer.into_iter().enumerate() {
            loads.fixed_rows_mut::<6>(6 * i).copy_from(&forces.fixed_rows::<6>(row));
            for (j, column) in outer.into_iter().enumerate() {
                held.fixed_view_mut::<6, 6>(6 * i, 6 * j).copy_from(&pick([row, 0], [column, 0]));
            }
        }
        let (mut still, mut following) = (DVector::zeros(inner), OMatrix::<f64, Dyn, U12>::zeros(inner));
        if inner > 0 {
            let free = stiffness.view((6, 6), (inner, inner)).into_owned().lu();
            let mut by_ends = OMatrix::<f64, Dyn, U12>::zeros(inner);
            let mut of_ends = OMatrix::<f64, U12, Dyn>::zeros(inner);
            for (i, end) in outer.into_iter().enumerate() {
                by_ends.view_mut((0, 6 * i), (inner, 6)).copy_from(&stiffness.view((6, end), (inner, 6)));
                of_ends.view_mut((6 * i, 0), (6, inner)).copy_from(&stiffness.view((end, 6), (6, inner)));
            }
            still = -free.solve(&forces.rows(6, inner).into_owned())?;
            following = -free.solve(&by_ends)?;
            loads += &of_ends * &still;
            held += &of_ends * &following;
        }
        // From the tube's ends to the plates' origins.
        let arms = [0, 1].map(|end: usize| plates[end].turn * self.seats[end].translation.vector);
        let mut carried = SMatrix::<f64, 12, 12>::identity();
        for (end, arm) in arms.iter().enumerate() {
            carried.fixed_view_mut::<3, 3>(6 * end, 6 * end + 3).copy_from(&-arm.cross_matrix());
        }
        let mut stiffness = carried.transpose() * held * carried;
        for (end, arm) in arms.iter().enumerate() {
            let force = Vector3::from(loads.fixed_rows::<3>(6 * end));
            let mut turning = stiffness.fixed_view_mut::<3, 3>(6 * end + 3, 6 * end + 3);
            turning += force.cross_matrix() * arm.cross_matrix();
        }
        Some(Condensed { forces: carried.tr_mul(&loads), stiffness, still, following: following * carried })
    }

    /// Moves the inner nodes as a step of the plates moves them, scaled.
    pub(crate) fn follow(&mut self, condensed: &Condensed, plates: &SVector<f64, 12>, scale: f64) {
        let steps = (&condensed.still + &condensed.following * plates) * scale;
        for (index, node) in self.inner.iter_mut().enumerate() {
            *node = node.moved(&steps.fixed_rows::<6>(6 * index).into_owned());
        }
    }

    /// Moves the inner nodes as far beyond their places as they have come since `start`.
    pub(crate) fn go_on(&mut self, start: &Self) {
        self.inner.iter_mut().zip(&start.inner).for_each(|(node, was)| *node = was.beyond(node));
    }

    /// Remembers the present shape at pressures, `span_s` after the last instant.
    pub(crate) fn remember(&mut self, plates: [&Node; 2], pressures_pa: &[f64], span_s: f64) {
        let (strains, pressure_pa) = (self.strains(plates), pressures_pa[self.channel]);
        for (memory, strain) in self.memory.iter_mut().zip(strains) {
            memory.advance(&self.law.elastic, self.law.deformation(strain.of(self.law.main), pressure_pa), span_s);
        }
    }

    /// Strains of its beams from below.
    pub(crate) fn strains(&self, plates: [&Node; 2]) -> Vec<Strain> {
        let nodes = self.nodes(plates);
        // Strains are of the shape alone.
        let beam = Beam { law: &self.law, length_m: self.beam_m, pressure_pa: 0.0, springs: [0.0; 3] };
        nodes.windows(2).map(|pair| beam.strain([&pair[0], &pair[1]])).collect()
    }
}
