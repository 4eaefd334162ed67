//! A scene with the parameters that a calibration found: the author's text with other values, and what is read from it.

use std::sync::LazyLock;

use fra_model::{ActuatorParameters, Material};
use softlimb_scene as scene;
use softlimb_scene::{RewriteError, Scene, rewritten};

use crate::scene_support::with_sheets;

/// With sheets in place of threads.
static SCENE: LazyLock<String> = LazyLock::new(|| with_sheets(include_str!("../../../scenes/weightless-b.toml")));

fn read(text: &str) -> Scene {
    scene::parse(text, "refitted.toml").unwrap_or_else(|error| panic!("{}\n{text}", error.render(false)))
}

fn unchanged(scene: &Scene) -> Vec<ActuatorParameters<f64>> {
    scene.modules().iter().map(|module| module.actuator()).collect()
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
    wanted.iter_mut().for_each(|actuator| actuator.length_m *= 1.0625);
    let (written, log) = rewritten(&scene, &wanted).unwrap();
    assert_eq!(log.len(), 3, "{log:?}");
    let lengths = |text: &str| text.lines().filter(|line| line.starts_with("length = ")).count();
    let others = |text: &str| text.lines().filter(|line| !line.starts_with("length = ")).collect::<Vec<_>>().join("\n");
    assert_eq!((lengths(&written), others(&written)), (lengths(&text), others(&text)));
    for (module, wanted) in read(&written).modules().iter().zip(&wanted) {
        assert!((*module.length_m / wanted.length_m - 1.0).abs() < 1e-9);
    }
}

#[test]
fn another_law_takes_the_place_of_the_one_before() {
    let scene = read(&SCENE);
    let mut wanted = unchanged(&scene);
    let material = match wanted[0].material {
        Material::NeoHookean { .. } => Material::Yeoh { c_pa: [8e4, 1.25e4, -50.0] },
        Material::Yeoh { .. } => Material::NeoHookean { shear_modulus_pa: 1.75e5 },
    };
    let first = scene.part_name(0, "material").unwrap();
    let users: Vec<usize> =
        (0..wanted.len()).filter(|index| scene.part_name(*index, "material").as_ref() == Some(&first)).collect();
    users.iter().for_each(|user| wanted[*user].material = material);
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

#[test]
fn module_of_its_own_gets_a_copy_of_the_part_it_shared() {
    let scene = read(&SCENE);
    let mut wanted = unchanged(&scene);
    let material = Material::NeoHookean { shear_modulus_pa: 2.125e5 };
    wanted[1].material = material;
    let fiber = wanted[0].fiber.as_mut().unwrap();
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
    let outer_m = wanted[user].outer_radius_m + 0.5e-3;
    wanted[user].outer_radius_m = outer_m;
    wanted[user].material = Material::NeoHookean { shear_modulus_pa: 2.5e5 };
    if let Some(fiber) = &mut wanted[user].fiber {
        fiber.radius_m = outer_m;
    }
    let (written, log) = rewritten(&scene, &wanted).unwrap();
    let again = read(&written).modules()[user].clone();
    assert_eq!(again.thread, scene.modules()[user].thread, "{written}");
    let [kept, asked] = [again.fiber.unwrap().modulus_pa, wanted[user].fiber.unwrap().modulus_pa];
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
    wanted[0].material = Material::Yeoh { c_pa: [1e5, 2e3, 0.0] };
    wanted[0].length_m = 0.125;
    let (written, _) = rewritten(&scene, &wanted).unwrap();
    let expected = text
        .replace(
            "\"neo-hookean\", shear_modulus = \"0.24 MPa\"",
            "\"yeoh\", c = [\"0.1 MPa\", \"0.002 MPa\", \"0 MPa\"]",
        )
        .replace("100 mm", "125 mm");
    assert_eq!(written, expected);
}
