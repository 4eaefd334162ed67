//! Gas volume against gauge pressure, tabulated once so that stepping needs no solver.

/// One node of the table: gauge pressure, gas volume and its slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node {
    /// Gauge pressure, Pa.
    pub(crate) pressure_pa: f64,
    /// Gas volume, m3.
    pub(crate) volume_m3: f64,
    /// `dV/dP`, m3/Pa; >= 0.
    pub(crate) slope_m3_per_pa: f64,
}

/// A monotone curve V(P): piecewise cubic with limited slopes between equidistant nodes, its end
/// tangent above the last one, and below zero gauge its first tangent down to half the volume at
/// rest.
#[derive(Clone, Debug)]
pub(crate) struct VolumeCurve {
    pieces: Vec<[f64; 4]>,
    inverse_width: f64,
    first: Node,
    last: Node,
}

/// Share of the volume at rest that suction cannot remove.
const LEAST_SHARE: f64 = 0.5;

impl VolumeCurve {
    /// A volume that does not depend on the pressure.
    #[cfg(test)]
    pub(crate) fn rigid(volume_m3: f64) -> Self {
        let node = Node { pressure_pa: 0.0, volume_m3, slope_m3_per_pa: 0.0 };
        Self { pieces: Vec::new(), inverse_width: 0.0, first: node, last: node }
    }

    /// The curve through `nodes`, which start at zero gauge and are `width_pa` apart; `None` when
    /// there is none, or when volume is not positive, falls, or is not finite.
    pub(crate) fn through(nodes: &[Node], width_pa: f64) -> Option<Self> {
        let (first, last) = (*nodes.first()?, *nodes.last()?);
        let sound = |n: &Node| n.volume_m3.is_finite() && n.slope_m3_per_pa.is_finite();
        if !nodes.iter().all(sound) || first.volume_m3 <= 0.0 {
            return None;
        }
        let pieces = nodes.windows(2).map(|pair| piece(&pair[0], &pair[1], width_pa)).collect::<Option<Vec<_>>>()?;
        Some(Self {
            pieces,
            inverse_width: 1.0 / width_pa,
            first: Node { slope_m3_per_pa: first.slope_m3_per_pa.max(0.0), ..first },
            last: Node { slope_m3_per_pa: last.slope_m3_per_pa.max(0.0), ..last },
        })
    }

    /// Volume, m3, and slope, m3/Pa, at a gauge pressure.
    #[inline]
    pub(crate) fn at(&self, pressure_pa: f64) -> (f64, f64) {
        if pressure_pa < 0.0 {
            return self.below_rest(pressure_pa);
        }
        let s = pressure_pa * self.inverse_width;
        // Truncation is the floor here, and a cast of a float saturates.
        let index = s as usize;
        match self.pieces.get(index) {
            Some([a, b, c, d]) => {
                let t = s - index as f64;
                let volume = a + t * (b + t * (c + t * d));
                let slope = (b + t * (2.0 * c + t * 3.0 * d)) * self.inverse_width;
                (volume, slope)
            }
            None => {
                let slope = self.last.slope_m3_per_pa;
                let beyond = pressure_pa - self.last.pressure_pa;
                (self.last.volume_m3 + slope * beyond, slope)
            }
        }
    }

    /// Volume at rest, m3.
    pub(crate) fn rest_volume_m3(&self) -> f64 {
        self.first.volume_m3
    }

    /// The gauge pressure, Pa, of a volume: within the table by Newton's method on its cubic, zero
    /// below it, along the end tangent above it.
    pub(crate) fn pressure_of(&self, volume_m3: f64) -> f64 {
        let beyond = volume_m3 - self.last.volume_m3;
        if beyond > 0.0 && self.last.slope_m3_per_pa > 0.0 {
            return self.last.pressure_pa + beyond / self.last.slope_m3_per_pa;
        }
        let above = self.pieces.partition_point(|piece| piece[0] < volume_m3);
        let Some(index) = above.checked_sub(1) else {
            return self.first.pressure_pa;
        };
        let [a, b, c, d] = self.pieces[index];
        let mut t = 0.5;
        for _ in 0..8 {
            let slope = b + t * (2.0 * c + t * 3.0 * d);
            if slope <= 0.0 {
                break;
            }
            let excess = a + t * (b + t * (c + t * d)) - volume_m3;
            t = (t - excess / slope).clamp(0.0, 1.0);
        }
        (index as f64 + t) / self.inverse_width
    }

    fn below_rest(&self, pressure_pa: f64) -> (f64, f64) {
        let slope = self.first.slope_m3_per_pa;
        let volume = self.first.volume_m3 + slope * pressure_pa;
        let least = LEAST_SHARE * self.first.volume_m3;
        if volume > least { (volume, slope) } else { (least, 0.0) }
    }
}

/// The cubic between two nodes in powers of the local coordinate 0..1. Slopes are held within
/// three times the secant, which keeps a cubic monotone (Fritsch and Carlson).
fn piece(left: &Node, right: &Node, width_pa: f64) -> Option<[f64; 4]> {
    let rise = right.volume_m3 - left.volume_m3;
    if rise < 0.0 {
        return None;
    }
    let limit = |slope: f64| (slope * width_pa).clamp(0.0, 3.0 * rise);
    let (m0, m1) = (limit(left.slope_m3_per_pa), limit(right.slope_m3_per_pa));
    Some([left.volume_m3, m0, 3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes of V = 1 + P + P^2 (P in units of the width).
    fn parabola(n: usize) -> Vec<Node> {
        (0..n)
            .map(|k| {
                let p = k as f64;
                Node { pressure_pa: p, volume_m3: 1.0 + p + p * p, slope_m3_per_pa: 1.0 + 2.0 * p }
            })
            .collect()
    }

    #[test]
    fn parabola_is_reproduced_exactly() {
        let curve = VolumeCurve::through(&parabola(5), 1.0).unwrap();
        for p in [0.0f64, 0.3, 1.0, 2.7, 3.999] {
            let (v, s) = curve.at(p);
            assert!((v - (1.0 + p + p * p)).abs() < 1e-12);
            assert!((s - (1.0 + 2.0 * p)).abs() < 1e-12);
        }
    }

    #[test]
    fn ends_continue_with_their_tangents_and_a_floor() {
        let curve = VolumeCurve::through(&parabola(5), 1.0).unwrap();
        assert_eq!(curve.at(6.0), (21.0 + 2.0 * 9.0, 9.0));
        assert_eq!(curve.at(-0.25), (0.75, 1.0));
        assert_eq!(curve.at(-3.0), (0.5, 0.0));
    }

    #[test]
    fn slopes_too_steep_for_the_secant_are_limited() {
        let steep = |p: f64, v: f64| Node { pressure_pa: p, volume_m3: v, slope_m3_per_pa: 100.0 };
        let curve = VolumeCurve::through(&[steep(0.0, 1.0), steep(1.0, 1.5)], 1.0).unwrap();
        let mut before = 0.0;
        for k in 0..100 {
            let v = curve.at(f64::from(k) / 100.0).0;
            assert!(v >= before, "falls at {k}");
            before = v;
        }
    }

    #[test]
    fn falling_empty_and_broken_tables_are_refused() {
        let mut falling = parabola(4);
        falling[3].volume_m3 = 0.1;
        assert!(VolumeCurve::through(&falling, 1.0).is_none());
        assert!(VolumeCurve::through(&[], 1.0).is_none());
        let mut broken = parabola(4);
        broken[2].slope_m3_per_pa = f64::NAN;
        assert!(VolumeCurve::through(&broken, 1.0).is_none());
    }

    #[test]
    fn pressure_of_inverts() {
        let curve = VolumeCurve::through(&parabola(5), 1.0).unwrap();
        // 1 + p + p^2 = 4.75 at p = 1.5.
        assert!((curve.pressure_of(4.75) - 1.5).abs() < 1e-12);
        assert_eq!(curve.pressure_of(0.0), 0.0);
        // Above the last node (4, 21) along its slope 9.
        assert!((curve.pressure_of(39.0) - 6.0).abs() < 1e-12);
    }
}
