//! `softlimb workspace --loaded`: the reachable tip positions under weight.

use std::fmt::Write;

use serde::Serialize;

use super::shared::{show, threads, write_if};
use super::workspace::{Extent, NAMES, Volume, Workspace, csv, rest_m};
use super::{Failure, Outcome};
use softlimb_limb::Limb;
use softlimb_limb::statics::{Load, LoadedLimb};
use softlimb_limb::workspace;
use softlimb_limb::workspace::{Extents, Grid, Loaded, LoadedExtents, LoadedReach, Tally, loaded_extents};
use softlimb_scene::Scene;

/// Everything that is shown.
struct Answer<'a> {
    scene: &'a Scene,
    limb: &'a Limb,
    payload_kg: f64,
    free: &'a Extents,
    extents: LoadedExtents,
    tally: Tally,
    grids: [Grid; 2],
    cell_m: f64,
}

impl Workspace {
    pub(super) fn run_loaded(
        &self,
        scene: &Scene,
        limb: &Limb,
        space: &workspace::Workspace<'_>,
        free: &Extents,
    ) -> Result<Outcome, Failure> {
        let bays: Vec<usize> =
            scene.modules().iter().map(|module| usize::from(self.spacers.unwrap_or(module.spacers)) + 1).collect();
        let load = Load { payload_kg: self.payload.si(), ..Load::default() };
        let loaded =
            Loaded::new(space, |pressures_pa: &[f64]| LoadedLimb::new(scene, limb, pressures_pa, &bays, &load));
        let (points, count, threads) = (self.points.into(), self.count(4096), threads(self.threads));
        let poses = loaded.sample(points, count, self.seed, threads);
        let extents = loaded_extents(&loaded, &poses, (points, self.seed), threads).ok_or_else(|| {
            Failure::new(format!(
                "none of {count} poses is reached: {}",
                unreached(&loaded.tally(&poses), limb).join("; ")
            ))
        })?;
        let tips: Vec<[f64; 3]> = poses.iter().flatten().copied().collect();
        let cell_m = self.cell_m(0.1);
        let answer = Answer {
            scene,
            limb,
            payload_kg: self.payload.si(),
            free,
            extents,
            tally: loaded.tally(&poses),
            grids: [cell_m, 2.0 * cell_m].map(|side| Grid::new(&tips, side)),
            cell_m,
        };
        write_if(self.csv.as_ref(), || csv(&tips))?;
        write_if(self.svg.as_ref(), || workspace::picture(scene.name(), &answer.grids[0], &rest_m(limb)))?;
        show(self.json, &answer.printed(), || answer.table())?;
        Ok(Outcome::Done)
    }
}

/// Reasons of unreachable poses, with their numbers.
fn unreached(tally: &Tally, limb: &Limb) -> Vec<String> {
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

impl Answer<'_> {
    fn printed(&self) -> Printed<'_> {
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

    /// Writing to a string cannot fail.
    fn table(&self) -> String {
        let mut text = String::new();
        let (name, mass_kg, payload_kg) = (self.scene.name(), self.scene.mass_kg(), self.payload_kg);
        let _ = writeln!(text, "{name} under its weight, {mass_kg:.2} kg, and {payload_kg:.2} kg at the tip; m");
        let _ = writeln!(
            text,
            "\n{:10} {:>10} {:>10} {:>10} {:>13} {:>9}",
            "", "least", "largest", "range", "without load", "error"
        );
        let mut at_border = false;
        for (index, (name, pair)) in NAMES.iter().zip(&self.extents.of).enumerate() {
            let [least, largest] = [0, 1].map(|side: usize| {
                let mark = if pair[side].at_border { "*" } else { " " };
                format!("{:.4}{mark}", pair[side].value_m)
            });
            at_border |= pair.iter().any(|reach| reach.at_border);
            let (range, free) = (self.extents.range_m(index), self.free.range_m(index));
            let error = pair[0].error_m.max(pair[1].error_m);
            let _ = writeln!(text, "{name:10} {least:>10} {largest:>10} {range:9.4}  {free:12.4}  {error:9.4}");
        }
        if at_border {
            let _ = writeln!(text, "* poses one step further are out of reach");
        }
        let tally = &self.tally;
        let _ = write!(text, "\n{} poses, {} reached", tally.total(), tally.reached);
        unreached(tally, self.limb).iter().for_each(|part| {
            let _ = write!(text, "; {part}");
        });
        let [fine, coarse] = &self.grids;
        let _ = writeln!(
            text,
            "\nvolume  {:.3} m3 in cubes of {:.0} mm; {:.3} m3 in cubes twice as wide",
            fine.volume_m3(),
            self.cell_m * 1e3,
            coarse.volume_m3(),
        );
        text
    }
}
