//! `softlimb fea calibrate`: coefficients of the analytic model, from finite elements.

use std::path::PathBuf;

use clap::Args;
use fra_model::{Families, Motion, Placement};
use serde::Serialize;

use super::super::shared::{limb, parts, show};
use super::super::{Failure, Outcome};
use softlimb_fea::axisymmetric::{Delta, EndLength, MeridianError, Thread, ThreadSheet, end_length, thread_sheet};
use softlimb_fea::cross_section::{CALIBRATED_FROM, Calibration, Options, Section};
use softlimb_limb::LimbModule;

/// Largest angle from the hoop, rad, up to which turns of thread are as good as rings.
const HOOP_RAD: f64 = 0.175;
/// Pressure at which a thread is compared with a sheet, and of the end length for a scene, as a share of the highest: what a thread is worth hardly
/// depends on it, and at high pressures the wall creases at the edges of the thread; ends take the more the higher the pressure.
const MODERATE: f64 = 0.3;

/// Calibrate the analytic model by finite elements: bending polynomial, end length, and the sheet equivalent to a thread
#[derive(Args)]
#[command(after_help = "Example: softlimb fea calibrate scenes/pick-and-place-a.toml --thread 772,3,0.178")]
pub(super) struct Calibrate {
    /// The scene whose actuators are calibrated
    scene: PathBuf,
    /// Only this module
    #[arg(long, value_name = "NAME")]
    module: Option<String>,
    /// The thread that winds the actuators: `E A` in N, distance of its turns in mm, width in mm
    #[arg(long, value_name = "N,MM,MM", allow_hyphen_values = true)]
    thread: Option<String>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Result of one module, or why there is none.
struct Found<'a> {
    module: &'a LimbModule,
    bending: Option<Result<Calibration, String>>,
    ends: Result<EndLength, String>,
    /// End length of the module's own motion at a moderate pressure, m.
    end_m: Option<f64>,
    sheet: Option<Result<ThreadSheet, String>>,
}

impl Calibrate {
    pub(super) fn run(&self) -> Result<Outcome, Failure> {
        let thread = self.thread()?;
        let (scene, limb) = limb(&self.scene)?;
        scene.require_no_segments("`fea`")?;
        let wanted = |module: &&LimbModule| self.module.as_ref().is_none_or(|name| *name == module.name);
        let modules: Vec<_> = limb.modules().iter().filter(wanted).collect();
        if modules.is_empty() {
            let names: Vec<_> = limb.modules().iter().map(|module| module.name.as_str()).collect();
            let asked = self.module.as_deref().unwrap_or_default();
            return Err(Failure::new(format!("there is no module \"{asked}\": one of {}", names.join(", "))));
        }
        let found = modules.into_iter().map(|module| find(module, thread.as_ref())).collect::<Result<Vec<_>, _>>()?;
        let printed = Printed { modules: found.iter().map(printed).collect() };
        show(self.json, &printed, || found.iter().map(words).collect::<Vec<_>>().join("\n"))?;
        let whole = |found: &Found| {
            let bending = found.bending.as_ref().is_none_or(Result::is_ok);
            bending && found.ends.is_ok() && found.sheet.as_ref().is_none_or(Result::is_ok)
        };
        Ok(if found.iter().all(whole) { Outcome::Done } else { Outcome::DoneWithWarnings })
    }

    fn thread(&self) -> Result<Option<Thread>, Failure> {
        let Some(text) = &self.thread else { return Ok(None) };
        let [stiffness_n, spacing_m, width_m] = parts("--thread", text, [("N", 1e6), ("mm", 1e4), ("mm", 1e3)])?;
        Ok(Some(Thread { stiffness_n, spacing_m, width_m }))
    }
}

fn find<'a>(module: &'a LimbModule, thread: Option<&Thread>) -> Result<Found<'a>, Failure> {
    let (parameters, second, highest_pa) =
        (module.actuator.parameters(), module.second_fiber(), module.pressure_max_pa);
    let section = || match second {
        None => Section::new(parameters, &Options::default()),
        Some(second) => Section::with_two_windings(parameters, second, &Options::default()),
    };
    let calibrate = || section()?.calibrate([CALIBRATED_FROM * highest_pa, highest_pa]);
    let bending = (module.motion == Motion::Bending).then(|| calibrate().map_err(|error| error.to_string()));
    let sheet = match thread.map(|thread| (thread, not_hooped(module))) {
        None => None,
        Some((_, Some(reason))) => Some(Err(reason)),
        Some((thread, None)) => match thread_sheet(parameters, thread, MODERATE * highest_pa) {
            Err(error @ MeridianError::Invalid(_)) => return Err(Failure::new(format!("--thread: {error}"))),
            found => Some(found.map_err(|error| error.to_string())),
        },
    };
    let ends = end_length(parameters, second, highest_pa).map_err(|error| error.to_string());
    let moderate = end_length(parameters, second, MODERATE * highest_pa).ok();
    let own = moderate.and_then(|ends| if module.motion == Motion::Twisting { ends.twist } else { ends.axial });
    Ok(Found { module, bending, ends, end_m: own.map(|delta| delta.delta_m), sheet })
}

/// Why a module's winding is not one of rings of thread.
fn not_hooped(module: &LimbModule) -> Option<String> {
    if module.second_fiber().is_some() {
        return Some("the module has two windings, and the thread could be either".to_owned());
    }
    let fiber = module.actuator.parameters().fiber?;
    let angle = fiber.angle_rad.abs();
    if angle > HOOP_RAD {
        let (angle, most) = (angle.to_degrees(), HOOP_RAD.to_degrees());
        return Some(format!(
            "the winding is at {angle:.0} deg; threads are taken as rings up to {most:.0} deg from the hoop"
        ));
    }
    (fiber.placement != Placement::Sheet).then(|| "the winding is no sheet".to_owned())
}

fn words(found: &Found) -> String {
    let Found { module, bending, ends, end_m, sheet } = found;
    let mut text = format!("{} ({:.0} kPa)\n", module.name, module.pressure_max_pa * 1e-3);
    match bending {
        Some(Ok(calibration)) => {
            let [a, b, c] = by_angle(calibration, module);
            text += &format!(
                "  bending: P = {a:.2} phi {b:+.2} phi^2 {c:+.2} phi^3 Pa, phi in rad; from {:.0} kPa on it errs by {:.2} % of the bend at most\n",
                calibration.pressures_pa[0] * 1e-3,
                100.0 * calibration.verified_error,
            );
        }
        Some(Err(reason)) => text += &format!("  bending: {reason}\n"),
        None => {}
    }
    match ends {
        Ok(EndLength { axial, twist, .. }) => {
            let bends = if module.motion == Motion::Bending { "the bend" } else { "the change of length" };
            for (name, delta) in [(bends, axial), ("the twist", twist)] {
                if let Some(Delta { delta_m, error_m }) = delta {
                    text +=
                        &format!("  ends: each takes {:.2} +- {:.2} mm out of {name}\n", delta_m * 1e3, error_m * 1e3);
                }
            }
        }
        Err(reason) => text += &format!("  ends: {reason}\n"),
    }
    if let Some(end_m) = end_m {
        let kpa = MODERATE * module.pressure_max_pa * 1e-3;
        text += &format!("  for the scene: end_length = \"{:.2} mm\", that of {kpa:.0} kPa\n", end_m * 1e3);
    }
    match sheet {
        Some(Ok(sheet)) => {
            text += &format!(
                "  thread: worth a sheet of {:.1} N/mm, not the {:.1} N/mm of threads without distance: {:.1} % less strain",
                sheet.effective_n_per_m * 1e-3,
                sheet.ideal_n_per_m * 1e-3,
                100.0 * (1.0 - sheet.strain / sheet.ideal_strain),
            );
            text += &modulus(module, sheet).map_or_else(String::new, |(modulus_pa, thickness_m)| {
                format!("; modulus = \"{:.4} MPa\" with thickness = \"{} mm\"", modulus_pa * 1e-6, thickness_m * 1e3)
            });
            text.push('\n');
        }
        Some(Err(reason)) => text += &format!("  thread: {reason}\n"),
        None => {}
    }
    text
}

/// Coefficients of the polynomial for the bend angle of the module's length.
fn by_angle(calibration: &Calibration, module: &LimbModule) -> [f64; 3] {
    let length_m = module.actuator.parameters().length_m;
    let [a, b, c] = calibration.polynomial.coefficients;
    [a / length_m, b / length_m.powi(2), c / length_m.powi(3)]
}

/// Modulus of a winding of the scene that is worth the thread, and its thickness.
fn modulus(module: &LimbModule, sheet: &ThreadSheet) -> Option<(f64, f64)> {
    let fiber = module.actuator.parameters().fiber.filter(|fiber| fiber.thickness_m > 0.0)?;
    let families = if fiber.families == Families::Two { 2.0 } else { 1.0 };
    Some((sheet.effective_n_per_m / (families * fiber.thickness_m), fiber.thickness_m))
}

/// The result of `--json`.
#[derive(Serialize)]
struct Printed<'a> {
    modules: Vec<PrintedModule<'a>>,
}

#[derive(Serialize)]
struct PrintedModule<'a> {
    module: &'a str,
    pressure_max_pa: f64,
    bending: Option<OrReason<Bending>>,
    ends: OrReason<Ends>,
    thread: Option<OrReason<Sheet>>,
}

/// A result, or the reason that there is none.
#[derive(Serialize)]
#[serde(untagged)]
enum OrReason<T> {
    Found(T),
    Reason { error: String },
}

#[derive(Serialize)]
struct Bending {
    coefficients_pa: [f64; 3],
    pressures_pa: [f64; 2],
    verified_error: f64,
    mesh_error: f64,
}

#[derive(Serialize)]
struct Ends {
    axial: Option<PrintedDelta>,
    twist: Option<PrintedDelta>,
}

#[derive(Serialize)]
struct PrintedDelta {
    delta_m: f64,
    error_m: f64,
}

#[derive(Serialize)]
struct Sheet {
    effective_n_per_m: f64,
    ideal_n_per_m: f64,
    error: f64,
    strain: f64,
    ideal_strain: f64,
    modulus_pa: Option<f64>,
}

fn or_reason<A, T>(found: &Result<A, String>, printed: impl Fn(&A) -> T) -> OrReason<T> {
    match found {
        Ok(found) => OrReason::Found(printed(found)),
        Err(reason) => OrReason::Reason { error: reason.clone() },
    }
}

fn printed<'a>(found: &Found<'a>) -> PrintedModule<'a> {
    let module = found.module;
    let delta =
        |delta: &Option<Delta>| delta.map(|delta| PrintedDelta { delta_m: delta.delta_m, error_m: delta.error_m });
    let bending = |calibration: &Calibration| Bending {
        coefficients_pa: by_angle(calibration, module),
        pressures_pa: calibration.pressures_pa,
        verified_error: calibration.verified_error,
        mesh_error: calibration.mesh_error,
    };
    let sheet = |sheet: &ThreadSheet| Sheet {
        effective_n_per_m: sheet.effective_n_per_m,
        ideal_n_per_m: sheet.ideal_n_per_m,
        error: sheet.error,
        strain: sheet.strain,
        ideal_strain: sheet.ideal_strain,
        modulus_pa: modulus(module, sheet).map(|(modulus_pa, _)| modulus_pa),
    };
    PrintedModule {
        module: &module.name,
        pressure_max_pa: module.pressure_max_pa,
        bending: found.bending.as_ref().map(|found| or_reason(found, bending)),
        ends: or_reason(&found.ends, |ends| Ends { axial: delta(&ends.axial), twist: delta(&ends.twist) }),
        thread: found.sheet.as_ref().map(|found| or_reason(found, sheet)),
    }
}
