//! How much of an actuator's length its caps take out of its motion.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Motion, Placement};

use super::body::{Body, Shaped};
use super::mesh::{EndOfWall, Mesh};
use super::wall::Wall;
use super::{MeridianError, across, positive};

/// Elements across the wall, of the coarser of two meshes.
const ACROSS: usize = 3;
/// Growth of the elements from the cap towards the middle; those at the cap are as long as those across the wall are wide.
const GROWTH: f64 = 1.25;
/// Longest element towards the middle, in inner radii, unless there would be more elements than this.
const LONGEST: f64 = 0.5;
const MOST: f64 = 200.0;
/// Smallest motion at mid-length that an end length is a share of.
const LEAST_MOTION: f64 = 1e-6;
/// Modulus of the winding of a bending actuator over that of its wall: it keeps its radius.
const STIFF: f64 = 1e4;

/// The length at each end that does not take part: an actuator of length `L` between bonded caps moves as one of length `L - 2 delta`
/// does without them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndLength {
    /// `delta` of the change of length, m; none where there is next to no such change. Also that of a bend.
    pub axial_m: Option<f64>,
    /// `delta` of the twist, m; none where nothing twists.
    pub twist_m: Option<f64>,
    /// What a finer mesh changes, m.
    pub error_m: f64,
    /// Axial strain at mid-length, and twist rate there, rad/m.
    pub middle: [f64; 2],
}

/// The end lengths of an actuator at a gauge pressure, Pa.
///
/// A bending actuator is taken as the tube with its hoop winding alone, without the limiting layer: the cap does the same to it.
///
/// # Errors
/// [`MeridianError`].
pub fn end_length(parameters: &ActuatorParameters<f64>, pressure_pa: f64) -> Result<EndLength, MeridianError> {
    Actuator::new(parameters)?;
    positive("pressure_pa", pressure_pa)?;
    let tube = straight(parameters);
    let coarse = lengths(&tube, pressure_pa, ACROSS)?;
    let fine = lengths(&tube, pressure_pa, 2 * ACROSS)?;
    let unit = tube.inner_radius_m;
    let differences = fine.delta.iter().zip(&coarse.delta).filter_map(|(a, b)| Some((a.as_ref()? - b.as_ref()?).abs()));
    let [strain, turn] = fine.middle;
    if strain.abs() < LEAST_MOTION && turn.abs() < LEAST_MOTION {
        return Err(MeridianError::NoMotion { motion: strain.abs().max(turn.abs()), pressure_pa });
    }
    Ok(EndLength {
        axial_m: fine.delta[0].map(|delta| delta * unit),
        twist_m: fine.delta[1].map(|delta| delta * unit),
        error_m: differences.fold(0.0, f64::max) * unit,
        middle: [strain, turn / unit],
    })
}

/// The tube whose ends are those of an actuator.
fn straight(parameters: &ActuatorParameters<f64>) -> ActuatorParameters<f64> {
    if parameters.motion != Motion::Bending {
        return *parameters;
    }
    let radius_m = parameters.fiber.map_or(parameters.outer_radius_m, |fiber| fiber.radius_m);
    let fiber = Fiber {
        angle_rad: 0.0,
        families: Families::One,
        modulus_pa: STIFF * parameters.material.shear_modulus_pa(),
        placement: Placement::Sheet,
        thickness_m: 0.1 * (parameters.outer_radius_m - parameters.inner_radius_m),
        radius_m,
    };
    ActuatorParameters { motion: Motion::Extension, fiber: Some(fiber), ..*parameters }
}

struct Lengths {
    delta: [Option<f64>; 2],
    middle: [f64; 2],
}

fn lengths(tube: &ActuatorParameters<f64>, pressure_pa: f64, count: usize) -> Result<Lengths, MeridianError> {
    let (unit, modulus) = (tube.inner_radius_m, tube.material.shear_modulus_pa());
    let (outer, half) = (tube.outer_radius_m / unit, 0.5 * tube.length_m / unit);
    let wall = Wall::new(tube);
    let radii = across(outer, wall.edge(), count);
    let places = along(half, (outer - 1.0) / count as f64);
    let body = Body { wall, mesh: Mesh { radii, places }, end: EndOfWall::Bonded, band: None };
    let shaped: Shaped = body
        .inflate(pressure_pa / modulus)
        .map_err(|none| MeridianError::NoEquilibrium { pressure_pa, last_pa: none.last * modulus })?;
    let ([shift, turn], [strain, rate]) = (shaped.end(), shaped.middle(&body.mesh));
    let delta = |motion: f64, rate: f64| (rate.abs() >= LEAST_MOTION).then(|| half - motion / rate);
    Ok(Lengths { delta: [delta(shift, strain), delta(turn, rate)], middle: [strain, rate] })
}

/// Corners along half a tube, close together at the end.
fn along(half: f64, shortest: f64) -> Vec<f64> {
    let mut from_end = vec![0.0];
    let longest = f64::max(LONGEST, half / MOST);
    let (mut place, mut part) = (0.0, shortest);
    while place + 1.5 * part < half {
        place += part;
        from_end.push(place);
        part = (part * GROWTH).min(longest);
    }
    from_end.push(half);
    from_end.iter().rev().map(|place| half - place).collect()
}
