//! Integration points of the energy in a column: points of the wall, of fiber surfaces, and the strain-limiting line.

use super::build::{Build, Fibers, Limit};
use super::grid::Grid;
use super::spot::Spot;
use crate::quadrilateral::{Shape, quadratics};
use softlimb_numerics::gauss::GAUSS_2;

/// Undeformed places of an element's nodes.
pub(super) fn places(grid: &Grid, angles: &[f64; 3], element: usize) -> [[f64; 2]; 9] {
    std::array::from_fn(|node| {
        let (sin, cos) = angles[node / 3].sin_cos();
        let radius = grid.radii[2 * element + node % 3];
        [radius * cos, radius * sin]
    })
}

/// A point of the wall, its weight being the area per `d xi d eta`.
pub(super) fn wall_spot(places: &[[f64; 2]; 9], element: usize, xi: f64, eta: f64) -> Spot {
    let Shape { n, slopes } = Shape::at(xi, eta);
    let (mut x, mut by_xi, mut by_eta) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    for node in 0..9 {
        for axis in 0..2 {
            x[axis] += n[node] * places[node][axis];
            by_xi[axis] += slopes[node][0] * places[node][axis];
            by_eta[axis] += slopes[node][1] * places[node][axis];
        }
    }
    let area = by_xi[0] * by_eta[1] - by_xi[1] * by_eta[0];
    let radius = x[0].hypot(x[1]);
    let (outwards, around) = ([x[0] / radius, x[1] / radius], [-x[1] / radius, x[0] / radius]);
    // Slopes by xi and eta times the inverse Jacobian, along a direction of the section.
    let along = |slope: [f64; 2], direction: [f64; 2]| {
        let xi = direction[0] * by_eta[1] - direction[1] * by_eta[0];
        let eta = direction[1] * by_xi[0] - direction[0] * by_xi[1];
        (slope[0] * xi + slope[1] * eta) / area
    };
    let slopes = slopes.map(|slope| [along(slope, outwards), along(slope, around)]);
    Spot { element, weight: area, n, slopes, pressure: Some([1.0, xi, eta]), fibers: None }
}

/// Points on a surface of nodes. Two for each element: with three, a stiff fiber surface would be too stiff to curve.
pub(super) fn surface_spots(grid: &Grid, angles: &[f64; 3], node: usize, fibers: Option<Fibers>) -> Vec<Spot> {
    let (element, offset) = if node == 0 { (0, 0) } else { ((node - 1) / 2, 2) };
    let places = places(grid, angles, element);
    let spot = |(eta, weight): (f64, f64)| {
        let (values, derivatives) = quadratics(eta);
        let (mut n, mut slopes, mut tangent) = ([0.0; 9], [[0.0; 2]; 9], [0.0; 2]);
        for line in 0..3 {
            let at = 3 * line + offset;
            (n[at], slopes[at][1]) = (values[line], derivatives[line]);
            tangent[0] += derivatives[line] * places[at][0];
            tangent[1] += derivatives[line] * places[at][1];
        }
        let length = tangent[0].hypot(tangent[1]);
        slopes.iter_mut().for_each(|slope| slope[1] /= length);
        Spot { element, weight: weight * length * grid.multiplicity(), n, slopes, pressure: None, fibers }
    };
    GAUSS_2.into_iter().map(spot).collect()
}

/// The strain-limiting line or the strip's share of a column.
pub(super) fn limiting_spots(build: &Build, grid: &Grid, angles: &[f64; 3], column: usize) -> Vec<Spot> {
    let outermost = grid.radii.len() - 1;
    match build.limit {
        Some(Limit::Line(fibers)) if column == 0 => {
            let mut n = [0.0; 9];
            n[2] = 1.0;
            let (element, slopes) = (grid.rings() - 1, [[0.0; 2]; 9]);
            vec![Spot { element, weight: 1.0, n, slopes, pressure: None, fibers: Some(fibers) }]
        }
        Some(Limit::Strip { fibers, .. }) => {
            let last = grid.closed() && column + grid.strip_columns >= grid.columns();
            let under = column < grid.strip_columns || last;
            if under { surface_spots(grid, angles, outermost, Some(fibers)) } else { Vec::new() }
        }
        _ => Vec::new(),
    }
}
