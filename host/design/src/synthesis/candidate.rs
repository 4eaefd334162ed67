//! A designed limb, as the model confirms it.

use serde::{Deserialize, Serialize};

/// What an actuator of a module does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ModuleMotion {
    /// Lengthens.
    Extension,
    /// Widens.
    Expansion,
    /// Bends.
    Bending,
    /// Twists.
    Twisting,
}

impl From<fra_model::Motion> for ModuleMotion {
    fn from(motion: fra_model::Motion) -> Self {
        match motion {
            fra_model::Motion::Extension => Self::Extension,
            fra_model::Motion::Expansion => Self::Expansion,
            fra_model::Motion::Bending => Self::Bending,
            fra_model::Motion::Twisting => Self::Twisting,
        }
    }
}

/// One module of a designed limb.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModuleDesign {
    /// Name of what it was chosen from.
    pub name: String,
    /// Its motion.
    pub motion: ModuleMotion,
    /// `R_i`, m.
    pub inner_radius_m: f64,
    /// `R_o`, m.
    pub outer_radius_m: f64,
    /// `L`, m.
    pub length_m: f64,
    /// Fiber angle from the hoop, rad; 0 for bending.
    pub fiber_angle_rad: f64,
    /// Angles of both windings from the hoop, rad; empty where there are no two.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub windings_rad: Vec<f64>,
    /// Direction that it bends towards, rad about the limb's axis; 0 for other motions.
    pub mount_angle_rad: f64,
    /// The highest gauge pressure that its bounds allow, with the margin to the limit point, Pa.
    pub pressure_cap_pa: f64,
    /// Mass of the elastomer of all its actuators and of its rigid parts, kg.
    pub mass_kg: f64,
}

/// A designed limb at one way-point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WayPointAnswer {
    /// Gauge pressure of each module, or of each of its segments, Pa.
    pub pressure_pa: Vec<f64>,
    /// Deformation of each module: axial stretch (extension), outer radius in m (expansion), bend angle or twist in rad.
    pub deformation: Vec<f64>,
    /// Deformations of the modules that have targets, m or rad; empty where the way-point is a place of the tip.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub totals: Vec<f64>,
    /// Tip at these pressures, m, from forward solves.
    pub tip_m: [f64; 3],
    /// Axis of the end effector there.
    pub axis: [f64; 3],
    /// Distance of the tip from its aim, m. For modules with targets: root of the sum of their squared errors, a radian counted as 100 mm.
    pub tip_error_m: f64,
    /// Angle of the end effector beyond its tolerance, rad; 0 where nothing is asked.
    pub direction_error_rad: f64,
    /// Least distance between the limb's surface and an obstacle, m; negative inside. `None` without obstacles.
    pub clearance_m: Option<f64>,
    /// Name of the obstacle that is nearest beyond its required clearance; `None` without obstacles.
    pub nearest_obstacle: Option<String>,
    /// The least distance along the move to here. `None` where there is no such move or it does not count.
    pub move_clearance_m: Option<f64>,
}

/// What limbs are compared by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Root of the mean squared tip error, m.
    pub tip_error_rms_m: f64,
    /// Largest tip error, m.
    pub tip_error_max_m: f64,
    /// Largest direction error, rad.
    pub direction_error_max_rad: f64,
    /// Highest gauge pressure, Pa.
    pub pressure_max_pa: f64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Least distance to an obstacle beyond what is required, at way-points and along moves that count, m; negative where it is not kept.
    /// `None` without obstacles.
    pub spare_clearance_m: Option<f64>,
    /// Gas put in from rest through all way-points, as its volume at atmospheric pressure, m3; nothing of what is vented is used again.
    pub air_m3: f64,
}

/// Why a limb does not do all that is asked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Shortfall {
    /// No limb within the bounds was found that reaches the way-point, even without obstacles.
    OutOfReach {
        /// The way-point, from 1.
        way_point: usize,
        /// What is left, m.
        by_m: f64,
    },
    /// The way-point itself is too close to an obstacle or inside of it for the end of the tool.
    TargetBlocked {
        /// The way-point, from 1.
        way_point: usize,
        /// The obstacle.
        obstacle: String,
        /// Distance that is missing, m.
        by_m: f64,
    },
    /// The way-points are reached without obstacles, but no limb within the bounds was found that keeps clear of this one.
    Obstacle {
        /// The way-point, from 1, at which or on the way to which.
        way_point: usize,
        /// The obstacle.
        obstacle: String,
        /// Distance that is missing at this design, m; 0 where it gives way and misses the way-point instead.
        by_m: f64,
    },
}

impl std::fmt::Display for Shortfall {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::OutOfReach { way_point, by_m } => write!(
                f,
                "way-point {way_point} is out of reach: the nearest found within the bounds is {:.3} mm away, obstacles left aside",
                by_m * 1e3
            ),
            Self::TargetBlocked { way_point, obstacle, by_m } => {
                write!(
                    f,
                    "way-point {way_point} is {:.3} mm too close to {obstacle} for the end of the tool",
                    by_m * 1e3
                )
            }
            Self::Obstacle { way_point, obstacle, by_m } if *by_m > 0.0 => {
                write!(
                    f,
                    "{obstacle} is in the way at way-point {way_point}: {:.3} mm of clearance are missing",
                    by_m * 1e3
                )
            }
            Self::Obstacle { way_point, obstacle, .. } => {
                write!(f, "{obstacle} keeps the limb from way-point {way_point}")
            }
        }
    }
}

/// A designed limb.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// Its modules from the base outwards.
    pub modules: Vec<ModuleDesign>,
    /// Its way-points.
    pub way_points: Vec<WayPointAnswer>,
    /// What it is compared by.
    pub figures: Figures,
    /// `J`: weighted squared errors of tip and direction and squared penetrations of all body points, mm2, from forward solves.
    pub objective_mm2: f64,
    /// Why something is left; `None` where every way-point is reached and every clearance kept.
    pub shortfall: Option<Shortfall>,
    /// Evaluations of all way-points with derivatives that the search took.
    pub evaluations: usize,
}

/// A tip error that counts as none, m.
pub const REACHED_M: f64 = 1e-6;
/// A missing clearance that counts as none, m; what is found keeps as much more than is required where it can.
pub const CLEAR_M: f64 = 4e-5;

impl Candidate {
    /// Whether every way-point is reached within [`REACHED_M`] (and its direction within 1e-5 rad) and every clearance kept.
    pub fn does_it(&self) -> bool {
        let figures = &self.figures;
        figures.tip_error_max_m <= REACHED_M
            && figures.direction_error_max_rad <= 1e-5
            && figures.spare_clearance_m.is_none_or(|spare| spare >= -CLEAR_M)
    }
}
