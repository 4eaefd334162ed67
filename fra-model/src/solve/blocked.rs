//! Blocked force and torque of a straight actuator: the loads at a given stretch, twist and pressure.

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::number::real::{Real, epsilon, real};
use crate::solution::{State, Status};
use crate::solve::energy::Wall;

/// Largest lumen volume of the search, as a share of that at rest.
const LARGEST_VOLUME: f64 = 1e6;
const ITERATIONS: u32 = 200;

/// A blocked actuator: its ends are held. The loads act on the free end; the actuator pushes and turns with their opposites.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocked<T> {
    /// Solved, or no solution if no volume balances the pressure at this stretch and twist.
    pub status: Status,
    /// The state; its compliance is that at constant stretch and twist.
    pub state: State<T>,
    /// Axial force `N_ext`, N; tension is positive.
    pub force_n: T,
    /// Torque `M_ext`, N m.
    pub torque_nm: T,
    /// `d(N_ext, M_ext)/dP` at constant stretch and twist: m2 and m3. The negative is `dV/d(l, Phi)`, the lever arm of the pressure.
    pub by_pressure: [T; 2],
    /// `d(N_ext, M_ext)/d(l, Phi)` at constant pressure: N/m, N, N m/m, N m/rad.
    pub stiffness: [[T; 2]; 2],
    /// Newton iterations.
    pub iterations: u32,
}

/// The state `(e, w, g)` at a stretch and twist under a pressure, with its derivatives, in units of the model.
pub(crate) struct BlockedPoint<T: Real> {
    pub(crate) status: Status,
    pub(crate) at: Vector3<T>,
    /// `(u_e, u_g)`.
    pub(crate) loads: Vector2<T>,
    /// `d(u_e, u_g)/d(u_w)`.
    pub(crate) by_pressure: Vector2<T>,
    /// `d(u_e, u_g)/d(e, g)` at constant `u_w`.
    pub(crate) stiffness: Matrix2<T>,
    /// `d(u_w)/dw`.
    pub(crate) slope: T,
    pub(crate) iterations: u32,
}

/// Finds the lumen volume that balances `pressure = P/mu1` at a strain and twist rate.
///
/// At fixed strain and twist the energy of a neo-Hookean wall with fibers is convex in the volume, so that the volume is unique and
/// a bracketed Newton iteration finds it.
pub(crate) fn block<T: Real>(wall: &Wall<T>, e: T, g: T, pressure: T) -> BlockedPoint<T> {
    let half: T = real(0.5);
    let (mut low, mut high) = (-T::one(), real::<T>(LARGEST_VOLUME));
    // Stiff windings keep the radius of the hoop.
    let mut w = e * wall.x_outer;
    if w <= -T::one() {
        w = e * half;
    }
    let (mut last, mut status) = (real::<T>(LARGEST_VOLUME), Status::NotConverged);
    let mut iterations = 0;
    while iterations < ITERATIONS {
        iterations += 1;
        let d = wall.derivatives(e, w, g);
        let (excess, slope) = (d.gradient.y - pressure, d.hessian[(1, 1)]);
        if excess > T::zero() {
            high = w
        } else {
            low = w
        }
        let newton = w - excess / slope;
        let size = (newton - w).abs();
        let rounding = real::<T>(64.0) * epsilon::<T>() * (w.abs() + e.abs());
        let at_root = size <= epsilon::<T>() * w.abs() || (size >= last * half && size <= rounding);
        if excess == T::zero() || (slope > T::zero() && at_root) {
            status = Status::Solved;
            break;
        }
        last = size;
        let inside = slope > T::zero() && newton > low && newton < high;
        let middle = ((T::one() + low) * (T::one() + high)).sqrt() - T::one();
        let next = if inside {
            newton
        } else if low > -T::one() {
            middle
        } else {
            (low + w) * half
        };
        // At the bounds the search ends.
        if next >= real::<T>(0.99 * LARGEST_VOLUME) || next == w {
            status = if next == w { Status::Solved } else { Status::NoSolution };
            break;
        }
        w = next;
    }
    let d = wall.derivatives(e, w, g);
    let (slope, coupling) = (d.hessian[(1, 1)], Vector2::new(d.hessian[(0, 1)], d.hessian[(2, 1)]));
    let direct = Matrix2::new(d.hessian[(0, 0)], d.hessian[(0, 2)], d.hessian[(2, 0)], d.hessian[(2, 2)]);
    BlockedPoint {
        status,
        at: Vector3::new(e, w, g),
        loads: Vector2::new(d.gradient.x, d.gradient.z),
        by_pressure: coupling / slope,
        stiffness: direct - coupling * coupling.transpose() / slope,
        slope,
        iterations,
    }
}
