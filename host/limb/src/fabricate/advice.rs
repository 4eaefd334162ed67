//! Warnings about windings that a person cannot wind, or whose distance of turns takes much of the motion.
//!
//! Figures are of the closed form of a thread ([`softlimb_scene::Thread`]); where the scene states a sheet, the number of threads is that of the workshop.

use fra_model::{Actuator, ActuatorParameters, Families, Load, Motion, Placement, Status};
use softlimb_scene as scene;
use softlimb_scene::{Module, Scene, WoundWall};

use super::Settings;
use super::piece::{CLOSE, groove, with_thread_of};
use super::winding::{HOOP_RAD, MODERATE, Winding, winding_radius_m};

/// Longest thread of one actuator without a warning, m: at two turns a minute of a tube of 30 mm an hour's work.
const THREAD_MAX_M: f64 = 20.0;
/// Largest share of the motion that the distance of the turns takes without a warning.
const LOSS_MAX: f64 = 0.05;
/// Largest share by which the stiffest winding of a thread may fall short of the scene's sheet without a warning.
const SHORT: f64 = 0.05;

/// Warnings about the windings of a scene, one line each with the place in the scene. A winding whose scene states no thread is taken for
/// that of the settings.
pub fn advice(scene: &Scene, settings: &Settings) -> Vec<String> {
    let of_module = |module: &Module| {
        let span = module.fiber.as_ref().map_or(module.span, |fiber| fiber.span);
        let (file, line) = (scene.source_name().to_owned(), scene.position(span).0);
        let name = module.name.to_string();
        let texts = Wound::new(module, settings).map_or_else(|text| vec![text], |wound| wound.warnings());
        texts.into_iter().map(move |text| format!("{file}:{line}: winding of `{name}`: {text}"))
    };
    // `fabricate` winds one.
    scene.modules().iter().filter(|module| module.second_fiber.is_none()).flat_map(of_module).collect()
}

/// A winding of whole threads at the scene's angle.
struct Wound {
    parameters: ActuatorParameters<f64>,
    thread: scene::Thread,
    wall: WoundWall,
    families: f64,
    /// Whether the scene states the thread.
    stated: bool,
    /// Width of a groove at the surface, m: the least distance of threads.
    groove_m: f64,
    pressure_pa: f64,
    /// The workshop, with its thread.
    settings: Settings,
}

impl Wound {
    /// The winding of a module, with one thread side by side where the scene states none.
    ///
    /// # Errors
    /// Why no thread can be wound.
    fn new(module: &Module, settings: &Settings) -> Result<Self, String> {
        let settings = with_thread_of(module, settings);
        let parameters = module.made_actuator();
        let [inner_m, outer_m] = [parameters.inner_radius_m, parameters.outer_radius_m];
        if outer_m - inner_m < settings.wall_min_m * (1.0 - 1e-9) {
            let [wall, least] = [outer_m - inner_m, settings.wall_min_m].map(|m| 1e3 * m);
            return Err(format!("the wall of {wall:.2} mm is too thin to be cast; {least:.2} mm can be"));
        }
        let straight = parameters.motion != Motion::Bending;
        if straight && parameters.fiber.is_some_and(|fiber| fiber.placement != Placement::Sheet) {
            return Err("no thread fills a layer or the whole wall: `placement = \"sheet\"` can be wound".to_owned());
        }
        let (cast_m, groove) = groove(&parameters, settings.thread.diameter_m);
        if cast_m - groove.depth_m <= inner_m {
            let least_mm = 1e3 * (inner_m + 0.5 * settings.thread.diameter_m);
            return Err(format!("its groove reaches the chamber: a `radius` above {least_mm:.3} mm does not"));
        }
        let fiber = parameters.fiber;
        let starts = module.thread.map_or(1, |thread| thread.starts);
        let two = fiber.is_none_or(|fiber| fiber.families == Families::Two);
        Ok(Self {
            parameters,
            thread: scene::Thread {
                stiffness_n: settings.thread.stiffness_n,
                diameter_m: settings.thread.diameter_m,
                starts,
            },
            wall: WoundWall {
                inner_radius_m: inner_m,
                outer_radius_m: outer_m,
                winding_radius_m: winding_radius_m(&parameters),
                angle_rad: fiber.map_or(0.0, |fiber| fiber.angle_rad),
                shear_modulus_pa: parameters.material.shear_modulus_pa(),
            },
            families: if two { 2.0 } else { 1.0 },
            stated: module.thread.is_some(),
            groove_m: groove.top_m,
            pressure_pa: MODERATE * *module.pressure_max_pa,
            settings,
        })
    }

    fn of(&self, starts: u32) -> scene::Thread {
        scene::Thread { starts, ..self.thread }
    }

    fn wall_m(&self) -> f64 {
        self.wall.outer_radius_m - self.wall.inner_radius_m
    }

    /// Thread on one actuator, m.
    fn length_m(&self, starts: u32) -> f64 {
        self.families * f64::from(starts) * self.parameters.length_m / self.wall.angle_rad.abs().sin()
    }

    /// Distance of the threads that the wall bulges between, m: near the hoop those of both families.
    fn between_m(&self, starts: u32) -> f64 {
        let across_m = self.of(starts).spacing_m(&self.wall);
        if self.wall.angle_rad.abs() <= HOOP_RAD { across_m / self.families } else { across_m }
    }

    /// Most threads side by side that have room.
    fn starts_max(&self) -> u32 {
        let most = self.of(1).spacing_m(&self.wall) / self.groove_m;
        (most.ceil() - 1.0).clamp(0.0, 1e6) as u32
    }

    /// The motion at a moderate pressure with a sheet of a stiffness for each family, N/m; `None` where the model has none.
    fn motion(&self, n_per_m: f64) -> Option<f64> {
        let mut parameters = self.parameters;
        let fiber = parameters.fiber.as_mut()?;
        fiber.modulus_pa = n_per_m / fiber.thickness_m;
        let solution = Actuator::new(&parameters).ok()?.forward(self.pressure_pa, &Load::none()).ok()?;
        let state = solution.state;
        let motion = match parameters.motion {
            Motion::Extension => state.axial_strain,
            Motion::Expansion => state.outer_radius_m / parameters.outer_radius_m - 1.0,
            Motion::Twisting => state.twist_rad,
            // The analytic bender takes its winding as inextensible.
            Motion::Bending => return None,
        };
        (solution.status == Status::Solved && motion != 0.0).then_some(motion)
    }

    /// Share of the motion that the distance of threads takes.
    fn loss(&self, starts: u32) -> Option<f64> {
        let thread = self.of(starts);
        let motion = self.motion(thread.sheet_n_per_m(&self.wall))?;
        Some(1.0 - motion / self.motion(thread.ideal_n_per_m(&self.wall))?)
    }

    fn warnings(&self) -> Vec<String> {
        // Without an angle the turns are half a wall apart, which can be wound.
        if self.wall.angle_rad == 0.0 {
            return Vec::new();
        }
        let most = self.starts_max();
        if most == 0 {
            let [apart, groove] = [self.of(1).spacing_m(&self.wall), self.groove_m].map(|m| 1e3 * m);
            return vec![format!(
                "at this angle turns are {apart:.3} mm apart, and their grooves {groove:.3} mm wide: a steeper `angle` can be wound"
            )];
        }
        if self.stated {
            return self.of_thread(most);
        }
        self.of_sheet(most)
    }

    fn of_thread(&self, most: u32) -> Vec<String> {
        let starts = self.thread.starts;
        let mut warnings = Vec::new();
        if starts > most {
            let groove = 1e3 * self.groove_m;
            warnings
                .push(format!("{starts} threads side by side leave no room for grooves of {groove:.3} mm: {most} do"));
        }
        warnings.extend(self.too_long(starts));
        let between_m = self.between_m(starts);
        if between_m > CLOSE * self.wall_m() {
            let enough = (f64::from(starts) * between_m / (CLOSE * self.wall_m())).ceil();
            warnings.push(format!(
                "threads {:.2} mm apart on a wall of {:.2} mm leave bulges that no sheet stands for: `starts = {enough}` would be close enough",
                1e3 * between_m,
                1e3 * self.wall_m()
            ));
        }
        if let Some(loss) = self.loss(starts).filter(|loss| *loss > LOSS_MAX) {
            let enough = (starts + 1..=most).find(|more| self.loss(*more).is_some_and(|loss| loss <= LOSS_MAX));
            let helps = enough.map_or_else(String::new, |enough| format!("; `starts = {enough}` takes less than 5 %"));
            let percent = 100.0 * loss;
            warnings.push(format!(
                "the distance of its turns takes {percent:.1} % of the motion, which the plan includes{helps}"
            ));
        }
        warnings
    }

    fn of_sheet(&self, most: u32) -> Vec<String> {
        let Some(fiber) = self.parameters.fiber.filter(|_| self.parameters.motion != Motion::Bending) else {
            return Vec::new();
        };
        let wanted = fiber.modulus_pa * fiber.thickness_m;
        let [stiffness, diameter] = [self.thread.stiffness_n, 1e3 * self.thread.diameter_m];
        // The workshop's own choice, so that both state one length.
        let nearest =
            Winding::new(&self.parameters, &self.settings, None, self.pressure_pa / MODERATE).starts.min(most);
        let found = self.of(most).sheet_n_per_m(&self.wall);
        let mut warnings = Vec::new();
        if found < (1.0 - SHORT) * wanted {
            let [found, wanted] = [found, wanted].map(|n_per_m| 1e-3 * self.families * n_per_m);
            warnings.push(format!(
                "thread of {stiffness} N and {diameter} mm is worth {found:.1} N/mm at most, the scene's sheet is {wanted:.1} N/mm: a stiffer thread, or `thread` in place of `modulus` and `thickness`"
            ));
        }
        warnings.extend(self.too_long(nearest));
        warnings
    }

    /// More thread than a person winds, and the number of threads that would do.
    fn too_long(&self, starts: u32) -> Option<String> {
        let length_m = self.length_m(starts);
        if length_m <= THREAD_MAX_M {
            return None;
        }
        let begin = format!(
            "{length_m:.1} m of thread on each actuator, {starts} side by side in each hand, {:.2} mm from one to the next",
            1e3 * self.between_m(starts)
        );
        let fewer = (f64::from(starts) * THREAD_MAX_M / length_m).floor().max(1.0) as u32;
        if fewer == starts || self.between_m(fewer) > CLOSE * self.wall_m() {
            return Some(format!("{begin}: more than {THREAD_MAX_M} m; a steeper `angle` takes less"));
        }
        let change = self.change(fewer).map_or_else(String::new, |change| {
            format!(", and moves {:.1} % {}", 100.0 * change.abs(), if change < 0.0 { "less" } else { "more" })
        });
        Some(format!(
            "{begin}: more than {THREAD_MAX_M} m; `thread = {{ stiffness = \"{} N\", diameter = \"{} mm\", starts = {fewer} }}` takes {:.1} m{change}",
            self.thread.stiffness_n,
            1e3 * self.thread.diameter_m,
            self.length_m(fewer),
        ))
    }

    /// Change of the motion with a number of threads, as a share of that of the scene's winding.
    fn change(&self, starts: u32) -> Option<f64> {
        let fiber = self.parameters.fiber?;
        let now = self.motion(fiber.modulus_pa * fiber.thickness_m)?;
        Some(self.motion(self.of(starts).sheet_n_per_m(&self.wall))? / now - 1.0)
    }
}
