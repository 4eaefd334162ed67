//! Elastomers by trade name.

use fra_model::Material;
use softlimb_scene::{CASTABLE_ELASTOMERS, castable_elastomer, parse, rewritten};

use crate::scene_support::{changed, picture};

/// The scene with its upper module of a castable elastomer.
fn cast() -> String {
    changed("material = \"silicone\"", "material = \"Dragon Skin 30\"")
}

#[test]
fn trade_name_is_the_law_of_the_library() {
    let scene = parse(&cast(), "arm.toml").unwrap();
    let known = castable_elastomer("Dragon Skin 30").unwrap();
    let (upper, elbow) = (&scene.modules()[0], &scene.modules()[1]);
    assert_eq!(*upper.material, Material::Yeoh { c_pa: known.c_pa });
    assert_eq!((upper.stretch_max, upper.density_kg_per_m3), (Some(known.stretch[1]), 1080.0));
    assert_eq!((*elbow.material, elbow.stretch_max), (Material::NeoHookean { shear_modulus_pa: 2e5 }, None));
}

#[test]
fn scene_of_castable_elastomers_alone_needs_no_materials() {
    let materials = "[materials.silicone]\nlaw = \"neo-hookean\"\nshear_modulus = \"0.2 MPa\"\n";
    let text = changed(materials, "").replace("\"silicone\"", "\"Ecoflex 00-30\"");
    let scene = parse(&text, "arm.toml").unwrap();
    assert!(scene.modules().iter().all(|module| module.stretch_max == Some(3.0)));
}

#[test]
fn stretch_of_the_test_may_be_stated() {
    let text = changed("shear_modulus = \"0.2 MPa\"", "shear_modulus = \"0.2 MPa\"\nstretch_max = 1.5");
    assert_eq!(parse(&text, "arm.toml").unwrap().modules()[0].stretch_max, Some(1.5));
}

#[test]
fn unknown_trade_name_is_refused_at_its_line() {
    assert_eq!(
        picture("material = \"silicone\"", "material = \"Dragon Skin 31\""),
        r#"error: unknown elastomer `Dragon Skin 31`
  --> arm.toml:25:12
   |
25 | material = "Dragon Skin 31"
   |            ^^^^^^^^^^^^^^^^ no such material
   |
   = help: did you mean "Dragon Skin 30"?"#
    );
}

#[test]
fn fitted_law_of_a_castable_elastomer_is_written_under_a_name_of_the_scene() {
    let scene = parse(&cast(), "arm.toml").unwrap();
    let mut wanted: Vec<_> = scene.modules().iter().map(|module| module.wound_actuator()).collect();
    wanted[0].0.material = Material::Yeoh { c_pa: [7e4, 6e3, -1e2] };
    let (text, log) = rewritten(&scene, &wanted).unwrap();
    assert!(text.contains("[materials.dragon-skin-30]") && text.contains("material = \"dragon-skin-30\""), "{text}");
    assert!(log.iter().any(|line| line == "module `upper`: material = \"dragon-skin-30\""), "{log:?}");
    let again = parse(&text, "arm.toml").unwrap();
    // The stretch of the test belongs to the law before.
    assert_eq!((*again.modules()[0].material, again.modules()[0].stretch_max), (wanted[0].0.material, None));
    assert_eq!(*again.modules()[1].material, *scene.modules()[1].material);
}

#[test]
fn names_are_told_apart_and_near_ones_are_suggested() {
    for elastomer in &CASTABLE_ELASTOMERS {
        assert_eq!(castable_elastomer(elastomer.name), Ok(elastomer));
    }
    assert_eq!(castable_elastomer("ecoflex 0030").unwrap_err(), "did you mean \"Ecoflex 00-30\"?");
    assert!(castable_elastomer("latex").unwrap_err().contains("softlimb materials"));
}
