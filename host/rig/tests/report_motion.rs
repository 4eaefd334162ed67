//! The animated picture of a run shows what the log holds.

use softlimb_rig::record::{Body, CarriedInfo, FaultRecord, RunLog, SolidInfo, SolidShape};
use softlimb_rig::report::motion_svg;

use crate::synthetic_run;

/// Height of the view, rad.
const ELEVATION: f64 = 0.35;
/// Code of a payload that was dropped.
const DROPPED: u8 = 243;

/// A limb of two tubes and a rigid end, upright on its base, that grows by 0.1 m in 10 s.
fn growing() -> RunLog {
    let mut run = synthetic_run::run();
    run.faults.clear();
    let body = |step: u32| {
        let time_s = 0.1 * f64::from(step);
        let top = 0.4 + 0.01 * time_s;
        let heights = [0.0, 0.1, 0.2, 0.2, 0.3, top, top, top + 0.05];
        Body {
            time_s,
            line_m: heights.map(|height| [0.0, 0.0, height]).to_vec(),
            radius_m: vec![0.05, 0.05, 0.05, 0.03, 0.03, 0.03, 0.02, 0.02],
            nearest: None,
            tip_unloaded_m: None,
        }
    };
    run.bodies = (0..=100).map(body).collect();
    run.info.solids.clear();
    run.info.carried.clear();
    run
}

/// The values of an animated attribute, in the order of the text.
fn values<'a>(svg: &'a str, attribute: &str) -> Vec<Vec<&'a str>> {
    let name = format!("attributeName=\"{attribute}\"");
    let parts = svg.split(name.as_str()).skip(1);
    parts.map(|part| part.split("values=\"").nth(1).unwrap().split('"').next().unwrap().split(';').collect()).collect()
}

fn points(text: &str) -> Vec<[f64; 2]> {
    let point = |pair: &str| {
        let (x, y) = pair.split_once(',').unwrap();
        [x.parse().unwrap(), y.parse().unwrap()]
    };
    text.split(' ').map(point).collect()
}

#[test]
fn lengths_of_the_limb_are_those_of_the_log_seen_from_above() {
    let svg = motion_svg(&growing()).unwrap();
    let parts = values(&svg, "points");
    assert_eq!(parts.len(), 3, "two tubes and a rigid end");
    let height = |frame: usize, part: usize| {
        let line = points(parts[part][frame]);
        assert!(line.iter().all(|[x, _]| (x - line[0][0]).abs() < 0.11), "an upright limb is upright: {line:?}");
        line[0][1] - line[line.len() - 1][1]
    };
    let px_per_m = height(0, 0) / (0.2 * ELEVATION.cos());
    let last = parts[0].len() - 1;
    for (frame, part, length_m) in [(last, 0, 0.2), (0, 1, 0.2), (last, 1, 0.3), (0, 2, 0.05), (last, 2, 0.05)] {
        let expected = length_m * ELEVATION.cos() * px_per_m;
        assert!((height(frame, part) - expected).abs() < 0.3, "{frame} {part}: {} {expected}", height(frame, part));
    }
    // A tube is as wide as it is.
    let widths: Vec<f64> = svg
        .split("class=\"tube edge\" stroke-width=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap().parse().unwrap())
        .collect();
    assert!((widths[0] - 0.1 * px_per_m).abs() < 0.15 && (widths[1] - 0.06 * px_per_m).abs() < 0.15, "{widths:?}");
}

#[test]
fn object_follows_the_tip_while_it_is_held_and_vanishes_where_it_is_lost() {
    let mut run = growing();
    let object = |from_s, to_s| CarriedInfo {
        name: "cup".into(),
        radius_m: 0.02,
        above_m: 0.01,
        below_m: 0.05,
        start_m: None,
        from_s,
        to_s,
    };
    run.info.carried = vec![object(2.0, Some(6.0))];
    let svg = motion_svg(&run).unwrap();
    let places: Vec<[f64; 2]> = values(&svg, "transform")[0].iter().map(|place| points(place)[0]).collect();
    let tips: Vec<[f64; 2]> = values(&svg, "points")[2].iter().map(|line| *points(line).last().unwrap()).collect();
    let last = places.len() - 1;
    let frame = |time_s: f64| (0.1 * time_s * last as f64).round() as usize;
    let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 0.11 && (a[1] - b[1]).abs() < 0.11;
    assert!(near(places[0], places[frame(1.5)]) && near(places[frame(4.0)], tips[frame(4.0)]));
    assert!(
        near(places[frame(6.5)], places[last]) && !near(places[last], tips[last]) && !near(places[0], places[last])
    );
    assert!(values(&svg, "opacity")[0].iter().all(|seen| *seen == "1"));
    run.faults.push(FaultRecord { code: DROPPED, time_s: 5.0, ..synthetic_run::run().faults[0].clone() });
    let svg = motion_svg(&run).unwrap();
    let seen = values(&svg, "opacity");
    assert_eq!((seen[0][frame(4.5)], seen[0][frame(5.5)], seen[0][last]), ("1", "0", "0"));
}

#[test]
fn picture_is_whole_for_any_values_of_a_log() {
    let sphere = Some(SolidShape::Sphere { center_m: [0.3, 0.0, 0.1], radius_m: 0.05 });
    let hostile = "</style><script>alert(\"1\")</script> & 'x'";
    for bad in [f64::NAN, f64::INFINITY, f64::MAX] {
        let mut run = growing();
        run.info.scene_name = hostile.into();
        run.info.phases[0].name = hostile.into();
        run.info.solids = vec![SolidInfo {
            name: hostile.into(),
            region: false,
            lines_m: vec![vec![[0.3, 0.0, 0.15]]],
            shape: sphere,
        }];
        run.bodies[25].line_m[3] = [bad; 3];
        run.bodies[26].line_m.pop();
        run.bodies[27].radius_m[2] = bad;
        run.info.phases[1].move_s = bad;
        let svg = motion_svg(&run).unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf") && !svg.contains("<script"), "{bad}");
        let frames: Vec<usize> = values(&svg, "points").iter().map(Vec::len).collect();
        assert!(frames.iter().all(|count| *count == frames[0] && *count >= 60), "{frames:?}");
    }
    let mut run = growing();
    run.info.weightless = true;
    assert!(motion_svg(&run).unwrap().contains("synthetic-limb, weightless"));
    run.bodies.clear();
    assert_eq!(motion_svg(&run), None);
}
