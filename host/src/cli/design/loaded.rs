//! `softlimb design limb` for a scene with weight: a limb that stands under its loads.

use std::fmt::Write as _;
use std::path::Path;

use serde::Serialize;

use crate::cli::check_margins::up_to;
use crate::cli::shared::show_of;
use crate::cli::{Failure, Outcome, note};
use crate::results::margin_warnings;
use softlimb_design::from_scene::{LoadedDesign, loaded_design, loaded_text};
use softlimb_design::loaded::{
    ActiveBound, ConfirmedPose, Effort, Evaluation, Found, LOAD_FACTOR_MOST, LimbSizes, StandingLimits, active_bounds,
    search_to_run,
};
use softlimb_files::write_whole;
use softlimb_limb::Limb;
use softlimb_limb::statics::BUCKLING_MARGIN_MAX;
use softlimb_motion as motion;
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// Output with `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    /// The design file.
    file: &'a Path,
    /// Whether every phase is reached with every margin.
    reached: bool,
    /// Share by which every margin is better than its limit.
    reserve: f64,
    /// The limits.
    limits: StandingLimits,
    /// Largest tilt of a carried object, deg; `None` where none is carried.
    tilt_max_deg: Option<f64>,
    /// Mass without payload, kg.
    mass_kg: f64,
    /// Length at rest, m.
    length_m: f64,
    /// Sizes of the limb.
    sizes: &'a LimbSizes,
    /// The phases.
    phases: &'a [ConfirmedPose],
    /// Bounds that the limb lies at, and what each costs.
    bounds: &'a [ActiveBound],
    /// Limbs judged.
    evaluations: usize,
    /// Why the planner refuses the design, or which margin it does not keep as the planner has it; `None` where it keeps all.
    refused: Option<String>,
    /// Limbs that were designed before this one and refused.
    refused_before: usize,
}

/// Designs a limb under load and writes the scene with it to `file`.
pub(super) fn design(scene: &Scene, file: &Path, seed: u64, json: bool) -> Result<Outcome, Failure> {
    let design = loaded_design(scene)?;
    let effort = Effort { seed, ..Effort::default() };
    let (task, space) = (&design.task, &design.space);
    let refusal = |limb: &Evaluation| refused(scene, &design, limb);
    let found = search_to_run(task, space, &space.first_guess(), &effort, &refusal, &|| false);
    let found = found.ok_or_else(|| {
        Failure::new("no limb within the bounds stands under its own weight in the first phase: raise `pressure_max` or the bounds of `[design]`")
    })?;
    let (phases, reached) = (&found.confirmed, found.reached);
    let bounds = active_bounds(task, space, &found, &|| false);
    let text = loaded_text(scene, &design, &found.evaluation).map_err(Failure::new)?;
    write_whole(file, &text).map_err(Failure::new)?;
    let printed = Printed {
        file,
        reached,
        reserve: if found.reached { found.by.reserve } else { 0.0 },
        limits: task.limits,
        tilt_max_deg: task.poses.iter().find_map(|pose| Some(pose.carried?.tilt_max_rad.to_degrees())),
        mass_kg: found.evaluation.mass_kg,
        length_m: found.evaluation.length_m,
        sizes: &found.evaluation.sizes,
        phases,
        bounds: &bounds,
        evaluations: found.evaluations,
        refused: found.refused.clone(),
        refused_before: found.refused_before,
    };
    let designed = scene::load(file)?;
    let limb = Limb::new(&designed)?;
    show_of(json, &limb, &printed, || table(scene, &design, &found, &printed))?;
    note(&format!("design: {}", file.display()));
    let outcome = super::windings(&designed, &limb.winding_warnings(&designed));
    if let Some(why) = &printed.refused {
        note(&format!("warning: the planner refuses the design: {why}"));
    }
    if reached && printed.refused.is_none() {
        return Ok(outcome);
    }
    if !reached {
        note("warning: not every margin is kept: the lacking ones are listed above");
    }
    Ok(Outcome::DoneWithWarnings)
}

/// Why the planner refuses the scene with a limb, or the margins that the limb does not keep as the planner has it: what `softlimb check`
/// says of it.
pub fn refused(scene: &Scene, design: &LoadedDesign, limb: &Evaluation) -> Option<String> {
    let complaint = || -> Result<Vec<String>, Box<dyn std::error::Error>> {
        let designed = scene::parse(&loaded_text(scene, design, limb)?, scene.name())?;
        let limb = Limb::new(&designed)?;
        let plan = motion::plan(&designed, &limb)?;
        let margins = motion::margins(&designed, &limb, &plan, &motion::sent(&designed, &limb, &plan)?)?;
        Ok(margin_warnings(&designed, &limb, &plan, &margins))
    };
    let complaints = complaint().unwrap_or_else(|error| vec![error.to_string()]);
    (!complaints.is_empty()).then(|| complaints.join("; "))
}

/// Result as text. Writing to a string cannot fail.
fn table(scene: &Scene, design: &LoadedDesign, found: &Found, printed: &Printed<'_>) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{}: {} under load; mass {:.2} kg, length {:.3} m, reserve of every margin {:.1} %, {} limbs judged",
        scene.name(),
        if printed.reached { "reached" } else { "nearest found" },
        printed.mass_kg,
        printed.length_m,
        100.0 * printed.reserve,
        printed.evaluations
    );
    let [x, y, z] = printed.sizes.position_m;
    let pitch_deg = printed.sizes.pitch_rad.to_degrees();
    let _ = writeln!(text, "base at ({x:.3}, {y:.3}, {z:.3}) m, pitch {pitch_deg:.1} deg\n");
    let _ = writeln!(
        text,
        "  {:<14} {:>8} {:>8} {:>8} {:>8} {:>8} {:>7} {:>7}",
        "module", "inner", "outer", "length", "spread", "spacers", "fiber", "mount"
    );
    let _ = writeln!(
        text,
        "  {:<14} {:>8} {:>8} {:>8} {:>8} {:>8} {:>7} {:>7}",
        "", "mm", "mm", "mm", "mm", "", "deg", "deg"
    );
    for (module, sizes) in design.space.modules.iter().zip(&printed.sizes.modules) {
        let [inner, outer] = sizes.radii_m.map(|radius| 1e3 * radius);
        let second = module.second.map_or_else(String::new, |(_, rad)| format!("/{:.1}", rad.to_degrees()));
        let angles = format!("{:.1}{second}", sizes.angle_rad.to_degrees());
        let _ = writeln!(
            text,
            "  {:<14} {inner:8.2} {outer:8.2} {:8.1} {:8.1} {:8} {angles:>7} {:7.1}",
            module.name,
            1e3 * sizes.length_m,
            1e3 * sizes.spread_m,
            sizes.spacers,
            sizes.mount_angle_rad.to_degrees()
        );
    }
    phases(&mut text, printed);
    bounds(&mut text, found.reached, printed);
    text
}

fn phases(text: &mut String, printed: &Printed<'_>) {
    let limits = &printed.limits;
    let _ = writeln!(
        text,
        "\n  {:<14} {:>7} {:>9} {:>11} {:>9} {:>8} {:>8} {:>8} {:>9} {:>6}  pressures, kPa",
        "phase", "payload", "tip error", "load factor", "stiffness", "sag", "buckling", "pressure", "clearance", "tilt"
    );
    let _ = writeln!(
        text,
        "  {:<14} {:>7} {:>9} {:>11} {:>9} {:>8} {:>8} {:>8} {:>9} {:>6}",
        "", "kg", "mm", "", "N/m", "% of L", "", "%", "mm spare", "deg"
    );
    let _ = writeln!(
        text,
        "  {:<14} {:>7} {:>9} {:>11} {:>9} {:>8} {:>8} {:>8} {:>9} {:>6}",
        "limit",
        "",
        "<= 0.1",
        format!(">= {}", limits.load_factor),
        format!(">= {}", limits.stiffness_n_per_m),
        format!("<= {:.0}", 100.0 * limits.sag_share),
        format!(">= {}", limits.buckling_margin),
        format!("<= {:.0}", 100.0 * limits.pressure_share),
        ">= 0",
        printed.tilt_max_deg.map_or(String::new(), |most| format!("<= {most:.0}"))
    );
    for phase in printed.phases {
        let pressures: Vec<_> = phase.pressures_pa.iter().map(|pressure| format!("{:.1}", 1e-3 * pressure)).collect();
        let _ = writeln!(
            text,
            "  {:<14} {:7.2} {:>9} {:>11} {:9.1} {:>8} {:>8} {:8.1} {:>9} {:6.1}  {}",
            phase.name,
            phase.payload_kg,
            known(1e3 * phase.tip_error_m, 3),
            up_to(limits.load_factor.max(LOAD_FACTOR_MOST), phase.load_factor, 2),
            phase.stiffness_n_per_m,
            known(100.0 * phase.sag_m / printed.length_m, 1),
            up_to(BUCKLING_MARGIN_MAX, phase.buckling_margin, 1),
            100.0 * phase.pressure_share,
            phase.spare_m.map_or("-".to_owned(), |spare| format!("{:.1}", 1e3 * spare)),
            phase.tilt_rad.to_degrees(),
            pressures.join(", ")
        );
    }
    for phase in printed.phases.iter().filter(|phase| !phase.lacks.is_empty()) {
        let names: Vec<_> = phase.lacks.iter().map(|margin| margin.name()).collect();
        let _ = writeln!(text, "  phase `{}` lacks: {}", phase.name, names.join(", "));
    }
}

/// A value, or a dash for a pose that the limb does not reach.
fn known(value: f64, digits: usize) -> String {
    if value.is_finite() { format!("{value:.digits$}") } else { "-".to_owned() }
}

fn bounds(text: &mut String, reached: bool, printed: &Printed<'_>) {
    if printed.bounds.is_empty() {
        return;
    }
    let _ = writeln!(text, "\n  active bounds, and the same search with one of them moved:");
    for bound in printed.bounds {
        let module = bound.module.as_ref().map_or(String::new(), |name| format!("{name} "));
        let [from, to] = [bound.bound, bound.moved_to].map(|value| shown(bound.name, value));
        let gain = if reached {
            format!("reserve {:.1} % instead of {:.1} %", 100.0 * bound.reserve, 100.0 * printed.reserve)
        } else if bound.reached {
            "every margin is kept: this bound forbids the task".to_owned()
        } else {
            format!("{:.0} % of the shortfall remains", 100.0 * bound.left)
        };
        let _ = writeln!(text, "  {module}{} = {from}: with {to} {gain}", bound.name);
    }
}

/// A value of a key with its unit.
fn shown(key: &str, value: f64) -> String {
    match key {
        "pressure_max" => format!("{:.1} kPa", 1e-3 * value),
        "base_pitch" | "fiber_angle" | "mount_angle" => format!("{:.1} deg", value.to_degrees()),
        "base_position" => format!("{value:.3} m"),
        _ => format!("{:.1} mm", 1e3 * value),
    }
}
