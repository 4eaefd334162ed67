//! Scenes of actuators with hoops, as text.

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
[windings.double]
angle = "10 deg"
families = 2
modulus = "722 MPa"
thickness = "0.178 mm"
[windings.helix]
angle = "28 deg"
families = 1
modulus = "361 MPa"
thickness = "0.178 mm"
[windings.mirrored]
angle = "-28 deg"
families = 1
modulus = "361 MPa"
thickness = "0.178 mm"
[windings.soft]
angle = "20 deg"
families = 2
modulus = "4 MPa"
thickness = "0.178 mm"
[windings.weak]
angle = "30 deg"
families = 2
modulus = "0.2 MPa"
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

/// A limb of modules as `motion, one or two windings, actuators, more keys`; one actuator lies on the axis, several reach 30 mm off it: bending ones in a row.
pub(crate) fn text_of(modules: &[(&str, &str, u8, &str)]) -> String {
    let mut text = HEAD.to_owned();
    for (index, (motion, winding, actuators, more)) in modules.iter().enumerate() {
        let winding = match winding.split_once(' ') {
            None if winding.is_empty() => String::new(),
            None => format!("winding = \"{winding}\"\n"),
            Some((first, second)) => format!("winding = [\"{first}\", \"{second}\"]\n"),
        };
        let material = if more.contains("material") { "" } else { "material = \"silicone\"\n" };
        // Bending actuators in a row, others on a circle; both reach 30 mm.
        let places = match (*motion, *actuators) {
            (_, 1) => String::new(),
            ("bending", count) => format!("arrangement = \"row\"\nspacing = \"{} mm\"", 60.0 / f64::from(count - 1)),
            _ => "circle_radius = \"30 mm\"".to_owned(),
        };
        text += &format!(
            "[[module]]\nname = \"m{index}\"\nmotion = \"{motion}\"\nactuators = {actuators}\n{places}\n\
             inner_radius = \"10 mm\"\nouter_radius = \"14 mm\"\nlength = \"240 mm\"\n{material}{winding}{more}\n",
        );
    }
    text
}
