//! A tube of two segments: a winding and shells each, one core, one pair of caps.

use std::f64::consts::PI;

use softlimb_limb::fabricate::mold::{HOLD_M, core, names, parts};
use softlimb_limb::fabricate::sheet::{html, markdown, sheet};
use softlimb_limb::fabricate::{FabricateError, Piece, Settings, plan};
use softlimb_scene::parse;

const SCENE: &str = include_str!("../../../../scenes/extend-and-bend.toml");

fn tube(from: &str, to: &str) -> Result<Vec<Piece>, FabricateError> {
    assert!(SCENE.contains(from), "{from}");
    let scene =
        parse(&SCENE.replacen(from, to, 1), "tube.toml").unwrap_or_else(|error| panic!("{}", error.render(false)));
    plan(&scene, &Settings::default())
}

#[test]
fn segments_are_pieces_on_one_core() {
    let pieces = tube("", "").unwrap();
    let [first, second] = &pieces[..] else { panic!("{} pieces", pieces.len()) };
    assert_eq!([&first.name, &second.name], ["finger.1", "finger.2"]);
    let places = [first, second].map(|piece| piece.segment.unwrap());
    assert_eq!(places.map(|place| (place.number, place.count)), [(1, 2), (2, 2)]);
    assert!(places[0].start_m == 0.0 && (places[1].start_m - 0.06).abs() < 1e-15);
    assert!(places.iter().all(|place| (place.tube_m - 0.16).abs() < 1e-15));
    let all_m3: f64 = pieces.iter().map(Piece::elastomer_m3).sum();
    assert!((all_m3 / (PI * (0.009_f64.powi(2) - 0.006_f64.powi(2)) * 0.16) - 1.0).abs() < 1e-12, "{all_m3}");
    // The thread of the scene, wound over the segment alone: 2 pi R tan a a turn.
    let turns = 0.06 / (2.0 * PI * first.winding.radius_m * first.winding.angle_rad.tan());
    assert!((first.winding.turns() / turns - 1.0).abs() < 1e-12 && (first.winding.length_m - 0.06).abs() < 1e-15);
    assert!((first.winding.angle_rad.to_degrees() - 3.0).abs() < 0.1, "{}", first.winding.angle_rad.to_degrees());
}

#[test]
fn core_base_and_caps_are_those_of_the_first_segment() {
    let pieces = tube("", "").unwrap();
    let of = |piece: &Piece| names(piece).into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    assert_eq!(of(&pieces[0]), ["core", "shell-a", "shell-b", "base", "cap", "port", "connector"]);
    assert_eq!(of(&pieces[1]), ["shell-a", "shell-b"]);
    let chord_m = 1e-5;
    let rod_m3 = PI * 0.006_f64.powi(2) * (0.16 + 2.0 * HOLD_M);
    let volume_m3 = core(&pieces[0], chord_m).volume_m3();
    assert!(volume_m3 < rod_m3 && volume_m3 > 0.995 * rod_m3, "{volume_m3} {rod_m3}");
    for piece in &pieces {
        let made = parts(piece, &Settings::default()).unwrap();
        assert_eq!(made.iter().map(|part| part.name).collect::<Vec<_>>(), of(piece));
        let tallest = made.iter().filter(|part| part.name == "shell-a").flat_map(|part| part.mesh.points_m.iter());
        let tallest_m = tallest.map(|point| point[2]).fold(0.0, f64::max);
        assert!((tallest_m - piece.parameters.length_m).abs() < 1e-9, "{tallest_m}");
    }
}

#[test]
fn sheet_states_the_place_of_each_segment() {
    let pieces = tube("length = \"100 mm\"", "length = \"100 mm\"\nbend_direction = \"90 deg\"").unwrap();
    let sheet = sheet("tube", &pieces, &Settings::default(), |_| vec!["one.stl".to_owned()]);
    let text = markdown(&sheet);
    for line in [
        "## finger.1: extension, make 1",
        "| segment | 1 of 2 |",
        "| place on the tube, from its near end | 0.000 mm to 60.000 mm | of 160.000 mm |",
        "## finger.2: bending, make 1",
        "| place on the tube, from its near end | 60.000 mm to 160.000 mm | of 160.000 mm |",
        "| length | 100.000 mm | over the segment |",
        "| side of the limb | 90.00 deg from up |",
        "| core | 200.000 mm |",
        "| ends of the thread | tied |",
    ] {
        assert!(text.contains(line), "{line}\n{text}");
    }
    assert_eq!(text.matches("Strain-limiting layer").count(), 1);
    assert_eq!(text.matches("### Ends").count(), 1);
    assert!(html(&sheet, &pieces, &Settings::default()).contains("one core of 200 mm through all segments"));
}

#[test]
fn covers_of_some_segments_only_are_refused() {
    let deep = "families = 2\nradius = \"8 mm\"";
    let error = tube("families = 2", deep).unwrap_err();
    let FabricateError::Scene(error) = error else { panic!("{error}") };
    let error = error.render(false);
    assert!(error.contains("these segments cannot be cast together"), "{error}");
    let (from, to) = ("length = \"100 mm\"", "length = \"100 mm\"\nwinding = \"hoop\"");
    let text = SCENE.replacen("families = 2", deep, 1).replacen(from, to, 1);
    let pieces = plan(&parse(&text, "tube.toml").unwrap(), &Settings::default()).unwrap();
    assert_eq!(names(&pieces[1]).last(), Some(&("cover", 2)));
}
