//! The workspace: fast kinematics against the model, extents against other ways to find them, samples, cubes.

mod bundle;
mod extents;
mod loaded;
mod samples;
mod series;
mod steering;

use softlimb_limb::Limb;
use softlimb_scene as scene;
use softlimb_scene::Scene;

/// A scene of the repository.
pub(crate) fn limb_of(name: &str) -> (Scene, Limb) {
    let scene = scene::load(format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))).expect("a scene");
    let limb = Limb::new(&scene).expect("a limb");
    (scene, limb)
}

/// A scene with modules as `motion, actuators, more keys`.
pub(crate) fn limb_with(modules: &[(&str, u8, &str)]) -> Limb {
    let scene = scene::parse(&text_with(modules), "test.toml").unwrap_or_else(|error| panic!("{error}"));
    Limb::new(&scene).expect("a limb")
}

/// Its text.
pub(crate) fn text_with(modules: &[(&str, u8, &str)]) -> String {
    let mut text = String::from(
        "format = 1\nname = \"test\"\n[materials.silicone]\nlaw = \"neo-hookean\"\nshear_modulus = \"0.223 MPa\"\n\
         [windings.hoops]\nangle = \"3 deg\"\nfamilies = 2\nmodulus = \"361 MPa\"\nthickness = \"0.178 mm\"\n\
         [windings.helix]\nangle = \"28 deg\"\nfamilies = 1\nmodulus = \"361 MPa\"\nthickness = \"0.178 mm\"\n\
         [limb]\nbase_direction = [0, 0, 1]\nbase_up = [1, 0, 0]\nconnector = { length = \"0 mm\", mass = \"0 g\" }\n",
    );
    for (index, (motion, actuators, more)) in modules.iter().enumerate() {
        let winding = match *motion {
            "bending" => "",
            "twisting" => "winding = \"helix\"\n",
            _ => "winding = \"hoops\"\n",
        };
        // Bending actuators in a row, others on a circle; both reach 30 mm.
        let places = match (*motion, *actuators) {
            (_, 1) => String::new(),
            ("bending", count) => format!("arrangement = \"row\"\nspacing = \"{} mm\"", 60.0 / f64::from(count - 1)),
            _ => "circle_radius = \"30 mm\"".to_owned(),
        };
        text += &format!(
            "[[module]]\nname = \"m{index}\"\nmotion = \"{motion}\"\nactuators = {actuators}\n{places}\n\
             inner_radius = \"10 mm\"\nouter_radius = \"14 mm\"\nlength = \"240 mm\"\nmaterial = \"silicone\"\n{winding}{more}\n",
        );
    }
    text + "[[phase]]\nname = \"p\"\nduration = \"5 s\"\ntargets = { m0 = { pressure = \"10 kPa\" } }\n[limits]\npressure_max = \"100 kPa\"\n"
}

/// Numbers of 0 to 1.
pub(crate) struct Stream(pub(crate) u64);

impl Stream {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}
