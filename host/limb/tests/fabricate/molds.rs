//! Molds: closed surfaces with the volume and the grooves that closed forms say.

use std::f64::consts::{PI, TAU};

use softlimb_limb::fabricate::mold::{HOLD_M, core, cover, parts, shell_radius_m, shells};
use softlimb_limb::fabricate::{Hand, Piece};

use crate::fabricate::common::{TUBE, Tube, settings};
use crate::fabricate::surface::Surface;

/// Windings of every kind: both hands, either, along the axis; one start and many; under a cover and on the surface.
fn kinds() -> Vec<(Piece, f64)> {
    let twisting = Tube { motion: "twisting", families: 1, ..TUBE };
    let expansion = Tube { motion: "expansion", ..TUBE };
    let tubes = [
        (TUBE, 0.5, 4.0),
        (Tube { angle_deg: 3.0, ..TUBE }, 0.18, 2.0),
        (Tube { angle_deg: 1.0, winding_mm: 14.0, ..TUBE }, 0.18, 0.8),
        (Tube { angle_deg: 0.0, winding_mm: 14.0, ..TUBE }, 0.3, 2.5),
        (Tube { angle_deg: 28.0, winding_mm: 14.0, ..twisting }, 0.3, 3.0),
        (Tube { angle_deg: -61.0, length_mm: 37.0, ..twisting }, 0.6, 5.0),
        (Tube { angle_deg: 45.0, inner_mm: 2.0, outer_mm: 4.0, winding_mm: 3.5, ..TUBE }, 0.3, 2.0),
        (Tube { angle_deg: 78.0, ..expansion }, 0.4, 6.0),
        (Tube { angle_deg: 89.5, ..expansion }, 0.4, 6.0),
        (Tube { angle_deg: 90.0, ..expansion }, 0.4, 6.0),
    ];
    tubes.iter().map(|(tube, diameter, spacing)| (tube.piece(*diameter, *spacing).unwrap(), *diameter)).collect()
}

#[test]
fn every_part_is_a_closed_surface() {
    for (piece, diameter) in kinds() {
        for chord_mm in [0.05, 0.02, 0.2] {
            let settings = softlimb_limb::fabricate::Settings { chord_m: chord_mm * 1e-3, ..settings(diameter, 1.0) };
            for part in parts(&piece, &settings).unwrap() {
                let surface = Surface::read(&part.mesh.stl());
                let angle = piece.winding.angle_rad.to_degrees();
                let holes = usize::from(["base", "cover-base", "port", "connector"].contains(&part.name));
                surface.assert_closed(&format!("{} at {angle} deg within {chord_mm} mm", part.name), holes);
                let volume = surface.volume();
                assert!(volume > 0.0);
                assert!((part.mesh.volume_m3() * 1e9 / volume - 1.0).abs() < 1e-5, "two ways to a volume");
            }
        }
    }
}

/// Mean of the deepest groove at a place, as a share of the depth, and of its square: by how often it is deeper than `t`, with
/// `q(t) = A - B t` for one hand and `1 - (1 - q)^2` for two, whose places are independent over the surface.
fn mean_depth(piece: &Piece) -> [f64; 2] {
    let period = piece.winding.spacing_m();
    let [a, b] = [piece.groove.top_m / period, (piece.groove.top_m - piece.groove.floor_m) / period];
    let (one, square) = (a - b / 2.0, a - 2.0 * b / 3.0);
    if piece.winding.hands.len() == 1 {
        return [one, square];
    }
    [2.0 * one - (a * a - a * b + b * b / 3.0), 2.0 * square - (a * a - 4.0 * a * b / 3.0 + b * b / 2.0)]
}

/// Volume of both shells, m3.
fn shell_m3(piece: &Piece) -> f64 {
    let (bore, depth, length) = (piece.cast_radius_m, piece.groove.depth_m, piece.parameters.length_m);
    let [mean, square] = mean_depth(piece);
    let bore_square = bore * bore - 2.0 * bore * depth * mean + depth * depth * square;
    PI * length * (shell_radius_m(bore).powi(2) - bore_square)
}

/// Over a length of whole distances of threads the mean is that of one period.
fn whole_periods(tube: Tube, diameter_mm: f64, spacing_mm: f64, periods: f64) -> Piece {
    let winding = tube.piece(diameter_mm, spacing_mm).unwrap().winding;
    let length_mm = 1e3 * periods * winding.lead_m() / f64::from(winding.starts);
    Tube { length_mm, ..tube }.piece(diameter_mm, spacing_mm).unwrap()
}

#[test]
fn shells_have_the_volume_of_the_closed_form() {
    let twisting = Tube { motion: "twisting", families: 1, ..TUBE };
    for piece in [
        whole_periods(TUBE, 1.0, 4.0, 9.0),
        whole_periods(Tube { angle_deg: 45.0, ..TUBE }, 0.8, 6.0, 5.0),
        whole_periods(Tube { angle_deg: 28.0, winding_mm: 14.0, ..twisting }, 1.0, 3.0, 11.0),
        whole_periods(Tube { angle_deg: -50.0, ..twisting }, 1.0, 5.0, 7.0),
    ] {
        let exact = shell_m3(&piece);
        let volume = |chord_m: f64| shells(&piece, chord_m).unwrap().map(|mesh| mesh.volume_m3()).iter().sum::<f64>();
        let surface = TAU * (piece.cast_radius_m + shell_radius_m(piece.cast_radius_m)) * piece.parameters.length_m;
        let length = piece.parameters.length_m;
        let smooth = PI * length * (shell_radius_m(piece.cast_radius_m).powi(2) - piece.cast_radius_m.powi(2));
        let ridges = exact - smooth;
        for (chord_m, share) in [(5e-5, 0.5), (1e-5, 0.1), (1e-6, 0.01)] {
            let error = volume(chord_m) - exact;
            println!("chords within {chord_m:e} m: {:.3} % of the ridges", 100.0 * error / ridges);
            assert!(error.abs() <= chord_m * surface, "{error:e} m3 within {chord_m} m");
            assert!(error.abs() <= share * ridges, "{error:e} beside {ridges:e}");
        }
    }
}

#[test]
fn cores_and_covers_have_the_volume_of_cylinders() {
    for (piece, _) in kinds() {
        let (p, chord_m) = (&piece.parameters, 2e-5);
        let length = p.length_m + 2.0 * HOLD_M;
        let exact = PI * p.inner_radius_m.powi(2) * length;
        let off = core(&piece, chord_m).volume_m3() - exact;
        assert!(
            off <= 0.0 && -off <= chord_m * TAU * p.inner_radius_m * length,
            "a core is too thin by at most a chord"
        );
        let outer = shell_radius_m(p.outer_radius_m);
        let exact = 0.5 * PI * (outer.powi(2) - p.outer_radius_m.powi(2)) * p.length_m;
        let off = cover(&piece, chord_m).volume_m3() - exact;
        assert!(off.abs() <= chord_m * PI * (outer + p.outer_radius_m) * p.length_m);
    }
}

/// Distance of a place on the surface from the nearest thread of a hand, measured across, m.
fn off_thread_m(piece: &Piece, hand: Hand, [angle, height]: [f64; 2]) -> f64 {
    let winding = &piece.winding;
    let turned = match hand {
        Hand::Right => angle - TAU * height / winding.lead_m(),
        Hand::Left => angle + TAU * height / winding.lead_m(),
        Hand::Straight => angle,
    };
    let apart = TAU / f64::from(winding.starts);
    let off = turned.rem_euclid(apart);
    off.min(apart - off) * winding.radius_m * winding.angle_rad.sin()
}

#[test]
fn grooves_lie_under_the_threads() {
    for (piece, _) in kinds() {
        let groove = piece.groove;
        let floor_mm = 1e3 * (piece.winding.radius_m - 0.5 * groove.floor_m);
        let mut on_floor = 0;
        for half in shells(&piece, 5e-5).unwrap() {
            for point in &half.points_m {
                let radius = point[0].hypot(point[1]);
                let place = [point[1].atan2(point[0]), point[2]];
                let offs = piece.winding.hands.iter().map(|hand| off_thread_m(&piece, *hand, place));
                let off = offs.fold(f64::INFINITY, f64::min);
                // Corners were moved onto cuts by up to 0.2 % of a cell.
                let slack = 0.02 * groove.floor_m;
                if (1e3 * radius - floor_mm).abs() < 1e-9 {
                    on_floor += 1;
                    assert!(off <= 0.5 * groove.floor_m + slack, "the floor is {off} m off the thread");
                } else if (radius - piece.cast_radius_m).abs() < 1e-12 {
                    assert!(off >= 0.5 * groove.top_m - slack, "no groove {off} m off the thread");
                }
                assert!(1e3 * radius > floor_mm - 1e-9, "nothing is below the floor");
            }
        }
        assert!(on_floor > 20, "a groove");
    }
}

#[test]
fn part_of_too_many_triangles_is_refused() {
    let piece = Tube { angle_deg: 1.0, length_mm: 2000.0, ..TUBE }.piece(0.18, 0.8).unwrap();
    let error = shells(&piece, 1e-6).unwrap_err();
    assert_eq!((error.field, error.value), ("chord_m", 1e-6));
    assert!(error.to_string().contains("million triangles"), "{error}");
}
