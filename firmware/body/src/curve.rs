//! A rising curve through points.

/// A monotone cubic through points, with straight lines behind both ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Place, value and slope of each node; places rise.
    nodes: Vec<[f64; 3]>,
}

impl Curve {
    /// The curve through points `[place, value]`; `None` unless there are two or more, finite, with places and values that rise.
    ///
    /// Slopes are Steffen's: between two nodes the curve stays between their values.
    pub fn rising(points: &[[f64; 2]]) -> Option<Self> {
        let rises = points.windows(2).all(|pair| pair[1][0] > pair[0][0] && pair[1][1] > pair[0][1]);
        if points.len() < 2 || !rises || points.as_flattened().iter().any(|value| !value.is_finite()) {
            return None;
        }
        let chord = |from: usize| {
            let [a, b] = [points[from], points[from + 1]];
            ((b[1] - a[1]) / (b[0] - a[0]), b[0] - a[0])
        };
        let slope = |node: usize| match node {
            0 => chord(0).0,
            last if last + 1 == points.len() => chord(last - 1).0,
            _ => {
                let ((before, h), (after, k)) = (chord(node - 1), chord(node));
                let parabola = (before * k + after * h) / (h + k);
                parabola.min(2.0 * before).min(2.0 * after)
            }
        };
        let nodes = points.iter().enumerate().map(|(node, [place, value])| [*place, *value, slope(node)]);
        Some(Self { nodes: nodes.collect() })
    }

    /// The value at a place.
    pub fn at(&self, place: f64) -> f64 {
        let last = self.nodes.len() - 1;
        let [first, end] = [self.nodes[0], self.nodes[last]];
        if place <= first[0] {
            return first[1] + first[2] * (place - first[0]);
        }
        if place >= end[0] {
            return end[1] + end[2] * (place - end[0]);
        }
        let after = self.nodes.partition_point(|node| node[0] <= place).min(last);
        let ([x0, y0, s0], [x1, y1, s1]) = (self.nodes[after - 1], self.nodes[after]);
        let (width, t) = (x1 - x0, (place - x0) / (x1 - x0));
        let (u, t2, u2) = (1.0 - t, t * t, (1.0 - t) * (1.0 - t));
        y0 * u2 * (1.0 + 2.0 * t) + y1 * t2 * (3.0 - 2.0 * t) + width * t * u * (s0 * u - s1 * t)
    }

    /// Place and value of the last node.
    pub fn end(&self) -> [f64; 2] {
        let [place, value, _] = self.nodes[self.nodes.len() - 1];
        [place, value]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curve_meets_its_points_and_rises_between_and_beyond() {
        let points = [[-1.0, -3.0], [0.0, 0.0], [0.5, 4.0], [2.0, 4.5], [3.0, 9.0]];
        let curve = Curve::rising(&points).unwrap();
        for [place, value] in points {
            assert!((curve.at(place) - value).abs() < 1e-14);
        }
        let values: Vec<f64> = (0..600).map(|k| curve.at(-2.0 + 0.01 * f64::from(k))).collect();
        assert!(values.is_sorted_by(|a, b| a < b));
    }

    #[test]
    fn straight_line_is_kept() {
        let curve = Curve::rising(&[[0.0, 1.0], [1.0, 3.0], [4.0, 9.0]]).unwrap();
        for place in [-2.0, 0.3, 2.7, 6.0] {
            assert!((curve.at(place) - (1.0 + 2.0 * place)).abs() < 1e-13);
        }
    }

    #[test]
    fn points_that_do_not_rise_are_refused() {
        for points in
            [&[[0.0, 0.0]][..], &[[0.0, 0.0], [0.0, 1.0]], &[[0.0, 1.0], [1.0, 1.0]], &[[0.0, f64::NAN], [1.0, 1.0]]]
        {
            assert_eq!(Curve::rising(points), None);
        }
    }
}
