//! Stiffness of a wound thread of some pitch as a sheet.

use fra_model::{Actuator, ActuatorParameters, Families, Fiber, Load, Motion, Placement, Status};

use super::body::Body;
use super::mesh::{EndOfWall, Mesh};
use super::wall::{Wall, Winding};
use super::{MeridianError, across};
use crate::spacing::evenly;
use softlimb_files::range::{positive, require};

/// Elements across the wall, of the coarser of two meshes.
const ACROSS: usize = 3;
/// Elements on half the thread's width, of the coarser mesh.
const ON_THREAD: usize = 1;
/// Growth of the elements away from the thread.
const GROWTH: f64 = 1.4;
/// Largest difference of two meshes that an answer may have, as a share.
const LARGEST_ERROR: f64 = 0.1;
/// Least change of the strain, as a share, with a sheet of a tenth more stiffness that a stiffness can be read from.
const LEAST_CHANGE: f64 = 1e-6;
/// Range of sheet moduli searched, over the wall's shear modulus, for a sheet as thick as a tenth of the wall.
const MODULI: [f64; 2] = [1e-3, 1e7];

/// A thread wound nearly in the hoop direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// Force per strain `E A`, N.
    pub stiffness_n: f64,
    /// Distance of one turn to the next along the axis, m; with two helices half the lead.
    pub spacing_m: f64,
    /// Width on the surface, m, over which the thread holds the wall; less than the spacing.
    pub width_m: f64,
}

/// The sheet that a thread is worth. Its energy per area is `km/2 (I4 - 1)^2`; a scene's winding has `km = families modulus thickness`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadSheet {
    /// `km = E A/(4 spacing)`, N/m: that of threads so close that the wall cannot bulge between them.
    pub ideal_n_per_m: f64,
    /// `km` of the sheet that lengthens as much as the thread at the pressure, N/m.
    pub effective_n_per_m: f64,
    /// Its relative change on a mesh of half the size.
    pub error: f64,
    /// Axial strain with the thread.
    pub strain: f64,
    /// Axial strain with the ideal sheet.
    pub ideal_strain: f64,
}

/// The sheet worth a hoop thread on a tube of the parameters' wall, at their winding radius, at a gauge pressure, Pa. Modulus, angle and
/// placement of the parameters' winding are not used.
///
/// The thread's turns are taken as rings, each the width of the thread, and one period of the wall between two planes of symmetry is solved.
///
/// # Errors
/// [`MeridianError`].
pub fn thread_sheet(
    parameters: &ActuatorParameters<f64>,
    thread: &Thread,
    pressure_pa: f64,
) -> Result<ThreadSheet, MeridianError> {
    Actuator::new(parameters)?;
    positive("pressure_pa", pressure_pa)?;
    positive("stiffness_n", thread.stiffness_n)?;
    positive("spacing_m", thread.spacing_m)?;
    positive("width_m", thread.width_m)?;
    require(thread.width_m < thread.spacing_m, "width_m", thread.width_m, "less than the spacing")?;
    let tube = ActuatorParameters { motion: Motion::Extension, ..*parameters };
    let ideal_n_per_m = thread.stiffness_n / (4.0 * thread.spacing_m);
    let coarse = strain(&tube, thread, pressure_pa, 1)?;
    let fine = strain(&tube, thread, pressure_pa, 2)?;
    let [of_coarse, of_fine] = [coarse, fine].map(|strain| matching(&tube, strain, pressure_pa));
    let (of_coarse, of_fine) = (of_coarse?, of_fine?);
    let by_sheet = sheet_strain(&tube, ideal_n_per_m, pressure_pa)?;
    let error = (of_fine / of_coarse - 1.0).abs();
    if error > LARGEST_ERROR {
        return Err(MeridianError::TooCoarse { error });
    }
    Ok(ThreadSheet { ideal_n_per_m, effective_n_per_m: of_fine, error, strain: fine, ideal_strain: by_sheet })
}

/// The axial strain of one period.
fn strain(
    tube: &ActuatorParameters<f64>,
    thread: &Thread,
    pressure_pa: f64,
    finer: usize,
) -> Result<f64, MeridianError> {
    let (unit, modulus) = (tube.inner_radius_m, tube.material.shear_modulus_pa());
    let outer = tube.outer_radius_m / unit;
    let radius = tube.fiber.map_or(outer, |fiber| fiber.radius_m / unit);
    let (half, edge) = (0.5 * thread.spacing_m / unit, 0.5 * thread.width_m / unit);
    // The radius of a thread within the wall is a mesh line, and the elements get small towards it.
    let radii = refined(across(outer, &[radius], ACROSS * finer), radius, edge / (ON_THREAD * finer) as f64);
    let mut places: Vec<f64> = evenly(0.0, edge, ON_THREAD * finer).collect();
    places.extend(growing(edge, half, edge / (ON_THREAD * finer) as f64).into_iter().skip(1));
    let per_area = thread.stiffness_n / (4.0 * thread.width_m) / (modulus * unit);
    let winding = Winding { modulus: per_area, cos: 1.0, sin: 0.0, families: Families::Two };
    // Two families in one direction share the modulus.
    let winding = Winding { modulus: 0.5 * winding.modulus, ..winding };
    let body = Body {
        wall: Wall::new(&ActuatorParameters { fiber: None, ..*tube }, None),
        mesh: Mesh { radii, places },
        end: EndOfWall::Mirror,
        band: Some((radius, edge, winding)),
    };
    let shaped = body
        .inflate(pressure_pa / modulus)
        .map_err(|none| MeridianError::NoEquilibrium { pressure_pa, last_pa: none.last * modulus })?;
    Ok(shaped.end()[0] / half)
}

/// Corners from one place to another, the first part as given and each next one longer.
fn growing(from: f64, to: f64, first: f64) -> Vec<f64> {
    let mut corners = vec![from];
    let (mut place, mut part) = (from, first);
    while place + 1.5 * part < to {
        place += part;
        corners.push(place);
        part *= GROWTH;
    }
    corners.push(to);
    corners
}

/// Corners with more of them towards a place, where parts are not longer than `finest`.
fn refined(corners: Vec<f64>, place: f64, finest: f64) -> Vec<f64> {
    let mut all = vec![corners[0]];
    for pair in corners.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let mut between = if (to - place).abs() < 1e-9 {
            growing(0.0, to - from, finest).iter().rev().map(|x| to - x).collect()
        } else if (from - place).abs() < 1e-9 {
            growing(from, to, finest)
        } else {
            vec![from, to]
        };
        between.remove(0);
        all.append(&mut between);
    }
    all
}

/// Stiffness of the hoop sheet that gives an axial strain.
fn matching(tube: &ActuatorParameters<f64>, strain: f64, pressure_pa: f64) -> Result<f64, MeridianError> {
    let unit = tube.material.shear_modulus_pa() * 0.1 * (tube.outer_radius_m - tube.inner_radius_m);
    let [mut low, mut high] = MODULI.map(|modulus| (modulus * unit).ln());
    let most = sheet_strain(tube, high.exp(), pressure_pa)?;
    // A stiffer sheet keeps the radius, so that more of the pressure lengthens the tube.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let below = match sheet_strain(tube, middle.exp(), pressure_pa) {
            Ok(found) => found < strain,
            Err(MeridianError::NoEquilibrium { .. }) => true,
            Err(error) => return Err(error),
        };
        if below { low = middle } else { high = middle }
    }
    let found = (0.5 * (low + high)).exp();
    // The softest sheet may be beyond its limit point: then there is no least strain but that of rest.
    let least = sheet_strain(tube, MODULI[0] * unit, pressure_pa).unwrap_or(0.0);
    let [here, stiffer] = [found, 1.1 * found].map(|per_area| sheet_strain(tube, per_area, pressure_pa));
    let is_read = match (here, stiffer) {
        (Ok(here), Ok(stiffer)) => {
            (here - strain).abs() <= 1e-6 * strain.abs() && (stiffer - here).abs() >= LEAST_CHANGE * strain.abs()
        }
        _ => false,
    };
    if is_read { Ok(found) } else { Err(MeridianError::NotMatched { strain, least, most }) }
}

/// Axial strain of a tube with a hoop sheet of a stiffness, by the thick-walled model.
fn sheet_strain(tube: &ActuatorParameters<f64>, per_area: f64, pressure_pa: f64) -> Result<f64, MeridianError> {
    let thickness_m = 0.1 * (tube.outer_radius_m - tube.inner_radius_m);
    let fiber = Fiber {
        angle_rad: 0.0,
        families: Families::One,
        modulus_pa: per_area / thickness_m,
        placement: Placement::Sheet,
        thickness_m,
        radius_m: tube.fiber.map_or(tube.outer_radius_m, |fiber| fiber.radius_m),
    };
    let solution =
        Actuator::new(&ActuatorParameters { fiber: Some(fiber), ..*tube })?.forward(pressure_pa, &Load::none())?;
    match solution.status {
        Status::Solved => Ok(solution.state.axial_strain),
        _ => Err(MeridianError::NoEquilibrium { pressure_pa, last_pa: solution.limit_pressure_pa.unwrap_or(0.0) }),
    }
}
