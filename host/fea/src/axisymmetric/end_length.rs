//! Length of an actuator that its caps take out of its motion.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Motion, Placement};

use super::body::{Body, Shaped};
use super::mesh::{EndOfWall, Mesh};
use super::wall::Wall;
use super::{MeridianError, across};
use crate::cross_section::is_wound_bender;
use softlimb_files::range::positive;

/// Elements across the wall, of the coarser of two meshes.
const ACROSS: usize = 3;
/// Growth of the elements from the cap towards the middle; those at the cap are as long as those across the wall are wide.
const GROWTH: f64 = 1.25;
/// Longest element towards the middle, in inner radii, unless there would be more elements than this.
const LONGEST: f64 = 0.5;
const MOST: f64 = 200.0;
/// Smallest part of the largest strain at mid-length that a motion must be to have an end length.
const LEAST_SHARE: f64 = 0.2;
/// Modulus of an unstated winding of a bending actuator over that of its wall: it keeps its radius.
const STIFF: f64 = 1e4;

/// The length at each end that does not take part: an actuator of length `L` between bonded caps moves as one of length `L - 2 delta`
/// does without them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delta {
    /// `delta`, m.
    pub delta_m: f64,
    /// Its change on a mesh of half the size, m.
    pub error_m: f64,
}

/// The end lengths of an actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndLength {
    /// That of the change of length, and of a bend; none where the actuator hardly changes its length.
    pub axial: Option<Delta>,
    /// That of the twist; none where the actuator hardly twists.
    pub twist: Option<Delta>,
    /// Axial strain at mid-length.
    pub axial_strain: f64,
    /// Twist rate at mid-length, rad/m.
    pub twist_rate_rad_per_m: f64,
}

/// The end lengths of an actuator with one or two windings at a gauge pressure, Pa.
///
/// A bending actuator is taken as the tube with its windings alone, without the limiting layer: the cap does the same to it. A winding without
/// a modulus is hoops that keep their radius.
///
/// # Errors
/// [`MeridianError`]; the fields of the second winding are `second_fiber.*`.
pub fn end_length(
    parameters: &ActuatorParameters<f64>,
    second_fiber: Option<&Fiber<f64>>,
    pressure_pa: f64,
) -> Result<EndLength, MeridianError> {
    Actuator::new(parameters)?;
    positive("pressure_pa", pressure_pa)?;
    let tube = straight(parameters);
    let actuator = Actuator::new(&tube)?;
    if let Some(second) = second_fiber {
        actuator.with_second_fiber(second)?;
    }
    let coarse = lengths(&tube, second_fiber, pressure_pa, ACROSS)?;
    let fine = lengths(&tube, second_fiber, pressure_pa, 2 * ACROSS)?;
    let unit = tube.inner_radius_m;
    let [axial_strain, twist_rate, hoop_strain] = fine.middle;
    let delta = |motion: usize| {
        let (fine, coarse) = (fine.delta[motion]?, coarse.delta[motion]?);
        Some(Delta { delta_m: fine * unit, error_m: (fine - coarse).abs() * unit })
    };
    let (axial, twist) = (delta(0), delta(1));
    if axial.is_none() && twist.is_none() {
        return Err(MeridianError::NoMotion { axial_strain, hoop_strain });
    }
    Ok(EndLength { axial, twist, axial_strain, twist_rate_rad_per_m: twist_rate / unit })
}

/// The tube whose ends are those of an actuator.
fn straight(parameters: &ActuatorParameters<f64>) -> ActuatorParameters<f64> {
    let tube = ActuatorParameters { motion: Motion::Extension, ..*parameters };
    if parameters.motion != Motion::Bending || is_wound_bender(parameters) {
        return tube;
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
    ActuatorParameters { fiber: Some(fiber), ..tube }
}

struct Lengths {
    delta: [Option<f64>; 2],
    middle: [f64; 3],
}

fn lengths(
    tube: &ActuatorParameters<f64>,
    second_fiber: Option<&Fiber<f64>>,
    pressure_pa: f64,
    count: usize,
) -> Result<Lengths, MeridianError> {
    let (unit, modulus) = (tube.inner_radius_m, tube.material.shear_modulus_pa());
    let (outer, half) = (tube.outer_radius_m / unit, 0.5 * tube.length_m / unit);
    let wall = Wall::new(tube, second_fiber);
    let radii = across(outer, &wall.edges(), count);
    let places = along(half, (outer - 1.0) / count as f64);
    let body = Body { wall, mesh: Mesh { radii, places }, end: EndOfWall::Bonded, band: None };
    let shaped: Shaped = body
        .inflate(pressure_pa / modulus)
        .map_err(|none| MeridianError::NoEquilibrium { pressure_pa, last_pa: none.last * modulus })?;
    let ([shift, turn], middle) = (shaped.end(), shaped.middle(&body.mesh));
    let [strain, rate, hoop] = middle;
    // A shear of the outer surface compares with a strain.
    let shear = rate * outer;
    let largest = strain.abs().max(hoop.abs()).max(shear.abs());
    let delta = |motion: f64, rate: f64, size: f64| (size.abs() >= LEAST_SHARE * largest).then(|| half - motion / rate);
    Ok(Lengths { delta: [delta(shift, strain, strain), delta(turn, rate, shear)], middle })
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
