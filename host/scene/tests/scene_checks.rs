//! What must hold between the keys of a scene: for each rule the title and the underlined text.

use crate::scene_support::{SCENE, changed, picture};
use softlimb_scene::parse;

/// Title of the only problem and the source text under its first label.
#[track_caller]
fn problem(text: &str) -> (String, String) {
    let picture = parse(text, "arm.toml").unwrap_err().render(false);
    assert_eq!(picture.matches("error:").count(), 1, "{picture}");
    let title = picture.lines().next().unwrap().trim_start_matches("error: ").to_owned();
    let lines: Vec<&str> = picture.lines().collect();
    let at = lines.iter().position(|line| line.contains('^')).unwrap_or_else(|| panic!("{picture}"));
    let start = lines[at].find('^').unwrap();
    let length = lines[at].matches('^').count();
    let underlined = lines[at - 1].chars().skip(start).take(length).collect();
    (title, underlined)
}

#[track_caller]
fn expect(text: &str, title: &str, underlined: &str) {
    assert_eq!(problem(text), (title.to_owned(), underlined.to_owned()));
}

#[test]
fn materials() {
    let rule = "`c` has no meaning with `law = \"neo-hookean\"`";
    expect(&changed("law = \"neo-hookean\"", "law = \"neo-hookean\"\nc = [1, 2, 3]"), rule, "c");
    expect(&changed("neo-hookean", "neohookean"), "unknown `law` `neohookean`", "\"neohookean\"");
    let yeoh = "law = \"yeoh\"\nc = [\"0.1 MPa\", 0]";
    expect(
        &changed("law = \"neo-hookean\"\nshear_modulus = \"0.2 MPa\"", yeoh),
        "`c` needs three values",
        "[\"0.1 MPa\", 0]",
    );
    let yeoh = "law = \"yeoh\"\nc = [\"-0.1 MPa\", 0, 0]";
    let rule = "`c` must be from 0.0005 MPa to 50 MPa";
    expect(&changed("law = \"neo-hookean\"\nshear_modulus = \"0.2 MPa\"", yeoh), rule, "\"-0.1 MPa\"");
}

#[test]
fn windings() {
    let sheet = "thickness = \"0.178 mm\"";
    expect(&changed(sheet, ""), "missing key `thickness` in `[windings.NAME]`", "[windings.hoop]");
    expect(&changed(sheet, "placement = \"layer\""), "missing key `radius` in `[windings.NAME]`", "[windings.hoop]");
    let outside = "winding `hoop` does not lie in the wall";
    expect(&changed(sheet, "placement = \"layer\"\nradius = \"14 mm\""), outside, "\"hoop\"");
    expect(&changed(sheet, "thickness = \"0.178 mm\"\nradius = \"9 mm\""), outside, "\"hoop\"");
    let rule = "`thickness` has no meaning for this placement: only a sheet has a thickness";
    expect(&changed(sheet, "thickness = 1e-3\nplacement = \"smeared\""), rule, "thickness");
    expect(&changed("\"3 deg\"", "\"91 deg\""), "`angle` must be from -90 deg to 90 deg", "\"91 deg\"");
    expect(&changed("winding = \"hoop\"", ""), "missing key `winding` in `[[module]]`", "[[module]]");
    let twisting = changed("motion = \"extension\"", "motion = \"twisting\"")
        .replace("axial_stretch = 1.1", "twist = -0.5")
        .replace("axial_stretch = 1.2", "twist = -0.6");
    expect(&twisting, "a `twisting` module needs a winding of one family", "\"hoop\"");
}

#[test]
fn two_windings() {
    let axial = "[windings.axial]\nangle = \"90 deg\"\nfamilies = 1\nmodulus = \"10 MPa\"\nthickness = \"0.1 mm\"\nradius = \"12 mm\"\n";
    let helix = axial.replace("axial", "helix").replace("90", "30");
    let with = |windings: &str| {
        let text = changed("[limb]", &format!("{axial}{helix}[limb]"));
        text.replace("winding = \"hoop\"", &format!("winding = {windings}"))
    };
    let scene = parse(&with("[\"hoop\", \"axial\"]"), "arm.toml").unwrap();
    let module = &scene.modules()[0];
    let (first, second) = (module.fiber.unwrap(), module.second_fiber.unwrap());
    assert_eq!((first.modulus_pa, first.radius_m), (361e6, 14e-3));
    assert_eq!((second.modulus_pa, second.radius_m, second.angle_rad), (10e6, 12e-3, std::f64::consts::FRAC_PI_2));
    assert_eq!(scene.modules()[1].second_fiber, None);
    expect(&with("[\"hoop\"]"), "`winding` needs a name or an array of two", "[\"hoop\"]");
    expect(&with("[\"hoop\", 2]"), "`winding` must be a string", "2");
    expect(&with("[\"hoop\", \"axail\"]"), "unknown winding `axail`", "\"axail\"");
    let rule = "winding `helix` twists, and a module that does not twist takes two that do not";
    expect(&with("[\"hoop\", \"helix\"]"), rule, "\"helix\"");
    let bending = |second: &str| {
        let wound = format!("motion = \"bending\"\nwinding = [\"hoop\", \"{second}\"]");
        with("\"hoop\"").replace("motion = \"bending\"", &wound)
    };
    assert!(parse(&bending("axial"), "arm.toml").unwrap().modules()[1].second_fiber.is_some());
    let rule = "winding `helix` twists, and plates hold the twist of several benders back";
    expect(&bending("helix"), rule, "\"helix\"");
    let twisting = |windings: &str| {
        let text = with(windings).replace("motion = \"extension\"", "motion = \"twisting\"");
        text.replace("axial_stretch = 1.1", "twist = -0.5").replace("axial_stretch = 1.2", "twist = -0.6")
    };
    expect(&twisting("[\"hoop\", \"axial\"]"), "a `twisting` module needs a helix of one family", "\"hoop\"");
    assert!(parse(&twisting("[\"helix\", \"axial\"]"), "arm.toml").is_ok());
}

#[test]
fn threads() {
    let sheet = "modulus = \"361 MPa\"\nthickness = \"0.178 mm\"";
    let thread = "thread = { stiffness = \"772 N\", diameter = \"0.178 mm\", starts = 2 }";
    let wound = changed(sheet, thread);
    let scene = parse(&wound, "arm.toml").unwrap();
    let found = scene.modules()[0].thread.unwrap();
    assert_eq!((found.stiffness_n, found.diameter_m, found.starts), (772.0, 0.178e-3, 2));
    let beside = changed("thickness = \"0.178 mm\"", &format!("thickness = \"0.178 mm\"\n{thread}"));
    let stated = parse(&beside, "arm.toml").unwrap().modules()[0].clone();
    assert_eq!((stated.thread, stated.fiber.unwrap().modulus_pa), (scene.modules()[0].thread, 361e6));
    expect(
        &changed("thickness = \"0.178 mm\"", thread),
        "missing key `thickness` in `[windings.NAME]`",
        "[windings.hoop]",
    );
    expect(&changed("modulus = \"361 MPa\"", thread), "missing key `modulus` in `[windings.NAME]`", "[windings.hoop]");
    expect(&changed(sheet, ""), "missing key `modulus` in `[windings.NAME]`", "[windings.hoop]");
    let smeared = changed(sheet, &format!("{thread}\nplacement = \"smeared\""));
    expect(&smeared, "a `thread` lies on one radius", "\"smeared\"");
    let level = wound.replace("\"3 deg\"", "\"0 deg\"");
    expect(&level, "a thread does not climb at 0 deg from the hoop", "\"0 deg\"");
    // 2 pi 14 mm sin(3 deg) = 4.604 mm are 25.9 diameters.
    let room = "the threads of winding `hoop` do not fit side by side";
    expect(&wound.replace("starts = 2", "starts = 26"), room, "\"hoop\"");
    let full = parse(&wound.replace("starts = 2", "starts = 26"), "arm.toml").unwrap_err().render(false);
    assert!(full.contains("up to 25 `starts` fit"), "{full}");
    parse(&wound.replace("starts = 2", "starts = 25"), "arm.toml").unwrap();
}

#[test]
fn base() {
    expect(&changed("[limb]", "[limb]\nbase_direction = [0, 0, 0]"), "`base_direction` has no direction", "[0, 0, 0]");
    expect(
        &changed("[limb]", "[limb]\nbase_direction = [0, 1, 0]\nbase_up = [0, -2, 0]"),
        "`base_up` is parallel to `base_direction`",
        "[0, -2, 0]",
    );
    expect(&changed("[limb]", "[limb]\nbase_position = [1, 2]"), "`base_position` needs three values", "[1, 2]");
}

#[test]
fn names() {
    expect(&changed("\"arm\"", "\"../arm\""), "`../arm` is not a name", "\"../arm\"");
    let twice = changed("name = \"stretch\"", "name = \"reach\"");
    expect(&twice, "there are two phases named `reach`", "\"reach\"");
}

#[test]
fn misspelled_table_is_one_problem() {
    let typo = SCENE.replace("[[module]]", "[[modul]]");
    let error = parse(&typo, "arm.toml").unwrap_err();
    assert_eq!(error.to_string(), "arm.toml:17:3: unknown key `modul`");
    assert_eq!(
        parse(&changed("[limb]", "[limbs]"), "arm.toml").unwrap_err().to_string(),
        "arm.toml:15:2: unknown key `limbs`"
    );
    let parts = parse("format = 1\nname = \"x\"\n", "x.toml").unwrap_err().render(false);
    for header in ["[limb]", "[[module]]", "[[phase]]"] {
        assert!(parts.contains(&format!("the scene has no `{header}`")), "{parts}");
    }
}

#[test]
fn phases() {
    let second = "targets = { upper = { axial_stretch = 1.2 } }";
    expect(&changed(second, ""), "the phase has no goal", "[[phase]]");
    let both = format!("{second}\ntip = [0.5, 0, 0]");
    expect(&changed(second, &both), "a phase has one of `targets`, `tip` and `inside`", "tip");
    expect(&changed(second, "targets = { upper = {} }"), "the target of `upper` names no quantity", "{}");
    let two = "targets = { upper = { axial_stretch = 1.2, pressure = 1e4 } }";
    expect(&changed(second, two), "the target of `upper` names more than one quantity", "pressure");
    let start = SCENE.find("[[phase]]").unwrap();
    let error = parse(&SCENE[..start], "arm.toml").unwrap_err().render(false);
    assert!(error.starts_with("error: the scene has no `[[phase]]`"), "{error}");
    let none = parse(&format!("phase = []\n{}", &SCENE[..start]), "arm.toml").unwrap_err().render(false);
    assert_eq!(none, error, "an empty array is no phase");
    let many: String =
        (0..201).map(|i| format!("[[phase]]\nname = \"p{i}\"\nduration = 1\ntip = [0, 0, 0]\n")).collect();
    expect(&format!("{}{many}", &SCENE[..start]), "too many phases", "[[phase]]");
}

#[test]
fn pressures() {
    let text =
        SCENE.replace("axial_stretch = 1.1", "pressure = \"120 kPa\"").replace("axial_stretch = 1.2", "pressure = 0");
    expect(&text, "the pressure is above the `pressure_max` of module `upper`", "\"120 kPa\"");
    let limits = "pressure_max = \"100 kPa\"\nsupply_min = \"200 kPa\"\nsupply_max = \"150 kPa\"";
    let rule = "`supply_min` must be at least 1 kPa below `supply_max`";
    expect(&changed("pressure_max = \"100 kPa\"", limits), rule, "\"200 kPa\"");
}

#[test]
fn supply() {
    assert_eq!(
        picture("[limits]", "[plant.sensor]\nsupply_full_scale = \"20 psi\"\n[limits]"),
        r#"error: `supply_max` is beyond the sensor of the supply, which reads to 137.895 kPa
  --> arm.toml:49:21
   |
49 | supply_full_scale = "20 psi"
   |                     ^^^^^^^^ the sensor reads to 137.895 kPa
   |
   = note: `supply_max` is 300 kPa, by default"#
    );
    let rule = "`supply_max` is beyond the sensor of the supply, which reads to 689.476 kPa";
    expect(&changed("[limits]", "[limits]\nsupply_max = \"7 bar\""), rule, "\"7 bar\"");

    // Six valves: 25 x 6 x 1.44e-9 / 5e-3 m3 is less than the smallest reservoir; 25 x 6 x 4e-8 / 5e-3 m3 is 1.2 L.
    let small = "the reservoir is too small for the flow of a millisecond";
    let valves = "[plant.valve]\nconductance = \"4 dm3/(s bar)\"\n[limits]";
    expect(&changed("[limits]", valves), small, "\"4 dm3/(s bar)\"");
    let both = format!("[plant.supply]\nreservoir_volume = \"0.3 L\"\n{valves}");
    expect(&changed("[limits]", &both), small, "\"0.3 L\"");
    let enough =
        "[plant.valve]\nconductance = \"4 dm3/(s bar)\"\n[plant.supply]\nreservoir_volume = \"1.201 L\"\n[limits]";
    assert!(parse(&changed("[limits]", enough), "arm.toml").is_ok());
    let help = picture("[limits]", valves);
    assert!(help.contains("help: `reservoir_volume` must be at least 1.20"), "{help}");
}

#[test]
fn valve_voltage() {
    let limits = |least: &str| format!("[limits]\nvalve_voltage_min = {least}");
    let rule = "`valve_voltage_min` is not below the `voltage` of the valves: 24 V";
    expect(&changed("[limits]", &limits("\"24 V\"")), rule, "\"24 V\"");
    let rule = "`valve_voltage_min` is not below the `voltage` of the valves: 12 V";
    let twelve = format!("[plant.valve]\nvoltage = \"12 V\"\n{}", limits("20"));
    expect(&changed("[limits]", &twelve), rule, "20");
    let scene = parse(&changed("[limits]", &limits("\"20000 mV\"")), "arm.toml").unwrap();
    assert_eq!(scene.limits().valve_voltage_min_v.map(|least| *least), Some(20.0));
    expect(&changed("[limits]", &limits("\"20 kPa\"")), "`valve_voltage_min` needs a voltage", "\"20 kPa\"");
}

#[test]
fn plant_and_controller() {
    let add = |text: &str| format!("{SCENE}{text}");
    let rule = "`creep` has no meaning for the simple limb: `limb = \"body\"` has them";
    expect(&add("[plant.truth]\ncreep = true\n"), rule, "creep");
    let rule = "`flow` has no meaning for a regulated supply";
    expect(&add("[plant.supply]\nkind = \"regulated\"\nflow = \"6 NL/min\""), rule, "flow");
    let rule = "the pump cannot reach `pressure`: it stalls at `stall_pressure`";
    expect(&add("[plant.supply]\npressure = \"260 kPa\""), rule, "\"260 kPa\"");
    let rule = "`control_period` must be a whole number of milliseconds";
    expect(&add("[controller]\ncontrol_period = \"12.5 ms\""), rule, "\"12.5 ms\"");
    expect(&add("[plant]\nvalve = 3"), "`valve` must be a table", "3");
    expect(
        &add("[plant.valve]\nconductance = \"0.144 dm3/s\""),
        "`conductance` needs a sonic conductance",
        "\"0.144 dm3/s\"",
    );
}
