//! One actuator in units of its inner radius and its shear modulus, ready to be meshed.

use fra_model::{ActuatorParameters, Families, Fiber, InvalidParameter, Motion, Placement};

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

    /// Directions of its families.
    fn families(&self) -> impl Iterator<Item = Direction> + '_ {
        self.directions[..self.families].iter().copied()
    }
}

/// Place of a winding.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    pub(super) windings: Vec<(Wound, Fibers)>,
    pub(super) limit: Option<Limit>,
    /// `R_i`, m, and `mu1`, Pa.
    pub(super) radius_m: f64,
    pub(super) modulus_pa: f64,
    twists: bool,
}

impl Build {
    /// `second` is a winding beside that of the parameters.
    pub(super) fn new(
        parameters: &ActuatorParameters<f64>,
        second: Option<&Fiber<f64>>,
        options: &Options,
    ) -> Result<Self, SectionError> {
        parameters.check()?;
        options.check()?;
        let (radius_m, modulus_pa) = (parameters.inner_radius_m, parameters.material.shear_modulus_pa());
        let outer = parameters.outer_radius_m / radius_m;
        let mut windings = Vec::from_iter(winding(parameters, second.is_some(), options, outer)?);
        if let Some(second) = second {
            windings.extend(self::second(parameters, second, options, outer)?);
        }
        let twists = !is_mirror_image(&windings);
        let per_surface = modulus_pa * radius_m;
        let limit = match options.limiter_for(parameters.motion) {
            Limiter::None => None,
            Limiter::Line => Some(Limit::Line(Fibers::one(INEXTENSIBLE, [0.0, 1.0]))),
            Limiter::Strip { half_angle_rad, stiffness_n_per_m } => {
                let fibers = Fibers::one(stiffness_n_per_m / (4.0 * per_surface), [0.0, 1.0]);
                Some(Limit::Strip { half_angle: half_angle_rad, fibers })
            }
        };
        let elastomer = Elastomer::of(&parameters.material);
        Ok(Self { outer, elastomer, windings, limit, radius_m, modulus_pa, twists })
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
        let on_surface = self.sheets().any(|radius| radius >= self.outer);
        match self.limit {
            None => 1.0 / 15.0,
            Some(Limit::Line(_)) if !on_surface => 10.0,
            Some(Limit::Line(_)) => 1.0,
            Some(Limit::Strip { .. }) => 1.0 / 3.0,
        }
    }

    /// The surface whose middle is the axis: that of the first sheet, else the outer one.
    pub(super) fn axis_surface(&self) -> f64 {
        self.sheets().next().unwrap_or(self.outer)
    }

    /// Radii of the windings that are sheets.
    fn sheets(&self) -> impl Iterator<Item = f64> {
        self.windings.iter().filter_map(|(wound, _)| match *wound {
            Wound::Sheet(radius) => Some(radius),
            Wound::From(_) => None,
        })
    }

    /// Radii inside the wall at which a winding lies or begins, in rising order.
    pub(super) fn radii_inside(&self) -> Vec<f64> {
        let radii = self.windings.iter().map(|(Wound::Sheet(radius) | Wound::From(radius), _)| *radius);
        let mut inside: Vec<f64> = radii.filter(|radius| *radius > 1.0 && *radius < self.outer).collect();
        inside.sort_by(f64::total_cmp);
        inside.dedup();
        inside
    }
}

/// Whether the windings are their own mirror image: every family has its counterpart, of equal stiffness and in the same place.
fn is_mirror_image(windings: &[(Wound, Fibers)]) -> bool {
    let along = |[hoop, axial]: Direction, other: Direction| (hoop * other[1] - axial * other[0]).abs() <= f64::EPSILON;
    let stiffness = |at: &Wound, direction: Direction| -> f64 {
        let here = windings.iter().filter(|(wound, _)| wound == at);
        let families = here.flat_map(|(_, fibers)| fibers.families().map(|family| (fibers.stiffness, family)));
        families.filter(|(_, family)| along(*family, direction)).map(|(stiffness, _)| stiffness).sum()
    };
    windings.iter().all(|(wound, fibers)| {
        let mut families = fibers.families();
        families.all(|[hoop, axial]| stiffness(wound, [hoop, axial]) == stiffness(wound, [-hoop, axial]))
    })
}

fn winding(
    parameters: &ActuatorParameters<f64>,
    has_second: bool,
    options: &Options,
    outer: f64,
) -> Result<Option<(Wound, Fibers)>, SectionError> {
    let fiber = parameters.fiber.filter(|fiber| fiber.modulus_pa > 0.0);
    let bends_unstated = parameters.motion == Motion::Bending && fiber.is_none();
    // A winding without a modulus is an ideal one, which takes no other.
    let allowed = "> 0 on a bending actuator with a second winding";
    require(!(bends_unstated && has_second), "modulus_pa", 0.0, allowed)?;
    if options.winding == Winding::Ideal || bends_unstated {
        let radius = parameters.fiber.map_or(outer, |fiber| radius(parameters, &fiber, outer));
        return Ok(Some((Wound::Sheet(radius), Fibers::one(INEXTENSIBLE, [1.0, 0.0]))));
    }
    fiber.map(|fiber| stated(parameters, &fiber, outer)).transpose()
}

/// The second winding, whose every field counts.
fn second(
    parameters: &ActuatorParameters<f64>,
    fiber: &Fiber<f64>,
    options: &Options,
    outer: f64,
) -> Result<Option<(Wound, Fibers)>, SectionError> {
    let refused = |field, value, allowed| SectionError::SecondWinding(InvalidParameter { field, value, allowed });
    if options.winding == Winding::Ideal {
        return Err(refused("angle_rad", fiber.angle_rad, "none beside an ideal winding"));
    }
    // A bending actuator is not checked for what its analytic model leaves out.
    let alone = ActuatorParameters { motion: Motion::Extension, fiber: Some(*fiber), ..*parameters };
    alone.check().map_err(SectionError::SecondWinding)?;
    (fiber.modulus_pa > 0.0).then(|| stated(parameters, fiber, outer)).transpose()
}

/// Radius of a winding within the wall.
fn radius(parameters: &ActuatorParameters<f64>, fiber: &Fiber<f64>, outer: f64) -> f64 {
    (fiber.radius_m / parameters.inner_radius_m).clamp(1.0, outer)
}

/// The winding with the modulus it has. [`ActuatorParameters::check`] leaves out what bending does not use.
fn stated(
    parameters: &ActuatorParameters<f64>,
    fiber: &Fiber<f64>,
    outer: f64,
) -> Result<(Wound, Fibers), SectionError> {
    let radius = radius(parameters, fiber, outer);
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
