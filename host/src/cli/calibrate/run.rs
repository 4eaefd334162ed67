//! `softlimb calibrate run`: actuators from the holds of a recorded run.

use std::path::PathBuf;

use clap::Args;

use super::super::shared::{about, corrections_csv, write};
use super::super::{Failure, Outcome};
use super::pressure::{Seen, Source};
use super::{Files, Fitting, Per, Unknowns};
use fra_model::{Actuator, Motion};
use softlimb_limb::Limb;
use softlimb_motion::carried;
use softlimb_rig::calibrate::{Body, Branch, LimbHold, Loaded, equalizing, holds, limb_holds};
use softlimb_rig::record;
use softlimb_rig::record::RunLog;
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// Fit actuators to the ends of the holds of a recorded run
#[derive(Args)]
#[command(after_help = "Files and method: docs/guide/calibrate.md\n\n\
    Example: softlimb calibrate run run.mcap --fit shear_modulus --per module --write fitted.toml")]
pub(super) struct Run {
    /// The log of the run (MCAP)
    log: PathBuf,
    /// The scene that describes the actuators [default: the one in the log]
    #[arg(long, value_name = "SCENE")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    unknowns: Unknowns,
    /// Write corrections of the setpoints for the unequal actuators of modules, with --per actuator
    #[arg(long, value_name = "FILE")]
    corrections: Option<PathBuf>,
    #[command(flatten)]
    fitting: Fitting,
    #[command(flatten)]
    files: Files,
}

/// Why actuators are not told apart.
const UNEQUAL_ONLY_UNDER_WEIGHT: &str =
    "--per actuator and --corrections take a run under weight, which alone tells the actuators of a module apart";
/// Why a log gives nothing to fit to.
const NOTHING_SEEN: &str = "no hold in which a deformation was seen and the pressure stood still: give phases a hold";

impl Run {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let about = about(&self.log);
        let log = record::read(&self.log).map_err(Failure::new)?;
        let recorded = scene::parse(&log.info.scene_text, &format!("scene.toml of {}", self.log.display()));
        let scene = match &self.scene {
            Some(scene) => scene::load(scene)?,
            None => recorded.clone()?,
        };
        scene.require_no_segments("`calibrate`")?;
        let limb = Limb::new(&scene)?;
        let names: Vec<String> = limb.drives().map(|drive| drive.name()).collect();
        if !names.iter().eq(log.info.modules.iter().map(|module| &module.name)) {
            return Err(about(&format!("the log has other modules than the scene, which has {}", names.join(", "))));
        }
        let (channels, own) = (log.info.channel_count(), limb.channels());
        if channels != own {
            return Err(about(&format!("the log has {channels} channels, and the scene {own}")));
        }
        if self.corrections.is_some() && !self.per_actuator() {
            return Err(Failure::wrong_line("--corrections takes --per actuator: equal actuators need none"));
        }
        let damaged: Vec<String> =
            log.incomplete.iter().map(|why| format!("{}: {why}: the holds before count", self.log.display())).collect();
        if !log.info.weightless {
            return self.under_weight(&scene, &limb, &limb_holds(&log, &carried(recorded?.phases())), damaged);
        }
        let seen = without_load(&limb, &log);
        if seen.is_empty() {
            return Err(self.nothing_seen(&damaged));
        }
        if self.per_actuator() || self.corrections.is_some() {
            return Err(Failure::wrong_line(UNEQUAL_ONLY_UNDER_WEIGHT));
        }
        let mut source = Source::of_modules(&scene, seen, None);
        source.warnings = damaged;
        Ok(self.unknowns.fit(&source, &self.log, (&self.fitting, &self.files))?.1)
    }

    /// The error of a log without a hold that counts, with the damage that may be the cause.
    fn nothing_seen(&self, damaged: &[String]) -> Failure {
        match damaged.first() {
            None => about(&self.log)(&NOTHING_SEEN),
            Some(why) => Failure::new(format!("{why}; none has a deformation and a pressure that stands still")),
        }
    }

    fn per_actuator(&self) -> bool {
        self.unknowns.per == Per::Actuator
    }

    /// Fits the limb as it hangs in its holds.
    fn under_weight(
        &self,
        scene: &Scene,
        limb: &Limb,
        holds: &[LimbHold],
        warnings: Vec<String>,
    ) -> Result<Outcome, Failure> {
        let Bodies { bodies, modules, of_channels } = bodies(scene, limb, self.per_actuator());
        let tip_accuracy_m = self.fitting.accuracy.si() * reach_m(holds);
        let loaded = Loaded { scene, limb, bodies: &of_channels, holds, tip_accuracy_m };
        let seen = |(hold, index): (usize, usize)| {
            let (hold, drive) = (&holds[hold], limb.drive(index));
            let reading_pa = hold.reading_pa(&drive.channels);
            let value = hold.values[index]?;
            Some(Seen {
                module: drive.index,
                reading_pa,
                branch: Branch::Loading,
                quantity: drive.kind,
                value,
                from: from(&hold.phase),
            })
        };
        let seen: Vec<Seen> = loaded.seen().into_iter().filter_map(seen).collect();
        if seen.is_empty() {
            return Err(self.nothing_seen(&warnings));
        }
        let source = Source { scene, bodies, modules, seen, warnings, loaded: Some(&loaded) };
        let (fit, outcome) = self.unknowns.fit(&source, &self.log, (&self.fitting, &self.files))?;
        if let Some(file) = &self.corrections {
            let (text, _) = scene::rewritten(scene, &source.means(&fit, &self.unknowns.fit)).map_err(Failure::new)?;
            let calibrated = scene::parse(&text, "the calibrated scene")?;
            let own = of_channels.iter().map(|body| fit.bodies[*body].actuator());
            let own: Vec<Actuator<f64>> = own.collect::<Result<_, _>>().map_err(Failure::new)?;
            write(file, &corrections_csv(scene, &equalizing(&calibrated, &own)?))?;
        }
        Ok(outcome)
    }
}

/// Actuators that are taken as equal, with the module of each, and the one of each channel.
struct Bodies {
    bodies: Vec<Body>,
    modules: Vec<usize>,
    of_channels: Vec<usize>,
}

/// A body for each module, or for each actuator of those that extend: the others hold their actuators to one motion.
fn bodies(scene: &Scene, limb: &Limb, per_actuator: bool) -> Bodies {
    let mut all = Bodies { bodies: Vec::new(), modules: Vec::new(), of_channels: Vec::new() };
    for (index, (module, described)) in limb.modules().iter().zip(scene.modules()).enumerate() {
        let (name, count) = (described.name.as_str(), module.channels.len());
        let single = per_actuator && count > 1 && module.motion == Motion::Extension;
        for actuator in 0..count {
            if single || actuator == 0 {
                let name = if single { format!("{name}.{}", actuator + 1) } else { name.to_owned() };
                let second_fiber = described.second_fiber.map(|fiber| *fiber);
                all.bodies.push(Body::new(name, described.actuator()).with_second_fiber(second_fiber));
                all.modules.push(index);
            }
            all.of_channels.push(all.bodies.len() - 1);
        }
    }
    all
}

/// Deformations at rest of actuators that carry nothing.
fn without_load(limb: &Limb, log: &RunLog) -> Vec<Seen> {
    let seen = holds(log).into_iter().map(|hold| Seen {
        module: limb.drive(hold.module).index,
        reading_pa: hold.reading_pa,
        branch: hold.branch,
        quantity: hold.quantity,
        value: hold.value,
        from: from(&hold.phase),
    });
    seen.collect()
}

fn from(phase: &str) -> String {
    format!("phase `{phase}`")
}

/// Largest distance of the tip in a hold from that in the first, m; 1 mm at least.
fn reach_m(holds: &[LimbHold]) -> f64 {
    let tips: Vec<[f64; 3]> = holds.iter().filter_map(|hold| hold.tip_m).collect();
    let from_first = |tip: &[f64; 3]| tip.iter().zip(&tips[0]).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    tips.iter().map(from_first).fold(1e-3, f64::max)
}
