//! Fabrication tolerances: derivatives against closed forms, samples against derivatives, and what is refused.

#[path = "tolerance/closed_forms.rs"]
mod closed_forms;
#[path = "tolerance/command.rs"]
mod command;
#[path = "tolerance/samples.rs"]
mod samples;

use softlimb::design::Limb;
use softlimb::fabricate::Tolerances;
use softlimb::scene;
use softlimb::tolerance::{Pose, Settings};

/// Elastomer and windings of all scenes here; the hoops are as good as rigid.
const HEAD: &str = r#"
format = 1
name = "test"
[materials.silicone]
law = "neo-hookean"
shear_modulus = "0.2 MPa"
[materials.other]
law = "neo-hookean"
shear_modulus = "0.25 MPa"
[windings.hoops]
angle = "0 deg"
families = 2
modulus = "1e6 MPa"
thickness = "0.178 mm"
[windings.slant]
angle = "10 deg"
families = 2
modulus = "361 MPa"
thickness = "0.178 mm"
[windings.helix]
angle = "28 deg"
families = 1
modulus = "361 MPa"
thickness = "0.178 mm"
[windings.lines]
angle = "90 deg"
families = 2
modulus = "361 MPa"
thickness = "0.178 mm"
[limb]
base_direction = [0, 0, 1]
base_up = [1, 0, 0]
connector = { length = "20 mm", mass = "0 g" }
[[phase]]
name = "only"
duration = "5 s"
targets = { m0 = { pressure = "1 kPa" } }
[limits]
pressure_max = "150 kPa"
"#;

/// A limb of modules as `motion, winding, actuators, more keys`; one actuator lies on the axis, several 30 mm off it.
pub(crate) fn text_of(modules: &[(&str, &str, u8, &str)]) -> String {
    let mut text = HEAD.to_owned();
    for (index, (motion, winding, actuators, more)) in modules.iter().enumerate() {
        let winding = if winding.is_empty() { String::new() } else { format!("winding = \"{winding}\"\n") };
        let material = if more.contains("material") { "" } else { "material = \"silicone\"\n" };
        text += &format!(
            "[[module]]\nname = \"m{index}\"\nmotion = \"{motion}\"\nactuators = {actuators}\ncircle_radius = \"{} mm\"\n\
             inner_radius = \"10 mm\"\nouter_radius = \"14 mm\"\nlength = \"240 mm\"\n{material}{winding}{more}\n",
            if *actuators > 1 { 30 } else { 0 },
        );
    }
    text
}

pub(crate) fn limb_of(modules: &[(&str, &str, u8, &str)]) -> Limb {
    let scene = scene::parse(&text_of(modules), "test.toml").unwrap_or_else(|error| panic!("{error}"));
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
