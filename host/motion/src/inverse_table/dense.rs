//! The pressure over a deformation in double precision: many short cubics, found by one multiplication.

use fra_model::{Argument, NotFinite};

use super::{NoTable, Subject};

/// Fewest pieces: a cubic takes four nodes.
const PIECES_MIN: usize = 4;

/// The inverse model of one unloaded actuator as equally long cubics, each through the four nodes next to it.
#[derive(Clone, Debug, PartialEq)]
pub struct DenseTable {
    from: f64,
    to: f64,
    argument: Argument,
    scale: f64,
    pieces: Vec<[f64; 4]>,
    error_pa: f64,
}

impl DenseTable {
    /// Solves the model at the ends of `pieces` pieces (at least 4), then in the middle of each to see how far the table is off.
    ///
    /// # Errors
    /// [`NoTable`] when the quantity turns back or the model has no solution.
    pub fn new(subject: &Subject, argument: Argument, pieces: usize) -> Result<Self, NoTable> {
        let (from, to) = subject.range()?;
        let count = pieces.max(PIECES_MIN);
        let target = |position: f64| {
            let u = position / count as f64;
            from + (to - from) * if argument == Argument::Root { u * u } else { u }
        };
        let mut nodes = vec![0.0; count + 1];
        for (node, pressure_pa) in nodes.iter_mut().enumerate().skip(1) {
            *pressure_pa = subject.pressure_at(target(node as f64))?;
        }
        let pieces = (0..count).map(|piece| cubic(&nodes, piece)).collect();
        let mut table = Self { from, to, argument, scale: 1.0 / (to - from), pieces, error_pa: 0.0 };
        for piece in 0..count {
            let middle = target(piece as f64 + 0.5);
            table.error_pa = table.error_pa.max((subject.pressure_at(middle)? - table.at(middle)).abs());
        }
        Ok(table)
    }

    /// The gauge pressure for a target in SI units, Pa; that of the nearer end outside of the range.
    ///
    /// # Errors
    /// [`NotFinite`] for NaN and infinities.
    #[inline]
    pub fn pressure_pa(&self, target: f64) -> Result<f64, NotFinite> {
        if target.is_finite() { Ok(self.at(target)) } else { Err(NotFinite) }
    }

    /// Target at zero and at the highest pressure.
    pub fn range(&self) -> (f64, f64) {
        (self.from, self.to)
    }

    /// The variable the pieces are equally long in.
    pub fn argument(&self) -> Argument {
        self.argument
    }

    /// Largest difference from the model in the middle of the pieces, Pa.
    pub fn error_pa(&self) -> f64 {
        self.error_pa
    }

    #[inline]
    fn at(&self, target: f64) -> f64 {
        let share = ((target - self.from) * self.scale).clamp(0.0, 1.0);
        let u = if self.argument == Argument::Root { share.sqrt() } else { share };
        let position = u * self.pieces.len() as f64;
        let piece = (position as usize).min(self.pieces.len() - 1);
        let t = position - piece as f64;
        let [a, b, c, d] = self.pieces[piece];
        (a + b * t) + (c + d * t) * (t * t)
    }
}

/// The cubic of a piece in powers of its own coordinate 0..1, through the nodes at -1, 0, 1, 2 or, at the ends, the nearest four.
fn cubic(nodes: &[f64], piece: usize) -> [f64; 4] {
    let first = piece.saturating_sub(1).min(nodes.len() - 4);
    let [p, q, r, s] = [nodes[first], nodes[first + 1], nodes[first + 2], nodes[first + 3]];
    // Newton's form about the first node, then shifted to the piece.
    let (d1, d2, d3) = (q - p, (r - 2.0 * q + p) / 2.0, (s - 3.0 * r + 3.0 * q - p) / 6.0);
    let (b, c, d) = (d1 - d2 + 2.0 * d3, d2 - 3.0 * d3, d3);
    let x = (piece - first) as f64;
    [p + x * (b + x * (c + x * d)), b + x * (2.0 * c + x * 3.0 * d), c + 3.0 * x * d, d]
}
