//! From parameters and options to numbers: mesh lines, symmetry, stiffness of layer and threads. Lengths in mm, stresses in MPa.

use std::f64::consts::{PI, TAU};

use fra_model::{ActuatorParameters, Families, Fiber, Motion, Placement};

use super::layers::{Smeared, nearest, radial};
use super::mesh::grid::Grid;
use super::threads::{Winding, is_mirror_image, repeats};
use super::{FemError, FiberModel, Options, Subject, SymmetryUse};
use crate::spacing::evenly;
use softlimb_files::range::require;

/// Surface stiffness `mu2 t` of a winding that none is stated for, in units of shear modulus and wall: as good as inextensible.
const IDEAL: f64 = 1000.0;
/// Height of a cap in outer radii, at least one wall.
const CAP: f64 = 0.4;
/// Distance of the gauges of the mid-length from the middle, in lengths.
const GAUGE: f64 = 0.1;

/// Part of the circle in the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Around {
    /// All of it.
    Whole,
    /// One half; the plane of the bend is a mirror.
    Half,
    /// One of so many equal sectors, which turn into each other.
    Sector(u32),
}

/// The symmetry a model uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symmetry {
    /// Around the axis.
    pub around: Around,
    /// Whether the middle of the length is a mirror.
    pub half_length: bool,
}

/// Fibers as trusses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Threads {
    pub(crate) winding: Winding,
    /// `E A` of one thread, N.
    pub(crate) stiffness: f64,
    /// Cross-section, mm2. Only the product with the modulus matters.
    pub(crate) area: f64,
    /// Lattice index of their radius.
    pub(crate) radius: usize,
}

/// Fibers of one winding as a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fibers {
    pub(crate) angle: f64,
    pub(crate) two_families: bool,
    /// `mu2` in the layer, MPa.
    pub(crate) modulus: f64,
}

/// Everything a model is built from.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    pub(crate) grid: Grid,
    pub(crate) symmetry: Symmetry,
    pub(crate) smeared: Option<Smeared>,
    /// The fibers of the layer, of each winding.
    pub(crate) fibers: Vec<Fibers>,
    /// The threads of each winding; none where fibers are smeared.
    pub(crate) threads: Vec<Threads>,
    /// Stiffness of the line that limits the strain of a bending actuator, N.
    pub(crate) line: Option<f64>,
    /// Lattice heights between which the middle is measured.
    pub(crate) gauges: [usize; 2],
    /// Largest share of the load in one increment.
    pub(crate) increment: f64,
    /// Length of the actuator, mm.
    pub(crate) length: f64,
}

/// The winding in mm and MPa: angle, families, `mu2` and where.
pub(crate) struct Wound {
    pub(crate) angle: f64,
    pub(crate) two: bool,
    pub(crate) modulus: f64,
    pub(crate) thickness: f64,
    pub(crate) placement: Placement,
    pub(crate) radius: f64,
}

impl Plan {
    /// Resolves every choice that the options leave open.
    pub(crate) fn new(subject: &Subject, options: &Options) -> Result<Self, FemError> {
        subject.check()?;
        options.check()?;
        let p = &subject.parameters;
        let wound = wound(p);
        let windings: Vec<Wound> =
            wound.into_iter().chain(subject.second_fiber.map(|fiber| stated(p, &fiber))).collect();
        let wound = windings.first();
        let (inner, outer, length) = (p.inner_radius_m * 1e3, p.outer_radius_m * 1e3, p.length_m * 1e3);
        let threads = windings.iter().map(|wound| winding(wound, options, outer - inner, length));
        let threads: Vec<Winding> = threads.collect::<Result<Option<Vec<_>>, _>>()?.unwrap_or_default();
        let symmetry = symmetry(subject, options, &windings, &threads);
        let (radii, lumen, layer, smeared) = radial(p, options, wound, !threads.is_empty())?;
        let around = around(options, symmetry, &threads)?;
        let along = along(options, [inner, outer, length], &threads);
        let (heights, wall) = heights([inner, outer, length], along, symmetry.half_length);
        let index = |radius: f64| nearest(&radii, radius);
        let threads = windings.iter().zip(threads).map(|(wound, winding)| Threads {
            winding,
            stiffness: 4.0 * wound.modulus * wound.thickness * winding.spacing_mm,
            area: 0.25 * PI * wound.thickness * wound.thickness,
            radius: index(wound.radius),
        });
        let threads: Vec<Threads> = threads.collect();
        let of_layer = |(smeared, wound): (Smeared, &Wound)| {
            let share = if wound.placement == Placement::Sheet { wound.thickness / smeared.thickness } else { 1.0 };
            Fibers { angle: wound.angle, two_families: wound.two, modulus: wound.modulus * share }
        };
        let fibers =
            smeared.map_or_else(Vec::new, |smeared| windings.iter().map(|wound| of_layer((smeared, wound))).collect());
        let sweep = match symmetry.around {
            Around::Whole => TAU,
            Around::Half => PI,
            Around::Sector(count) => TAU / f64::from(count),
        };
        let closed = symmetry.around == Around::Whole;
        let outside = index(outer);
        let grid = Grid { radii, lumen, layer, outside, around, sweep, closed, heights, wall };
        let gauges = gauges(&grid, length, symmetry.half_length);
        let mu = p.material.shear_modulus_pa() * 1e-6;
        Ok(Self {
            grid,
            symmetry,
            smeared,
            fibers,
            threads,
            line: (p.motion == Motion::Bending).then_some(1e4 * mu * outer * outer),
            gauges,
            increment: options.increment.unwrap_or(if p.motion == Motion::Twisting { 0.05 } else { 0.1 }),
            length,
        })
    }
}

/// The winding that is modelled: the stated one if it has any stiffness, for bending else an ideal one along the hoop, at the radius that
/// is stated or on the outer face.
fn wound(p: &ActuatorParameters<f64>) -> Option<Wound> {
    let mu = p.material.shear_modulus_pa() * 1e-6;
    let [inner, outer] = [p.inner_radius_m * 1e3, p.outer_radius_m * 1e3];
    let radius = p.fiber.map_or(outer, |fiber| (fiber.radius_m * 1e3).clamp(inner, outer));
    match p.fiber.filter(|fiber| fiber.modulus_pa > 0.0) {
        Some(fiber) => Some(stated(p, &fiber)),
        None if p.motion == Motion::Bending => {
            let wall = outer - inner;
            let thickness = 0.1 * wall;
            let modulus = IDEAL * mu * wall / thickness;
            Some(Wound { angle: 0.0, two: false, modulus, thickness, placement: Placement::Sheet, radius })
        }
        None => None,
    }
}

/// A winding with the stiffness that it states.
fn stated(p: &ActuatorParameters<f64>, fiber: &Fiber<f64>) -> Wound {
    Wound {
        angle: fiber.angle_rad,
        two: fiber.families == Families::Two,
        modulus: fiber.modulus_pa * 1e-6,
        thickness: fiber.thickness_m * 1e3,
        placement: fiber.placement,
        radius: (fiber.radius_m * 1e3).clamp(p.inner_radius_m * 1e3, p.outer_radius_m * 1e3),
    }
}

/// The whole threads nearest to the spacing asked for; `None` where fibers are smeared.
fn winding(wound: &Wound, options: &Options, wall: f64, length: f64) -> Result<Option<Winding>, FemError> {
    let FiberModel::Threads { spacing_m } = options.fibers else { return Ok(None) };
    let sheet = wound.placement == Placement::Sheet;
    if !sheet {
        return Err(FemError::NoSheet);
    }
    let wanted = spacing_m.map_or(0.75 * wall, |m| m * 1e3);
    let room = length.min(TAU * wound.radius);
    let allowed = format!("{:.4} to {room:.4} mm", room / 500.0);
    require(wanted >= room / 500.0 && wanted <= room, "spacing_mm", wanted, allowed)?;
    Ok(Some(Winding::nearest(wound.angle, wound.radius, length, wanted, wound.two)))
}

/// The symmetry that subject, winding and options leave.
fn symmetry(subject: &Subject, options: &Options, windings: &[Wound], threads: &[Winding]) -> Symmetry {
    let whole = Symmetry { around: Around::Whole, half_length: false };
    if options.symmetry == SymmetryUse::Whole || subject.actuators > 1 {
        return whole;
    }
    let mirror = windings.iter().all(|wound| is_mirror_image(wound.angle, wound.two));
    let sectors = match threads {
        // Two elements a sector.
        _ if threads.iter().all(Winding::has_rings) => Some(options.around.unwrap_or(AROUND) / 2),
        [winding] => repeats(winding),
        // The threads of two windings rarely repeat alike.
        _ => None,
    };
    let around = match (subject.parameters.motion, sectors) {
        (Motion::Bending, _) if mirror => Around::Half,
        (Motion::Bending, _) => return whole,
        (_, Some(count)) if count >= 3 || !mirror => Around::Sector(count),
        _ if mirror => Around::Half,
        _ => return whole,
    };
    Symmetry { around, half_length: mirror }
}

/// Elements around the whole circle where nothing else is said.
const AROUND: u32 = 24;

/// Elements around in the domain.
fn around(options: &Options, symmetry: Symmetry, threads: &[Winding]) -> Result<usize, FemError> {
    let whole = options.around.unwrap_or_else(|| {
        // Two elements between neighbouring threads that run mostly along the axis.
        let helices = threads.iter().filter(|winding| !winding.has_rings());
        let needed = helices.map(|winding| 2 * winding.count).max().unwrap_or(0);
        AROUND.max(needed.min(96))
    });
    match symmetry.around {
        Around::Whole => Ok(whole as usize),
        Around::Half => Ok((whole / 2) as usize),
        Around::Sector(count) => Ok(whole.div_ceil(count).max(1) as usize),
    }
}

/// Elements along the whole length, an even number.
fn along(options: &Options, [inner, outer, length]: [f64; 3], threads: &[Winding]) -> u32 {
    options.along.unwrap_or_else(|| {
        let plain = f64::max(outer - inner, 0.4 * outer);
        let size = threads.iter().fold(plain, |size, winding| size.min(0.5 * winding.axial_spacing_mm()));
        2 * (0.5 * length / size).ceil().clamp(4.0, 400.0) as u32
    })
}

fn heights([inner, outer, length]: [f64; 3], along: u32, half: bool) -> (Vec<f64>, std::ops::Range<usize>) {
    let cap = f64::max(outer - inner, CAP * outer);
    let top = 0.5 * length;
    let along = along as usize;
    if half {
        let heights: Vec<f64> = evenly(0.0, top, along / 2).chain([top + cap]).collect();
        return (heights, 0..along / 2);
    }
    let heights = std::iter::once(-top - cap).chain(evenly(-top, top, along)).chain([top + cap]).collect();
    (heights, 1..along + 1)
}

/// Lattice heights of the lines nearest to a tenth of the length from the middle, on both sides or from the middle on.
fn gauges(grid: &Grid, length: f64, half: bool) -> [usize; 2] {
    let lines = grid.wall.start..=grid.wall.end;
    let next = |height: f64| {
        let off = |line: &usize| (grid.heights[*line] - height).abs();
        lines.clone().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(grid.wall.end)
    };
    let middle = next(0.0);
    let up = next(GAUGE * length).max(middle + 1);
    let down = if half { middle } else { next(-GAUGE * length).min(middle - 1) };
    [2 * down, 2 * up]
}
