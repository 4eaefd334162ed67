//! Volume of a mesh and the sign of its Jacobians.

use softlimb_numerics::gauss::GAUSS_3;

use super::{Element, Kind, Mesh, shape};

/// Quality of a mesh by integration over it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Volume of all elements, mm3. Elements that lie on top of each other count each.
    pub volume_mm3: f64,
    /// The smallest Jacobian of an element over its mean; positive in a sound mesh.
    pub worst_jacobian: f64,
}

impl Mesh {
    /// Integrates over the elements of a part, or over all.
    pub fn quality(&self, accept: impl Fn(&Element) -> bool) -> Quality {
        let mut quality = Quality { volume_mm3: 0.0, worst_jacobian: f64::INFINITY };
        for element in self.elements.iter().filter(|element| accept(element)) {
            let samples = samples(element.kind);
            let jacobians: Vec<f64> = samples.iter().map(|(at, _)| self.jacobian(element, *at)).collect();
            let mean = jacobians.iter().sum::<f64>() / jacobians.len() as f64;
            let least = jacobians.iter().copied().fold(f64::INFINITY, f64::min);
            quality.worst_jacobian = quality.worst_jacobian.min(least / mean.abs());
            quality.volume_mm3 += jacobians.iter().zip(&samples).map(|(j, (_, weight))| j * weight).sum::<f64>();
        }
        quality
    }

    /// Determinant of the place by the natural coordinates: central differences, exact for these polynomials of degree two in each.
    fn jacobian(&self, element: &Element, at: [f64; 3]) -> f64 {
        const STEP: f64 = 1e-3;
        let column = |axis: usize| {
            let shifted = |by: f64| {
                let mut at = at;
                at[axis] += by;
                self.place(&element.nodes.iter().copied().zip(values(element.kind, at)).collect::<Vec<_>>())
            };
            let (a, b) = (shifted(-STEP), shifted(STEP));
            [0, 1, 2].map(|n| (b[n] - a[n]) / (2.0 * STEP))
        };
        let [a, b, c] = [column(0), column(1), column(2)];
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    }
}

fn values(kind: Kind, at: [f64; 3]) -> Vec<f64> {
    match kind {
        Kind::Brick => shape::brick(at).to_vec(),
        Kind::Wedge => shape::wedge(at).to_vec(),
    }
}

fn samples(kind: Kind) -> Vec<([f64; 3], f64)> {
    let line = GAUSS_3.iter();
    match kind {
        Kind::Brick => line
            .flat_map(|(x, u)| {
                GAUSS_3.iter().flat_map(move |(y, v)| GAUSS_3.iter().map(move |(z, w)| ([*x, *y, *z], u * v * w)))
            })
            .collect(),
        Kind::Wedge => {
            // Degree 3 is enough for a test: the midpoints of the edges and of the sides.
            let triangle = [([0.5, 0.0], 1.0 / 6.0), ([0.5, 0.5], 1.0 / 6.0), ([0.0, 0.5], 1.0 / 6.0)];
            line.flat_map(|(z, w)| triangle.iter().map(move |([g, h], v)| ([*g, *h, *z], v * w))).collect()
        }
    }
}
