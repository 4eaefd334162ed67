//! Candidates as text.

use std::fmt::Write as _;

use fra_model::Motion;
use softlimb_design::from_scene::Tasked;
use softlimb_design::synthesis::Candidate;
use softlimb_scene::Scene;

/// The limbs to pick from.
pub(super) fn pareto(list: &[&Candidate]) -> String {
    if list.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "{:>4}  {:<34} {:>10} {:>8} {:>8} {:>13} {:>7}\n",
        "pick", "modules", "error, mm", "kPa", "kg", "clearance, mm", "air, L"
    );
    for (index, limb) in list.iter().enumerate() {
        let figures = &limb.figures;
        let names: Vec<_> = limb.modules.iter().map(|module| module.name.as_str()).collect();
        let spare = figures.spare_clearance_m.map_or("-".into(), |spare| format!("{:.2}", spare * 1e3));
        let _ = writeln!(
            text,
            "{:>4}  {:<34} {:>10.4} {:>8.1} {:>8.2} {spare:>13} {:>7.2}",
            index + 1,
            names.join(", "),
            figures.tip_error_rms_m * 1e3,
            figures.pressure_max_pa * 1e-3,
            figures.mass_kg,
            figures.air_m3 * 1e3
        );
    }
    text + "\n"
}

/// A limb as text. Writing to a string cannot fail.
pub(super) fn limb(found: &Candidate) -> String {
    let mut text = String::new();
    let figures = &found.figures;
    let _ = writeln!(
        text,
        "{}: tip error {:.4} mm RMS, {:.4} mm at most; highest pressure {:.1} kPa; mass {:.2} kg; air {:.2} L",
        if found.does_it() { "reached" } else { "nearest found" },
        figures.tip_error_rms_m * 1e3,
        figures.tip_error_max_m * 1e3,
        figures.pressure_max_pa * 1e-3,
        figures.mass_kg,
        figures.air_m3 * 1e3
    );
    if let Some(spare) = figures.spare_clearance_m {
        let _ = writeln!(text, "clearance beyond the required one: {:.2} mm", spare * 1e3);
    }
    text += &modules(found);
    let _ = writeln!(
        text,
        "\n{:>9} {:>12} {:>14} {:>14}  kPa",
        "way-point", "error, mm", "clearance, mm", "on the way, mm"
    );
    for (index, point) in found.way_points.iter().enumerate() {
        let millimetres = |value: Option<f64>| value.map_or("-".into(), |value| format!("{:.2}", value * 1e3));
        let pressures: Vec<_> = point.pressure_pa.iter().map(|pressure| format!("{:.2}", pressure * 1e-3)).collect();
        let _ = writeln!(
            text,
            "{:>9} {:>12.4} {:>14} {:>14}  {}",
            index + 1,
            point.tip_error_m * 1e3,
            millimetres(point.clearance_m),
            millimetres(point.move_clearance_m),
            pressures.join(", ")
        );
    }
    text
}

/// The fiber angle, or those of two windings.
pub(super) fn angles(one_deg: f64, both_deg: impl Iterator<Item = f64>) -> String {
    let both: Vec<String> = both_deg.map(|angle| format!("{angle:.3}")).collect();
    if both.is_empty() { format!("angle {one_deg:.3} deg") } else { format!("angles {} deg", both.join(" and ")) }
}

/// Sizes of the modules of a limb.
fn modules(found: &Candidate) -> String {
    let mut text = String::new();
    for module in &found.modules {
        let _ = writeln!(
            text,
            "\n{}: inner radius {:.4} mm, outer radius {:.4} mm, length {:.3} mm, fiber {}, mount angle {:.2} deg, up to {:.1} kPa",
            module.name,
            module.inner_radius_m * 1e3,
            module.outer_radius_m * 1e3,
            module.length_m * 1e3,
            angles(module.fiber_angle_rad.to_degrees(), module.windings_rad.iter().map(|angle| angle.to_degrees())),
            module.mount_angle_rad.to_degrees(),
            module.pressure_cap_pa * 1e-3
        );
    }
    text
}

/// A limb whose modules have targets, as text. Writing to a string cannot fail.
pub(super) fn deformed(scene: &Scene, tasked: &Tasked, found: &Candidate) -> String {
    let mut text = String::new();
    let figures = &found.figures;
    let _ = writeln!(
        text,
        "{}: highest pressure {:.1} kPa; mass {:.2} kg",
        if found.does_it() { "reached" } else { "nearest found" },
        figures.pressure_max_pa * 1e-3,
        figures.mass_kg
    );
    text += &modules(found);
    let _ = writeln!(text, "\n{:<16} {:<16} {:>14} {:>14} {:>10}", "phase", "module", "target", "found", "kPa");
    let phases = scene.phases().iter().zip(&tasked.task.way_points).zip(&found.way_points);
    for ((phase, asked), answer) in phases {
        for (total, value) in asked.totals.iter().zip(&answer.totals) {
            let shown = |value: f64| match total.motion {
                Motion::Extension | Motion::Expansion => format!("{:.4} mm", 1e3 * value),
                Motion::Bending | Motion::Twisting => format!("{:.4} deg", value.to_degrees()),
            };
            let _ = writeln!(
                text,
                "{:<16} {:<16} {:>14} {:>14} {:>10.2}",
                *phase.name,
                *scene.modules()[tasked.patterns[total.first]].name,
                shown(total.value),
                shown(*value),
                answer.pressure_pa[total.first] * 1e-3
            );
        }
    }
    text
}
