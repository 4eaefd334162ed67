//! What the workshop works with.

use super::Tolerances;
use softlimb_files::range::{OutOfRange, require};

/// The thread that is wound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thread {
    /// Force per strain `E A`, N; > 0.
    pub stiffness_n: f64,
    /// Diameter, m; 0.01 mm to 5 mm.
    pub diameter_m: f64,
}

/// Everything that a scene does not say about how it is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The thread of windings for which the scene states none.
    pub thread: Thread,
    /// Distance of one turn to the next, m: along the axis for windings near the hoop, across the threads of one family for others. `None`: the
    /// distance at which the thread is worth the scene's winding; half a wall where the scene states no stiffness.
    pub spacing_m: Option<f64>,
    /// How far finished parts may be off.
    pub tolerances: Tolerances,
    /// Thinnest wall that can be cast, m; 0.1 mm to 50 mm.
    pub wall_min_m: f64,
    /// Largest distance of a chord from the curve that it stands for, m, in meshes and paths; 0.001 mm to 1 mm.
    pub chord_m: f64,
    /// Inner diameter of the hose to each actuator, m; 0.5 mm to 20 mm. `None`: 3 mm, or less where the chamber is narrow.
    pub hose_m: Option<f64>,
}

impl Default for Settings {
    /// Kevlar thread of 772 N and 0.178 mm, walls from 1 mm, chords within 0.05 mm.
    fn default() -> Self {
        Self {
            thread: Thread { stiffness_n: 772.0, diameter_m: 0.178e-3 },
            spacing_m: None,
            tolerances: Tolerances::default(),
            wall_min_m: 1e-3,
            chord_m: 5e-5,
            hose_m: None,
        }
    }
}

impl Settings {
    /// Checks every field.
    ///
    /// # Errors
    /// [`OutOfRange`] with field, value and allowed range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        let between = |field, value: f64, [low, high]: [f64; 2]| {
            require((low..=high).contains(&value), field, value, format!("{low} to {high}"))
        };
        between("stiffness_n", self.thread.stiffness_n, [1e-3, 1e6])?;
        between("diameter_m", self.thread.diameter_m, [1e-5, 5e-3])?;
        if let Some(spacing_m) = self.spacing_m {
            between("spacing_m", spacing_m, [1e-5, 1.0])?;
        }
        between("wall_min_m", self.wall_min_m, [1e-4, 0.05])?;
        between("chord_m", self.chord_m, [1e-6, 1e-3])?;
        if let Some(hose_m) = self.hose_m {
            between("hose_m", hose_m, [5e-4, 0.02])?;
        }
        self.tolerances.check()
    }
}
