//! Scenes of one actuator.

use softlimb_limb::fabricate::{FabricateError, Piece, Settings, Thread, plan};
use softlimb_scene::{Scene, parse};

/// A straight actuator and its winding.
#[derive(Clone, Copy)]
pub(crate) struct Tube {
    pub(crate) motion: &'static str,
    pub(crate) inner_mm: f64,
    pub(crate) outer_mm: f64,
    pub(crate) length_mm: f64,
    pub(crate) angle_deg: f64,
    pub(crate) families: u8,
    pub(crate) winding_mm: f64,
}

pub(crate) const TUBE: Tube = Tube {
    motion: "extension",
    inner_mm: 10.0,
    outer_mm: 14.0,
    length_mm: 60.0,
    angle_deg: 20.0,
    families: 2,
    winding_mm: 13.0,
};

impl Tube {
    pub(crate) fn text(&self) -> String {
        let Self { motion, inner_mm, outer_mm, length_mm, angle_deg, families, winding_mm } = self;
        let goal = match *motion {
            "twisting" => "{ tube = { twist = 0.0 } }",
            "expansion" => "{ tube = { pressure = \"1 kPa\" } }",
            _ => "{ tube = { axial_stretch = 1.0 } }",
        };
        format!(
            "format = 1\nname = \"tube\"\n[materials.rubber]\nlaw = \"neo-hookean\"\nshear_modulus = \"0.2 MPa\"\n\
             [windings.thread]\nangle = \"{angle_deg} deg\"\nfamilies = {families}\nmodulus = \"300 MPa\"\n\
             thickness = \"0.2 mm\"\nradius = \"{winding_mm} mm\"\n\
             [limb]\nconnector = {{ length = \"15 mm\", mass = \"50 g\" }}\n\
             [[module]]\nname = \"tube\"\nmotion = \"{motion}\"\nactuators = 1\ninner_radius = \"{inner_mm} mm\"\n\
             outer_radius = \"{outer_mm} mm\"\nlength = \"{length_mm} mm\"\nmaterial = \"rubber\"\nwinding = \"thread\"\n\
             [[phase]]\nname = \"rest\"\nduration = \"1 s\"\ntargets = {goal}\n"
        )
    }

    pub(crate) fn scene(&self) -> Scene {
        let text = self.text();
        parse(&text, "tube.toml").unwrap_or_else(|error| panic!("{}", error.render(false)))
    }

    /// How it is made with a thread of a diameter, mm, at a distance, mm.
    pub(crate) fn piece(&self, diameter_mm: f64, spacing_mm: f64) -> Result<Piece, FabricateError> {
        let mut pieces = plan(&self.scene(), &settings(diameter_mm, spacing_mm))?;
        Ok(pieces.remove(0))
    }
}

pub(crate) fn settings(diameter_mm: f64, spacing_mm: f64) -> Settings {
    Settings {
        thread: Thread { stiffness_n: 772.0, diameter_m: diameter_mm * 1e-3 },
        spacing_m: Some(spacing_mm * 1e-3),
        ..Settings::default()
    }
}

/// The text of a failure.
pub(crate) fn words(error: &FabricateError) -> String {
    match error {
        FabricateError::Scene(error) => error.render(false),
        FabricateError::Invalid(error) => error.to_string(),
    }
}
