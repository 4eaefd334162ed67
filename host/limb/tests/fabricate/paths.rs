//! Paths of the thread against the geometry of a helix.

use std::f64::consts::{PI, TAU};

use softlimb_limb::fabricate::path::{Point, csv, points};
use softlimb_limb::fabricate::{Hand, Piece, Settings, plan};
use softlimb_scene::parse;

use crate::fabricate::common::{TUBE, Tube};

fn apart(a: &Point, b: &Point) -> f64 {
    (0..3).map(|axis| (a.place_m[axis] - b.place_m[axis]).powi(2)).sum::<f64>().sqrt()
}

fn pieces() -> Vec<Piece> {
    let twisting = Tube { motion: "twisting", families: 1, ..TUBE };
    [
        (TUBE, 4.0),
        (Tube { angle_deg: 3.0, ..TUBE }, 2.0),
        (Tube { angle_deg: 0.0, ..TUBE }, 2.0),
        (Tube { angle_deg: -28.0, ..twisting }, 3.0),
        (Tube { angle_deg: 80.0, motion: "expansion", ..TUBE }, 6.0),
    ]
    .map(|(tube, spacing)| tube.piece(0.3, spacing).unwrap())
    .into()
}

#[test]
fn a_thread_is_as_long_as_the_hypotenuse_of_its_unrolled_triangle() {
    for piece in pieces() {
        let winding = &piece.winding;
        let around = TAU * winding.radius_m * winding.turns();
        let length = around.hypot(piece.parameters.length_m);
        assert!((winding.thread_m() / length - 1.0).abs() < 1e-13, "{} {length}", winding.thread_m());
        for hand in &winding.hands {
            let path = points(winding, *hand, 1e-7);
            let last = path.iter().rfind(|point| point.start == 0).unwrap();
            assert!((last.arc_m / length - 1.0).abs() < 1e-13);
            let chords: f64 = path.windows(2).filter(|w| w[0].start == w[1].start).map(|w| apart(&w[0], &w[1])).sum();
            let sum = chords / f64::from(winding.starts);
            // Chords of half the angle d leave out a share of up to d^2/6, here 1e-7/R/3.
            assert!(sum <= length && sum >= length * (1.0 - 2e-5), "{sum} {length}");
        }
    }
}

#[test]
fn the_pitch_is_the_height_of_one_turn() {
    for piece in pieces() {
        let winding = &piece.winding;
        for hand in &winding.hands {
            let path = points(winding, *hand, 5e-5);
            let sign = if *hand == Hand::Left { -1.0 } else { 1.0 };
            for point in &path {
                let [x, y, z] = point.place_m;
                assert!((x.hypot(y) / winding.radius_m - 1.0).abs() < 1e-14);
                let turned = point.turn_rad - TAU * f64::from(point.start) / f64::from(winding.starts);
                let height = sign * turned / TAU * winding.lead_m();
                assert!((z - height).abs() < 1e-12, "{z} {height}");
            }
        }
    }
    // 2 pi R tan(20 deg).
    let lead = pieces()[0].winding.lead_m();
    assert!((lead - 2.0 * PI * 0.013 * 0.363_970_234_266_202_4).abs() < 1e-15, "{lead}");
}

#[test]
fn chords_stay_within_their_distance_of_the_helix_and_use_it() {
    for piece in pieces() {
        for chord_m in [5e-5, 1e-5, 3e-4] {
            let path = points(&piece.winding, piece.winding.hands[0], chord_m);
            let most = path.windows(2).filter(|w| w[0].start == w[1].start).map(|w| {
                let middle = [0, 1].map(|axis| 0.5 * (w[0].place_m[axis] + w[1].place_m[axis]));
                piece.winding.radius_m - middle[0].hypot(middle[1])
            });
            let most = most.fold(0.0, f64::max);
            assert!(most <= chord_m * (1.0 + 1e-9), "{most} {chord_m}");
            assert!(most >= 0.4 * chord_m, "{most} {chord_m}: too many points");
        }
    }
}

#[test]
fn threads_along_the_axis_are_straight_lines() {
    let piece = Tube { motion: "expansion", angle_deg: 90.0, ..TUBE }.piece(0.3, 6.0).unwrap();
    let winding = &piece.winding;
    assert_eq!(winding.hands, [Hand::Straight]);
    let path = points(winding, Hand::Straight, 5e-5);
    assert_eq!(path.len(), 2 * winding.starts as usize);
    for ends in path.chunks(2) {
        assert_eq!(ends[0].place_m[..2], ends[1].place_m[..2]);
        assert_eq!([ends[0].place_m[2], ends[1].place_m[2]], [0.0, piece.parameters.length_m]);
    }
}

/// The model has one sheet per family. In an axial winding both have the same direction.
#[test]
fn two_families_of_threads_along_the_axis_are_twice_the_threads_of_one() {
    let threads = |families: u8| {
        let sheet = "modulus = \"300 MPa\"\nthickness = \"0.2 mm\"";
        let text = Tube { motion: "expansion", angle_deg: 90.0, families, ..TUBE }.text();
        let text = text.replace(sheet, "thread = { stiffness = \"772 N\", diameter = \"0.2 mm\", starts = 12 }");
        plan(&parse(&text, "tube.toml").unwrap(), &Settings::default()).unwrap()[0].winding.threads()
    };
    assert_eq!([threads(1), threads(2)], [12, 24]);
}

#[test]
fn file_reads_back_to_the_digit() {
    let piece = TUBE.piece(0.3, 4.0).unwrap();
    let path = points(&piece.winding, Hand::Left, 5e-5);
    let text = csv(&path);
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("start,turn_deg,x_m,y_m,z_m,arc_m"));
    for (line, point) in lines.by_ref().zip(&path) {
        let read: Vec<f64> = line.split(',').map(|value| value.parse().unwrap()).collect();
        let [x, y, z] = point.place_m;
        assert_eq!(read, [f64::from(point.start + 1), point.turn_rad.to_degrees(), x, y, z, point.arc_m]);
    }
    assert_eq!(text.lines().count(), path.len() + 1);
}
