//! Windings whose angle the analytic bender ignores.

use fra_model::{Families, Motion, Placement};

use super::{Module, Scene};

/// Angle from the hoop up to which the analytic bender takes each winding as a hoop, deg.
const HOOP_LIKE_DEG: f64 = 5.0;
/// Rounding of an angle that the scene gives in a unit of its own, deg.
const ROUNDING_DEG: f64 = 1e-9;

impl Scene {
    /// The warning about a bending module whose winding is more than 5 deg from the hoop and not two families in a sheet with a modulus, whose
    /// angle the model heeds; `None` for all others.
    pub fn winding_warning(&self, module: &Module) -> Option<String> {
        let fiber = module.fiber.filter(|_| *module.motion == Motion::Bending)?;
        let angle_deg = fiber.angle_rad.to_degrees().abs();
        let is_heeded =
            fiber.families == Families::Two && fiber.placement == Placement::Sheet && fiber.modulus_pa > 0.0;
        if is_heeded || angle_deg <= HOOP_LIKE_DEG + ROUNDING_DEG {
            return None;
        }
        let (file, (line, _), name) = (self.source_name(), self.position(fiber.span), &*module.name);
        Some(format!(
            "{file}:{line}: the analytic bender ignores the winding angle of `{name}`, {angle_deg:.1} deg from the hoop: two equal \
             families in a sheet are the one winding whose angle it heeds, and at 20 deg it halves the bend"
        ))
    }

    /// The warnings about all modules, from the base to the tip.
    pub fn winding_warnings(&self) -> Vec<String> {
        self.modules().iter().filter_map(|module| self.winding_warning(module)).collect()
    }
}
