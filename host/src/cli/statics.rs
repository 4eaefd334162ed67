//! `softlimb statics`: what does weight do to the limb?

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::{Failure, Outcome};
use softlimb_limb::Limb;
use softlimb_limb::statics::{Answer, Load, LoadedLimb, Lost, cheapest};
use softlimb_motion as motion;
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// Ratio of a tube's compression to its load of buckling above which no rod is right.
const BUCKLED: f64 = 0.5;

/// The limb under its weight and a payload at the end of each phase: deflection, stiffness, margins
#[derive(Args)]
#[command(after_help = "Example: softlimb statics scenes/pick-and-place-a.toml --payload 0.5 --spacers 5\n\n\
                        What the columns mean, and what the model leaves out: docs/guide/statics.md")]
pub(super) struct Statics {
    /// The scene file
    scene: PathBuf,
    /// Mass at the tip, kg, in place of the phases' own `payload`
    #[arg(long, value_name = "KG", value_parser = mass)]
    payload: Option<f64>,
    /// Plates in each module, in place of the modules' own `spacers`
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=50))]
    spacers: Option<u8>,
    /// Error of the tip that may be left, % of the limb's length
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0, value_parser = percent)]
    tolerance: f64,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

fn mass(text: &str) -> Result<f64, String> {
    number(text, 0.0, 100.0, "kg")
}

fn percent(text: &str) -> Result<f64, String> {
    number(text, 0.001, 50.0, "%")
}

fn number(text: &str, least: f64, most: f64, unit: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|found| (least..=most).contains(found));
    found.ok_or_else(|| format!("a number of {least} to {most} {unit}"))
}

/// What happens at the end of a phase.
struct Row {
    phase: String,
    payload_kg: f64,
    free_tip_m: [f64; 3],
    found: Result<Loaded, Lost>,
}

struct Loaded {
    answer: Answer,
    tip_m: [f64; 3],
    deflection_m: f64,
    /// Along the scene's axes, N/m.
    stiffness_n_per_m: Option<[f64; 3]>,
    stability: f64,
    buckling_ratio: f64,
    /// Module of the tube that is closest to buckling, and one that is bent backwards.
    weakest: Option<usize>,
    bent_back: Option<usize>,
}

impl Statics {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let scene = scene::load(&self.scene)?;
        let limb = Limb::new(&scene)?;
        let plan = motion::plan(&scene, &limb)?;
        let phases = plan.phases.iter().zip(scene.phases());
        let rows: Vec<Row> = phases
            .map(|(planned, phase)| {
                let end_us = (planned.start_us + planned.move_us + planned.hold_us) as f64;
                let pressures: Vec<f64> = plan.states_at(end_us).iter().map(|state| state.pressure_pa).collect();
                self.row(&scene, &limb, &planned.name, &pressures, self.payload.unwrap_or(phase.payload_kg))
            })
            .collect::<Result<_, _>>()?;
        if self.json {
            super::say(&json!({"scene": scene.name(), "mass_kg": scene.mass_kg(), "phases": rows.iter().map(|row| row.json(&limb)).collect::<Vec<_>>()}).to_string())?;
        } else {
            super::say(&table(&scene, &rows))?;
        }
        let warnings: Vec<String> = rows.iter().flat_map(|row| row.warnings(&limb, self.tolerance * 1e-2)).collect();
        warnings.iter().for_each(|warning| super::note(&format!("warning: {warning}")));
        Ok(if warnings.is_empty() { Outcome::Done } else { Outcome::DoneWithWarnings })
    }

    fn row(
        &self,
        scene: &Scene,
        limb: &Limb,
        phase: &str,
        pressures_pa: &[f64],
        payload_kg: f64,
    ) -> Result<Row, Failure> {
        let of_module = limb.modules().iter().zip(pressures_pa);
        let channels: Vec<f64> =
            of_module.flat_map(|(module, pressure)| std::iter::repeat_n(*pressure, module.channels.len())).collect();
        let bays: Vec<usize> =
            scene.modules().iter().map(|module| usize::from(self.spacers.unwrap_or(module.spacers)) + 1).collect();
        let load = Load { payload_kg, ..Load::default() };
        let loaded = LoadedLimb::new(scene, limb, &channels, &bays, &load).ok_or_else(|| {
            Failure::new(format!(
                "phase `{phase}`: an actuator has no equilibrium at its pressure, or a bundle no stiffness"
            ))
        })?;
        let free_tip_m: [f64; 3] = loaded.free_tip().translation.vector.into();
        let answer = cheapest(&loaded, self.tolerance * 1e-2, scene.rest_length_m());
        let found = answer.map(|answer| Loaded::new(&loaded, answer, free_tip_m));
        Ok(Row { phase: phase.to_owned(), payload_kg, free_tip_m, found })
    }
}

impl Loaded {
    fn new(limb: &LoadedLimb, answer: Answer, free_tip_m: [f64; 3]) -> Self {
        let tip_m: [f64; 3] = answer.tip().translation.vector.into();
        let deflection_m = tip_m.iter().zip(free_tip_m).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let compliance = answer.compliance_m_per_n();
        Self {
            tip_m,
            deflection_m,
            stiffness_n_per_m: compliance.map(|by| [0, 1, 2].map(|axis| 1.0 / by[(axis, axis)])),
            stability: answer.stability(limb),
            buckling_ratio: answer.buckling.map_or(0.0, |tube| tube.ratio()),
            weakest: answer.buckling.map(|tube| tube.module),
            bent_back: limb.bent_back(&answer.rod, &answer.shape, 1e-9),
            answer,
        }
    }
}

impl Row {
    fn json(&self, limb: &Limb) -> Value {
        let head = json!({"name": self.phase, "payload_kg": self.payload_kg, "free_tip_m": self.free_tip_m});
        let name = |module: Option<usize>| module.map(|index| limb.modules()[index].name.clone());
        let body = match &self.found {
            Err(lost) => json!({"lost": lost.to_string()}),
            Ok(found) => json!({
                "tip_m": found.tip_m,
                "deflection_m": found.deflection_m,
                "tip_stiffness_n_per_m": found.stiffness_n_per_m,
                "stability": found.stability,
                "buckling_ratio": found.buckling_ratio,
                "weakest_module": name(found.weakest),
                "bent_back": name(found.bent_back),
                "tier": found.answer.tier.name(),
                "order_error": found.answer.order_error,
                "bundle_error": found.answer.bundle_error,
                "rods_error": found.answer.tubes.as_ref().map(|(_, rods)| rods),
                "bundle_shift_m": found.answer.bundle_shift_m.map(|shift| shift.as_slice().to_vec()),
                "newton_iterations": found.answer.shape.iterations,
            }),
        };
        match (head, body) {
            (Value::Object(mut head), Value::Object(body)) => {
                head.extend(body);
                Value::Object(head)
            }
            (head, _) => head,
        }
    }

    fn warnings(&self, limb: &Limb, tolerance: f64) -> Vec<String> {
        let phase = &self.phase;
        let found = match &self.found {
            Err(lost) => return vec![format!("phase `{phase}`: {lost}")],
            Ok(found) => found,
        };
        let mut warnings = Vec::new();
        let name = |module: Option<usize>| module.map_or("", |index| limb.modules()[index].name.as_str());
        if found.buckling_ratio > BUCKLED {
            let (ratio, module) = (100.0 * found.buckling_ratio, name(found.weakest));
            warnings.push(format!("phase `{phase}`: buckling: a tube of `{module}` carries {ratio:.0} % of the load that it buckles at between two plates; more `spacers` help"));
        } else if found.answer.error() > tolerance {
            let error = 100.0 * found.answer.error();
            warnings.push(format!(
                "phase `{phase}`: the tip is known to {error:.1} % of the length only, by the finest model there is"
            ));
        }
        if found.bent_back.is_some() {
            let module = name(found.bent_back);
            warnings.push(format!("phase `{phase}`: `{module}` is bent backwards by the load, where its lines would have to shorten: the shape is not to be trusted"));
        }
        warnings
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

fn table(scene: &Scene, rows: &[Row]) -> String {
    let mut lines = vec![
        format!("{}: {:.2} kg, {:.3} m at rest", scene.name(), scene.mass_kg(), scene.rest_length_m()),
        String::new(),
        format!(
            "{:16} {:>7} {:>23} {:>10} {:>20} {:>9} {:>9} {:>7}  model",
            "phase", "payload", "tip x, y, z", "deflection", "stiffness x, y, z", "stability", "buckling", "error"
        ),
        format!("{:16} {:>7} {:>23} {:>10} {:>20} {:>9} {:>9} {:>7}", "", "kg", "m", "mm", "N/m", "", "%", "%"),
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
                    "{head} {:>23} {:10.1} {stiffness:>20} {:9.3} {:9.1} {:7.2}  {}",
                    format!("{x:.3}, {y:.3}, {z:.3}"),
                    found.deflection_m * 1e3,
                    found.stability,
                    100.0 * found.buckling_ratio,
                    100.0 * found.answer.error(),
                    model(&found.answer),
                )
            }
        });
    }
    lines.join("\n")
}
