//! The interactive page: self-contained, small, and with the numbers of its log. `tests/browser` opens it in a browser.

use std::io::Read;

use flate2::read::GzDecoder;
use serde_json::Value;
use softlimb_numerics::Random;
use softlimb_rig::record::{
    Body, CarriedInfo, ModuleInfo, NearestInfo, Observer, RunLog, Sample, SolidInfo, SolidShape, SwingInfo,
};
use softlimb_rig::report::html;

use crate::synthetic_run;

/// The text of an inert script.
fn inert<'a>(page: &'a str, id: &str) -> &'a str {
    let (_, rest) = page.split_once(&format!("id=\"{id}\">")).unwrap_or_else(|| panic!("the page has {id}"));
    rest.split_once("</script>").unwrap().0
}

/// The page without what it carries for others: our markup and scripts.
fn own(page: &str) -> String {
    let carried = ["plotly", "numbers"].map(|id| inert(page, id));
    carried.into_iter().fold(page.to_owned(), |page, text| page.replace(text, ""))
}

/// RFC 4648, digit by digit.
fn from_base64(text: &str) -> Vec<u8> {
    let digit = |letter: u8| match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        other => panic!("{other} is no digit"),
    };
    let (mut bits, mut held, mut bytes) = (0_u32, 0, Vec::new());
    for letter in text.trim().trim_end_matches('=').bytes() {
        bits = bits << 6 | u32::from(digit(letter));
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    bytes
}

fn inflated(page: &str, id: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    GzDecoder::new(&from_base64(inert(page, id))[..]).read_to_end(&mut bytes).unwrap();
    bytes
}

/// The columns of a page by table and name: values and their step.
fn columns(page: &str) -> Vec<(String, String, f64, Vec<f64>)> {
    let run: Value = serde_json::from_str(inert(page, "run")).unwrap();
    let bytes = inflated(page, "numbers");
    let (mut found, mut start) = (Vec::new(), 0);
    for table in run["tables"].as_array().unwrap() {
        let rows = table[1]["rows"].as_u64().unwrap() as usize;
        for column in table[1]["columns"].as_array().unwrap() {
            let (mut units, mut values) = (0_i64, Vec::new());
            let step = column["step"].as_f64().unwrap();
            for row in 0..rows {
                let planes: [u8; 4] = std::array::from_fn(|plane| bytes[start + plane * rows + row]);
                let code = i64::from(u32::from_le_bytes(planes));
                let difference = if code % 2 == 0 { code / 2 } else { -(code + 1) / 2 };
                // The differences wrap at 32 bits.
                units = i64::from((units + difference) as i32);
                values.push(if units == i64::from(i32::MIN) { f64::NAN } else { units as f64 * step });
            }
            start += 4 * rows;
            found.push((
                table[0].as_str().unwrap().to_owned(),
                column["name"].as_str().unwrap().to_owned(),
                step,
                values,
            ));
        }
    }
    assert_eq!(start, bytes.len(), "every byte is of a column");
    found
}

/// Whether a column has the values of a log.
fn assert_column(page: &str, table: &str, name: &str, expected: &[f64]) {
    let columns = columns(page);
    let column = columns.iter().find(|column| column.0 == table && column.1 == name);
    let (_, _, step, values) = column.unwrap_or_else(|| panic!("{table} has no {name}"));
    assert_eq!(values.len(), expected.len(), "{name}");
    for (value, expected) in values.iter().zip(expected) {
        let same = (value - expected).abs() <= 0.5001 * step || value.is_nan() && !expected.is_finite();
        assert!(same, "{table}.{name}: {value}, not {expected}");
    }
}

fn of_samples(run: &RunLog, value: impl Fn(&Sample) -> f64) -> Vec<f64> {
    run.samples.iter().map(value).collect()
}

#[test]
fn page_needs_nothing_else() {
    let page = html(&synthetic_run::run());
    let own = own(&page);
    for outside in ["http:", "https:", "src=", "@import", "url(", "fetch(", "import("] {
        assert!(!own.contains(outside), "{outside}");
    }
    let script = String::from_utf8(inflated(&page, "plotly")).unwrap();
    assert!(script.chars().take(200).collect::<String>().contains("plotly.js v"));
    assert!(!script.contains("</script"), "the script would end early");
    for text in ["18446744073709551615", "e3069283", "000000ff", "implausible", "real-time factor 80.0"] {
        assert!(own.contains(text), "{text}");
    }
}

#[test]
fn numbers_of_the_page_are_those_of_the_log() {
    let mut run = synthetic_run::run();
    run.samples[700].tip_achieved_m = None;
    run.samples[701].channels[7].pressure_pa = f64::NAN;
    run.samples[702].channels[7].pressure_pa = f64::INFINITY;
    let page = html(&run);
    assert_column(&page, "samples", "t", &of_samples(&run, |sample| sample.time_s));
    for channel in [0, 4, 7, 8] {
        let measured = of_samples(&run, |sample| sample.channels[channel].pressure_pa * 1e-3);
        let reference = of_samples(&run, |sample| sample.channels[channel].reference_pa * 1e-3);
        assert_column(&page, "samples", &format!("pressure_{channel}"), &measured);
        assert_column(&page, "samples", &format!("reference_{channel}"), &reference);
    }
    let bend_deg = |sample: &Sample| sample.modules[1].achieved.unwrap().to_degrees();
    assert_column(&page, "samples", "achieved_1", &of_samples(&run, bend_deg));
    let height_m = |sample: &Sample| sample.tip_achieved_m.map_or(f64::NAN, |tip| tip[2]);
    assert_column(&page, "samples", "tip_z", &of_samples(&run, height_m));
    let error_mm = |sample: &Sample| {
        let squares = sample
            .tip_achieved_m
            .map(|tip| (0..3).map(|axis| (tip[axis] - sample.tip_setpoint_m[axis]).powi(2)).sum::<f64>());
        squares.map_or(f64::NAN, |sum| 1e3 * sum.sqrt())
    };
    assert_column(&page, "samples", "error", &of_samples(&run, error_mm));
    let of_bodies = |value: fn(&Body) -> f64| run.bodies.iter().map(value).collect::<Vec<_>>();
    assert_column(&page, "bodies", "clearance", &of_bodies(|body| 1e3 * body.nearest.as_ref().unwrap().0));
    assert_column(&page, "bodies", "body_3_x", &of_bodies(|body| body.line_m[3][0]));
    assert_column(&page, "bodies", "radius_18", &of_bodies(|body| body.radius_m[18]));
    assert_column(&page, "lines", "set_9_y", &run.shapes.iter().map(|shape| shape.setpoint[9][1]).collect::<Vec<_>>());
}

/// The headings of the table of phases.
fn phase_headings(page: &str) -> Vec<&str> {
    let (_, rest) = page.split_once("<thead><tr><th>phase</th>").unwrap();
    let cells = rest.split_once("</thead>").unwrap().0.split("<th").skip(1);
    cells.map(|cell| cell.split_once('>').unwrap().1.split("</th>").next().unwrap()).collect()
}

#[test]
fn columns_of_phases_without_content_are_left_out() {
    let mut run = synthetic_run::run();
    let page = html(&run);
    let headings = phase_headings(&page);
    for heading in ["tip error, mm", "by pressure, mm", "by model, mm"] {
        assert!(headings.contains(&heading), "{heading} of {headings:?}");
    }
    for (feedback, corrections) in [(Some(Observer::Camera), false), (None, true)] {
        (run.info.feedback, run.info.corrections) = (feedback, corrections);
        let page = html(&run);
        let headings = phase_headings(&page);
        assert!(headings.contains(&"tip error, mm"), "{headings:?}");
        for heading in ["by pressure, mm", "by model, mm", "by sag, mm"] {
            assert!(!headings.contains(&heading), "{heading} of {headings:?}");
        }
        assert!(!page.contains("The causes add as vectors") && page.contains("not split into causes"));
    }
    // Nobody saw the limb.
    (run.info.feedback, run.info.corrections) = (None, false);
    run.samples.iter_mut().for_each(|sample| sample.tip_achieved_m = None);
    run.bodies.iter_mut().for_each(|body| body.tip_unloaded_m = None);
    let page = html(&run);
    let headings = phase_headings(&page);
    assert!(headings.contains(&"by pressure, mm"), "{headings:?}");
    assert!(!headings.contains(&"tip error, mm") && !headings.contains(&"by model, mm"), "{headings:?}");
    // Nothing then says whether corrected setpoints were right.
    run.info.corrections = true;
    let page = html(&run);
    assert!(page.contains("its error is unknown") && !page.contains("brought every module"), "{page}");
}

#[test]
fn lines_of_equal_pressures_leave_each_other_in_sight() {
    let page = html(&synthetic_run::run());
    let described: Value = serde_json::from_str(inert(&page, "run")).unwrap();
    let panels = described["panels"].as_array().unwrap().iter().filter(|panel| panel["section"] == "Pressures");
    let mut seen = 0;
    for panel in panels {
        let traces = panel["traces"].as_array().unwrap();
        for style in ["setpoint", "line"] {
            let drawn = traces.iter().filter(|trace| trace["style"] == style);
            let widths: Vec<f64> = drawn.map(|trace| trace["width"].as_f64().unwrap()).collect();
            assert_eq!(widths.len(), 3, "channels of a module");
            // Later lines lie on earlier ones: half a pixel of these stays in sight on both sides at least.
            assert!(widths.windows(2).all(|pair| pair[0] - pair[1] >= 1.0), "{widths:?}");
            seen += 1;
        }
    }
    assert_eq!(seen, 6);
}

#[test]
fn text_from_outside_is_escaped() {
    let mut run = synthetic_run::run();
    let plain = own(&html(&run)).matches("<script").count();
    let hostile = "</pre></script><script>alert(\"1\")</script> & 'x'";
    run.info.scene_name = hostile.into();
    run.info.scene_text = hostile.into();
    run.info.modules[0].name = hostile.into();
    run.info.phases[0].name = hostile.into();
    run.faults[0].text = hostile.into();
    run.incomplete = Some(hostile.into());
    run.info.solids = vec![SolidInfo { name: hostile.into(), region: false, lines_m: Vec::new(), shape: None }];
    let page = html(&run);
    assert_eq!(own(&page).matches("<script").count(), plain);
    assert!(!page.contains("alert(\"1\")</script>"));
    let parsed: Value = serde_json::from_str(inert(&page, "run")).unwrap();
    assert_eq!(parsed["phases"][0]["name"], hostile);
}

#[test]
fn page_is_whole_for_any_values_of_a_log() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN] {
        let mut run = synthetic_run::run();
        for sample in run.samples.iter_mut().skip(100).step_by(7) {
            sample.supply_pa = bad;
            sample.modules[1].achieved = Some(bad);
            sample.channels[2].pressure_pa = bad;
            sample.tip_achieved_m = Some([bad, 0.0, bad]);
        }
        run.shapes[25].setpoint[3] = [bad; 3];
        run.bodies[25].line_m[3] = [bad; 3];
        run.bodies[26].line_m.pop();
        run.faults[0].time_s = bad;
        run.info.phases[1].move_s = bad;
        run.info.phases[2].nearest = Some(NearestInfo { obstacle: "post".into(), distance_m: bad, time_s: bad });
        let page = html(&run);
        let supply =
            of_samples(&run, |sample| if sample.supply_pa.abs() > 1e9 { f64::NAN } else { sample.supply_pa * 1e-3 });
        assert_column(&page, "samples", "supply", &supply);
        assert!(!inert(&page, "run").contains("null"), "no number of the description is absent");
    }
}

#[test]
fn log_of_nothing_still_makes_a_page() {
    let mut run = synthetic_run::run();
    run.samples.clear();
    run.shapes.clear();
    run.bodies.clear();
    run.faults.clear();
    run.info.phases.clear();
    run.info.modules.clear();
    assert!(html(&run).contains("No faults."));
}

/// The sentences at the top.
fn verdict(run: &RunLog) -> Vec<String> {
    let page = html(run);
    let (_, rest) = page.split_once("<div class=\"verdict").unwrap();
    let (verdict, _) = rest.split_once("</div>").unwrap();
    let sentence = |line: &str| line.split("</p>").next().unwrap().replace("&#39;", "'").replace('\u{a0}', " ");
    verdict.split("<p>").skip(1).map(sentence).collect()
}

/// A run whose tip is off by 3 mm by pressure and by 4 mm across that by the model, and from 6 s on by half of both.
fn run_with_known_errors() -> RunLog {
    let mut run = synthetic_run::run();
    run.faults.clear();
    for sample in &mut run.samples {
        let [x, y, z] = sample.tip_setpoint_m;
        let scale = if sample.time_s < 6.0 { 1e-3 } else { 5e-4 };
        sample.tip_modelled_m = [x + 3.0 * scale, y, z];
        sample.tip_achieved_m = Some([x + 3.0 * scale, y + 4.0 * scale, z]);
        sample.modules.iter_mut().for_each(|module| module.modelled = module.setpoint);
    }
    run.bodies.iter_mut().for_each(|body| body.tip_unloaded_m = None);
    run.info.phases[1].nearest = Some(NearestInfo { obstacle: "post".into(), distance_m: 0.015, time_s: 8.8 });
    run.info.clearance_m = Some(0.01);
    run
}

#[test]
fn verdict_says_whether_why_and_how_close() {
    let run = run_with_known_errors();
    assert_eq!(
        verdict(&run),
        [
            "Hit all 4 goals: the tip ended at most 5.0 mm off (allowed 18.0 mm, 3 % of the limb's length).",
            "Farthest from its setpoint at the end of a phase: 5.0 mm at “reach”, 4.0 mm because the simulated limb differs from the model, 3.0 mm by pressure tracking; they add as vectors.",
            "Least clearance of the run: 12.0 mm from post at 9.00 s, above the required 10.0 mm; planned 15.0 mm.",
        ]
    );
    let mut on_a_bench = run.clone();
    on_a_bench.info.simulated = false;
    assert!(verdict(&on_a_bench)[1].contains("4.0 mm because the limb differs from its model"));
    let mut contact = run.clone();
    contact.bodies[100].nearest = Some((-0.002, "post".into()));
    let touched = "The limb touched an obstacle: 2.0 mm deep in post at 10.00 s; planned 15.0 mm, required 10.0 mm.";
    assert!(verdict(&contact)[0].contains(touched), "{:?}", verdict(&contact));
    let mut stopped = run.clone();
    stopped.samples.truncate(1201);
    assert_eq!(
        verdict(&stopped)[..2],
        [
            "The run ended at 12.00 s in phase “lift”: 2 of 4 phases finished, 2 at their goals.",
            "Until then the tip was at most 5.0 mm off its setpoint.",
        ]
    );
    let rows = html(&stopped);
    let goals = |goal: &str| rows.matches(&format!("<td>{goal}</td>")).count();
    assert_eq!((goals("hit"), goals("not finished"), goals("not begun")), (2, 1, 1));
    let mut near = run.clone();
    near.info.clearance_m = Some(0.013);
    assert!(html(&near).contains("class=\"verdict alarming\""), "12 mm are less than the 13 mm asked for");
    let headline = verdict(&near).remove(0);
    let violation = " Clearance 12.0 mm from post at 9.00 s, below the required 13.0 mm; planned 15.0 mm.";
    assert!(headline.starts_with("Hit all 4 goals: ") && headline.ends_with(violation), "{headline}");
    assert!(html(&near).contains("at 9.00\u{a0}s, below required</td>"), "the table marks the phase");
    near.info.clearance_m = Some(0.012_04);
    assert!(verdict(&near)[0].contains("12.0 mm from post at 9.00 s, below the required 12.040 mm"));
    // A plan that the run did not come to is no measure for it: the least of the plan is at 8.8 s.
    let mut early = run.clone();
    early.samples.truncate(701);
    early.bodies.retain(|body| body.time_s <= 7.0);
    let clearance = verdict(&early).into_iter().find(|text| text.starts_with("Least clearance"));
    assert!(clearance.is_none_or(|text| !text.contains("planned")), "{:?}", verdict(&early));
    let mut weightless = run.clone();
    weightless.info.weightless = true;
    assert!(verdict(&weightless)[3].starts_with("The run is weightless: "), "{:?}", verdict(&weightless));
    let mut missed = run.clone();
    let window = missed.samples.iter_mut().filter(|sample| (4.5..=5.0).contains(&sample.time_s));
    for sample in window {
        sample.modules[1].modelled *= 0.5;
        sample.modules[1].achieved = Some(sample.modules[1].modelled);
    }
    assert!(
        verdict(&missed)[0].starts_with("Module elbow missed its setpoint at the end of “reach” by "),
        "{:?}",
        verdict(&missed)
    );
    let faults = synthetic_run::run().faults;
    let mut faulty = run.clone();
    faulty.faults = faults;
    assert_eq!(
        verdict(&faulty)[3],
        "One fault: 12.340 s, channel 4: sensor of channel 4 implausible (code 1, value -7)."
    );
}

#[test]
fn tip_beyond_its_tolerance_or_its_region_is_a_miss() {
    let run = run_with_known_errors();
    assert!(!html(&run).contains("class=\"verdict alarming\""));
    let mut off = run.clone();
    let window = off.samples.iter_mut().filter(|sample| (9.5..=10.0).contains(&sample.time_s));
    for sample in window {
        let [x, y, z] = sample.tip_modelled_m;
        sample.tip_achieved_m = Some([x, y + 0.061, z]);
    }
    // The model is 1.5 mm off along x.
    assert_eq!(
        verdict(&off)[..2],
        [
            "Missed 1 of 4 goals: “grasp”, 61.0 mm off (allowed 18.0 mm, 3 % of the limb's length).",
            "Farthest from its setpoint at the end of a phase: 61.0 mm at “grasp”, 61.0 mm because the simulated limb differs from the model, 1.5 mm by pressure tracking; they add as vectors.",
        ]
    );
    let page = html(&off);
    assert!(page.contains("class=\"verdict alarming\""));
    let goals = |goal: &str| page.matches(&format!("<td>{goal}</td>")).count();
    assert_eq!((goals("hit"), goals("missed")), (3, 1));

    // Phases of one name are one entry, the farthest of them.
    let mut again = off.clone();
    again.info.phases[0].name = "grasp".into();
    let window = again.samples.iter_mut().filter(|sample| (4.5..=5.0).contains(&sample.time_s));
    for sample in window {
        let [x, y, z] = sample.tip_modelled_m;
        sample.tip_achieved_m = Some([x, y + 0.04, z]);
    }
    let limit = "(allowed 18.0 mm, 3 % of the limb's length)";
    let grouped = format!("Missed 2 of 4 goals: “grasp” 2 times, at most 61.0 mm off {limit}.");
    assert_eq!(verdict(&again)[0], grouped);
    assert!(html(&again).contains("<th class=\"number\">start, s</th>"), "starts tell phases of one name apart");
    again.info.phases[0].name = "reach".into();
    assert_eq!(verdict(&again)[0], format!("Missed 2 of 4 goals: “grasp”, 61.0 mm off; “reach”, 40.1 mm off {limit}."));
    assert!(page.contains("61.0\u{a0}mm off (allowed 18.0\u{a0}mm, 3\u{a0}% of"), "no line ends before a unit");

    // The gripper of the simulation takes its object there all the same.
    let mut carried = off.clone();
    carried.info.carried = vec![CarriedInfo {
        name: "bottle".into(),
        radius_m: 0.03,
        above_m: 0.05,
        below_m: 0.1,
        start_m: None,
        from_s: 8.0,
        to_s: None,
    }];
    carried.info.simulated = true;
    let expected = "The limb missed its goal in “grasp”, but “bottle” was still carried: a simulated gripper takes its object wherever it closes.";
    assert_eq!(verdict(&carried)[1], expected);
    let told = |run: &RunLog| html(run).matches("takes its object wherever it closes").count();
    assert_eq!(told(&carried), 1);
    carried.info.carried[0].from_s = 3.0;
    assert!(!verdict(&carried).iter().any(|text| text.contains("still carried")), "taken where the goal was hit");
    assert_eq!(told(&carried), 1, "below the table of phases");

    // Within a region the tip may be far from its setpoint.
    let mut within = off.clone();
    let at = within.samples.iter().rfind(|sample| sample.time_s <= 10.0).unwrap().tip_achieved_m.unwrap();
    let half_axes_m = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]];
    let shape = SolidShape::Box { center_m: at, half_axes_m };
    within.info.solids = vec![SolidInfo { name: "tray".into(), region: true, lines_m: Vec::new(), shape: Some(shape) }];
    within.info.phases[1].region = Some("tray".into());
    assert_eq!(
        verdict(&within)[0],
        "Hit all 4 goals: the tip ended at most 5.0 mm off (allowed 18.0 mm, 3 % of the limb's length)."
    );

    // A region of 0.2 m whose near face is 10 mm beyond the tip, which is 2 mm from its setpoint.
    let mut beside = run;
    let at = beside.samples.iter().rfind(|sample| sample.time_s <= 10.0).unwrap().tip_setpoint_m;
    let half_axes_m = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]];
    let shape = SolidShape::Box { center_m: [at[0], at[1] + 0.112, at[2]], half_axes_m };
    beside.info.solids = vec![SolidInfo { name: "tray".into(), region: true, lines_m: Vec::new(), shape: Some(shape) }];
    beside.info.phases[1].region = Some("tray".into());
    assert_eq!(verdict(&beside)[0], "Missed 1 of 4 goals: “grasp”, 10.0 mm outside of region “tray”.");
}

#[test]
fn unobserved_limb_is_said_to_be_unobserved() {
    let mut run = run_with_known_errors();
    run.bodies.clear();
    run.shapes.iter_mut().for_each(|shape| shape.achieved = None);
    for sample in &mut run.samples {
        sample.tip_achieved_m = None;
        sample.modules.iter_mut().for_each(|module| module.achieved = None);
    }
    let verdict = verdict(&run);
    assert_eq!(verdict[0], "The pressures brought every module to its setpoint. No observer measured the limb.");
    assert_eq!(
        verdict[1],
        "Least clearance of the run: 15.0 mm planned, from post at 8.80 s, required 10.0 mm; not observed."
    );
    let page = html(&run);
    assert!(
        page.contains("\"name\":\"required\",\"table\":\"planned\""),
        "the required clearance is a line of its own"
    );
    let unseen = [("samples", "error"), ("samples", "achieved_1"), ("samples", "by_model"), ("bodies", "clearance")];
    let columns = columns(&page);
    assert!(unseen.iter().all(|(table, name)| !columns.iter().any(|column| column.0 == *table && column.1 == *name)));
}

#[test]
fn swing_after_a_move_is_told_beside_the_predicted_one() {
    let mut run = run_with_known_errors();
    let swing = SwingInfo { residual_m: 0.0077, frequency_hz: 2.5 };
    run.info.phases.iter_mut().for_each(|phase| phase.swing = Some(swing));
    // The gripper excites a swing of its own; a hold of less than a period shows none.
    run.info.phases[1].gripper = Some("close".into());
    run.info.phases[3].hold_s = 0.3;
    // 3 mm that ring down by a tenth in a period, on a limb that creeps by 1 mm/s.
    for sample in &mut run.samples {
        let (time_s, [x, y, z]) = (sample.time_s, sample.tip_achieved_m.unwrap());
        for phase in &run.info.phases {
            let after_s = time_s - phase.hold_start_s();
            if (0.0..phase.hold_s).contains(&after_s) {
                let swing_m = 3e-3 * 0.9_f64.powf(2.5 * after_s) * (std::f64::consts::TAU * 2.5 * after_s).sin();
                sample.tip_achieved_m = Some([x, y, z + swing_m + 1e-3 * after_s]);
            }
        }
    }
    let page = html(&run);
    let rows: Vec<&str> = page.split("<tr><td>").filter(|row| row.contains("<td class=\"number\">7.7</td>")).collect();
    assert_eq!(rows.len(), 4, "every phase has the swing of the plan");
    let seen = |row: &str| {
        let (before, _) = row.split_once("</td><td class=\"number\">7.7</td>").unwrap();
        before.rsplit('>').next().unwrap().parse::<f64>().ok()
    };
    let seen: Vec<_> = rows.into_iter().map(seen).collect();
    assert!(seen[0].is_some_and(|mm| (mm - 3.1).abs() <= 0.3), "{seen:?}");
    assert!(seen[2].is_some_and(|mm| (mm - 3.1).abs() <= 0.3), "{seen:?}");
    assert_eq!((seen[1], seen[3]), (None, None));
}

/// A factor near 1 that never repeats: a run that did would be compressed too well.
fn drift(row: usize, index: usize) -> f64 {
    1.0 + 0.05 * (0.000_7 * row as f64 + index as f64).sin()
}

/// Five minutes at 50 Hz with noise of a sensor on 27 channels, and the solid of a limb of nine modules.
fn long_run() -> RunLog {
    let short = synthetic_run::run();
    let mut run = short.clone();
    let mut random = Random::new(1, 0);
    run.info.modules = (0..9)
        .map(|index| {
            let like = &short.info.modules[index % 3];
            ModuleInfo { name: format!("module-{index}"), channels: 3 * index..3 * index + 3, ..like.clone() }
        })
        .collect();
    run.samples = (0..15_000)
        .map(|row| {
            let mut sample = short.samples[(2 * row) % 2000].clone();
            sample.time_s = 0.02 * row as f64;
            sample.channels = (0..27).map(|channel| sample.channels[channel % 9]).collect();
            // A sensor's noise of some 30 Pa in steps of 10 Pa, as in the logs of simulated boards.
            for (index, channel) in sample.channels.iter_mut().enumerate() {
                let factor = drift(row, index);
                channel.reference_pa *= factor;
                channel.pressure_pa = ((factor * channel.pressure_pa + 30.0 * random.normal()) / 10.0).round() * 10.0;
            }
            sample.modules = (0..9).map(|module| sample.modules[module % 3]).collect();
            for (index, module) in sample.modules.iter_mut().enumerate() {
                let factor = drift(row, index);
                module.setpoint *= factor;
                module.modelled = factor * module.modelled + 1e-4 * random.normal();
                module.achieved = module.achieved.map(|value| factor * value + 1e-4 * random.normal());
            }
            sample.tip_setpoint_m = sample.tip_setpoint_m.map(|part| part * drift(row, 0));
            let tip = sample.tip_achieved_m.unwrap();
            sample.tip_achieved_m = Some(tip.map(|part| part * drift(row, 0) + 1e-4 * random.normal()));
            sample
        })
        .collect();
    let of_time = |time_s: f64| ((time_s % 20.0) / 0.1) as usize;
    run.bodies = (0..3000)
        .map(|row| {
            let mut body = short.bodies[of_time(0.1 * row as f64)].clone();
            body.time_s = 0.1 * row as f64;
            // 40 points, none of which moves like another.
            let point = |index: usize| body.line_m[index % 19].map(|part| part * drift(5 * row, index));
            body.line_m = (0..40).map(point).collect();
            body.radius_m = vec![0.03; 40];
            body
        })
        .collect();
    run.shapes = (0..1500)
        .map(|row| {
            let mut shape = short.shapes[of_time(0.2 * row as f64) / 2].clone();
            shape.time_s = 0.2 * row as f64;
            shape.setpoint.iter_mut().for_each(|point| *point = point.map(|part| part * drift(10 * row, 0)));
            shape
        })
        .collect();
    run.info.phases = (0..60)
        .map(|index| {
            let mut phase = short.info.phases[index % 4].clone();
            phase.start_s = 5.0 * index as f64;
            phase
        })
        .collect();
    run.info.solids = vec![SolidInfo {
        name: "post".into(),
        region: false,
        lines_m: vec![vec![[0.2, 0.0, -0.3], [0.2, 0.0, 0.0]]],
        shape: Some(SolidShape::Capsule { from_m: [0.2, 0.0, -0.3], to_m: [0.2, 0.0, 0.0], radius_m: 0.02 }),
    }];
    run.info.carried = vec![CarriedInfo {
        name: "bottle".into(),
        radius_m: 0.03,
        above_m: 0.05,
        below_m: 0.1,
        start_m: None,
        from_s: 10.0,
        to_s: Some(200.0),
    }];
    run
}

#[test]
fn five_minutes_of_27_channels_stay_small() {
    let page = html(&long_run());
    assert!(page.len() < 3_500_000, "{} bytes, {} of them numbers", page.len(), inert(&page, "numbers").len());
}
