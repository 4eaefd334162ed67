//! The limit of inextensible fibers: an explicit inverse.

use fra_model::{ActuatorParameters, Motion, Placement};

use super::wall::{Integration, Wall};
use crate::accuracy::number::Number;

/// Rounds to the strain of an expansion actuator whose winding lies inside the wall.
const ROUNDS: u32 = 6;

/// A tube with two families of inextensible fibers in a sheet: `lambda^2 s^2 + (r_f/R_f)^2 c^2 = 1` leaves one unknown, and the
/// pressure is `P = mu1 (u_e + u_w w')/w'` with the elastomer's derivatives alone.
pub(super) struct Inextensible<N> {
    wall: Wall<N>,
    motion: Motion,
    /// Place of the winding, `sin^2` and `cos^2` of its angle.
    x: N,
    sin2: N,
    cos2: N,
    inverse_size: N,
}

impl<N: Number> Inextensible<N> {
    /// `None` where the limit is not explicit: another placement, one family, a twist asked for.
    pub(super) fn new(p: &ActuatorParameters<f64>) -> Option<Self> {
        let fiber = p.fiber.filter(|fiber| fiber.placement == Placement::Sheet)?;
        let wall = Wall::new(p, Integration::Closed);
        let winding = wall.winding.as_ref().filter(|winding| winding.both)?;
        let (sin2, cos2) = (winding.sin * winding.sin, winding.cos * winding.cos);
        let x = N::of((fiber.radius_m / p.inner_radius_m).powi(2));
        let motion = p.motion;
        let inverse_size = N::of(1.0 / p.outer_radius_m);
        matches!(motion, Motion::Extension | Motion::Expansion).then_some(())?;
        Some(Self { wall, motion, x, sin2, cos2, inverse_size })
    }

    /// `P/mu1` at a stretch or an outer radius; `None` at a radius that fibers of this length do not reach.
    pub(super) fn pressure(&self, target: N) -> Option<N> {
        let one = N::of(1.0);
        let e = match self.motion {
            Motion::Expansion => self.strain(target * self.inverse_size)?,
            _ => target - one,
        };
        let (w, slope) = self.volume(e);
        let gradient = self.wall.elastomer([e, w, N::of(0.0)]).gradient;
        Some(gradient[0] / slope + gradient[1])
    }

    /// `w` and `dw/de` on the fibers' constraint.
    fn volume(&self, e: N) -> (N, N) {
        let (one, three) = (N::of(1.0), N::of(3.0));
        let per = self.x / self.cos2;
        let lambda = one + e;
        (per * e * (one - self.sin2 * (three + three * e + e * e)), per * (one - three * lambda * lambda * self.sin2))
    }

    /// The axial strain at a hoop stretch of the outer surface: `w/X_o - t e = t - 1`, `t` its square.
    fn strain(&self, stretch: N) -> Option<N> {
        let one = N::of(1.0);
        let excess = (stretch - one) * (stretch + one);
        let (mut e, mut last) = (N::of(0.0), N::of(0.0));
        for _ in 0..ROUNDS {
            let (w, slope) = self.volume(e);
            let rest = w / self.wall.x_outer - (one + excess) * e - excess;
            last = rest / (slope / self.wall.x_outer - one - excess);
            e = e - last;
        }
        let settled = last.nearest().abs() < N::difference() && e.nearest() > -1.0;
        settled.then_some(e)
    }
}
