//! Residual and tangent of an element against its energy written out a second time, whose derivatives are those of hyper-dual numbers.

use fra_model::Families;

use super::super::wall::tests::{DIRECTIONS, anything, second_energy, second_fibers};
use super::*;
use crate::hyper_dual::HyperDual;

const INNER: f64 = 1.0;
const WIDTH: f64 = 0.3;
const HEIGHT: f64 = 0.4;
const PRESSURE: f64 = 0.3;

/// Wall, sheets on both sides and lumen by the code under test.
fn share(values: &[f64; ALL]) -> Share {
    let (wall, winding) = anything();
    let element = Element { inner: INNER, width: WIDTH, height: HEIGHT, values };
    let mut share = Share::NONE;
    element.add_wall(&wall, &mut share).expect("not inside out");
    element.add_sheet(-1.0, &winding, &mut share);
    element.add_sheet(1.0, &winding, &mut share);
    element.add_lumen(PRESSURE, &mut share);
    share
}

/// A polynomial through -1, 0 and 1 by Lagrange's product, and its slope.
fn lagrange(i: usize, x: f64) -> [f64; 2] {
    let at = [-1.0, 0.0, 1.0];
    let [a, b] = [at[(i + 1) % 3], at[(i + 2) % 3]];
    let unit = (at[i] - a) * (at[i] - b);
    [(x - a) * (x - b) / unit, (2.0 * x - a - b) / unit]
}

/// Where a point of the element has gone: its radius and, as rows, the deformation gradient in the directions (radial, hoop, axial).
struct Moved {
    at: f64,
    radius: HyperDual,
    gradient: [[HyperDual; 3]; 3],
}

fn moved(values: &[HyperDual; ALL], xi: f64, eta: f64) -> Moved {
    let at = INNER + 0.5 * WIDTH * (1.0 + xi);
    // Value, slope along the radius and slope along the axis of change of radius, turn and shift.
    let mut fields = [[HyperDual::default(); 3]; 3];
    for node in 0..9 {
        let ([a, da], [b, db]) = (lagrange(node % 3, xi), lagrange(node / 3, eta));
        let weights = [a * b, da * b * 2.0 / WIDTH, a * db * 2.0 / HEIGHT];
        for (field, sums) in fields.iter_mut().enumerate() {
            (0..3).for_each(|k| sums[k] = sums[k] + values[3 * node + field] * weights[k]);
        }
    }
    let ([u, turn, shift], one, none) = (fields, HyperDual::from(1.0), HyperDual::default());
    let radius = u[0] + HyperDual::from(at);
    let gradient = [
        [u[1] + one, none, u[2]],
        [radius * turn[1], radius * (1.0 / at), radius * turn[2]],
        [shift[1], none, shift[2] + one],
    ];
    Moved { at, radius, gradient }
}

/// The same energy written out again, per radian: `int W r dr dz` and so on.
fn second(values: &[HyperDual; ALL]) -> HyperDual {
    let far = 0.6f64.sqrt();
    let points = [(-far, 5.0 / 9.0), (0.0, 8.0 / 9.0), (far, 5.0 / 9.0)];
    let (wall, winding) = anything();
    let mut sum = HyperDual::default();
    for (eta, along) in points {
        for (xi, across) in points {
            let Moved { at, gradient, .. } = moved(values, xi, eta);
            let pressure = values[27] + values[28] * xi + values[29] * eta;
            let energy = second_energy(&wall, pressure, &gradient);
            sum = sum + energy * (at * across * along * 0.25 * WIDTH * HEIGHT);
        }
        for side in [-1.0, 1.0] {
            let Moved { at, gradient, .. } = moved(values, side, eta);
            sum = sum + second_fibers(&winding, &gradient) * (at * along * 0.5 * HEIGHT);
        }
        // The lumen: half the squared radius along the axis.
        let Moved { radius, gradient, .. } = moved(values, -1.0, eta);
        sum = sum - radius * radius * gradient[2][2] * (0.5 * PRESSURE * along * 0.5 * HEIGHT);
    }
    sum
}

fn along(values: &[f64; ALL], [u, v]: [&dyn Fn(usize) -> f64; 2]) -> HyperDual {
    second(&std::array::from_fn(|i| HyperDual::moving(values[i], [u(i), v(i)])))
}

/// Every entry, at values without symmetry.
#[test]
fn residual_and_tangent_are_those_of_the_energy_by_hyper_dual_numbers() {
    assert_eq!(anything().1.families, Families::One);
    let values: [f64; ALL] = std::array::from_fn(|i| 0.04 * (i as f64 * 1.7).sin());
    let here = share(&values);
    let largest = here.second.iter().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
    let unit = |at: usize| move |i: usize| f64::from(u8::from(i == at));
    for i in 0..ALL {
        for j in 0..ALL {
            let exact = along(&values, [&unit(i), &unit(j)]);
            let (residual, tangent) = (here.first[i] - exact.first[0], here.second[i][j] - exact.second);
            assert!(residual.abs() <= 1e-15 + 1e-11 * exact.first[0].abs(), "{i}: {residual:e} of {exact:?}");
            let bar = 1e-15 * largest + 1e-11 * exact.second.abs();
            assert!(tangent.abs() <= bar, "{i} {j}: {tangent:e} of {exact:?}");
        }
    }
}

/// The sums that a step of Newton's method works with.
#[test]
fn slopes_and_second_derivatives_along_random_directions_are_those_of_the_energy() {
    for seed in DIRECTIONS {
        let wave = |k: f64| move |i: usize| (seed + k * i as f64).sin();
        let values: [f64; ALL] = std::array::from_fn(|i| 0.03 * wave(2.3)(i));
        let (u, v, here) = (wave(1.1), wave(0.7), share(&values));
        let exact = along(&values, [&u, &v]);
        let slope: f64 = (0..ALL).map(|i| here.first[i] * u(i)).sum();
        let row = |i: usize| (0..ALL).map(|j| here.second[i][j] * v(j)).sum::<f64>();
        let second: f64 = (0..ALL).map(|i| u(i) * row(i)).sum();
        assert!((slope - exact.first[0]).abs() <= 1e-11 * slope.abs(), "{slope} {exact:?}");
        assert!((second - exact.second).abs() <= 1e-11 * second.abs(), "{second} {exact:?}");
    }
}
