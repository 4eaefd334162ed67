//! `softlimb workspace`: the reachable tip positions.

use std::fmt::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::shared::{limb, quantity, show, threads, write_if};
use super::{Failure, Outcome};
use softlimb_chart::labelled;
use softlimb_limb::Limb;
use softlimb_limb::workspace;
use softlimb_limb::workspace::{Command, Convergence, Extents, Grid, Points, Reach};
use softlimb_scene::Quantity;

/// Names of what is measured.
pub(super) const NAMES: [&str; 4] = ["x", "y", "z", "distance"];
/// Numbers of samples whose convergence is shown, as shares of all.
const SHARES: [usize; 4] = [1000, 100, 10, 1];

/// Find the exact extents of the tip, and sample its workspace for pictures and volume
#[derive(Args)]
#[command(after_help = "Scope: docs/guide/workspace.md\n\n\
                        Example: softlimb workspace scenes/pick-and-place-a.toml --svg workspace.svg")]
pub(super) struct Workspace {
    /// The scene file
    scene: PathBuf,
    /// The free pressures
    #[arg(long, value_enum, default_value_t = Pressures::Actuators)]
    pressures: Pressures,
    /// Under the limb's own weight: poses that fall, buckle or bend backwards are counted as not reached
    #[arg(long)]
    pub(super) loaded: bool,
    /// Mass at the tip, 0 to 100 kg
    #[arg(long, value_name = "KG", requires = "loaded", default_value = "0 kg", value_parser = quantity("kg", 0.0, 100.0))]
    pub(super) payload: Quantity,
    /// Plates in each module, in place of the modules' own `spacers`
    #[arg(long, value_name = "N", requires = "loaded", value_parser = clap::value_parser!(u8).range(0..=50))]
    pub(super) spacers: Option<u8>,
    /// Number of samples [default: 1000000, or 4096 with --loaded]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    samples: Option<u32>,
    /// Distribution of the samples in the box of pressures
    #[arg(long, value_enum, default_value_t = Filling::Faces)]
    pub(super) points: Filling,
    /// Seed of the samples
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
    /// Threads; the samples do not depend on it [default: one for each processor]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// Side of the counted cubes, 1 to 1000 mm [default: 20 mm, or 100 mm with --loaded]
    #[arg(long, value_name = "MM", value_parser = quantity("mm", 1.0, 1e3))]
    cell: Option<Quantity>,
    /// Write side and front view
    #[arg(long, value_name = "FILE")]
    pub(super) svg: Option<PathBuf>,
    /// Write the samples: x, y, z in m
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Pressures {
    /// A pressure for each actuator of extending and expanding modules, one for each other module
    Actuators,
    /// A pressure for each setpoint: of a module, or of an actuator of a steering module
    Modules,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Filling {
    /// Low discrepancy, a third of each pressure's samples at its ends
    Faces,
    /// Low discrepancy, even
    Even,
    /// Independent random numbers: plain Monte Carlo
    Random,
}

impl From<Filling> for Points {
    fn from(filling: Filling) -> Self {
        match filling {
            Filling::Faces => Self::Faces,
            Filling::Even => Self::Even,
            Filling::Random => Self::Random,
        }
    }
}

/// Everything that is shown.
struct Answer<'a> {
    name: &'a str,
    space: workspace::Workspace<'a>,
    limb: &'a Limb,
    extents: Extents,
    grids: [Grid; 2],
    thinned: Grid,
    rows: Vec<Convergence>,
    cell_m: f64,
}

impl Workspace {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (scene, limb) = limb(&self.scene)?;
        let command = match self.pressures {
            Pressures::Actuators => Command::Actuators,
            Pressures::Modules => Command::Modules,
        };
        let space = workspace::Workspace::new(&limb, command).map_err(Failure::new)?;
        let extents = workspace::extents(&space)
            .ok_or_else(|| Failure::new("the model has no equilibrium at an extreme of the workspace"))?;
        if self.loaded {
            return self.run_loaded(&scene, &limb, &space, &extents);
        }
        let (count, threads) = (self.count(1_000_000), threads(self.threads));
        let tips = workspace::sample_single(&space, self.points.into(), count, self.seed, threads);
        let cell_m = self.cell_m(0.02);
        let counts = SHARES.map(|share| (count / share).max(1));
        let answer = Answer {
            name: scene.name(),
            rows: workspace::convergence(&space, &extents, &counts, self.seed, threads),
            grids: [cell_m, 2.0 * cell_m].map(|side| Grid::new(&tips, side)),
            thinned: Grid::new(&tips[..count.div_ceil(4)], cell_m),
            limb: &limb,
            extents,
            space,
            cell_m,
        };
        write_if(self.csv.as_ref(), || csv(&tips))?;
        let title = labelled(scene.name(), true);
        write_if(self.svg.as_ref(), || workspace::picture(&title, &answer.grids[0], &rest_m(&limb)))?;
        show(self.json, &answer.printed(), || answer.table())?;
        Ok(Outcome::Done)
    }

    pub(super) fn count(&self, by_default: u32) -> usize {
        self.samples.unwrap_or(by_default) as usize
    }

    pub(super) fn cell_m(&self, by_default: f64) -> f64 {
        self.cell.as_ref().map_or(by_default, Quantity::si)
    }
}

/// The centre line at rest, m.
pub(super) fn rest_m(limb: &Limb) -> Vec<[f64; 3]> {
    let rest: Vec<_> = limb.drives().map(|drive| drive.curve.states()[0]).collect();
    limb.backbone(&rest)
}

pub(super) fn csv<T: Copy + Into<f64>>(tips: &[[T; 3]]) -> String {
    let mut text = String::from("x_m,y_m,z_m\n");
    for [x, y, z] in tips.iter().map(|tip| tip.map(Into::into)) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{x:.6},{y:.6},{z:.6}");
    }
    text
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
pub(super) struct Extent<R> {
    pub(super) measure: &'static str,
    pub(super) least: R,
    pub(super) largest: R,
    pub(super) range_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) range_without_load_m: Option<f64>,
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
pub(super) struct Volume {
    cell_m: f64,
    volume_m3: f64,
    with_double_cells_m3: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    with_a_quarter_of_the_samples_m3: Option<f64>,
}

impl Volume {
    pub(super) fn new(cell_m: f64, [fine, coarse]: &[Grid; 2]) -> Self {
        let (volume_m3, with_double_cells_m3) = (fine.volume_m3(), coarse.volume_m3());
        Self { cell_m, volume_m3, with_double_cells_m3, with_a_quarter_of_the_samples_m3: None }
    }
}

#[derive(Serialize)]
struct Row {
    samples: usize,
    missing: [f64; 3],
}

impl Answer<'_> {
    fn printed(&self) -> Printed<'_> {
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

    /// Writing to a string cannot fail.
    fn table(&self) -> String {
        let mut text = String::new();
        let each = if self.space.command() == Command::Actuators { "each actuator" } else { "each setpoint" };
        let axes = self.space.axes();
        let _ = writeln!(text, "{}: {} pressures, {each} on its own; m", labelled(self.name, true), axes.len());
        let _ = writeln!(text, "\n{:10} {:>9} {:>9} {:>9}   corners alone miss", "", "least", "largest", "range");
        for (index, (name, [least, largest])) in NAMES.iter().zip(&self.extents.of).enumerate() {
            let range = self.extents.range_m(index);
            let missed = ((least.corner_m - least.value_m) + (largest.value_m - largest.corner_m)) / range.max(1e-12);
            let (low, high) = (least.value_m, largest.value_m);
            let _ = writeln!(text, "{name:10} {low:9.4} {high:9.4} {range:9.4}   {:.3} %", 100.0 * missed.max(0.0));
        }
        let [fine, coarse] = &self.grids;
        let _ = writeln!(
            text,
            "\nvolume  {:.4} m3 in cubes of {:.0} mm; {:.4} m3 in cubes twice as wide; {:.4} m3 by a quarter of the samples",
            fine.volume_m3(),
            self.cell_m * 1e3,
            coarse.volume_m3(),
            self.thinned.volume_m3(),
        );
        let _ = writeln!(text, "\nlargest part of a range that samples miss, %");
        let _ =
            writeln!(text, "{:>10} {:>12} {:>16} {:>12}", "samples", "Monte Carlo", "low discrepancy", "with faces");
        for row in &self.rows {
            let [random, even, faces] = row.missing.map(|share| 100.0 * share);
            let _ = writeln!(text, "{:10} {random:12.3} {even:16.3} {faces:12.3}", row.count);
        }
        for axis in axes.iter().filter(|axis| axis.ends_at_limit) {
            let (name, kpa) = (&self.limb.modules()[axis.module].name, axis.pressure_max_pa * 1e-3);
            let _ = writeln!(text, "{name}: at most {kpa:.2} kPa, just below its limit point");
        }
        text
    }
}
