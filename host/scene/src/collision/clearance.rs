//! The least distance between a body and a solid, by branch and bound.
//!
//! With `d` the signed distance of a convex solid, `g` its gradient at the middle `m` of an interval of the centre line, `t` the unit
//! tangent there and `k` the curvature, a point of the line at the arc length `x` from the middle is `m + t x + e` with
//! `|e| <= k x^2/2`. Since `d` is convex and `|g| = 1`,
//!
//! ```text
//! d(m + t x + e) >= d(m) + g.t x - k x^2/2
//! ```
//!
//! so that an interval of half width `w` holds nothing below `d(m) - |g.t| w - k w^2/2`, nor below `d(m) - w`. An interval that cannot
//! beat the best point found is dropped, any other is halved. The second order makes a smooth minimum cost some dozens of points.

use nalgebra::Vector3;

use super::body::{Body, Piece};
use super::shape::Shape;

/// Largest error of a clearance, m: it is never below the true one and at most this above.
pub const TOLERANCE_M: f64 = 1e-6;

/// Point of a body nearest to a solid, or deepest in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// Distance of the surfaces, m; negative where they overlap: then how deep the deepest ball of the body is in the solid.
    pub distance_m: f64,
    /// Index of the piece in [`Body::pieces`].
    pub piece: usize,
    /// Share of that piece's length, 0 to 1.
    pub share: f64,
    /// The point of the centre line, m.
    pub point_m: Vector3<f64>,
    /// Unit vector along which that point leaves the solid fastest: the gradient of the distance by the point.
    pub away: Vector3<f64>,
}

impl Body {
    /// The clearance between this body and a solid; `None` for a body without pieces.
    pub fn clearance(&self, shape: &Shape) -> Option<Clearance> {
        self.nearest(shape, f64::INFINITY)
    }

    /// Whether the clearance is at least `required_m`; much faster than the clearance where that is obvious.
    ///
    /// Where it is at most [`TOLERANCE_M`] larger than required the answer may be no.
    pub fn clears(&self, shape: &Shape, required_m: f64) -> bool {
        self.nearest(shape, required_m + TOLERANCE_M).is_none()
    }

    /// The clearance, or `None` where it is at least `enough_m - TOLERANCE_M`.
    ///
    /// A body that is not finite has a clearance of NaN.
    pub fn nearest(&self, shape: &Shape, enough_m: f64) -> Option<Clearance> {
        let mut search = Search { shape, best: None, bound_m: enough_m };
        // The middles of all pieces first, so that far pieces are dropped against a good bound.
        for (index, piece) in self.pieces().iter().enumerate() {
            search.least_m(index, piece, 0.5, 0.5);
        }
        for (index, piece) in self.pieces().iter().enumerate() {
            search.divide(index, piece, 0.5, 0.5);
        }
        search.best
    }
}

struct Search<'a> {
    shape: &'a Shape,
    best: Option<Clearance>,
    /// Bound that a point must beat: the best one, or a sufficient one.
    bound_m: f64,
}

impl Search<'_> {
    /// Searches the interval of shares `middle - half .. middle + half`.
    ///
    /// The recursion ends because an interval of half width `w` is dropped for `w <= TOLERANCE_M` at the latest.
    fn divide(&mut self, index: usize, piece: &Piece, middle: f64, half: f64) {
        let least_m = self.least_m(index, piece, middle, half);
        if least_m < self.bound_m - TOLERANCE_M {
            let half = 0.5 * half;
            self.divide(index, piece, middle - half, half);
            self.divide(index, piece, middle + half, half);
        }
    }

    /// Looks at the middle of an interval; gives what no point of the interval is below.
    fn least_m(&mut self, index: usize, piece: &Piece, middle: f64, half: f64) -> f64 {
        let (point_m, tangent) = piece.at(middle);
        let found = self.shape.distance(&point_m);
        let distance_m = found.distance_m - piece.radius_m();
        if distance_m < self.bound_m || distance_m.is_nan() {
            self.bound_m = if distance_m.is_nan() { f64::NEG_INFINITY } else { distance_m };
            self.best = Some(Clearance { distance_m, piece: index, share: middle, point_m, away: found.gradient });
        }
        let width = half * piece.length_m();
        let slope = found.gradient.dot(&tangent).abs();
        let fall = width * (slope + 0.5 * piece.curvature_per_m() * width);
        distance_m - fall.min(width)
    }
}
