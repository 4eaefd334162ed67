//! `softlimb workspace`: the reachable tip positions.

use std::fmt::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::shared::{limb, quantity, show_of, threads, write_if};
use super::{Failure, Outcome, workspace_loaded};
use crate::results::{LoadedWorkspaceResult, NAMES, WorkspaceOptions, WorkspaceResult};
use softlimb_chart::labelled;
use softlimb_limb::Limb;
use softlimb_limb::workspace;
use softlimb_limb::workspace::{Command, ExtremeLine, Points};
use softlimb_scene::Quantity;

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
    loaded: bool,
    /// Mass at the tip, 0 to 100 kg
    #[arg(long, value_name = "KG", requires = "loaded", default_value = "0 kg", value_parser = quantity("kg", 0.0, 100.0))]
    payload: Quantity,
    /// Plates in each module, in place of the modules' own `spacers`
    #[arg(long, value_name = "N", requires = "loaded", value_parser = clap::value_parser!(u8).range(0..=50))]
    spacers: Option<u8>,
    /// Number of samples [default: 1000000, or 4096 with --loaded]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    samples: Option<u32>,
    /// Distribution of the samples in the box of pressures
    #[arg(long, value_enum, default_value_t = Filling::Faces)]
    points: Filling,
    /// Seed of the samples
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads; the samples do not depend on it [default: one for each processor]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Side of the counted cubes, 1 to 1000 mm [default: 20 mm, or 100 mm with --loaded]
    #[arg(long, value_name = "MM", value_parser = quantity("mm", 1.0, 1e3))]
    cell: Option<Quantity>,
    /// Write three views, shaded by depth
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    /// Write the samples: x, y, z in m
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Line of a workspace that its tips do not fill.
pub(super) const NO_VOLUME: &str = "\nvolume  none: the tips lie on a curve or a surface\n";

#[derive(Clone, Copy, ValueEnum)]
enum Pressures {
    /// A pressure for each actuator of extending and expanding modules, one for each other module
    Actuators,
    /// A pressure for each setpoint: of a module, or of an actuator of a steering module
    Modules,
}

#[derive(Clone, Copy, ValueEnum)]
enum Filling {
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

impl From<Pressures> for Command {
    fn from(pressures: Pressures) -> Self {
        match pressures {
            Pressures::Actuators => Self::Actuators,
            Pressures::Modules => Self::Modules,
        }
    }
}

impl Workspace {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (scene, limb) = limb(&self.scene)?;
        let (samples, cell_m) = if self.loaded { (4096, 0.1) } else { (1_000_000, 0.02) };
        let options = WorkspaceOptions {
            command: self.pressures.into(),
            points: self.points.into(),
            samples: self.samples.unwrap_or(samples) as usize,
            seed: self.seed,
            threads: threads(self.threads),
            cell_m: self.cell.as_ref().map_or(cell_m, Quantity::si),
        };
        if self.loaded {
            let payload_kg = self.payload.si();
            let result = LoadedWorkspaceResult::new(&scene, &limb, &options, payload_kg, self.spacers)?;
            write_if(self.csv.as_ref(), || csv(&result.tips_m))?;
            write_if(self.svg.as_ref(), || {
                let grids = (&result.grids[0], Some(&result.free_grid));
                let (name, mass_kg) = (scene.name(), scene.mass_kg());
                let carried =
                    if payload_kg > 0.0 { format!(", and {payload_kg:.2} kg at the tip") } else { String::new() };
                let title = format!("{name} under its own weight, {mass_kg:.2} kg{carried}");
                workspace::picture(&title, grids, &rest_m(&limb), &[])
            })?;
            show_of(self.json, &limb, &result.printed(), || workspace_loaded::table(&result))?;
            return Ok(Outcome::Done);
        }
        let result = WorkspaceResult::new(&scene, &limb, &options)?;
        write_if(self.csv.as_ref(), || csv(&result.tips_m))?;
        let title = labelled(scene.name(), true);
        write_if(self.svg.as_ref(), || {
            workspace::picture(&title, (&result.grids[0], None), &rest_m(&limb), &extreme_m(&result))
        })?;
        show_of(self.json, &limb, &result.printed(), || table(&title, &limb, &result))?;
        Ok(Outcome::Done)
    }
}

/// The limb at the extremes of the coordinates.
fn extreme_m(result: &WorkspaceResult<'_>) -> Vec<ExtremeLine<'static>> {
    const EXTREMES: [[&str; 2]; 3] = [["least x", "largest x"], ["least y", "largest y"], ["lowest", "highest"]];
    let of_axis = |(axis, names): (usize, &[&'static str; 2])| {
        let ends = names.iter().zip(&result.extents.of[axis]);
        let line = |(name, reach): (&&'static str, &workspace::Reach)| {
            Some(ExtremeLine { name, axis, line_m: result.space.line_by_the_model(&reach.pressures_pa)? })
        };
        ends.filter_map(line).collect::<Vec<_>>()
    };
    EXTREMES.iter().enumerate().flat_map(of_axis).collect()
}

/// The centre line at rest, m.
fn rest_m(limb: &Limb) -> Vec<[f64; 3]> {
    let rest: Vec<_> = limb.drives().map(|drive| drive.curve.states()[0]).collect();
    limb.backbone(&rest)
}

fn csv<T: Copy + Into<f64>>(tips: &[[T; 3]]) -> String {
    let mut text = String::from("x_m,y_m,z_m\n");
    for [x, y, z] in tips.iter().map(|tip| tip.map(Into::into)) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{x:.6},{y:.6},{z:.6}");
    }
    text
}

/// Writing to a string cannot fail.
fn table(title: &str, limb: &Limb, result: &WorkspaceResult<'_>) -> String {
    let mut text = String::new();
    let each = match result.space.command() {
        Command::Actuators => "one for each actuator that extends or expands, and for each other module",
        Command::Modules => "one for each setpoint",
    };
    let axes = result.space.axes();
    let (count, plural) = (axes.len(), if axes.len() == 1 { "" } else { "s" });
    let _ = writeln!(text, "{title}: {count} pressure{plural}, {each}; m");
    let _ = writeln!(text, "\n{:10} {:>9} {:>9} {:>9}   corners alone miss", "", "least", "largest", "range");
    for (index, (name, [least, largest])) in NAMES.iter().zip(&result.extents.of).enumerate() {
        let range = result.extents.range_m(index);
        let missed = ((least.corner_m - least.value_m) + (largest.value_m - largest.corner_m)) / range.max(1e-12);
        let (low, high) = (least.value_m, largest.value_m);
        let _ = writeln!(text, "{name:10} {low:9.4} {high:9.4} {range:9.4}   {:.3} %", 100.0 * missed.max(0.0));
    }
    let [fine, coarse] = &result.grids;
    if fine.is_solid() {
        let _ = writeln!(
            text,
            "\nvolume  {:.4} m3 in cubes of {:.0} mm; {:.4} m3 in cubes twice as wide; {:.4} m3 by a quarter of the samples",
            fine.volume_m3(),
            result.cell_m * 1e3,
            coarse.volume_m3(),
            result.thinned.volume_m3(),
        );
    } else {
        text += NO_VOLUME;
    }
    let _ = writeln!(text, "\nlargest part of a range that samples miss, %");
    let _ = writeln!(text, "{:>10} {:>12} {:>16} {:>12}", "samples", "Monte Carlo", "low discrepancy", "with faces");
    for row in &result.rows {
        let [random, even, faces] = row.missing.map(|share| 100.0 * share);
        let _ = writeln!(text, "{:10} {random:12.3} {even:16.3} {faces:12.3}", row.count);
    }
    for axis in axes.iter().filter(|axis| axis.ends_at_limit) {
        let (name, kpa) = (&limb.modules()[axis.module].name, axis.pressure_max_pa * 1e-3);
        let _ = writeln!(text, "{name}: at most {kpa:.2} kPa, just below its limit point");
    }
    text
}
