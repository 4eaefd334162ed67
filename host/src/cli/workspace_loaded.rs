//! `softlimb workspace --loaded`: where can the tip be under weight?

use std::fmt::Write;

use serde_json::{Value, json};

use super::kept::write;
use super::workspace::{NAMES, Workspace, csv, rest_m};
use super::{Failure, Outcome};
use softlimb_limb::Limb;
use softlimb_limb::statics::{Load, LoadedLimb};
use softlimb_limb::workspace;
use softlimb_limb::workspace::{Extents, Grid, Loaded, LoadedExtents, LoadedReach, Tally, loaded_extents};
use softlimb_scene::{Scene, WEIGHTLESS};

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
        let load = Load { payload_kg: self.payload, ..Load::default() };
        let loaded =
            Loaded::new(space, |pressures_pa: &[f64]| LoadedLimb::new(scene, limb, pressures_pa, &bays, &load));
        let (points, count, threads) = (self.points.into(), self.count(4096), self.threads());
        let poses = loaded.sample(points, count, self.seed, threads);
        let extents = loaded_extents(&loaded, &poses, (points, self.seed), threads).ok_or_else(|| {
            Failure::new(format!(
                "none of {count} poses is reached: {}",
                unreached(&loaded.tally(&poses), limb).join("; ")
            ))
        })?;
        let tips: Vec<[f64; 3]> = poses.iter().flatten().copied().collect();
        let cell_m = self.cell_m(100.0);
        let answer = Answer {
            scene,
            limb,
            payload_kg: self.payload,
            free,
            extents,
            tally: loaded.tally(&poses),
            grids: [cell_m, 2.0 * cell_m].map(|side| Grid::new(&tips, side)),
            cell_m,
        };
        if let Some(file) = &self.csv {
            write(file, &csv(&tips))?;
        }
        if let Some(file) = &self.svg {
            write(file, &workspace::picture(scene.name(), &answer.grids[0], &rest_m(limb)))?;
        }
        if self.json {
            super::say(&answer.json().to_string())?
        } else {
            super::say(&answer.table())?
        }
        Ok(Outcome::Done)
    }
}

/// What keeps poses from being reached, with their numbers.
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

impl Answer<'_> {
    fn json(&self) -> Value {
        let reach = |reach: &LoadedReach| {
            json!({
                "value_m": reach.value_m,
                "tip_m": reach.tip_m,
                "pressures_pa": reach.pressures_pa,
                "error_m": reach.error_m,
                "at_border": reach.at_border,
            })
        };
        let extents: Vec<_> = NAMES
            .iter()
            .zip(&self.extents.of)
            .enumerate()
            .map(|(index, (name, [least, largest]))| {
                json!({
                    "measure": name,
                    "least": reach(least),
                    "largest": reach(largest),
                    "range_m": self.extents.range_m(index),
                    "range_without_load_m": self.free.range_m(index),
                })
            })
            .collect();
        let modules: Vec<_> = self.limb.modules().iter().map(|module| module.name.as_str()).collect();
        let tally = &self.tally;
        json!({
            "scene": self.scene.name(),
            WEIGHTLESS: false,
            "mass_kg": self.scene.mass_kg(),
            "payload_kg": self.payload_kg,
            "extents": extents,
            "poses": {
                "all": tally.total(),
                "reached": tally.reached,
                "fall": tally.falls,
                "no_equilibrium": tally.no_equilibrium,
                "modules": modules,
                "buckle_by_module": tally.buckles,
                "bent_back_by_module": tally.bent_back,
            },
            "volume": {
                "cell_m": self.cell_m,
                "volume_m3": self.grids[0].volume_m3(),
                "with_double_cells_m3": self.grids[1].volume_m3(),
            },
        })
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
            let _ = writeln!(text, "* a step further on poses are no longer reached");
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
