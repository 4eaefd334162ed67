//! Gauss-Legendre rules: nodes and weights on `-1..1`.

/// Two nodes: exact for polynomials of degree 3.
pub const GAUSS_2: [(f64, f64); 2] = [(-0.577_350_269_189_625_8, 1.0), (0.577_350_269_189_625_8, 1.0)];

/// Three nodes: exact for polynomials of degree 5.
pub const GAUSS_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Six nodes: exact for polynomials of degree 11.
pub const GAUSS_6: [(f64, f64); 6] = [
    (-0.932_469_514_203_152, 0.171_324_492_379_170_35),
    (-0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (-0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
    (0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_35),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_of_n_nodes_integrate_powers_below_2n_exactly() {
        for rule in [&GAUSS_2[..], &GAUSS_3[..], &GAUSS_6[..]] {
            for degree in 0..2 * rule.len() as i32 {
                let found: f64 = rule.iter().map(|(x, weight): &(f64, f64)| weight * x.powi(degree)).sum();
                let exact = if degree % 2 == 0 { 2.0 / f64::from(degree + 1) } else { 0.0 };
                assert!((found - exact).abs() < 1e-15, "{degree}: {found}");
            }
        }
    }
}
