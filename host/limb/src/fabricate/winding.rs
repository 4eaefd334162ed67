//! How the thread runs: hands, starts, lead, and what it is worth.
//!
//! A thread at the angle `a` from the hoop climbs `2 pi R tan a` a turn on the radius `R`. `n` of them side by side are
//! `2 pi R sin a/n` apart, measured across, and `2 pi R tan a/n` along the axis.

use std::f64::consts::{FRAC_PI_2, TAU};

use fra_model::{ActuatorParameters, Families, Motion};
use serde::Serialize;

use super::Settings;
use softlimb_fea::axisymmetric::{Thread as Rings, thread_sheet};

/// Largest angle from the hoop, rad, up to which turns of thread are as good as rings.
pub(super) const HOOP_RAD: f64 = 0.175;
/// Threads whose angle has a lower cosine run along the axis.
const STRAIGHT: f64 = 1e-4;
/// Pressure at which a thread is compared with a sheet, as a share of the highest.
pub(super) const MODERATE: f64 = 0.3;
/// Distance of turns along the axis in walls where the scene states no stiffness.
const PLAIN: f64 = 0.5;
/// Distances of turns among which one is sought, from this many diameters to this many walls.
const SOUGHT: [f64; 2] = [1.5, 2.0];

/// Logarithm of the factor between distances that are tried on the way up.
const STRIDE: f64 = 0.5;

/// Which way a thread climbs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Hand {
    /// As a common screw: a positive fiber angle.
    Right,
    /// Its mirror image.
    Left,
    /// Along the axis.
    Straight,
}

/// The sheet that rings of the thread are worth, by finite elements of one period of the wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Worth {
    /// Stiffness `km` of the sheet that lengthens as much, N/m.
    pub effective_n_per_m: f64,
    /// `E A/(4 distance)`, N/m: that of a thread without distance between its turns.
    pub ideal_n_per_m: f64,
    /// `km` of the scene's winding, N/m; `None` where it states none.
    pub scene_n_per_m: Option<f64>,
    /// Share of the strain under pressure that the distance of the turns takes away.
    pub strain_lost: f64,
    /// `modulus` for the scene's winding, at its thickness, Pa; `None` where it states a thread.
    pub modulus_pa: Option<f64>,
}

/// A winding of whole threads over the length of an actuator.
#[derive(Clone, Debug, PartialEq)]
pub struct Winding {
    /// Angle of the threads from the hoop as wound, rad; > 0, at most pi/2.
    pub angle_rad: f64,
    /// Radius of the thread's centre line, m.
    pub radius_m: f64,
    /// Length along the axis that is wound, m.
    pub length_m: f64,
    /// The hands it is wound in.
    pub hands: Vec<Hand>,
    /// Threads side by side in each hand.
    pub starts: u32,
    /// Whether its turns are as good as rings.
    pub is_hoop: bool,
    /// What rings of the thread are worth, or why that is not known; `None` for helices.
    pub worth: Option<Result<Worth, String>>,
    /// What whoever winds it should know.
    pub remarks: Vec<String>,
}

impl Winding {
    /// The winding of one actuator, with a sheet or none, up to a gauge pressure, Pa; of as many threads side by side as the scene
    /// states, if it does.
    pub(super) fn new(
        parameters: &ActuatorParameters<f64>,
        settings: &Settings,
        starts: Option<u32>,
        pressure_max_pa: f64,
    ) -> Self {
        let stated = parameters.fiber.map(|fiber| fiber.angle_rad).filter(|angle| *angle != 0.0);
        let radius_m = winding_radius_m(parameters);
        let angle = stated.map_or(0.0, f64::abs);
        let mut winding = Self {
            angle_rad: angle.min(FRAC_PI_2),
            radius_m,
            length_m: parameters.length_m,
            hands: hands(parameters, angle),
            starts: 1,
            is_hoop: angle <= HOOP_RAD,
            worth: None,
            remarks: Vec::new(),
        };
        if let Some(starts) = starts {
            winding.starts = winding.merged(parameters) * starts;
            if winding.is_hoop {
                winding.find_worth(parameters, settings, pressure_max_pa);
                // The scene takes the sheet from the thread.
                winding.worth.iter_mut().flatten().for_each(|worth| worth.modulus_pa = None);
            }
        } else if winding.is_hoop {
            winding.wind_hoop(parameters, settings, pressure_max_pa);
        } else {
            winding.wind_helix(parameters, settings);
        }
        winding
    }

    /// Rise of one thread in one turn, m; infinite along the axis.
    pub fn lead_m(&self) -> f64 {
        if self.is_straight() { f64::INFINITY } else { TAU * self.radius_m * self.angle_rad.tan() }
    }

    /// Turns of one thread.
    pub fn turns(&self) -> f64 {
        self.length_m / self.lead_m()
    }

    /// Length of one thread on the actuator, m.
    pub fn thread_m(&self) -> f64 {
        self.length_m / self.angle_rad.sin()
    }

    /// Number of threads.
    pub fn threads(&self) -> u32 {
        self.starts * self.hands.len() as u32
    }

    /// Distance of neighbouring threads of one hand, measured across them, m.
    pub fn spacing_m(&self) -> f64 {
        TAU * self.radius_m * self.angle_rad.sin() / f64::from(self.starts)
    }

    /// Distance of one turn to the next along the axis, of all hands, m; infinite along the axis.
    pub fn turn_spacing_m(&self) -> f64 {
        self.lead_m() / f64::from(self.threads())
    }

    /// Whether the threads run along the axis.
    pub fn is_straight(&self) -> bool {
        self.angle_rad.cos() < STRAIGHT
    }

    fn wind_hoop(&mut self, parameters: &ActuatorParameters<f64>, settings: &Settings, pressure_max_pa: f64) {
        let pressure_pa = MODERATE * pressure_max_pa;
        let wall_m = parameters.outer_radius_m - parameters.inner_radius_m;
        let wanted_m = settings.spacing_m.unwrap_or_else(|| match scene_n_per_m(parameters) {
            Some(wanted) => self.spacing_worth(parameters, settings, wanted, pressure_pa),
            None => PLAIN * wall_m,
        });
        let hands = self.hands.len() as f64;
        if self.angle_rad == 0.0 {
            let lead_m = hands * wanted_m;
            self.angle_rad = (lead_m / (TAU * self.radius_m)).atan();
        } else {
            self.starts = whole(self.lead_m() / (hands * wanted_m));
        }
        self.say_rounded(wanted_m, self.turn_spacing_m(), "distance of the turns");
        self.find_worth(parameters, settings, pressure_max_pa);
    }

    /// Length of all threads on the actuator, m.
    pub fn all_threads_m(&self) -> f64 {
        f64::from(self.threads()) * self.thread_m()
    }

    fn find_worth(&mut self, parameters: &ActuatorParameters<f64>, settings: &Settings, pressure_max_pa: f64) {
        let pressure_pa = MODERATE * pressure_max_pa;
        let rings = Rings { spacing_m: self.turn_spacing_m(), ..rings(settings) };
        self.worth = Some(
            thread_sheet(parameters, &rings, pressure_pa)
                .map(|sheet| Worth {
                    effective_n_per_m: sheet.effective_n_per_m,
                    ideal_n_per_m: sheet.ideal_n_per_m,
                    scene_n_per_m: scene_n_per_m(parameters),
                    strain_lost: 1.0 - sheet.strain / sheet.ideal_strain,
                    modulus_pa: modulus_pa(parameters, sheet.effective_n_per_m),
                })
                .map_err(|error| error.to_string()),
        );
    }

    /// The distance of turns at which they are worth a sheet's stiffness, m; the nearest that there is, with a remark.
    fn spacing_worth(
        &mut self,
        parameters: &ActuatorParameters<f64>,
        settings: &Settings,
        wanted: f64,
        pressure_pa: f64,
    ) -> f64 {
        let wall_m = parameters.outer_radius_m - parameters.inner_radius_m;
        let low = SOUGHT[0] * settings.thread.diameter_m;
        let high = (SOUGHT[1] * wall_m).max(2.0 * low);
        let excess = |spacing_m: f64| {
            let rings = Rings { spacing_m, ..rings(settings) };
            thread_sheet(parameters, &rings, pressure_pa).map(|sheet| (sheet.effective_n_per_m / wanted).ln())
        };
        match root(excess, low.ln(), high.ln()) {
            Ok(spacing_m) => spacing_m,
            Err(Outside::Low) => {
                self.remarks.push(format!(
                    "no distance of this thread is worth the scene's {:.1} N/mm: it is wound as close as can be",
                    wanted * 1e-3
                ));
                low
            }
            Err(Outside::High) => {
                self.remarks.push(format!(
                    "at {:.2} mm from turn to turn the thread is still worth more than the scene's {:.1} N/mm",
                    high * 1e3,
                    wanted * 1e-3
                ));
                high
            }
            Err(Outside::Unknown(reason)) => {
                self.remarks.push(format!(
                    "the distance of turns is half a wall, because their stiffness as a sheet is not known: {reason}"
                ));
                PLAIN * wall_m
            }
        }
    }

    fn wind_helix(&mut self, parameters: &ActuatorParameters<f64>, settings: &Settings) {
        let wall_m = parameters.outer_radius_m - parameters.inner_radius_m;
        let stiffness = parameters.fiber.map_or(0.0, |fiber| 4.0 * fiber.modulus_pa * fiber.thickness_m);
        let stiffness = f64::from(self.merged(parameters)) * stiffness;
        let wanted_m = settings.spacing_m.unwrap_or(if stiffness > 0.0 {
            settings.thread.stiffness_n / stiffness
        } else {
            PLAIN * wall_m
        });
        self.starts = whole(TAU * self.radius_m * self.angle_rad.sin() / wanted_m);
        self.say_rounded(wanted_m, self.spacing_m(), "distance of the threads");
    }

    /// Number of fiber families in one hand: both families of an axial winding have the same direction.
    fn merged(&self, parameters: &ActuatorParameters<f64>) -> u32 {
        let both = self.is_straight() && parameters.fiber.is_some_and(|fiber| fiber.families == Families::Two);
        if both { 2 } else { 1 }
    }

    fn say_rounded(&mut self, wanted_m: f64, found_m: f64, what: &str) {
        if (found_m / wanted_m - 1.0).abs() > 0.05 {
            self.remarks.push(format!(
                "the {what} is {:.3} mm, not the {:.3} mm wanted: only whole threads fit at this angle",
                found_m * 1e3,
                wanted_m * 1e3
            ));
        }
    }
}

/// Radius of the thread's centre line, m.
pub(super) fn winding_radius_m(parameters: &ActuatorParameters<f64>) -> f64 {
    let [inner, outer] = [parameters.inner_radius_m, parameters.outer_radius_m];
    parameters.fiber.map_or(outer, |fiber| fiber.radius_m.clamp(inner, outer))
}

/// Nearest whole number that is at least 1.
fn whole(count: f64) -> u32 {
    count.round().clamp(1.0, 1e6) as u32
}

fn hands(parameters: &ActuatorParameters<f64>, angle: f64) -> Vec<Hand> {
    let Some(fiber) = parameters.fiber else { return vec![Hand::Right, Hand::Left] };
    match (fiber.families, fiber.angle_rad < 0.0) {
        _ if angle.cos() < STRAIGHT => vec![Hand::Straight],
        (Families::Two, _) => vec![Hand::Right, Hand::Left],
        (Families::One, false) => vec![Hand::Right],
        (Families::One, true) => vec![Hand::Left],
    }
}

fn rings(settings: &Settings) -> Rings {
    let thread = settings.thread;
    Rings { stiffness_n: thread.stiffness_n, spacing_m: 0.0, width_m: thread.diameter_m }
}

/// `km` of all families of the scene's winding, N/m.
fn scene_n_per_m(parameters: &ActuatorParameters<f64>) -> Option<f64> {
    let bends = parameters.motion == Motion::Bending;
    let stated = parameters.fiber.map(|fiber| families(parameters) * fiber.modulus_pa * fiber.thickness_m);
    // Bending takes its winding as inextensible: its modulus is not asked for.
    stated.filter(|stiffness| !bends && *stiffness > 0.0)
}

fn modulus_pa(parameters: &ActuatorParameters<f64>, effective_n_per_m: f64) -> Option<f64> {
    let fiber = parameters.fiber.filter(|fiber| fiber.thickness_m > 0.0)?;
    Some(effective_n_per_m / (families(parameters) * fiber.thickness_m))
}

fn families(parameters: &ActuatorParameters<f64>) -> f64 {
    if parameters.fiber.is_some_and(|fiber| fiber.families == Families::Two) { 2.0 } else { 1.0 }
}

/// Why a distance is not found within the range.
enum Outside {
    /// It would lie below.
    Low,
    /// It would lie above.
    High,
    /// The function has no value somewhere.
    Unknown(String),
}

/// Where a function that falls with the logarithm of its argument is zero, to a thousandth; looked for from below, because turns that
/// are far apart may have no answer.
fn root<E: std::fmt::Display>(value: impl Fn(f64) -> Result<f64, E>, low: f64, high: f64) -> Result<f64, Outside> {
    let at = |place: f64| value(place.exp()).map_err(|error| Outside::Unknown(error.to_string()));
    let mut a = (low, at(low)?);
    if a.1 <= 0.0 {
        return Err(Outside::Low);
    }
    let mut b = a;
    while b.1 > 0.0 {
        if b.0 >= high {
            return Err(Outside::High);
        }
        a = b;
        let place = (a.0 + STRIDE).min(high);
        b = (place, at(place)?);
    }
    // The Illinois variant of the secant method: an end that stays counts half.
    for _ in 0..30 {
        let place = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
        let found = at(place)?;
        if found.abs() < 1e-3 {
            return Ok(place.exp());
        }
        if found > 0.0 {
            a = (place, found);
            b.1 *= 0.5;
        } else {
            b = (place, found);
            a.1 *= 0.5;
        }
    }
    Ok((0.5 * (a.0 + b.0)).exp())
}
