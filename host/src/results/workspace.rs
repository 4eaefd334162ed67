//! Reachable tip positions of the weightless limb.

use serde::Serialize;

use super::ResultError;
use softlimb_limb::Limb;
use softlimb_limb::workspace;
use softlimb_limb::workspace::{Command, Convergence, Extents, Grid, Points, Reach, Workspace};
use softlimb_scene::Scene;

/// Names of what is measured.
pub(crate) const NAMES: [&str; 4] = ["x", "y", "z", "distance"];
/// Numbers of samples whose convergence is shown, as shares of all.
const SHARES: [usize; 4] = [1000, 100, 10, 1];

/// Free pressures and samples of a workspace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkspaceOptions {
    /// The free pressures.
    pub command: Command,
    /// Distribution of the samples in the box of pressures.
    pub points: Points,
    /// Number of samples.
    pub samples: usize,
    /// Seed of the samples.
    pub seed: u64,
    /// Number of threads; the samples do not depend on it.
    pub threads: usize,
    /// Side of the counted cubes, m.
    pub cell_m: f64,
}

/// Reachable tip positions of the weightless limb.
pub struct WorkspaceResult<'a> {
    name: &'a str,
    limb: &'a Limb,
    pub(crate) space: Workspace<'a>,
    pub(crate) extents: Extents,
    pub(crate) grids: [Grid; 2],
    pub(crate) thinned: Grid,
    pub(crate) rows: Vec<Convergence>,
    pub(crate) cell_m: f64,
    /// The samples: x, y, z, m.
    pub tips_m: Vec<[f32; 3]>,
}

/// The free pressures of a limb, and the exact extents that its tip reaches without weight.
///
/// # Errors
/// [`ResultError::NoEquilibrium`].
pub(crate) fn extents(limb: &Limb, command: Command) -> Result<(Workspace<'_>, Extents), ResultError> {
    let space = Workspace::new(limb, command).map_err(|error| ResultError::NoEquilibrium(error.to_string()))?;
    let extents = workspace::extents(&space);
    let none = || ResultError::NoEquilibrium("the model has no equilibrium at an extreme of the workspace".to_owned());
    let extents = extents.ok_or_else(none)?;
    Ok((space, extents))
}

impl<'a> WorkspaceResult<'a> {
    /// The extents, and samples for volume and pictures.
    ///
    /// # Errors
    /// [`ResultError::NoEquilibrium`], and [`ResultError::Scene`] at the second winding of a bender that twists.
    pub fn new(scene: &'a Scene, limb: &'a Limb, options: &WorkspaceOptions) -> Result<Self, ResultError> {
        let WorkspaceOptions { command, points, samples: count, seed, threads, cell_m } = *options;
        limb.require_plane_benders(scene, "`workspace`")?;
        let (space, extents) = extents(limb, command)?;
        let tips_m = workspace::sample_single(&space, points, count, seed, threads);
        let counts = SHARES.map(|share| (count / share).max(1));
        Ok(Self {
            name: scene.name(),
            rows: workspace::convergence(&space, &extents, &counts, seed, threads),
            grids: [cell_m, 2.0 * cell_m].map(|side| Grid::new(&tips_m, side, space.axes().len())),
            thinned: Grid::new(&tips_m[..count.div_ceil(4)], cell_m, space.axes().len()),
            limb,
            extents,
            space,
            cell_m,
            tips_m,
        })
    }

    /// The result as `--json` prints it.
    pub fn printed(&self) -> impl Serialize {
        let extents =
            NAMES.iter().zip(&self.extents.of).enumerate().map(|(index, (&measure, [least, largest]))| Extent {
                measure,
                least: least.into(),
                largest: largest.into(),
                range_m: self.extents.range_m(index),
                range_without_load_m: None,
            });
        let axes = self.space.axes().iter().map(|axis| Axis {
            module: &self.limb.modules()[axis.module].name,
            channels: [axis.channels.start, axis.channels.end],
            pressure_max_pa: axis.pressure_max_pa,
            ends_at_limit_point: axis.ends_at_limit,
        });
        let rows = self.rows.iter().map(|row| Row { samples: row.count, missing: row.missing });
        Printed {
            scene: self.name,
            weightless: true,
            axes: axes.collect(),
            table_error: self.space.error(),
            extents: extents.collect(),
            kinematics: Kinematics {
                origin_m: self.space.base(),
                rotation: self.space.rotation(),
                modules: self.space.tables(),
            },
            volume: Volume {
                with_a_quarter_of_the_samples_m3: Some(self.thinned.volume_m3()),
                ..Volume::new(self.cell_m, &self.grids)
            },
            convergence: rows.collect(),
        }
    }
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    scene: &'a str,
    weightless: bool,
    axes: Vec<Axis<'a>>,
    table_error: f64,
    extents: Vec<Extent<PrintedReach<'a>>>,
    kinematics: Kinematics,
    volume: Volume,
    convergence: Vec<Row>,
}

#[derive(Serialize)]
struct Axis<'a> {
    module: &'a str,
    channels: [usize; 2],
    pressure_max_pa: f64,
    ends_at_limit_point: bool,
}

/// Range of a coordinate or of the distance.
#[derive(Serialize)]
pub(crate) struct Extent<R> {
    pub(crate) measure: &'static str,
    pub(crate) least: R,
    pub(crate) largest: R,
    pub(crate) range_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) range_without_load_m: Option<f64>,
}

#[derive(Serialize)]
struct PrintedReach<'a> {
    value_m: f64,
    tip_m: [f64; 3],
    pressures_pa: &'a [f64],
    best_corner_m: f64,
    table_error_m: f64,
}

impl<'a> From<&'a Reach> for PrintedReach<'a> {
    fn from(reach: &'a Reach) -> Self {
        Self {
            value_m: reach.value_m,
            tip_m: reach.tip_m,
            pressures_pa: &reach.pressures_pa,
            best_corner_m: reach.corner_m,
            table_error_m: reach.table_error_m,
        }
    }
}

#[derive(Serialize)]
struct Kinematics {
    origin_m: [f64; 3],
    rotation: [[f64; 3]; 3],
    modules: Vec<workspace::ModuleTable>,
}

/// Volume of the counted cubes.
#[derive(Serialize)]
pub(crate) struct Volume {
    cell_m: f64,
    volume_m3: f64,
    with_double_cells_m3: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    with_a_quarter_of_the_samples_m3: Option<f64>,
}

impl Volume {
    pub(crate) fn new(cell_m: f64, [fine, coarse]: &[Grid; 2]) -> Self {
        let (volume_m3, with_double_cells_m3) = (fine.volume_m3(), coarse.volume_m3());
        Self { cell_m, volume_m3, with_double_cells_m3, with_a_quarter_of_the_samples_m3: None }
    }
}

#[derive(Serialize)]
struct Row {
    samples: usize,
    missing: [f64; 3],
}
