//! One tube of a bundle as a geometrically exact rod, shot from one plate to the next.

use nalgebra::{Isometry3, Matrix3, Matrix6, Vector3, Vector6};

const STEPS: usize = 10;

/// A tube by its springs, per length at rest; its shape without load is straight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tube {
    pub(crate) at_m: [f64; 2],
    pub(crate) stretch: f64,
    pub(crate) axial_n: f64,
    pub(crate) bending_nm2: f64,
    pub(crate) torsion_nm2: f64,
    pub(crate) shear_n: f64,
    pub(crate) kg_per_m: f64,
}

/// End of a tube in the frame of its start: place, directors, force and moment.
#[derive(Clone, Copy)]
pub(crate) struct End {
    x: Vector3<f64>,
    r: Matrix3<f64>,
    n: Vector3<f64>,
    m: Vector3<f64>,
}

impl Tube {
    fn rate(&self, at: &End, weight: &Vector3<f64>) -> End {
        let (n, m) = (at.r.transpose() * at.n, at.r.transpose() * at.m);
        let x = at.r * Vector3::new(n.x / self.shear_n, n.y / self.shear_n, self.stretch + n.z / self.axial_n);
        let u = Vector3::new(m.x / self.bending_nm2, m.y / self.bending_nm2, m.z / self.torsion_nm2);
        End { x, r: at.r * u.cross_matrix(), n: -weight, m: -x.cross(&at.n) }
    }

    /// Its end where it starts with a wrench; `weight` is per length at rest.
    pub(crate) fn shoot(&self, rest_m: f64, wrench: &Vector6<f64>, weight: &Vector3<f64>) -> End {
        let mut at = End {
            x: Vector3::zeros(),
            r: Matrix3::identity(),
            n: wrench.fixed_rows::<3>(0).into(),
            m: wrench.fixed_rows::<3>(3).into(),
        };
        let h = rest_m / STEPS as f64;
        let moved = |at: &End, by: &End, h: f64| End {
            x: at.x + by.x * h,
            r: at.r + by.r * h,
            n: at.n + by.n * h,
            m: at.m + by.m * h,
        };
        for _ in 0..STEPS {
            let a = self.rate(&at, weight);
            let b = self.rate(&moved(&at, &a, 0.5 * h), weight);
            let c = self.rate(&moved(&at, &b, 0.5 * h), weight);
            let d = self.rate(&moved(&at, &c, h), weight);
            at = moved(&moved(&moved(&moved(&at, &a, h / 6.0), &b, h / 3.0), &c, h / 3.0), &d, h / 6.0);
        }
        at
    }
}

/// How far an end is from where it shall be: place and half the difference of turns.
pub(crate) fn gap(end: &End, goal: &Isometry3<f64>) -> Vector6<f64> {
    let turn = goal.rotation.to_rotation_matrix().into_inner().transpose() * end.r;
    let x = end.x - goal.translation.vector;
    let skew = (turn - turn.transpose()) * 0.5;
    Vector6::new(x.x, x.y, x.z, skew[(2, 1)], skew[(0, 2)], skew[(1, 0)])
}

/// A tube that fits between its plates: its wrench at the start, and how gap and end's wrench change with it.
#[derive(Clone)]
pub(crate) struct Fitted {
    pub(crate) wrench: Vector6<f64>,
    pub(crate) close: Matrix6<f64>,
    pub(crate) end: Matrix6<f64>,
}

pub(crate) fn end_wrench(end: &End) -> Vector6<f64> {
    Vector6::new(end.n.x, end.n.y, end.n.z, end.m.x, end.m.y, end.m.z)
}

/// Fits a tube between plates from a wrench nearby.
pub(crate) fn fit(
    tube: &Tube,
    rest_m: f64,
    goal: &Isometry3<f64>,
    weight: &Vector3<f64>,
    start: &Vector6<f64>,
) -> Option<Fitted> {
    let mut wrench = *start;
    for _ in 0..20 {
        let here = tube.shoot(rest_m, &wrench, weight);
        let (left, ends) = (gap(&here, goal), end_wrench(&here));
        let (mut slope, mut end) = (Matrix6::zeros(), Matrix6::zeros());
        for axis in 0..6 {
            let step = if axis < 3 { 1e-5 } else { 1e-6 };
            let mut moved = wrench;
            moved[axis] += step;
            let there = tube.shoot(rest_m, &moved, weight);
            slope.set_column(axis, &((gap(&there, goal) - left) / step));
            end.set_column(axis, &((end_wrench(&there) - ends) / step));
        }
        let close = slope.try_inverse()?;
        if left.amax() < 1e-12 {
            return Some(Fitted { wrench, close, end });
        }
        wrench -= close * left;
    }
    None
}
