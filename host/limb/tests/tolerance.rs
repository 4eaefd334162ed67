//! Fabrication tolerances: derivatives against closed forms, samples against derivatives, and what is refused.

mod closed_forms;
mod samples;
mod steering;
mod text;
mod wound;

use softlimb_limb::Limb;
use softlimb_limb::fabricate::Tolerances;
use softlimb_limb::tolerance::{Pose, Settings};
use softlimb_scene as scene;

pub(crate) fn limb_of(modules: &[(&str, &str, u8, &str)]) -> Limb {
    let scene = scene::parse(&text::text_of(modules), "test.toml").unwrap_or_else(|error| panic!("{error}"));
    Limb::new(&scene).expect("a limb")
}

/// Each actuator its own.
pub(crate) fn settings(wall_mm: f64, angle_deg: f64, modulus_percent: f64) -> Settings {
    let tolerances =
        Tolerances { wall_m: wall_mm * 1e-3, angle_rad: angle_deg.to_radians(), modulus: modulus_percent * 1e-2 };
    Settings { tolerances, shared_modulus: false }
}

/// One pose at pressures in kPa.
pub(crate) fn pose(pressures_kpa: &[f64]) -> Vec<Pose> {
    vec![Pose { name: "pose".into(), pressures_pa: pressures_kpa.iter().map(|kpa| kpa * 1e3).collect() }]
}
