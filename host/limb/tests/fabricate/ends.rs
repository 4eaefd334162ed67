//! Caps, ports, plates and bases: closed surfaces with the volumes of their closed forms.

use std::f64::consts::{PI, TAU};

use softlimb_limb::fabricate::mold::{
    CAP_M, FIT_M, HOLD_M, NIPPLE_M, RECESS_M, SOCKET_M, SPIGOT_M, base, base_radius_m, cap, connector, connector_m,
    connector_radius_m, nipple_m, port, shell_radius_m,
};
use softlimb_limb::fabricate::{Piece, Settings, plan};

use crate::fabricate::common::{TUBE, Tube};
use crate::fabricate::surface::Surface;

const CHORD_M: f64 = 2e-6;

fn fine() -> Settings {
    Settings { chord_m: CHORD_M, ..Settings::default() }
}

fn disk(outer_m: f64, inner_m: f64) -> f64 {
    PI * (outer_m * outer_m - inner_m * inner_m)
}

fn assert_volume(found_m3: f64, exact_m3: f64, surface_m2: f64) {
    assert!((found_m3 - exact_m3).abs() <= CHORD_M * surface_m2, "{found_m3:e} in place of {exact_m3:e} m3");
}

#[test]
fn turned_parts_have_the_volume_of_disks_and_rings() {
    for tube in [TUBE, Tube { inner_mm: 2.0, outer_mm: 4.0, winding_mm: 3.5, ..TUBE }] {
        let piece = tube.piece(0.5, 4.0).unwrap();
        let (inner, outer) = (piece.parameters.inner_radius_m, piece.parameters.outer_radius_m);
        let solid = disk(outer, 0.0) * CAP_M + disk(inner, 0.0) * SPIGOT_M;
        assert_volume(cap(&piece, CHORD_M).volume_m3(), solid, TAU * outer * 0.02);
        let [nipple, barb, bore] = nipple_m(&piece, &fine());
        assert!(bore < nipple && nipple < barb && barb < inner);
        // Frustums from the tip to the barb, and from there to the nipple.
        let frustum = |a: f64, b: f64, height: f64| PI * height * (a * a + a * b + b * b) / 3.0;
        let outside = frustum(nipple, barb, 0.2 * NIPPLE_M)
            + frustum(barb, nipple, 0.05 * NIPPLE_M)
            + disk(nipple, 0.0) * 0.75 * NIPPLE_M;
        let exact = solid + outside - disk(bore, 0.0) * (NIPPLE_M + CAP_M + SPIGOT_M);
        assert_volume(port(&piece, &fine()).unwrap().volume_m3(), exact, TAU * outer * 0.04);
        let bore_m = piece.cast_radius_m;
        let exact = disk(base_radius_m(bore_m), inner + FIT_M) * HOLD_M
            + disk(base_radius_m(bore_m), shell_radius_m(bore_m) + FIT_M) * RECESS_M;
        assert_volume(base(&piece, bore_m, CHORD_M).volume_m3(), exact, TAU * base_radius_m(bore_m) * 0.08);
    }
}

/// Actuators side by side, apart and alone.
fn shipped() -> Vec<Piece> {
    let pieces = ["pick-and-place-a", "weightless-a", "finger", "steering"].into_iter().map(|name| {
        let scene = softlimb_scene::load(format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))).unwrap();
        plan(&scene, &Settings::default()).unwrap()
    });
    pieces.flatten().collect()
}

#[test]
fn plates_are_closed_and_have_sockets_and_holes() {
    let (mut most, mut flat) = (0, 0);
    for piece in shipped() {
        let settings = fine();
        let mesh = connector(&piece, &settings);
        let name = format!("plate of {} with {} actuators", piece.name, piece.copies.len());
        let surface = Surface::read(&mesh.stl());
        surface.assert_closed(&name, piece.copies.len());
        let (radius, thickness, count) = (connector_radius_m(&piece), connector_m(&piece), piece.copies.len() as f64);
        let socket = piece.parameters.outer_radius_m + FIT_M;
        let hole = nipple_m(&piece, &settings)[1] + FIT_M;
        let plain = disk(radius, 0.0) * thickness - count * disk(hole, 0.0) * thickness;
        let sunk = plain - count * disk(socket, hole) * SOCKET_M;
        let volume = mesh.volume_m3();
        let slack = CHORD_M * TAU * (radius + count * socket) * (thickness + radius);
        let has_sockets = (volume - sunk).abs() < slack;
        assert!(has_sockets || (volume - plain).abs() < slack, "{name}: {volume:e}, {sunk:e}, {plain:e}");
        most = most.max(piece.copies.len());
        flat += usize::from(!has_sockets);
        assert!(thickness >= 0.5 * piece.connector_m);
    }
    println!("up to {most} actuators, {flat} plates without sockets");
    assert!(most >= 3);
}

#[test]
fn hose_wider_than_the_chamber_is_refused() {
    let piece = TUBE.piece(0.5, 4.0).unwrap();
    let error = port(&piece, &Settings { hose_m: Some(0.018), ..fine() }).unwrap_err();
    assert_eq!((error.field, error.value), ("hose_m", 0.018));
    assert!(error.to_string().contains("0.01739"), "{error}");
}
