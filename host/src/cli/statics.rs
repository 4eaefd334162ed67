//! `softlimb statics`: the limb under its weight and a payload.

use std::path::PathBuf;

use clap::Args;

use super::check_margins::load_factor;
use super::shared::{limb, quantity, show};
use super::{Failure, Outcome, warn};
use crate::results::bend::rows;
use crate::results::{StaticsOptions, StaticsResult, StaticsRow as Row};
use softlimb_limb::statics::{Answer, BUCKLING_MARGIN_MAX};
use softlimb_scene::{Quantity, Scene};

/// Deflection, stiffness and margins under weight and a payload, at the end of each phase
#[derive(Args)]
#[command(after_help = "Columns, and limits of the model: docs/guide/statics.md\n\n\
                        Example: softlimb statics scenes/pick-and-place-a.toml --payload 0.5kg --spacers 5")]
pub(super) struct Statics {
    /// The scene file
    scene: PathBuf,
    /// Mass at the tip, 0 to 100 kg, in place of the phases' own `payload`
    #[arg(long, value_name = "KG", value_parser = quantity("kg", 0.0, 100.0))]
    payload: Option<Quantity>,
    /// Plates in each module, in place of the modules' own `spacers`
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=50))]
    spacers: Option<u8>,
    /// Largest error of the tip over the limb's length, 0.001 to 50 %
    #[arg(long, value_name = "PERCENT", default_value = "1 %", value_parser = quantity("%", 0.001, 50.0))]
    tolerance: Quantity,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

impl Statics {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let (scene, limb) = limb(&self.scene)?;
        let options = StaticsOptions {
            payload_kg: self.payload.as_ref().map(Quantity::si),
            spacers: self.spacers,
            tolerance: self.tolerance.si(),
        };
        let result = StaticsResult::new(&scene, &limb, &options)?;
        show(self.json, &result.printed(), || [vec![table(&scene, &result.rows)], rows(&limb)].concat().join("\n"))?;
        Ok(warn(&result.warnings))
    }
}

/// Which model was taken, and why where rods did not do.
fn model(answer: &Answer) -> String {
    let name = answer.tier.name();
    answer
        .tubes
        .as_ref()
        .map_or_else(|| name.to_owned(), |(_, error)| format!("{name} (rods are {:.2} % off)", 100.0 * error))
}

/// Compression over the load of buckling, %; the largest margin stands for tubes that are pulled.
fn buckling_percent(margin: f64) -> String {
    if margin < BUCKLING_MARGIN_MAX { format!("{:.1}", 100.0 / margin) } else { format!("< {:.0}", 100.0 / margin) }
}

fn table(scene: &Scene, rows: &[Row]) -> String {
    let mut lines = vec![
        format!("{}: {:.2} kg, {:.3} m at rest", scene.name(), scene.mass_kg(), scene.rest_length_m()),
        String::new(),
        format!(
            "{:16} {:>7} {:>23} {:>7} {:>10} {:>20} {:>9} {:>9} {:>7}  model",
            "phase",
            "payload",
            "tip x, y, z",
            "target",
            "deflection",
            "stiffness x, y, z",
            "load fac.",
            "buckling",
            "error"
        ),
        format!(
            "{:16} {:>7} {:>23} {:>7} {:>10} {:>20} {:>9} {:>9} {:>7}",
            "", "kg", "m", "mm off", "mm", "N/m", "", "%", "%"
        ),
    ];
    for row in rows {
        let head = format!("{:16} {:7.2}", row.phase, row.payload_kg);
        lines.push(match &row.found {
            Err(lost) => format!("{head} {lost}"),
            Ok(found) => {
                let [x, y, z] = found.tip_m;
                let stiffness = found
                    .stiffness_n_per_m
                    .map_or_else(String::new, |k| format!("{:.1}, {:.1}, {:.1}", k[0], k[1], k[2]));
                format!(
                    "{head} {:>23} {:7.1} {:10.1} {stiffness:>20} {:>9} {:>9} {:7.2}  {}",
                    format!("{x:.3}, {y:.3}, {z:.3}"),
                    1e3 * row.off_target_m(found),
                    found.sag_m * 1e3,
                    load_factor(found.load_factor),
                    buckling_percent(found.buckling_margin),
                    100.0 * found.answer.error(),
                    model(&found.answer),
                )
            }
        });
    }
    lines.join("\n")
}
