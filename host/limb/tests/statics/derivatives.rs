//! The potential: its derivatives against differences of it, symmetry, independence of the frame.

use nalgebra::{DVector, Isometry3, Matrix4x2, Translation3, UnitQuaternion, Vector3};
use softlimb_limb::statics::{Bends, LOAD_FACTOR_MAX, Rod, solve};

use crate::statics::{Stream, random_rod};

/// A rod whose bends and slides are coupled, as those of leaning tubes are.
fn coupled_rod(stream: &mut Stream) -> Rod {
    let mut rod = random_rod(stream, 1.0);
    for piece in &mut rod.pieces {
        piece.coupled = Matrix4x2::from_fn(|_, _| stream.between(-3.0, 3.0));
        piece.free_shear = [stream.between(-0.05, 0.05), stream.between(-0.05, 0.05)];
    }
    rod
}

fn random_shape(stream: &mut Stream, count: usize, size: f64) -> DVector<f64> {
    DVector::from_fn(count, |index, _| {
        let unit = [3.0, 2.0, 3.0, 2.0, 1.0, 0.1, 0.1, 0.1][index % 8];
        size * unit * stream.between(-1.0, 1.0)
    })
}

#[test]
fn gradient_is_that_of_the_potential() {
    let mut stream = Stream(3);
    for _ in 0..20 {
        let rod = coupled_rod(&mut stream);
        let q = random_shape(&mut stream, rod.unknowns(), 1.0);
        let gradient = rod.potential(&q, 0.7).gradient;
        for index in 0..q.len() {
            let step = 1e-5;
            let value = |by: f64| {
                let mut moved = q.clone();
                moved[index] += by;
                rod.potential(&moved, 0.7).value_j
            };
            let slope = (8.0 * (value(step) - value(-step)) - (value(2.0 * step) - value(-2.0 * step))) / (12.0 * step);
            let off = (slope - gradient[index]).abs();
            assert!(off < 1e-7 * gradient.amax().max(1.0), "{index}: {slope} {}", gradient[index]);
        }
    }
}

#[test]
fn tangent_is_symmetric_and_the_slope_of_the_gradient() {
    let mut stream = Stream(5);
    for _ in 0..20 {
        let rod = coupled_rod(&mut stream);
        let q = random_shape(&mut stream, rod.unknowns(), 1.0);
        let tangent = rod.potential(&q, 1.0).tangent;
        let springs = rod.potential(&DVector::zeros(q.len()), 0.0).tangent;
        assert!((&tangent - tangent.transpose()).amax() < 1e-12 * tangent.amax());
        for column in 0..q.len() {
            let step = 1e-6;
            let gradient = |by: f64| {
                let mut moved = q.clone();
                moved[column] += by;
                rod.potential(&moved, 1.0).gradient
            };
            let slope = (gradient(step) - gradient(-step)) / (2.0 * step);
            for row in 0..q.len() {
                let size = (springs[(row, row)] * springs[(column, column)]).sqrt();
                let off = (slope[row] - tangent[(row, column)]).abs();
                assert!(off < 1e-6 * size, "{row} {column}: {} {}", slope[row], tangent[(row, column)]);
            }
        }
    }
}

#[test]
fn potential_does_not_depend_on_the_frame() {
    let mut stream = Stream(8);
    for _ in 0..20 {
        let rod = random_rod(&mut stream, 0.3);
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.4, -1.3, 0.9));
        let mut turned = rod.clone();
        turned.base = Isometry3::from_parts(Translation3::identity(), turn) * rod.base;
        turned.gravity_m_per_s2 = turn * rod.gravity_m_per_s2;
        turned.tip_force_n = turn * rod.tip_force_n;
        let (a, b) = (solve(&rod, Bends::Linear, None), solve(&turned, Bends::Linear, None));
        let (Ok(a), Ok(b)) = (a, b) else { continue };
        let off = (turn * a.tip().translation.vector - b.tip().translation.vector).norm();
        assert!(off < 1e-8, "{off:e}");
    }
}

#[test]
fn unloaded_rods_do_not_move() {
    let mut stream = Stream(13);
    for bends in [Bends::Constant, Bends::Linear] {
        let rod = random_rod(&mut stream, 0.0);
        let shape = solve(&rod, bends, None).expect("stable");
        assert_eq!(shape.q.amax(), 0.0);
        assert_eq!(shape.load_factor(&rod, bends), LOAD_FACTOR_MAX);
    }
}
