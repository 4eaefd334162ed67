//! Polynomials through values at nodes.

/// Weights of the values at nodes in the polynomial through them, at a place: Lagrange's. The nodes are all different; the weights sum to 1.
pub fn lagrange_weights(nodes: &[f64], at: f64) -> Vec<f64> {
    let weight = |(index, own): (usize, &f64)| {
        let others = nodes.iter().enumerate().filter(move |(other, _)| *other != index);
        others.map(|(_, other)| (at - other) / (own - other)).product()
    };
    nodes.iter().enumerate().map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::lagrange_weights;

    #[test]
    fn cubic_is_found_through_four_nodes() {
        let cubic = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x * x;
        let nodes = [-1.0, 0.5, 2.0, 3.5];
        for at in [-1.0, 0.0, 1.7, 3.0, 4.0] {
            let weights = lagrange_weights(&nodes, at);
            let found: f64 = nodes.iter().zip(&weights).map(|(node, weight)| weight * cubic(*node)).sum();
            assert!((found - cubic(at)).abs() < 1e-13, "{at}: {found}");
        }
        assert_eq!(lagrange_weights(&[7.0], 3.0), [1.0]);
    }
}
