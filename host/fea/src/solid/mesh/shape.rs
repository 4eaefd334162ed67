//! Shape functions of the elements, for placing threads and for judging meshes.

/// Corners of the brick in natural coordinates, in the order of a deck.
const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Ends of the edges that carry nodes 9 to 20 of the brick.
pub(crate) const BRICK_EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

/// Ends of the edges that carry nodes 7 to 15 of the wedge.
pub(crate) const WEDGE_EDGES: [[usize; 2]; 9] =
    [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]];

/// Values of the 20 shape functions of the brick at natural coordinates in -1 to 1.
pub(crate) fn brick(at: [f64; 3]) -> [f64; 20] {
    let mut values = [0.0; 20];
    for (n, corner) in CORNERS.iter().enumerate() {
        let f: [f64; 3] = std::array::from_fn(|a| 1.0 + corner[a] * at[a]);
        let sum: f64 = (0..3).map(|a| corner[a] * at[a]).sum();
        values[n] = 0.125 * f[0] * f[1] * f[2] * (sum - 2.0);
    }
    for (n, ends) in BRICK_EDGES.iter().enumerate() {
        values[8 + n] = (0..3).fold(0.25, |product, a| {
            let place = 0.5 * (CORNERS[ends[0]][a] + CORNERS[ends[1]][a]);
            product * if place == 0.0 { 1.0 - at[a] * at[a] } else { 1.0 + place * at[a] }
        });
    }
    values
}

/// Values of the 15 shape functions of the wedge at `[g, h, z]`: `g, h >= 0`, `g + h <= 1`, `z` in -1 to 1.
pub(crate) fn wedge([g, h, z]: [f64; 3]) -> [f64; 15] {
    let l = [1.0 - g - h, g, h];
    let mut values = [0.0; 15];
    for (layer, side) in [-1.0, 1.0].into_iter().enumerate() {
        let reach = 1.0 + side * z;
        for n in 0..3 {
            values[3 * layer + n] = 0.5 * l[n] * reach * (2.0 * l[n] - 1.0 - (1.0 - side * z));
            values[6 + 3 * layer + n] = 2.0 * l[n] * l[(n + 1) % 3] * reach;
        }
    }
    for n in 0..3 {
        values[12 + n] = l[n] * (1.0 - z * z);
    }
    values
}
