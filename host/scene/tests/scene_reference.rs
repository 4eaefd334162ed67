//! `docs/reference/scene.md` and `study.md` are what the schema says. To write them anew: `SOFTLIMB_WRITE_REFERENCE=1 cargo test -p softlimb-scene scene_reference`.

#[test]
fn reference_pages_are_up_to_date() {
    is_up_to_date("scene.md", &softlimb_scene::reference());
    is_up_to_date("study.md", &softlimb_scene::study_reference());
}

fn is_up_to_date(name: &str, page: &str) {
    let path = format!("{}/../../docs/reference/{name}", env!("CARGO_MANIFEST_DIR"));
    if std::env::var_os("SOFTLIMB_WRITE_REFERENCE").is_some() {
        std::fs::write(&path, page).unwrap();
    }
    let written = std::fs::read_to_string(path).unwrap();
    assert!(written == page, "docs/reference/{name} is out of date: run this test with SOFTLIMB_WRITE_REFERENCE=1");
}

#[test]
fn defaults_of_the_page_are_accepted_by_the_reader() {
    let page = softlimb_scene::reference();
    let mut count = 0;
    for (section, header) in page.split("\n## `").skip(1).filter_map(|part| Some((part, part.split_once('`')?.0))) {
        let rows = section.lines().filter(|line| line.starts_with("| `"));
        for row in rows {
            let cells: Vec<&str> = row.split(" | ").collect();
            let [key, _, default, _] = cells[..] else { panic!("{row}") };
            let key = key.trim_start_matches("| ").trim_matches('`');
            let is_quantity = default.starts_with(|c: char| c.is_ascii_digit()) && default.contains(' ');
            if is_quantity && header.starts_with("plant.") && !default.contains("for one") {
                let text = format!("{MINIMAL}\n[{header}]\n{key} = \"{default}\"\n");
                let scene = softlimb_scene::parse(&text, "default.toml");
                assert_eq!(
                    scene.map(|scene| scene.plant().clone()),
                    softlimb_scene::parse(MINIMAL, "minimal.toml").map(|scene| scene.plant().clone()),
                    "{header}.{key}"
                );
                count += 1;
            }
        }
    }
    assert!(count >= 25, "{count}");
}

const MINIMAL: &str = r#"
format = 1
name = "minimal"
materials.silicone = { law = "neo-hookean", shear_modulus = "0.2 MPa" }
limb.connector = { length = 0, mass = 0 }
module = [{ name = "a", motion = "bending", actuators = 1, inner_radius = 0.010, outer_radius = 0.014, length = 0.2, material = "silicone" }]
phase = [{ name = "p", duration = 1, targets = { a = { pressure = "20 kPa" } } }]
"#;
