//! A second winding over the first.

use std::f64::consts::{FRAC_PI_2, TAU};

use softlimb_limb::fabricate::path::points;
use softlimb_limb::fabricate::sheet::{html, sheet};
use softlimb_limb::fabricate::{FabricateError, Hand, Piece, plan};
use softlimb_scene::parse;

use crate::fabricate::common::{TUBE, Tube, settings, words};

/// A twist rod with a helix of 30 deg on a radius of 13 mm, and a second winding.
fn rod(second: &str) -> Result<Piece, FabricateError> {
    let tube = Tube { motion: "twisting", families: 1, angle_deg: 30.0, ..TUBE };
    let text = tube.text().replace("winding = \"thread\"", "winding = [\"thread\", \"second\"]").replace(
        "[limb]",
        &format!(
            "[windings.second]\nfamilies = 1\nmodulus = \"300 MPa\"\nthickness = \"0.2 mm\"\n{second}\n[weight]\n\
             simulated = false\ncompensated = false\n[limb]"
        ),
    );
    let scene = parse(&text, "rod.toml").unwrap_or_else(|error| panic!("{}", error.render(false)));
    Ok(plan(&scene, &settings(0.3, 4.0))?.remove(0))
}

#[test]
fn axial_threads_run_straight_over_the_helix() {
    let piece = rod("angle = \"90 deg\"\nradius = \"13 mm\"").unwrap();
    let second = piece.second.as_ref().expect("wound twice");
    assert_eq!(second.winding.hands, [Hand::Straight]);
    // 2 pi 13 mm/4 mm = 20.4 threads.
    assert_eq!((second.winding.starts, piece.winding.starts), (20, 10));
    let path = points(&second.winding, Hand::Straight, 5e-5);
    for point in &path {
        let [x, y, _] = point.place_m;
        assert!((x.hypot(y) - 13e-3).abs() < 1e-12);
        assert!((point.turn_rad - TAU * f64::from(point.start) / 20.0).abs() < 1e-12);
    }
    let all: f64 = path.windows(2).map(|pair| (pair[1].place_m[2] - pair[0].place_m[2]).max(0.0)).sum();
    assert!((all - 20.0 * 60e-3).abs() < 1e-12, "{all}");
    assert!((second.winding.angle_rad - FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn opposite_helix_climbs_the_other_way_at_its_own_angle() {
    let piece = rod("angle = \"-50 deg\"\nradius = \"13.2 mm\"").unwrap();
    let winding = &piece.second.as_ref().expect("wound twice").winding;
    assert_eq!(winding.hands, [Hand::Left]);
    let path = points(winding, Hand::Left, 5e-5);
    for pair in path.windows(2).filter(|pair| pair[0].start == pair[1].start) {
        let rise = pair[1].place_m[2] - pair[0].place_m[2];
        let around = 13.2e-3 * (pair[1].turn_rad - pair[0].turn_rad);
        assert!((rise / around + 50_f64.to_radians().tan()).abs() < 1e-9, "{rise} {around}");
    }
}

#[test]
fn sheet_has_both_windings() {
    let piece = rod("angle = \"90 deg\"\nradius = \"13 mm\"").unwrap();
    let settings = settings(0.3, 4.0);
    let sheet = sheet("rod", std::slice::from_ref(&piece), &settings, |_| Vec::new());
    let titles: Vec<&str> = sheet.pages[0].tables.iter().map(|table| table.title.as_str()).collect();
    assert!(titles.contains(&"Winding") && titles.contains(&"Second winding"), "{titles:?}");
    let page = html(&sheet, &[piece], &settings);
    assert_eq!(page.matches("<path class=\"thread\"").count(), 2);
}

#[test]
fn second_winding_that_cannot_be_laid_is_refused_at_its_name() {
    for (second, reason) in [
        ("angle = \"90 deg\"\nradius = \"12 mm\"", "its thread at 12.000 mm does not lie on the first cast"),
        ("angle = \"90 deg\"\nradius = \"14 mm\"", "its thread at 14.000 mm does not lie on the first cast"),
    ] {
        let text = words(&rod(second).unwrap_err());
        assert!(text.contains(reason) && text.contains("winding = [\"thread\", \"second\"]"), "{text}");
    }
}
