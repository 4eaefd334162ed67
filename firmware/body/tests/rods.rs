//! An independent solution: exact rods by the method of shooting.
//!
//! Every tube is a rod with stretch, shear, bend and twist, integrated from the lower plate by Runge and Kutta's method with the wrench at
//! its foot as a guess. Newton's method finds the wrenches at which the tops of all tubes fit one plate, and the plate is in balance.

use nalgebra::{DMatrix, DVector, Isometry3, Matrix3, Rotation3, Vector3};
use softlimb_body::Main;

use super::laws::Springs;

const STEPS: usize = 60;

/// A tube on its plates: springs, pressure, main strain and length, with its place on both plates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rod {
    pub(crate) springs: Springs,
    pub(crate) main: Main,
    pub(crate) pressure_pa: f64,
    pub(crate) length_m: f64,
    pub(crate) place: Isometry3<f64>,
}

#[derive(Clone, Copy)]
struct State {
    place: Vector3<f64>,
    turn: Matrix3<f64>,
    moment: Vector3<f64>,
}

/// Change of place, turn and moment along a rod.
type Slopes = (Vector3<f64>, Vector3<f64>, Vector3<f64>);

impl Rod {
    fn slopes(&self, state: &State, force: &Vector3<f64>) -> Slopes {
        let Springs { axial_n, bending_nm2: [towards, across], torsion_nm2, shear_n, by_pressure } = self.springs;
        let free = by_pressure * self.pressure_pa;
        let (stretch, bend) = if self.main == Main::Bend { (1.0, free) } else { (1.0 + free, 0.0) };
        let (n, m) = (state.turn.tr_mul(force), state.turn.tr_mul(&state.moment));
        let along = state.turn * Vector3::new(n.x / shear_n, n.y / shear_n, stretch + n.z / axial_n);
        // A bend towards `x` turns about `y`, one towards `y` about minus `x`.
        let rates = Vector3::new(m.x / across, bend + m.y / towards, m.z / torsion_nm2);
        (along, rates, -along.cross(force))
    }

    /// The state at its top, with force and moment at its foot.
    fn top(&self, base: &Isometry3<f64>, force: &Vector3<f64>, moment: &Vector3<f64>) -> State {
        let foot = base * self.place;
        let mut state = State {
            place: foot.translation.vector,
            turn: *foot.rotation.to_rotation_matrix().matrix(),
            moment: *moment,
        };
        let h = self.length_m / STEPS as f64;
        let turned = |state: &State, by: &Slopes, h: f64| State {
            place: state.place + by.0 * h,
            turn: state.turn * Rotation3::new(by.1 * h).matrix(),
            moment: state.moment + by.2 * h,
        };
        for _ in 0..STEPS {
            let first = self.slopes(&state, force);
            let second = self.slopes(&turned(&state, &first, 0.5 * h), force);
            let third = self.slopes(&turned(&state, &second, 0.5 * h), force);
            let fourth = self.slopes(&turned(&state, &third, h), force);
            let mean = |part: fn(&Slopes) -> Vector3<f64>| {
                (part(&first) + 2.0 * (part(&second) + part(&third)) + part(&fourth)) / 6.0
            };
            state = turned(&state, &(mean(|s| s.0), mean(|s| s.1), mean(|s| s.2)), h);
        }
        state
    }
}

/// Pose of the plate that rods on a base carry, with a force, N, in space at a place in the plate's frame.
pub(crate) fn plate(
    base: &Isometry3<f64>,
    rods: &[Rod],
    force_n: &Vector3<f64>,
    at_m: &Vector3<f64>,
) -> Isometry3<f64> {
    let count = 6 * rods.len();
    let tops = |guess: &DVector<f64>| -> Vec<State> {
        let part = |rod: usize, from: usize| Vector3::from(guess.fixed_rows::<3>(6 * rod + from));
        rods.iter().enumerate().map(|(index, rod)| rod.top(base, &part(index, 0), &part(index, 3))).collect()
    };
    let pose = |rod: &Rod, top: &State| {
        let turn = Rotation3::from_matrix_eps(&top.turn, 1e-14, 50, Rotation3::identity());
        let turn = nalgebra::UnitQuaternion::from_rotation_matrix(&turn);
        Isometry3::from_parts(top.place.into(), turn) * rod.place.inverse()
    };
    let residual = |guess: &DVector<f64>, share: f64| {
        let tops = tops(guess);
        let first = pose(&rods[0], &tops[0]);
        let mut found = DVector::zeros(count);
        for (index, (rod, top)) in rods.iter().zip(&tops).enumerate().skip(1) {
            let apart = first.inverse() * pose(rod, top);
            found.fixed_rows_mut::<3>(6 * index).copy_from(&apart.translation.vector);
            found.fixed_rows_mut::<3>(6 * index + 3).copy_from(&apart.rotation.scaled_axis());
        }
        // The plate: what its tubes pull it with, and what it carries.
        let carried = force_n * share;
        let arm = first.rotation * at_m;
        let (mut force, mut moment) = (carried, arm.cross(&carried));
        for (index, top) in tops.iter().enumerate() {
            let own = Vector3::from(guess.fixed_rows::<3>(6 * index));
            force -= own;
            moment -= top.moment + (top.place - first.translation.vector).cross(&own);
        }
        found.fixed_rows_mut::<3>(0).copy_from(&force);
        found.fixed_rows_mut::<3>(3).copy_from(&moment);
        found
    };
    let mut guess = DVector::zeros(count);
    for step in 1..=10 {
        let share = f64::from(step) / 10.0;
        for _ in 0..12 {
            let now = residual(&guess, share);
            let mut slopes = DMatrix::zeros(count, count);
            for column in 0..count {
                let mut moved = guess.clone();
                moved[column] += 1e-6;
                slopes.set_column(column, &((residual(&moved, share) - &now) / 1e-6));
            }
            guess -= slopes.lu().solve(&now).expect("regular");
        }
    }
    assert!(residual(&guess, 1.0).amax() < 1e-7, "the shooting has settled");
    let top = &tops(&guess)[0];
    pose(&rods[0], top)
}
