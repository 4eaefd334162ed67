//! A scene with the parameters that a calibration found: the author's text with other values, and what is read from it.

use std::sync::LazyLock;

use fra_model::Material;
use softlimb_scene as scene;
use softlimb_scene::{RewriteError, Scene, WoundActuator, recast, rewritten};

use crate::scene_support::with_sheets;

/// With sheets in place of threads.
static SCENE: LazyLock<String> = LazyLock::new(|| with_sheets(include_str!("../../../scenes/weightless-b.toml")));

fn read(text: &str) -> Scene {
    scene::parse(text, "refitted.toml").unwrap_or_else(|error| panic!("{}\n{text}", error.render(false)))
}

fn unchanged(scene: &Scene) -> Vec<WoundActuator> {
    scene.modules().iter().map(softlimb_scene::Module::wound_actuator).collect()
}

/// The text after a replacement that finds something.
fn with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "no {from}");
    text.replace(from, to)
}

#[test]
fn same_parameters_leave_the_text_as_it_was() {
    let scene = read(&SCENE);
    assert_eq!(rewritten(&scene, &unchanged(&scene)).unwrap(), (SCENE.clone(), Vec::new()));
    let error = rewritten(&scene, &unchanged(&scene)[1..]).unwrap_err();
    assert_eq!(error, RewriteError::Modules { found: 2, modules: 3 });
}

#[test]
fn number_changes_and_the_line_around_it_does_not() {
    let text = with(&SCENE, "outer_radius = ", "# measured twice\nouter_radius   = ");
    let scene = read(&text);
    let mut wanted = unchanged(&scene);
    wanted.iter_mut().for_each(|(actuator, _)| actuator.length_m *= 1.0625);
    let (written, log) = rewritten(&scene, &wanted).unwrap();
    assert_eq!(log.len(), 3, "{log:?}");
    let lengths = |text: &str| text.lines().filter(|line| line.starts_with("length = ")).count();
    let others = |text: &str| text.lines().filter(|line| !line.starts_with("length = ")).collect::<Vec<_>>().join("\n");
    assert_eq!((lengths(&written), others(&written)), (lengths(&text), others(&text)));
    for (module, wanted) in read(&written).modules().iter().zip(&wanted) {
        assert!((*module.length_m / wanted.0.length_m - 1.0).abs() < 1e-9);
    }
}

#[test]
fn another_law_takes_the_place_of_the_one_before() {
    let scene = read(&SCENE);
    let mut wanted = unchanged(&scene);
    let material = match wanted[0].0.material {
        Material::NeoHookean { .. } => Material::Yeoh { c_pa: [8e4, 1.25e4, -50.0] },
        Material::Yeoh { .. } => Material::NeoHookean { shear_modulus_pa: 1.75e5 },
    };
    let first = scene.part_name(0, "material").unwrap();
    let users: Vec<usize> =
        (0..wanted.len()).filter(|index| scene.part_name(*index, "material").as_ref() == Some(&first)).collect();
    users.iter().for_each(|user| wanted[*user].0.material = material);
    let (written, log) = rewritten(&scene, &wanted).unwrap();
    assert_eq!(log.len(), 2, "{log:?}");
    let again = read(&written);
    assert!(users.iter().all(|user| again.modules()[*user].material.value == material), "{written}");
    // Law and coefficients are where they were, with what is said of them.
    let comments =
        |text: &str| text.lines().filter_map(|line| Some(line.split_once('#')?.1.to_owned())).collect::<Vec<_>>();
    assert_eq!(comments(&written), comments(&SCENE));
    assert_eq!(written.lines().count(), SCENE.lines().count());
}

/// A tensile test does not measure the winding: the sheet of a thread follows from the new material.
#[test]
fn sheets_of_threads_follow_another_material() {
    let text = include_str!("../../../scenes/pick-and-place-a.toml");
    let scene = read(text);
    let material = Material::NeoHookean { shear_modulus_pa: 0.2e6 };
    let (written, log) = recast(&scene, &vec![material; scene.modules().len()]).unwrap();
    assert_eq!(log.len(), 1, "{log:?}");
    let by_hand = read(&with(text, "\"0.305 MPa\"", "\"0.2 MPa\""));
    for ((new, by_hand), before) in read(&written).modules().iter().zip(by_hand.modules()).zip(scene.modules()) {
        assert_eq!(new.wound_actuator(), by_hand.wound_actuator());
        let sheet_pa = |(actuator, _): WoundActuator| actuator.fiber.map_or(0.0, |fiber| fiber.modulus_pa);
        let [softer, stiffer] = [new, before].map(|module| sheet_pa(module.wound_actuator()));
        // A bender's hoops are taken as inextensible.
        assert!(softer < stiffer || stiffer == 0.0, "{softer} of {stiffer}");
    }
}

#[test]
fn module_of_its_own_gets_a_copy_of_the_part_it_shared() {
    let scene = read(&SCENE);
    let mut wanted = unchanged(&scene);
    let material = Material::NeoHookean { shear_modulus_pa: 2.125e5 };
    wanted[1].0.material = material;
    let fiber = wanted[0].0.fiber.as_mut().unwrap();
    fiber.angle_rad = 0.25;
    let (written, log) = rewritten(&scene, &wanted).unwrap();
    let again = read(&written);
    for (index, module) in again.modules().iter().enumerate() {
        let new = if index == 1 { material } else { scene.modules()[index].material.value };
        assert_eq!(module.material.value, new, "{written}");
        assert_eq!(module.density_kg_per_m3, scene.modules()[index].density_kg_per_m3);
    }
    assert!((again.modules()[0].fiber.unwrap().angle_rad - 0.25).abs() < 1e-9);
    let fiber = |scene: &Scene| scene.modules()[2].fiber.map(|fiber| fiber.value);
    assert_eq!(fiber(&again), fiber(&scene));
    assert_eq!(again.part_name(1, "material").unwrap(), format!("{}-fit", *scene.modules()[1].name), "{log:?}");
}

#[test]
fn thread_stays_beside_its_sheet_where_something_changes() {
    let sheet = "modulus = \"361 MPa\"";
    let at = SCENE.find(sheet).unwrap();
    let end = at + SCENE[at..].find("mm\"").unwrap() + 3;
    let thread = "thread = { stiffness = \"772 N\", diameter = \"0.178 mm\" }";
    let text = format!("{}{thread}{}", &SCENE[..at], &SCENE[end..]);
    let scene = read(&text);
    let user = scene.modules().iter().position(|module| module.thread.is_some()).unwrap();
    assert_eq!(rewritten(&scene, &unchanged(&scene)).unwrap().0, text);
    let mut wanted = unchanged(&scene);
    let outer_m = wanted[user].0.outer_radius_m + 0.5e-3;
    wanted[user].0.outer_radius_m = outer_m;
    wanted[user].0.material = Material::NeoHookean { shear_modulus_pa: 2.5e5 };
    if let Some(fiber) = &mut wanted[user].0.fiber {
        fiber.radius_m = outer_m;
    }
    let (written, log) = rewritten(&scene, &wanted).unwrap();
    let again = read(&written).modules()[user].clone();
    assert_eq!(again.thread, scene.modules()[user].thread, "{written}");
    let [kept, asked] = [again.fiber.unwrap().modulus_pa, wanted[user].0.fiber.unwrap().modulus_pa];
    assert!((kept / asked - 1.0).abs() < 1e-8, "{written}");
    assert!(log.iter().any(|line| line.contains("the sheet of its thread")), "{log:?}");
}

#[test]
fn parts_and_modules_on_one_line_take_new_values() {
    let text = r#"format = 1
name = "line"
materials.soft = { law = "neo-hookean", shear_modulus = "0.24 MPa" }  # cast in spring
limb.connector = { length = "15 mm", mass = "50 g" }
module = [
  # the only one
  { name = "finger", motion = "bending", actuators = 1, inner_radius = "6 mm", outer_radius = "8 mm", length = "100 mm", material = "soft" },
]
phase = [{ name = "out", duration = "1 s", hold = "1 s", targets = { finger = { bend_angle = "20 deg" } } }]
limits.pressure_max = "150 kPa"
"#;
    let scene = read(text);
    let mut wanted = unchanged(&scene);
    wanted[0].0.material = Material::Yeoh { c_pa: [1e5, 2e3, 0.0] };
    wanted[0].0.length_m = 0.125;
    let (written, _) = rewritten(&scene, &wanted).unwrap();
    let expected = text
        .replace(
            "\"neo-hookean\", shear_modulus = \"0.24 MPa\"",
            "\"yeoh\", c = [\"0.1 MPa\", \"0.002 MPa\", \"0 MPa\"]",
        )
        .replace("100 mm", "125 mm");
    assert_eq!(written, expected);
}

/// Both windings of an array are written under their own names; a module that differs names a copy at its place.
#[test]
fn two_windings_take_new_values_at_their_places() {
    let windings = "\
        [windings.helix]\nangle = \"30 deg\"   # wound by hand\nfamilies = 1\nmodulus = \"200 MPa\"\nthickness = \"0.1 mm\"\n\
        [windings.axial]\nangle = \"80 deg\"\nfamilies = 1\nthread = { stiffness = \"10 N\", diameter = \"0.1 mm\" }\n";
    let module = |name: &str| {
        format!(
            "[[module]]\nname = \"{name}\"\nmotion = \"twisting\"\nactuators = 1\ninner_radius = \"6 mm\"\nouter_radius = \"8 mm\"\n\
             length = \"100 mm\"\nmaterial = \"silicone\"\nwinding = [\"helix\", \"axial\"]\npressure_max = \"50 kPa\"\n"
        )
    };
    let text = format!(
        "format = 1\nname = \"rods\"\nmaterials.silicone = {{ law = \"neo-hookean\", shear_modulus = \"0.2 MPa\" }}\n\
         limb.connector = {{ length = 0, mass = 0 }}\n{windings}{}{}[[phase]]\nname = \"twist\"\nduration = 1\nhold = 1\n\
         targets = {{ a = {{ twist = -0.1 }} }}\n",
        module("a"),
        module("b")
    );
    let scene = read(&text);
    assert_eq!(rewritten(&scene, &unchanged(&scene)).unwrap().0, text);
    assert_eq!(
        [scene.part_name(1, "winding"), scene.second_winding_name(1)],
        ["helix", "axial"].map(|name| Some(name.into()))
    );
    let mut wanted = unchanged(&scene);
    wanted.iter_mut().for_each(|(actuator, _)| actuator.fiber.as_mut().unwrap().angle_rad = 0.5);
    wanted[1].1.as_mut().unwrap().angle_rad = 1.5;
    let (written, log) = rewritten(&scene, &wanted).unwrap();
    let again = read(&written);
    for (module, (actuator, second)) in again.modules().iter().zip(&wanted) {
        let (first, own) = (module.fiber.unwrap(), module.second_fiber.unwrap());
        assert!((first.angle_rad / actuator.fiber.unwrap().angle_rad - 1.0).abs() < 1e-8, "{written}");
        assert!((own.angle_rad / second.unwrap().angle_rad - 1.0).abs() < 1e-8, "{written}");
        // The sheet of the thread stays as it was.
        assert!((own.modulus_pa / second.unwrap().modulus_pa - 1.0).abs() < 1e-8, "{written}");
    }
    assert!(written.contains("# wound by hand") && written.contains("winding = [\"helix\", \"axial\"]"), "{written}");
    assert_eq!(log.iter().filter(|line| line.contains("the sheet of its thread")).count(), 2, "{log:?}");
}
