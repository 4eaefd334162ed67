//! Shape functions of the nine-node quadrilateral, for all finite elements in two dimensions.

/// The three quadratics that are one at `-1`, `0` and `1` in turn, and their slopes.
pub(crate) fn quadratics(x: f64) -> ([f64; 3], [f64; 3]) {
    ([0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)], [x - 0.5, -2.0 * x, x + 0.5])
}

/// Shape functions at one point: node `3 j + i` is the `i`-th outwards on the `j`-th line around.
pub(crate) struct Shape {
    /// Values.
    pub(crate) n: [f64; 9],
    /// Derivatives outwards (`xi`) and around (`eta`).
    pub(crate) slopes: [[f64; 2]; 9],
}

impl Shape {
    pub(crate) fn at(xi: f64, eta: f64) -> Self {
        let ((a, da), (b, db)) = (quadratics(xi), quadratics(eta));
        let n = std::array::from_fn(|node| a[node % 3] * b[node / 3]);
        let slopes = std::array::from_fn(|node| [da[node % 3] * b[node / 3], a[node % 3] * db[node / 3]]);
        Self { n, slopes }
    }
}
