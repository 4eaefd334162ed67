//! The model of a module's bend.

use std::fmt;

use fra_model::Motion;
use softlimb_scene::{Module, Scene, SceneError};

use crate::Limb;
use crate::limb::twists;

/// Model of a bending module with a stated winding, with the largest relative error that the analytic bend states over its pressures; `None` where it states none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bend {
    /// The analytic one.
    Analytic(Option<f64>),
    /// Finite elements of the section, because the analytic bend errs by more than is accepted.
    SectionFe(Option<f64>),
    /// Finite elements of the section, because the analytic bend takes one winding.
    TwoWindings,
}

impl Bend {
    /// Whether finite elements answer.
    pub fn is_by_section(self) -> bool {
        !matches!(self, Self::Analytic(_))
    }

    /// The name of the model, as `eval --batch` has it.
    pub fn model(self) -> &'static str {
        if self.is_by_section() { "section-fe" } else { "analytic" }
    }

    /// Largest relative error that the analytic bend states.
    pub fn analytic_error(self) -> Option<f64> {
        match self {
            Self::Analytic(error) | Self::SectionFe(error) => error,
            Self::TwoWindings => None,
        }
    }
}

impl fmt::Display for Bend {
    /// Behind "bends by".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |error: f64| 100.0 * error;
        match self {
            Self::Analytic(Some(error)) => {
                write!(f, "the analytic model, within {:.1} % of finite elements", percent(*error))
            }
            Self::Analytic(None) => {
                f.write_str("the analytic model, whose error is not known up to its highest pressure")
            }
            Self::SectionFe(Some(error)) => {
                write!(f, "finite elements: the analytic model errs by up to {:.1} %", percent(*error))
            }
            Self::SectionFe(None) => {
                f.write_str("finite elements: the error of the analytic model is not known up to its highest pressure")
            }
            Self::TwoWindings => f.write_str("finite elements: the analytic model takes one winding"),
        }
    }
}

/// Refuses a bender that twists as it bends, at its second winding, in a room that has bends in one plane.
pub(crate) fn out_of_plane(scene: &Scene, module: &Module, room: &str) -> SceneError {
    let span = module.second_fiber.as_ref().map_or(module.span, |second| second.span);
    let title = format!("`{}` twists as it bends, and {room} takes benders that do not", *module.name);
    scene.diagnostic(span, &title, "this winding has no mirror image", None)
}

impl Limb {
    /// Refuses a limb with a bender that twists as it bends, for a room that has bends in one plane.
    ///
    /// # Errors
    /// A diagnostic at the second winding.
    pub fn require_plane_benders(&self, scene: &Scene, room: &str) -> Result<(), SceneError> {
        let described = scene.modules().iter().flat_map(Module::parts);
        let mut benders = described.zip(self.parts()).filter(|(_, built)| built.motion == Motion::Bending);
        match benders.find(|(_, built)| twists(&built.curve)) {
            Some((module, _)) => Err(out_of_plane(scene, &module, room)),
            None => Ok(()),
        }
    }

    /// The warnings about windings that the model of a module or segment ignores, from the base to the tip.
    pub fn winding_warnings(&self, scene: &Scene) -> Vec<String> {
        let described = scene.modules().iter().flat_map(Module::parts);
        let ignoring = self.parts().zip(described).filter(|(part, _)| !part.is_by_section());
        ignoring.filter_map(|(_, described)| scene.winding_warning(&described)).collect()
    }
}
