//! What stands on the sheet.

use std::f64::consts::{PI, TAU};

use softlimb_fea::axisymmetric::{Thread, thread_sheet};
use softlimb_limb::fabricate::sheet::{Page, html, markdown, sheet};
use softlimb_limb::fabricate::{Hand, Settings, plan};
use softlimb_scene::{load, parse};

use crate::fabricate::common::{TUBE, Tube, settings};

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/weightless-a.toml");

fn value<'a>(page: &'a Page, what: &str) -> &'a str {
    let mut rows = page.tables.iter().flat_map(|table| &table.rows);
    &rows.find(|row| row.what == what).unwrap_or_else(|| panic!("no {what}")).value
}

#[test]
fn numbers_are_those_of_the_geometry() {
    let tube = Tube { angle_deg: 30.0, ..TUBE };
    let settings = settings(0.3, 4.0);
    let pieces = plan(&tube.scene(), &settings).unwrap();
    let sheet = sheet("tube", &pieces, &settings, |_| vec!["tube-core.stl".to_owned()]);
    let page = &sheet.pages[0];
    assert_eq!((page.module.as_str(), page.motion.as_str(), page.count), ("tube", "extension", 1));
    // R = 13 mm, tan 30 deg = 1/sqrt 3; the nearest whole number of threads to 2 pi 13 sin 30 deg/4 = 10.2 is 10.
    let lead = TAU * 13.0 / 3_f64.sqrt();
    assert_eq!(value(page, "pitch of one thread"), format!("{lead:.3} mm"));
    assert_eq!(value(page, "turns of one thread"), format!("{:.3}", 60.0 / lead));
    assert_eq!(value(page, "threads side by side, each hand"), "10");
    assert_eq!(value(page, "threads of one hand, measured across"), format!("{:.3} mm", PI * 13.0 / 10.0));
    assert_eq!(value(page, "length of one thread"), "0.1200 m");
    assert_eq!(value(page, "thread in all, per actuator"), "2.400 m");
    let volume = PI * (14.0_f64.powi(2) - 100.0) * 60.0 * 1e-3;
    assert_eq!(value(page, "elastomer, one actuator"), format!("{volume:.3} mL"));
    assert_eq!(value(page, "mass, one actuator"), format!("{:.3} g", 1.08 * volume));
    assert_eq!(value(page, "chamber at rest"), format!("{:.3} mL", PI * 6.0));
    let cover = PI * (14.0_f64.powi(2) - 13.15_f64.powi(2)) * 60.0 * 1e-3;
    assert_eq!(value(page, "second cast"), format!("{cover:.3} mL"));
    for text in [markdown(&sheet), html(&sheet, &pieces, &settings)] {
        for row in page.tables.iter().flat_map(|table| &table.rows) {
            assert!(text.contains(&row.what) && text.contains(&row.value), "{row:?} is missing");
        }
        assert!(text.contains("tube-core.stl"));
    }
    let page = html(&sheet, &pieces, &settings);
    let dimensions = [
        "length at rest 60 mm",
        "outer diameter 28 mm",
        "thread on diameter 26 mm",
        "chamber diameter 20 mm; wall 4 mm",
        // Of a hose of 3 mm.
        "air port: bore 1.65 mm, through the cap",
        "air port: nipple 3 mm by 10 mm long",
        "barb 3.45 mm",
    ];
    assert!(dimensions.iter().all(|text| page.contains(text)), "{page}");
    // 560 px for 60 mm would be 261 px high: the diameter sets the scale, 150 px for 28 mm. A thread is 1 mm below the surface.
    let (path, _) = page.split_once("<path class=\"thread\" d=\"").unwrap().1.split_once('"').unwrap();
    let points: Vec<f64> =
        path.split(['M', 'L', ' ']).filter(|number| !number.is_empty()).map(|number| number.parse().unwrap()).collect();
    let scale = 150.0 / 28.0;
    let [mut xs, mut ys] = [0, 1].map(|axis: usize| points.iter().skip(axis).step_by(2).copied().collect::<Vec<f64>>());
    xs.sort_by(f64::total_cmp);
    ys.sort_by(f64::total_cmp);
    let extents = [xs[xs.len() - 1] - xs[0], ys[ys.len() - 1] - ys[0]];
    assert!((extents[0] - 60.0 * scale).abs() < 0.2 && (extents[1] - 26.0 * scale).abs() < 1.0, "{extents:?}");
}

#[test]
fn turns_near_the_hoop_are_as_far_apart_as_the_scene_s_stiffness_asks_for() {
    let text = std::fs::read_to_string(SCENE).unwrap();
    let thread = "thread = { stiffness = \"772 N\", diameter = \"0.178 mm\", starts = 2 }";
    assert!(text.contains(thread));
    // A scene that states the thread takes its sheet from that, and has no modulus to write.
    let stated = plan(&parse(&text, "thread.toml").unwrap(), &Settings::default()).unwrap();
    assert!(stated[0].winding.worth.as_ref().unwrap().as_ref().unwrap().modulus_pa.is_none());
    let text = text.replace(thread, "modulus = \"361 MPa\"\nthickness = \"0.178 mm\"");
    let (settings, scene) = (Settings::default(), parse(&text, "sheet.toml").unwrap());
    let piece = &plan(&scene, &settings).unwrap()[0];
    let winding = &piece.winding;
    assert_eq!(winding.hands, [Hand::Right, Hand::Left]);
    let worth = winding.worth.as_ref().unwrap().as_ref().unwrap();
    assert!(worth.modulus_pa.is_some());
    // 2 families of 361 MPa and 0.178 mm.
    assert!((worth.scene_n_per_m.unwrap() - 2.0 * 361e6 * 0.178e-3).abs() < 1e-6);
    // What whole threads allow on either side is worth less and more than the scene's sheet.
    let sheet = |starts: u32| {
        let spacing_m = winding.lead_m() / f64::from(2 * starts);
        let thread = Thread { stiffness_n: 772.0, spacing_m, width_m: 0.178e-3 };
        thread_sheet(&piece.parameters, &thread, 0.3 * piece.pressure_max_pa).unwrap().effective_n_per_m
    };
    let [fewer, here, more] = [winding.starts - 1, winding.starts, winding.starts + 1].map(sheet);
    assert_eq!(here, worth.effective_n_per_m);
    assert!(fewer < worth.scene_n_per_m.unwrap() && worth.scene_n_per_m.unwrap() < more, "{fewer} {here} {more}");
}

#[test]
fn bending_actuator_says_where_its_layer_lies() {
    let scene = load(SCENE).unwrap();
    let settings = Settings { spacing_m: Some(2e-3), ..Settings::default() };
    let pieces = plan(&scene, &settings).unwrap();
    let sheet = sheet(scene.name(), &pieces, &settings, |_| Vec::new());
    let elbow = &sheet.pages[1];
    assert_eq!(elbow.motion, "bending");
    assert_eq!(value(elbow, "where"), "at 0 deg, along the axis");
    assert_eq!(value(elbow, "distance from the axis"), "14.000 mm");
    assert_eq!(value(elbow, "side of the limb"), "180.00 deg from up");
    // Three actuators in a row of a spacing of 34 mm, at right angles to where the module bends, which is down.
    let places: Vec<_> = elbow.copies.iter().map(|copy| copy.place.as_str()).collect();
    let side = |mm: &str| format!("0.00 mm towards up, {mm} mm to the side");
    assert_eq!(places, [side("34.00"), side("0.00"), side("-34.00")]);
    assert_eq!(elbow.copies.iter().map(|copy| copy.channel).collect::<Vec<_>>(), [3, 4, 5]);
    assert!(sheet.pages[0].tables.iter().all(|table| table.title != "Strain-limiting layer"));
    // Drawn along the actuator and across it, and named once.
    let text = html(&sheet, &pieces, &settings);
    let drawn = text.split("<section>").skip(1).map(|page| {
        [page.matches("<path class=\"layer\"").count(), page.matches("strain-limiting layer, on the side").count()]
    });
    assert_eq!(drawn.collect::<Vec<_>>(), [[0, 0], [2, 1], [0, 0]]);
    // A lead of two distances, both hands.
    assert!((pieces[1].winding.lead_m() - 4e-3).abs() < 1e-15);
}

#[test]
fn families_along_the_axis_are_one() {
    let expansion = Tube { motion: "expansion", angle_deg: 90.0, ..TUBE };
    let starts = |families: u8| {
        let scene = parse(&Tube { families, ..expansion }.text(), "tube.toml").unwrap();
        let settings = Settings { spacing_m: None, ..settings(0.3, 1.0) };
        plan(&scene, &settings).unwrap()[0].winding.starts
    };
    // E A/(4 mu2 t) = 772/(4 300e6 0.2e-3) = 3.217 mm on 2 pi 13 mm: 25.4; half the distance: 50.8.
    assert_eq!([starts(1), starts(2)], [25, 51]);
}
