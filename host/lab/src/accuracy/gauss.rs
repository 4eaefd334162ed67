//! Gauss-Legendre rules of any order, to the digits of the number they are asked for in.

use super::number::Number;

/// Nodes on -1..1 and their weights.
#[derive(Clone, Debug)]
pub(super) struct Rule<N> {
    nodes: Vec<(N, N)>,
}

impl<N: Number> Rule<N> {
    /// The rule of `count` nodes: roots of the Legendre polynomial by Newton's method, weights `2/((1 - x^2) P'^2)`.
    pub(super) fn new(count: u32) -> Self {
        let (one, two) = (N::of(1.0), N::of(2.0));
        let node = |index: u32| {
            let guess = (std::f64::consts::PI * (f64::from(index) + 0.75) / (f64::from(count) + 0.5)).cos();
            let mut x = N::of(guess);
            for _ in 0..8 {
                let (value, slope) = legendre(count, x);
                x = x - value / slope;
            }
            let slope = legendre(count, x).1;
            (x, two / ((one - x * x) * slope * slope))
        };
        Self { nodes: (0..count).map(node).collect() }
    }

    /// The integral of `f` from `a` to `b`.
    pub(super) fn integrate<const K: usize>(&self, a: N, b: N, mut f: impl FnMut(N) -> [N; K]) -> [N; K] {
        let half = N::of(0.5);
        let (middle, reach) = ((a + b) * half, (b - a) * half);
        let mut sum = [N::of(0.0); K];
        for &(x, weight) in &self.nodes {
            for (total, value) in sum.iter_mut().zip(f(middle + reach * x)) {
                *total = *total + value * (weight * reach);
            }
        }
        sum
    }

    /// Nodes and weights on -1..1.
    pub(super) fn nodes(&self) -> &[(N, N)] {
        &self.nodes
    }
}

/// The Legendre polynomial of a degree and its slope.
fn legendre<N: Number>(degree: u32, x: N) -> (N, N) {
    let one = N::of(1.0);
    let (mut before, mut value) = (one, x);
    for n in 2..=degree {
        let n = f64::from(n);
        let next = (N::of(2.0 * n - 1.0) * x * value - N::of(n - 1.0) * before) / N::of(n);
        (before, value) = (value, next);
    }
    (value, N::of(f64::from(degree)) * (x * value - before) / (x * x - one))
}

#[cfg(test)]
mod tests {
    use super::*;
    use qd::Quad;

    #[test]
    fn rule_of_n_nodes_is_exact_to_degree_2n_minus_1() {
        for count in [2, 3, 8] {
            let rule = Rule::<Quad>::new(count);
            let degree = 2 * count - 1;
            let power = |x: Quad| [(0..degree).fold(Quad::of(1.0), |p, _| p * x)];
            let [found] = rule.integrate(Quad::of(0.0), Quad::of(1.0), power);
            let exact = Quad::of(1.0) / Quad::of(f64::from(2 * count));
            assert!((found - exact).nearest().abs() < 1e-31, "{count}");
        }
    }

    #[test]
    fn hundred_nodes_integrate_a_pole_nearby_to_thirty_digits() {
        // int_0^1 dx/(x + 1/2)^2 = 2 - 2/3
        let rule = Rule::<Quad>::new(100);
        let half = Quad::of(0.5);
        let [found] = rule.integrate(Quad::of(0.0), Quad::of(1.0), |x| [Quad::of(1.0) / ((x + half) * (x + half))]);
        let exact = Quad::of(4.0) / Quad::of(3.0);
        assert!((found - exact).nearest().abs() < 1e-29, "{:e}", (found - exact).nearest());
    }
}
