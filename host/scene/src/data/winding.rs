//! Windings whose angle the analytic bender ignores.

use fra_model::Motion;

use super::{Module, Scene};

/// Largest angle from the hoop without a warning, deg.
const HOOP_LIKE_DEG: f64 = 5.0;
/// Rounding of an angle that the scene gives in a unit of its own, deg.
const ROUNDING_DEG: f64 = 1e-9;

impl Scene {
    /// The warning about a bending module whose winding is more than 5 deg from the hoop although the model takes it as a hoop; `None` for
    /// all others.
    pub fn winding_warning(&self, module: &Module) -> Option<String> {
        let fiber = module.fiber.filter(|_| *module.motion == Motion::Bending)?;
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
