//! Bounds of a design.

use fra_model::Motion;

use crate::source::Located;

/// A lower and an upper value in SI units; equal ones fix the value.
pub type Bounds = [f64; 2];

/// Bounds of `softlimb design`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Design {
    /// Bounds of a module that is added where the number of modules is chosen; `None` where `[design]` has none.
    pub common: ModuleBounds,
    /// Bounds of the scene's modules, in their order: their own, or else the common ones.
    pub modules: Vec<ModuleBounds>,
    /// Share of the pressure at the limit point that is kept free, 0.001 to 0.9.
    pub limit_margin: f64,
    /// Share of the highest pressure a device follows that is kept free; 0..=0.5.
    pub pressure_reserve: f64,
    /// Largest mass of the limb without what it carries, kg; `None` for any.
    pub mass_max_kg: Option<Located<f64>>,
    /// Largest distance of the plates of a module, m; > 0.
    pub bay_m: f64,
    /// Bounds of the angle by which the base may be turned from its direction towards its `up`, rad.
    pub base_pitch_rad: Option<Located<Bounds>>,
    /// The box that the base may be in: its index in [`Scene::regions`](super::Scene::regions).
    pub base_region: Option<Located<usize>>,
    /// Whether all modules have the same pressure.
    pub shared_supply_line: bool,
    /// Whether modules may be turned about the limb's axis.
    pub mount_angle_free: bool,
    /// Least and greatest number of modules, and the kinds to choose from, where kinds and order are chosen, too.
    pub choice: Option<Located<Choice>>,
}

/// Kinds and number of modules to choose from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Choice {
    /// Least number of modules, >= 1.
    pub modules_min: usize,
    /// Greatest number of modules, <= 9.
    pub modules_max: usize,
    /// The kinds, each once; at least one.
    pub motions: Vec<Motion>,
}

/// Bounds of one module; `None` keeps its own value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ModuleBounds {
    /// Inner radius at rest, m.
    pub inner_radius_m: Option<Located<Bounds>>,
    /// Thickness of the wall at rest, m.
    pub wall_m: Option<Located<Bounds>>,
    /// Length at rest, m.
    pub length_m: Option<Located<Bounds>>,
    /// Fiber angle from the hoop direction, rad.
    pub fiber_angle_rad: Option<Located<Bounds>>,
    /// Radius of the circle of its actuators, m.
    pub circle_radius_m: Option<Located<Bounds>>,
    /// Distance of neighbours in the row of its actuators, m.
    pub spacing_m: Option<Located<Bounds>>,
}

impl ModuleBounds {
    /// These bounds, and those of `other` where there are none.
    pub(crate) fn or(self, other: &Self) -> Self {
        Self {
            inner_radius_m: self.inner_radius_m.or(other.inner_radius_m),
            wall_m: self.wall_m.or(other.wall_m),
            length_m: self.length_m.or(other.length_m),
            fiber_angle_rad: self.fiber_angle_rad.or(other.fiber_angle_rad),
            circle_radius_m: self.circle_radius_m.or(other.circle_radius_m),
            spacing_m: self.spacing_m.or(other.spacing_m),
        }
    }
}
