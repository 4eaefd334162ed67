//! `softlimb workspace --loaded`: the reachable tip positions under weight.

use std::fmt::Write;

use super::workspace::NO_VOLUME;
use crate::results::{LoadedWorkspaceResult, NAMES, unreached};

/// Writing to a string cannot fail.
pub(super) fn table(result: &LoadedWorkspaceResult<'_>) -> String {
    let mut text = String::new();
    let (name, mass_kg, payload_kg) = (result.scene.name(), result.scene.mass_kg(), result.payload_kg);
    let _ = writeln!(text, "{name} under its weight, {mass_kg:.2} kg, and {payload_kg:.2} kg at the tip; m");
    let _ = writeln!(
        text,
        "\n{:10} {:>10} {:>10} {:>10} {:>13} {:>9}",
        "", "least", "largest", "range", "without load", "error"
    );
    let mut at_border = false;
    for (index, (name, pair)) in NAMES.iter().zip(&result.extents.of).enumerate() {
        let [least, largest] = [0, 1].map(|side: usize| {
            let mark = if pair[side].at_border { "*" } else { " " };
            format!("{:.4}{mark}", pair[side].value_m)
        });
        at_border |= pair.iter().any(|reach| reach.at_border);
        let (range, free) = (result.extents.range_m(index), result.free.range_m(index));
        let error = pair[0].error_m.max(pair[1].error_m);
        let _ = writeln!(text, "{name:10} {least:>10} {largest:>10} {range:9.4}  {free:12.4}  {error:9.4}");
    }
    if at_border {
        let _ = writeln!(text, "* poses one step further are out of reach");
    }
    let tally = &result.tally;
    let _ = write!(text, "\n{} poses, {} reached", tally.total(), tally.reached);
    unreached(tally, result.limb).iter().for_each(|part| {
        let _ = write!(text, "; {part}");
    });
    let [fine, coarse] = &result.grids;
    if !fine.is_solid() {
        return text + NO_VOLUME;
    }
    let _ = writeln!(
        text,
        "\nvolume  {:.3} m3 in cubes of {:.0} mm; {:.3} m3 in cubes twice as wide",
        fine.volume_m3(),
        result.cell_m * 1e3,
        coarse.volume_m3(),
    );
    text
}
