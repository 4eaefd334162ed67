//! The tables of `docs/evidence/measured.md`.

use std::fmt::Write;

use softlimb::cli::Failure;
use softlimb_rig::calibrate::{Tension, fit_range};
use softlimb_scene::TENSILE_TESTS;

use super::{Row, STATED_PA, Set};

/// The lines a page's tables stand between.
pub const PLACE: [&str; 2] = ["<!-- written by cargo xtask lab measured -->", "<!-- end -->"];

/// The tables in Markdown.
///
/// # Errors
/// [`Failure`] if the tensile tests cannot be read.
pub fn page(sets: &[Set]) -> Result<String, Failure> {
    let mut text = "\n| threads, deg from the hoop | length, mm | pressure, kPa | readings | bend, deg, mean (range) | analytic, % | cross-section, % | fitted, % |\n\
                    | --: | --: | --: | --: | --- | --: | --: | --: |\n"
        .to_owned();
    for set in sets {
        for row in &set.rows {
            let _ = writeln!(
                text,
                "| {:.0} | {:.0} | {:.1} | {} | {} | {} | {} | {} |",
                set.angle_deg,
                1e3 * set.length_m,
                1e-3 * row.pressure_pa,
                row.readings.len(),
                measured(row),
                error(row.analytic, row),
                error(row.section, row),
                if set.rows.len() > 1 { error(row.fitted, row) } else { "-".into() },
            );
        }
    }
    text += "\nRoot mean squares of the errors of each set:\n\n\
             | threads, deg | length, mm | analytic, % | cross-section, % | default, % | fitted, % | fitted modulus over the stated one |\n\
             | --: | --: | --: | --: | --: | --: | --: |\n";
    for set in sets.iter().filter(|set| set.rows.len() > 1) {
        let percent = |model: fn(&Row) -> f64| format!("{:.1}", 100.0 * set.rms(model));
        let _ = writeln!(
            text,
            "| {:.0} | {:.0} | {} | {} | {} | {} | {:.3} |",
            set.angle_deg,
            1e3 * set.length_m,
            percent(|row| row.analytic),
            percent(|row| row.section),
            percent(|row| row.default),
            percent(|row| row.fitted),
            set.fitted_pa / STATED_PA,
        );
    }
    text += "\nYeoh laws of elastomers beside their tensile tests:\n\n\
             | elastomer | readings in the range | strain, % | rms, % | worst, % |\n\
             | --- | --: | --: | --: | --: |\n";
    let mut tests = Tension::read_by_name(TENSILE_TESTS).map_err(Failure::new)?;
    tests.sort_by(|a, b| a.0.cmp(&b.0));
    for (name, test) in &tests {
        let fit = fit_range(test).ok_or_else(|| Failure::new(format!("{name} has no law")))?;
        let [low, high] = fit.stretch;
        let count = test.points().iter().filter(|point| (low..=high).contains(&point[0])).count();
        let _ = writeln!(
            text,
            "| {name} | {count} of {} | {:.0} to {:.0} | {:.1} | {:.1} |",
            test.points().len(),
            100.0 * (low - 1.0),
            100.0 * (high - 1.0),
            100.0 * fit.rms,
            100.0 * fit.worst,
        );
    }
    text.push('\n');
    Ok(text)
}

fn measured(row: &Row) -> String {
    let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max]
        .map(|of| row.readings.iter().copied().reduce(of).unwrap_or(f64::NAN).to_degrees());
    let mean = row.mean().to_degrees();
    if row.readings.len() == 1 { format!("{mean:.0}") } else { format!("{mean:.0} ({low:.0} to {high:.0})") }
}

fn error(bend: f64, row: &Row) -> String {
    format!("{:+.1}", 100.0 * (bend / row.mean() - 1.0))
}
