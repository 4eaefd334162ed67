//! `softlimb workspace`: where can the tip be?

use std::fmt::Write;
use std::num::NonZero;
use std::path::PathBuf;
use std::thread;

use clap::{Args, ValueEnum};
use serde_json::{Value, json};

use super::kept::write;
use super::{Failure, Outcome};
use softlimb_limb::Limb;
use softlimb_limb::workspace;
use softlimb_limb::workspace::{Command, Convergence, Extents, Grid, Points, Reach};
use softlimb_scene as scene;
use softlimb_scene::{WEIGHTLESS, labelled};

/// Names of what is measured.
pub(super) const NAMES: [&str; 4] = ["x", "y", "z", "distance"];
/// Numbers of samples whose convergence is shown, as shares of all.
const SHARES: [usize; 4] = [1000, 100, 10, 1];

/// Find the tip's extents exactly, and sample its workspace for pictures and volume
#[derive(Args)]
#[command(after_help = "Example: softlimb workspace scenes/pick-and-place-a.toml --svg workspace.svg\n\n\
                        What is and is not looked at: docs/workspace.md")]
pub(super) struct Workspace {
    /// The scene file
    scene: PathBuf,
    /// What is free to choose
    #[arg(long, value_enum, default_value_t = Pressures::Actuators)]
    pressures: Pressures,
    /// Under the limb's own weight: poses that fall, buckle or bend backwards are counted and not shown as reached
    #[arg(long)]
    pub(super) loaded: bool,
    /// Mass at the tip, kg
    #[arg(long, value_name = "KG", requires = "loaded", default_value_t = 0.0, value_parser = mass)]
    pub(super) payload: f64,
    /// Plates in each module, in place of the modules' own `spacers`
    #[arg(long, value_name = "N", requires = "loaded", value_parser = clap::value_parser!(u8).range(0..=50))]
    pub(super) spacers: Option<u8>,
    /// Number of samples; default: 1000000, or 4096 with `--loaded`
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    samples: Option<u32>,
    /// How the samples fill the box of pressures
    #[arg(long, value_enum, default_value_t = Filling::Faces)]
    pub(super) points: Filling,
    /// Seed of the samples
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
    /// Threads; default: as many as processors. The samples do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Side of the cubes that are counted, mm; default: 20, or 100 with `--loaded`
    #[arg(long, value_parser = cell)]
    cell: Option<f64>,
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
    /// One pressure for each module, as setpoints have it
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

fn cell(text: &str) -> Result<f64, String> {
    let side: f64 = text.parse().map_err(|_| "a number of mm, 1 to 1000".to_owned())?;
    if (1.0..=1000.0).contains(&side) { Ok(side) } else { Err("1 to 1000 mm".to_owned()) }
}

fn mass(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|found| (0.0..=100.0).contains(found));
    found.ok_or_else(|| "a number of 0 to 100 kg".to_owned())
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
        let scene = scene::load(&self.scene)?;
        let limb = Limb::new(&scene)?;
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
        let (count, threads) = (self.count(1_000_000), self.threads());
        let tips = workspace::sample_single(&space, self.points.into(), count, self.seed, threads);
        let cell_m = self.cell_m(20.0);
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
        if let Some(file) = &self.csv {
            write(file, &csv(&tips))?;
        }
        if let Some(file) = &self.svg {
            write(file, &workspace::picture(&labelled(scene.name(), true), &answer.grids[0], &rest_m(&limb)))?;
        }
        if self.json {
            super::say(&answer.json().to_string())?
        } else {
            super::say(&answer.table())?
        }
        Ok(Outcome::Done)
    }

    pub(super) fn count(&self, by_default: u32) -> usize {
        self.samples.unwrap_or(by_default) as usize
    }

    pub(super) fn cell_m(&self, by_default_mm: f64) -> f64 {
        self.cell.unwrap_or(by_default_mm) * 1e-3
    }

    pub(super) fn threads(&self) -> usize {
        self.threads.map_or_else(|| thread::available_parallelism().map_or(1, NonZero::get), usize::from)
    }
}

/// The centre line at rest, m.
pub(super) fn rest_m(limb: &Limb) -> Vec<[f64; 3]> {
    let rest: Vec<_> = limb.modules().iter().map(|module| module.curve.states()[0]).collect();
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

impl Answer<'_> {
    fn json(&self) -> Value {
        let reach = |reach: &Reach| {
            json!({
                "value_m": reach.value_m,
                "tip_m": reach.tip_m,
                "pressures_pa": reach.pressures_pa,
                "best_corner_m": reach.corner_m,
                "table_error_m": reach.table_error_m,
            })
        };
        let extents: Vec<_> = NAMES
            .iter()
            .zip(&self.extents.of)
            .enumerate()
            .map(|(index, (name, [least, largest]))| {
                json!({"measure": name, "least": reach(least), "largest": reach(largest), "range_m": self.extents.range_m(index)})
            })
            .collect();
        let axes: Vec<_> = self
            .space
            .axes()
            .iter()
            .map(|axis| {
                json!({
                    "module": self.limb.modules()[axis.module].name,
                    "channels": [axis.channels.start, axis.channels.end],
                    "pressure_max_pa": axis.pressure_max_pa,
                    "ends_at_limit_point": axis.ends_at_limit,
                })
            })
            .collect();
        let rows: Vec<_> = self.rows.iter().map(|row| json!({"samples": row.count, "missing": row.missing})).collect();
        json!({
            "scene": self.name,
            WEIGHTLESS: true,
            "axes": axes,
            "table_error": self.space.error(),
            "extents": extents,
            "kinematics": {"origin_m": self.space.base(), "rotation": self.space.rotation(), "modules": self.space.tables()},
            "volume": {
                "cell_m": self.cell_m,
                "volume_m3": self.grids[0].volume_m3(),
                "with_double_cells_m3": self.grids[1].volume_m3(),
                "with_a_quarter_of_the_samples_m3": self.thinned.volume_m3(),
            },
            "convergence": rows,
        })
    }

    /// Writing to a string cannot fail.
    fn table(&self) -> String {
        let mut text = String::new();
        let each = if self.space.command() == Command::Actuators { "each actuator" } else { "each module" };
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
