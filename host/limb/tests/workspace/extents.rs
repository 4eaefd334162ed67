//! Extents against closed forms, dense scans and another search.

use fra_model::Load;
use softlimb_limb::workspace::{Command, Workspace, extents};

use crate::workspace::{Stream, limb_of, limb_with};

#[test]
fn extending_actuator_reaches_from_rest_to_its_longest() {
    let limb = limb_with(&[("extension", 1, "")]);
    let space = Workspace::new(&limb, Command::Actuators).expect("a workspace");
    let found = extents(&space).expect("extents");
    let module = &limb.modules()[0];
    let most = module.actuator.forward(module.curve.pressure_max_pa(), &Load::none()).expect("finite").state;
    let [least, largest] = &found.of[2];
    assert!((least.value_m - 0.24).abs() < 1e-12, "{}", least.value_m);
    assert!((largest.value_m - 0.24 * most.axial_stretch).abs() < 1e-12);
    assert!(found.range_m(0) < 1e-12 && found.range_m(1) < 1e-12);
}

/// Two arcs in a plane, all pressures of a fine lattice.
#[test]
fn workspace_of_two_bends_is_the_lattice_of_their_arcs() {
    let limb = limb_with(&[("bending", 3, ""), ("bending", 3, "mount_angle = \"180 deg\"")]);
    let space = Workspace::new(&limb, Command::Actuators).expect("a workspace");
    let found = extents(&space).expect("extents");
    let count = 400;
    let arcs: Vec<(f64, f64, f64)> = (0..=count)
        .map(|i| {
            let module = &limb.modules()[0];
            let pressure_pa = module.curve.pressure_max_pa() * f64::from(i) / f64::from(count);
            let state = module.actuator.forward(pressure_pa, &Load::none()).expect("finite").state;
            let (angle, length) = (state.bend_angle_rad, 0.24 * state.axial_stretch);
            let chord = |f: fn(f64) -> f64, small: f64| if angle > 1e-9 { length * f(angle) / angle } else { small };
            (angle, chord(|a| 1.0 - a.cos(), 0.0), chord(f64::sin, 0.24))
        })
        .collect();
    let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for (angle, x, z) in &arcs {
        for (_, back, on) in &arcs {
            // The second bends back: its own x points the other way.
            let tip = [x - angle.cos() * back + angle.sin() * on, z + angle.sin() * back + angle.cos() * on];
            for (end, value) in ends.iter_mut().zip(tip) {
                *end = [end[0].min(value), end[1].max(value)];
            }
        }
    }
    for (index, axis) in [(0, 0), (1, 2)] {
        let range = ends[index][1] - ends[index][0];
        for side in [0, 1] {
            let sign = if side == 0 { -1.0 } else { 1.0 };
            let beyond = sign * (found.of[axis][side].value_m - ends[index][side]);
            // A lattice can only miss; its step costs at most 3 mm, at an extreme inside the box far less.
            assert!((-1e-7 * range..2e-3 * range).contains(&beyond), "axis {axis} side {side}: {beyond:e} m");
        }
    }
}

/// Random places and a search that moves one pressure at a time, from each of them.
#[test]
fn no_other_search_gets_beyond_the_extents() {
    for name in ["weightless-a", "weightless-b", "weightless-c"] {
        let (_, limb) = limb_of(name);
        for command in [Command::Actuators, Command::Modules] {
            let space = Workspace::new(&limb, command).expect("a workspace");
            let found = extents(&space).expect("extents");
            let base = space.base();
            let value = |shares: &[f64], index: usize| {
                let tip = space.tip(shares);
                let square = |axis: usize| (tip[axis] - base[axis]).powi(2);
                if index < 3 { tip[index] } else { (0..3).map(square).sum::<f64>().sqrt() }
            };
            let mut stream = Stream(11);
            for (index, pair) in found.of.iter().enumerate() {
                for (side, reach) in pair.iter().enumerate() {
                    let sign = if side == 0 { -1.0 } else { 1.0 };
                    let mut best = f64::NEG_INFINITY;
                    for _ in 0..25 {
                        best = best.max(pattern_search(&mut stream, space.axes().len(), |s| sign * value(s, index)));
                    }
                    let beyond = best - sign * reach.value_m;
                    assert!(
                        beyond < 1e-4 * found.range_m(index).max(1e-3),
                        "{name} {command:?} {index} {side}: {beyond:e}"
                    );
                    assert!(reach.table_error_m < 2e-7, "{:e}", reach.table_error_m);
                    assert!(sign * (reach.value_m - reach.corner_m) > -1e-6, "an ascent never loses");
                }
            }
        }
    }
}

fn pattern_search(stream: &mut Stream, axes: usize, value: impl Fn(&[f64]) -> f64) -> f64 {
    let mut at: Vec<f64> = (0..axes).map(|_| (3.0 * stream.next() - 1.0).clamp(0.0, 1.0)).collect();
    let (mut best, mut step) = (value(&at), 0.3);
    while step > 1e-4 {
        let mut moved = false;
        for axis in 0..axes {
            for sign in [1.0, -1.0] {
                let before = at[axis];
                at[axis] = (before + sign * step).clamp(0.0, 1.0);
                let now = value(&at);
                if now > best {
                    (best, moved) = (now, true);
                } else {
                    at[axis] = before;
                }
            }
        }
        step *= if moved { 1.0 } else { 0.5 };
    }
    best
}
