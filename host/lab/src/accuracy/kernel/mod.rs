//! Methods the product does not contain, small and plain, to compare it with: other numbers of nodes, Newton's method without
//! safeguards, limits, and equations as the paper prints them.

mod inextensible;
mod newton;
mod ring;
mod section;
mod wall;

pub(super) use newton::Stop;
pub(super) use section::Balance;
pub(super) use wall::Integration;

use fra_model::{ActuatorParameters, Material, Motion, Placement};

use self::inextensible::Inextensible;
use self::section::Section;
use self::wall::Wall;
use super::number::Number;

/// What a method found: three coordinates of a deformation, or a pressure in the first; and the steps it took.
pub(super) type Found<N> = Option<([N; 3], u32)>;

/// The deformation `(e, w, g)` at a pressure, from a start.
pub(super) fn forward<N: Number>(
    p: &ActuatorParameters<f64>,
    integration: Integration,
    stop: Stop,
    start: [N; 3],
    pressure_pa: f64,
) -> impl Fn() -> Found<N> + use<N> {
    let wall = Wall::new(p, integration);
    let (pressure, per_modulus) = (N::of(pressure_pa), N::of(1.0 / p.material.shear_modulus_pa()));
    move || newton::forward(&wall, start, pressure * per_modulus, stop)
}

/// The pressure at a target, from a start.
pub(super) fn inverse<N: Number>(
    p: &ActuatorParameters<f64>,
    integration: Integration,
    stop: Stop,
    start: [N; 3],
    target: f64,
) -> impl Fn() -> Found<N> + use<N> {
    let wall = Wall::new(p, integration);
    let (zero, one) = (N::of(0.0), N::of(1.0));
    let (motion, x_outer) = (p.motion, wall.x_outer);
    let modulus = N::of(p.material.shear_modulus_pa());
    let target = N::of(target);
    let per_radius = N::of(1.0 / p.outer_radius_m);
    let per_length = N::of(p.inner_radius_m / p.length_m);
    move || {
        let (weights, value) = match motion {
            Motion::Expansion => {
                let stretch = target * per_radius;
                let excess = (stretch - one) * (stretch + one);
                ([-(one + excess), one / x_outer, zero], excess)
            }
            Motion::Twisting => ([zero, zero, one], target * per_length),
            Motion::Extension | Motion::Bending => ([one, zero, zero], target - one),
        };
        let (pressure, steps) = newton::inverse(&wall, start, weights, value, stop)?;
        Some(([pressure * modulus, zero, zero], steps))
    }
}

/// The pressure at a target where the fibers do not stretch; `None` where that is not explicit.
pub(super) fn inextensible<N: Number>(
    p: &ActuatorParameters<f64>,
    target: f64,
) -> Option<impl Fn() -> Found<N> + use<N>> {
    let limit = Inextensible::new(p)?;
    let (modulus, target) = (N::of(p.material.shear_modulus_pa()), N::of(target));
    Some(move || Some(([limit.pressure(target)? * modulus, N::of(0.0), N::of(0.0)], 0)))
}

/// The pressure of a state that is given, by the printed (8).
pub(super) fn printed<N: Number>(p: &ActuatorParameters<f64>, at: [N; 3]) -> impl Fn() -> Found<N> + use<N> {
    let wall = Wall::new(p, Integration::Nodes(8));
    let modulus = N::of(p.material.shear_modulus_pa());
    move || Some(([wall.printed_pressure(at) * modulus, N::of(0.0), N::of(0.0)], 0))
}

/// The angle at a pressure.
pub(super) fn bend<N: Number>(
    p: &ActuatorParameters<f64>,
    balance: Balance,
    pressure_pa: f64,
) -> impl Fn() -> Found<N> + use<N> {
    let section = Section::new(p, balance);
    let (pressure, per_modulus) = (N::of(pressure_pa), N::of(1.0 / p.material.shear_modulus_pa()));
    let per_curvature = N::of(p.length_m / p.outer_radius_m);
    move || {
        let (k, steps) = section.curvature(pressure * per_modulus)?;
        Some(([k * per_curvature, N::of(0.0), N::of(0.0)], steps))
    }
}

/// The pressure at an angle.
pub(super) fn unbend<N: Number>(
    p: &ActuatorParameters<f64>,
    balance: Balance,
    angle_rad: f64,
) -> impl Fn() -> Found<N> + use<N> {
    let section = Section::new(p, balance);
    let modulus = N::of(p.material.shear_modulus_pa());
    let (angle, curvature) = (N::of(angle_rad), N::of(p.outer_radius_m / p.length_m));
    move || Some(([section.pressure(angle * curvature) * modulus, N::of(0.0), N::of(0.0)], 0))
}

/// Whether every integral of an actuator has a closed form here.
pub(super) fn closed_form(p: &ActuatorParameters<f64>) -> bool {
    let sheet = p.fiber.is_none_or(|fiber| fiber.placement == Placement::Sheet);
    sheet && matches!(p.material, Material::NeoHookean { .. })
}
