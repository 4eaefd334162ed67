//! Windings whose angle the analytic bender ignores.

use fra_model::Motion;

use super::{Module, Scene};
use crate::SceneError;

/// Largest angle from the hoop without a warning, deg.
const HOOP_LIKE_DEG: f64 = 5.0;
/// Rounding of an angle that the scene gives in a unit of its own, deg.
const ROUNDING_DEG: f64 = 1e-9;

impl Scene {
    /// Refuses a module of segments in series, for a room that takes actuators of one winding along their length.
    ///
    /// # Errors
    /// [`SceneError`] at the second segment.
    pub fn require_no_segments(&self, room: &str) -> Result<(), SceneError> {
        let series = self.modules().iter().find_map(|module| Some((module, module.segments.get(1)?)));
        let Some((module, second)) = series else { return Ok(()) };
        let title = format!("`{}` has several segments, and {room} takes modules of one", &*module.name);
        let help = "`check`, `run`, `statics`, `workspace`, `design limb` and `fabricate` take segments";
        Err(self.diagnostic(second.span, &title, "the second segment", Some(help)))
    }

    /// The warning about a bending module whose winding is more than 5 deg from the hoop although the model takes it as a hoop; `None` for
    /// all others.
    pub fn winding_warning(&self, module: &Module) -> Option<String> {
        if !module.segments.is_empty() {
            return module.segment_modules().iter().find_map(|segment| self.winding_warning(segment));
        }
        let one_winding = module.second_fiber.is_none();
        let fiber = module.fiber.filter(|_| one_winding && *module.motion == Motion::Bending)?;
        let angle_deg = fiber.angle_rad.to_degrees().abs();
        if fiber.shrinks_bends() || angle_deg <= HOOP_LIKE_DEG + ROUNDING_DEG {
            return None;
        }
        let (file, (line, _), name) = (self.source_name(), self.position(fiber.span), &*module.name);
        Some(format!(
            "{file}:{line}: the analytic bender ignores the winding angle of `{name}`, {angle_deg:.1} deg from the hoop: it \
             follows that of two equal families in a sheet only, which at 20 deg halves the bend"
        ))
    }

    /// The warnings about all modules, from the base to the tip.
    pub fn winding_warnings(&self) -> Vec<String> {
        self.modules().iter().filter_map(|module| self.winding_warning(module)).collect()
    }
}
