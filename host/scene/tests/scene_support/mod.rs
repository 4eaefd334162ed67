//! A right scene for the tests to break.

use softlimb_scene::parse;

/// Two modules, two phases; line numbers count from `format`.
pub(crate) const SCENE: &str = r#"format = 1
name = "arm"
seed = 7

[materials.silicone]
law = "neo-hookean"
shear_modulus = "0.2 MPa"

[windings.hoop]
angle = "3 deg"
families = 2
modulus = "361 MPa"
thickness = "0.178 mm"

[limb]
connector = { length = "15 mm", mass = "300 g" }
[[module]]
name = "upper"
motion = "extension"
actuators = 3
circle_radius = "30 mm"
inner_radius = "10 mm"
outer_radius = "14 mm"
length = "240 mm"
material = "silicone"
winding = "hoop"

[[module]]
name = "elbow"
motion = "bending"
actuators = 3
circle_radius = "30 mm"
inner_radius = "10 mm"
outer_radius = "14 mm"
length = "240 mm"
material = "silicone"

[[phase]]
name = "reach"
duration = "3 s"
targets = { upper = { axial_stretch = 1.1 }, elbow = { bend_angle = "40 deg" } }

[[phase]]
name = "stretch"
duration = "2 s"
targets = { upper = { axial_stretch = 1.2 } }

[limits]
pressure_max = "100 kPa"
"#;

/// The scene with the first `from` replaced.
#[track_caller]
pub(crate) fn changed(from: &str, to: &str) -> String {
    assert!(SCENE.contains(from), "{from}");
    SCENE.replacen(from, to, 1)
}

/// The diagnostic of the scene with the first `from` replaced.
#[track_caller]
#[allow(dead_code, reason = "not every test file draws")]
pub(crate) fn picture(from: &str, to: &str) -> String {
    parse(&changed(from, to), "arm.toml").unwrap_err().render(false)
}

/// A scene with a sheet of one thickness in place of each thread.
pub(crate) fn with_sheets(text: &str) -> String {
    let sheet = "modulus = \"361 MPa\"\nthickness = \"0.178 mm\"";
    let lines = text.lines().map(|line| if line.starts_with("thread = ") { sheet } else { line });
    lines.flat_map(|line| [line, "\n"]).collect()
}
