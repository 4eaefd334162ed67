//! One actuator in units of its inner radius and its shear modulus, ready to be meshed.

use fra_model::{ActuatorParameters, Families, Fiber, Motion, Placement};

use super::error::SectionError;
use super::options::{EndLoad, Limiter, Options, Winding};
use crate::elastomer::Elastomer;
use softlimb_files::range::{positive, require};

/// Stiffness of what keeps its length, in units of `mu1 R_i` for a surface and `mu1 R_i^2` for a line. Its strain is the inverse of
/// this times a pressure in units of `mu1`.
const INEXTENSIBLE: f64 = 1e7;

/// Cosine and sine of a fiber's angle from the hoop.
pub(super) type Direction = [f64; 2];

/// Up to two fiber families of one stiffness; energy per family `stiffness/2 (I4-1)^2`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fibers {
    pub(super) stiffness: f64,
    pub(super) directions: [Direction; 2],
    pub(super) families: usize,
}

impl Fibers {
    fn one(stiffness: f64, direction: Direction) -> Self {
        Self { stiffness, directions: [direction; 2], families: 1 }
    }
}

/// Place of the winding.
#[derive(Clone, Copy, Debug)]
pub(super) enum Wound {
    /// On the surface of this radius, energy per area.
    Sheet(f64),
    /// From this radius outwards, energy per volume.
    From(f64),
}

/// The strain-limiting layer in units of the section.
#[derive(Clone, Copy, Debug)]
pub(super) enum Limit {
    Line(Fibers),
    Strip { half_angle: f64, fibers: Fibers },
}

/// Which part of the section is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// A narrow wedge of a section that is the same all around: stretch and twist.
    Wedge,
    /// Half of a section that is its own mirror image: stretch and one bend.
    Half,
    /// The whole section, which may warp: stretch, two bends, twist.
    Ring,
}

/// The actuator without units.
#[derive(Clone, Debug)]
pub(super) struct Build {
    pub(super) outer: f64,
    pub(super) elastomer: Elastomer,
    pub(super) winding: Option<(Wound, Fibers)>,
    pub(super) limit: Option<Limit>,
    /// `R_i`, m, and `mu1`, Pa.
    pub(super) radius_m: f64,
    pub(super) modulus_pa: f64,
    twists: bool,
}

impl Build {
    pub(super) fn new(parameters: &ActuatorParameters<f64>, options: &Options) -> Result<Self, SectionError> {
        parameters.check()?;
        options.check()?;
        let (radius_m, modulus_pa) = (parameters.inner_radius_m, parameters.material.shear_modulus_pa());
        let outer = parameters.outer_radius_m / radius_m;
        let winding = winding(parameters, options, outer)?;
        let twists = winding.is_some_and(|(_, fibers)| fibers.families == 1 && is_oblique(fibers.directions[0]));
        let per_surface = modulus_pa * radius_m;
        let limit = match options.limiter_for(parameters.motion) {
            Limiter::None => None,
            Limiter::Line => Some(Limit::Line(Fibers::one(INEXTENSIBLE, [0.0, 1.0]))),
            Limiter::Strip { half_angle_rad, stiffness_n_per_m } => {
                let fibers = Fibers::one(stiffness_n_per_m / (4.0 * per_surface), [0.0, 1.0]);
                Some(Limit::Strip { half_angle: half_angle_rad, fibers })
            }
        };
        Ok(Self { outer, elastomer: Elastomer::of(&parameters.material), winding, limit, radius_m, modulus_pa, twists })
    }

    /// The least part of the section that shows everything a load can do.
    pub(super) fn part(&self, load: &EndLoad) -> Part {
        let [_, bending, sideways, torque] = load.components();
        if self.limit.is_none() && bending == 0.0 && sideways == 0.0 {
            Part::Wedge
        } else if !self.twists && sideways == 0.0 && torque == 0.0 {
            Part::Half
        } else {
            Part::Ring
        }
    }

    /// Units of force, of the two moments and of torque.
    pub(super) fn load_units(&self) -> [f64; 4] {
        let force = self.modulus_pa * self.radius_m * self.radius_m;
        let moment = force * self.radius_m;
        [force, moment, moment, moment]
    }

    /// Error of the finer of two meshes in units of the difference between them, when elements are halved.
    ///
    /// Without anything singular errors fall as the fourth power of the element size. At the edges of a strip they do so at first and more
    /// slowly in the end, for which the second power is taken; where a line sits on a fiber surface, it is the first. A line on bare
    /// elastomer is a concentrated load, which sinks in by as much again with every halving: there is no limit, and what is given is what ten
    /// more halvings would change.
    pub(super) fn error_factor(&self) -> f64 {
        let on_surface = matches!(self.winding, Some((Wound::Sheet(radius), _)) if radius >= self.outer);
        match self.limit {
            None => 1.0 / 15.0,
            Some(Limit::Line(_)) if !on_surface => 10.0,
            Some(Limit::Line(_)) => 1.0,
            Some(Limit::Strip { .. }) => 1.0 / 3.0,
        }
    }

    /// The surface whose middle is the axis: that of the winding, else the outer one.
    pub(super) fn axis_surface(&self) -> f64 {
        match self.winding {
            Some((Wound::Sheet(radius), _)) => radius,
            _ => self.outer,
        }
    }
}

/// Neither along the hoop nor along the axis.
fn is_oblique(direction: Direction) -> bool {
    direction[0].abs() > f64::EPSILON && direction[1].abs() > f64::EPSILON
}

fn winding(
    parameters: &ActuatorParameters<f64>,
    options: &Options,
    outer: f64,
) -> Result<Option<(Wound, Fibers)>, SectionError> {
    let stiff = |fiber: &Fiber<f64>| fiber.modulus_pa > 0.0;
    let radius = |fiber: &Fiber<f64>| (fiber.radius_m / parameters.inner_radius_m).clamp(1.0, outer);
    let bends_unstated = parameters.motion == Motion::Bending && !parameters.fiber.as_ref().is_some_and(stiff);
    if options.winding == Winding::Ideal || bends_unstated {
        let radius = parameters.fiber.as_ref().map_or(outer, radius);
        return Ok(Some((Wound::Sheet(radius), Fibers::one(INEXTENSIBLE, [1.0, 0.0]))));
    }
    let fiber = parameters.fiber.filter(stiff);
    fiber.map(|fiber| stated(parameters, &fiber, radius(&fiber))).transpose()
}

/// The winding with the modulus it has. [`ActuatorParameters::check`] leaves out what bending does not use.
fn stated(
    parameters: &ActuatorParameters<f64>,
    fiber: &Fiber<f64>,
    radius: f64,
) -> Result<(Wound, Fibers), SectionError> {
    let ratio = fiber.modulus_pa / parameters.material.shear_modulus_pa();
    let (sin, cos) = fiber.angle_rad.sin_cos();
    let (wound, stiffness) = match fiber.placement {
        Placement::Sheet => {
            let thickness = fiber.thickness_m;
            positive("thickness_m", thickness)?;
            (Wound::Sheet(radius), ratio * thickness / parameters.inner_radius_m)
        }
        Placement::Layer => {
            let thick = fiber.radius_m < parameters.outer_radius_m;
            require(thick, "radius_m", fiber.radius_m, "less than outer_radius_m: a layer needs thickness")?;
            (Wound::From(radius), ratio)
        }
        Placement::Smeared => (Wound::From(1.0), ratio),
    };
    let families = if fiber.families == Families::One { 1 } else { 2 };
    Ok((wound, Fibers { stiffness, directions: [[cos, sin], [-cos, sin]], families }))
}
