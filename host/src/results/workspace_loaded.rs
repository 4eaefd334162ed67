//! Reachable tip positions under weight.

use serde::Serialize;

use super::ResultError;
use super::workspace::{Extent, NAMES, Volume, WorkspaceOptions, extents};
use softlimb_limb::statics::{Load, LoadedLimb};
use softlimb_limb::workspace::{Extents, Grid, Loaded, LoadedExtents, LoadedReach, Tally, loaded_extents};
use softlimb_limb::{Limb, workspace};
use softlimb_scene::Scene;

/// Samples without load for each one under load: they cost next to nothing.
const FREE: usize = 16;

/// Reachable tip positions under the limb's own weight: poses that fall, buckle or bend backwards are not reached.
pub struct LoadedWorkspaceResult<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) limb: &'a Limb,
    pub(crate) payload_kg: f64,
    pub(crate) free: Extents,
    pub(crate) extents: LoadedExtents,
    pub(crate) tally: Tally,
    pub(crate) grids: [Grid; 2],
    /// Cubes of tips without load.
    pub(crate) free_grid: Grid,
    pub(crate) cell_m: f64,
    /// The samples that are reached: x, y, z, m.
    pub tips_m: Vec<[f64; 3]>,
}

impl<'a> LoadedWorkspaceResult<'a> {
    /// The extents, and samples, with a payload at the tip and plates in place of the modules' own.
    ///
    /// # Errors
    /// [`ResultError::NoEquilibrium`] when no sampled pose is reached.
    pub fn new(
        scene: &'a Scene,
        limb: &'a Limb,
        options: &WorkspaceOptions,
        payload_kg: f64,
        spacers: Option<u8>,
    ) -> Result<Self, ResultError> {
        limb.require_plane_benders(scene, "`workspace --loaded`")?;
        let WorkspaceOptions { command, points, samples: count, seed, threads, cell_m } = *options;
        let (space, free) = extents(limb, command)?;
        let bays: Vec<usize> =
            scene.modules().iter().map(|module| usize::from(spacers.unwrap_or(module.spacers)) + 1).collect();
        let load = Load { payload_kg, ..Load::default() };
        let loaded =
            Loaded::new(&space, |pressures_pa: &[f64]| LoadedLimb::new(scene, limb, pressures_pa, &bays, &load));
        let poses = loaded.sample(points, count, seed, threads);
        let tally = loaded.tally(&poses);
        let extents = loaded_extents(&loaded, &poses, (points, seed), threads).ok_or_else(|| {
            let reasons = unreached(&tally, limb).join("; ");
            ResultError::NoEquilibrium(format!("none of {count} poses is reached: {reasons}"))
        })?;
        let tips_m: Vec<[f64; 3]> = poses.iter().flatten().copied().collect();
        let grids = [cell_m, 2.0 * cell_m].map(|side| Grid::new(&tips_m, side, space.axes().len()));
        let free_m = workspace::sample_single(&space, points, FREE * count, seed, threads);
        let free_grid = Grid::new(&free_m, cell_m, space.axes().len());
        Ok(Self { scene, limb, payload_kg, free, extents, tally, grids, free_grid, cell_m, tips_m })
    }

    /// The result as `--json` prints it.
    pub fn printed(&self) -> impl Serialize {
        let extents =
            NAMES.iter().zip(&self.extents.of).enumerate().map(|(index, (&measure, [least, largest]))| Extent {
                measure,
                least: least.into(),
                largest: largest.into(),
                range_m: self.extents.range_m(index),
                range_without_load_m: Some(self.free.range_m(index)),
            });
        let tally = &self.tally;
        Printed {
            scene: self.scene.name(),
            weightless: false,
            mass_kg: self.scene.mass_kg(),
            payload_kg: self.payload_kg,
            extents: extents.collect(),
            poses: Poses {
                all: tally.total(),
                reached: tally.reached,
                fall: tally.falls,
                no_equilibrium: tally.no_equilibrium,
                modules: self.limb.modules().iter().map(|module| module.name.as_str()).collect(),
                buckle_by_module: &tally.buckles,
                bent_back_by_module: &tally.bent_back,
            },
            volume: Volume::new(self.cell_m, &self.grids),
        }
    }
}

/// Reasons of unreachable poses, with their numbers.
pub(crate) fn unreached(tally: &Tally, limb: &Limb) -> Vec<String> {
    let by_module = |counts: &[usize]| {
        let named = limb.modules().iter().zip(counts).filter(|(_, count)| **count > 0);
        named.map(|(module, count)| format!("{} {count}", module.name)).collect::<Vec<_>>().join(", ")
    };
    let mut parts = Vec::new();
    if tally.falls > 0 {
        parts.push(format!("in {} the limb falls", tally.falls));
    }
    let buckles = tally.buckles.iter().sum::<usize>();
    if buckles > 0 {
        let modules = by_module(&tally.buckles);
        parts.push(format!("in {buckles} a tube carries more than half of its load of buckling ({modules})"));
    }
    let bent = tally.bent_back.iter().sum::<usize>();
    if bent > 0 {
        parts.push(format!("in {bent} a bending module is bent backwards ({})", by_module(&tally.bent_back)));
    }
    if tally.no_equilibrium > 0 {
        parts.push(format!("in {} an actuator has no equilibrium", tally.no_equilibrium));
    }
    parts
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    scene: &'a str,
    weightless: bool,
    mass_kg: f64,
    payload_kg: f64,
    extents: Vec<Extent<PrintedReach<'a>>>,
    poses: Poses<'a>,
    volume: Volume,
}

#[derive(Serialize)]
struct PrintedReach<'a> {
    value_m: f64,
    tip_m: [f64; 3],
    pressures_pa: &'a [f64],
    error_m: f64,
    at_border: bool,
}

impl<'a> From<&'a LoadedReach> for PrintedReach<'a> {
    fn from(reach: &'a LoadedReach) -> Self {
        let LoadedReach { value_m, tip_m, ref pressures_pa, error_m, at_border } = *reach;
        Self { value_m, tip_m, pressures_pa, error_m, at_border }
    }
}

/// Numbers of sampled poses.
#[derive(Serialize)]
struct Poses<'a> {
    all: usize,
    reached: usize,
    fall: usize,
    no_equilibrium: usize,
    modules: Vec<&'a str>,
    buckle_by_module: &'a [usize],
    bent_back_by_module: &'a [usize],
}
