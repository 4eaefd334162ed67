//! Elastomers by trade name, and those of a file.

use crate::cli::desk::Desk;

#[test]
fn list_has_a_row_for_each_elastomer_and_one_has_its_readings() {
    let desk = Desk::new();
    let list = desk.softlimb("materials").done().out;
    assert_eq!(list.lines().count(), 16, "{list}");
    let rows = desk.softlimb("materials --json").done().json();
    assert_eq!(rows.as_array().unwrap().len(), 15);
    assert!(rows.as_array().unwrap().iter().all(|row| row["rms"].as_f64().unwrap() <= 0.05));
    let one = desk.softlimb("materials \"Ecoflex 00-30\" --svg ecoflex.svg").done().out;
    assert!(one.starts_with("[materials.ecoflex-00-30]\nlaw = \"yeoh\"\n"), "{one}");
    assert!(std::fs::read_to_string(desk.path("ecoflex.svg")).unwrap().contains("Ecoflex 00-30"));
    // The readings beyond the law's range are rings, as many as the table names.
    let table = desk.softlimb("materials \"Dragon Skin 30\" --svg dragon.svg").done().out;
    let picture = std::fs::read_to_string(desk.path("dragon.svg")).unwrap();
    let outside = table.lines().filter(|line| line.ends_with("outside the range")).count();
    // One more stands in the key.
    assert_eq!(picture.matches("ink rings").count(), outside + 1, "{table}");
    assert!(outside > 0 && picture.contains(">Yeoh law<"), "{table}");
    desk.softlimb("materials \"ecoflex 0030\"").failed(2, &["did you mean \"Ecoflex 00-30\"?"]);
}

#[test]
fn table_of_one_is_a_part_of_a_scene() {
    let desk = Desk::new();
    let one = desk.softlimb("materials \"Dragon Skin 30\"").done().out;
    let (table, _) = one.split_once("\n\n").unwrap();
    let scene = super::desk::SCENE.replace("[limb]", &format!("{table}\n\n[limb]"));
    desk.put("stated.toml", scene.replace("material = \"silicone\"", "material = \"dragon-skin-30\""));
    desk.put("named.toml", super::desk::SCENE.replace("material = \"silicone\"", "material = \"Dragon Skin 30\""));
    let pressure = |scene: &str| {
        let checked = desk.softlimb(&format!("check {scene} --json")).json();
        checked["modules"][0]["highest_pressure_pa"].as_f64().unwrap()
    };
    assert!((pressure("stated.toml") / pressure("named.toml") - 1.0).abs() < 1e-4);
}

#[test]
fn tests_of_a_lab_are_fitted_and_faults_are_named() {
    let desk = Desk::new();
    // A neo-Hookean wall of 60 kPa: a Yeoh law with two coefficients of 0.
    let stretches = (1..=20).map(|step| 1.0 + 0.1 * f64::from(step));
    let rows = |name: &str| {
        let row = |l: f64| format!("{name},{l},{}\n", 60.0 * (l - l.powi(-2)));
        stretches.clone().map(row).collect::<String>()
    };
    desk.put("tests.csv", format!("material,stretch,nominal_stress_kpa\n{}{}", rows("a"), rows("b")));
    let found = desk.softlimb("materials --file tests.csv --json").done().json();
    assert!((found[1]["c_pa"][0].as_f64().unwrap() / 30e3 - 1.0).abs() < 1e-9, "{found}");
    desk.put("short.csv", "strain,nominal_stress_kpa\n0.1,10\n0.2,19\n0.5,30\n");
    let short = desk.softlimb("materials --file short.csv");
    assert!(short.code == Some(3) && short.err.contains("no Yeoh law describes `short`"), "{short:?}");
    desk.put("bad.csv", "strain,nominal_stress_kpa\n0.1,10\n0.2,x\n");
    desk.softlimb("materials --file bad.csv").failed(1, &["bad.csv: line 3", "`x` is not allowed"]);
    desk.softlimb("materials --file none.csv").failed(1, &["none.csv"]);
}

#[test]
fn wall_that_stretches_beyond_its_test_is_a_warning_of_check() {
    let desk = Desk::with_scene("shear_modulus = \"0.223 MPa\"", "shear_modulus = \"0.223 MPa\"\nstretch_max = 1.01");
    let checked = desk.softlimb("check scene.toml");
    assert!(checked.code == Some(3) && checked.err.contains("`finger` stretches its wall to 1."), "{checked:?}");
    let desk = Desk::with_scene("shear_modulus = \"0.223 MPa\"", "shear_modulus = \"0.223 MPa\"\nstretch_max = 2");
    desk.softlimb("check scene.toml").done();
}
