//! The static page: self-contained, well-formed, and without NaN or infinity.

use softlimb_rig::record::RunLog;
use softlimb_rig::report::still_html as html;

/// Everything between `open` and the next `close`, for each `open`.
fn between<'a>(text: &'a str, open: &str, close: &str) -> Vec<&'a str> {
    text.split(open).skip(1).map(|rest| rest.split(close).next().unwrap()).collect()
}

fn drawings(page: &str) -> Vec<&str> {
    between(page, "<svg", "</svg>")
}

/// Every number of every attribute that places something.
fn placements(page: &str) -> Vec<String> {
    let attributes = [" d=\"", " x=\"", " y=\"", " width=\"", " height=\"", " viewBox=\""];
    let texts = drawings(page).into_iter().flat_map(|svg| attributes.map(|name| between(svg, name, "\"")));
    let split = |text: &str| {
        text.split(|c: char| c.is_ascii_whitespace() || "MLHVh".contains(c)).map(str::to_owned).collect::<Vec<_>>()
    };
    texts.flatten().flat_map(split).filter(|number| !number.is_empty()).collect()
}

fn assert_sound(page: &str) {
    assert!(drawings(page).len() >= 5, "{} drawings", drawings(page).len());
    for number in placements(page) {
        let value: f64 = number.parse().unwrap_or_else(|_| panic!("{number:?} is no number"));
        assert!(value.is_finite() && value.abs() < 1e5, "{number:?}");
    }
    for svg in drawings(page) {
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert_balanced(svg);
    }
}

/// Every element that opens closes, in order. `svg` begins inside its own open tag.
fn assert_balanced(svg: &str) {
    let mut open = Vec::new();
    for tag in between(&svg[svg.find('>').unwrap()..], "<", ">") {
        let name = tag.split_whitespace().next().unwrap();
        match name.strip_prefix('/') {
            Some(closed) => assert_eq!(open.pop(), Some(closed), "{tag}"),
            None if tag.ends_with('/') => {}
            None => open.push(name),
        }
    }
    assert!(open.is_empty(), "{open:?} stay open");
}

#[test]
fn page_shows_every_module_and_needs_nothing_else() {
    let page = html(&crate::synthetic_run::run());
    assert_sound(&page);
    // Two tip views, two error charts, deformation and pressures of three modules, supply.
    assert_eq!(drawings(&page).len(), 2 + 2 + 3 + 3 + 1);
    for title in ["proximal: extension", "elbow: bending", "distal: pressures", "Tip error", "Supply"] {
        assert!(page.contains(&format!("aria-label=\"{title}\"")), "{title}");
    }
    for text in ["18446744073709551615", "e3069283", "000000ff", "implausible", "15.00", "real-time factor 80.0"] {
        assert!(page.contains(text), "{text}");
    }
    for outside in ["<script", "http:", "https:", "src=", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert_eq!(between(&page, "href=\"", "\""), ["#faults"]);
    assert!(page.len() < 400_000, "{} bytes", page.len());
}

#[test]
fn text_from_outside_is_escaped() {
    let mut run = crate::synthetic_run::run();
    let hostile = "</pre><script>alert(\"1\")</script> & 'x'\u{7}";
    run.info.scene_name = hostile.into();
    run.info.scene_text = hostile.into();
    run.info.tool_version = hostile.into();
    run.info.modules[0].name = hostile.into();
    run.info.modules[1].motion = hostile.into();
    run.info.phases[0].name = hostile.into();
    run.faults[0].text = hostile.into();
    run.incomplete = Some(hostile.into());
    let page = html(&run);
    assert!(!page.contains("<script"));
    assert_eq!(page.matches("</pre>").count(), 1);
    assert!(!drawings(&page).iter().any(|svg| svg.contains('\u{7}')));
    assert_sound(&page);
}

#[test]
fn drawings_are_whole_for_any_values_of_a_log() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 0.0] {
        let mut run = crate::synthetic_run::run();
        for sample in run.samples.iter_mut().skip(100).step_by(7) {
            sample.supply_pa = bad;
            sample.modules[0].setpoint = bad;
            sample.modules[1].achieved = Some(bad);
            sample.channels[2].pressure_pa = bad;
            sample.channels[5].reference_pa = bad;
            sample.tip_achieved_m = Some([bad, 0.0, bad]);
        }
        run.shapes[25].setpoint[3] = [bad; 3];
        run.faults[0].time_s = bad;
        run.info.phases[1].move_s = bad;
        assert_sound(&html(&run));
    }
}

#[test]
fn log_of_nothing_still_makes_a_page() {
    let mut run = crate::synthetic_run::run();
    run.samples.clear();
    run.shapes.clear();
    run.faults.clear();
    run.info.phases.clear();
    run.info.modules.clear();
    let page = html(&run);
    assert!(page.contains("No faults."));
    assert_sound(&page);
}

#[test]
fn targets_met_by_hand_are_told() {
    let run = crate::synthetic_run::run();
    for page in [html(&run), softlimb_rig::report::html(&run)] {
        let table = between(&page, "Targets met by hand", "</table>")[0];
        let numbers = |name: &str| {
            let row = between(table, &format!("<tr><td>{name}</td>"), "</tr>")[0];
            between(row, "<td class=\"number\">", "</td>").join(" ")
        };
        assert_eq!(numbers("lift"), "12.5 4.6 0.8");
        assert_eq!(numbers("place"), "not met never seen 0.0");
    }
    let run = RunLog { targets: Vec::new(), ..run };
    assert!(!html(&run).contains("Targets met by hand"));
}

#[test]
fn both_pages_begin_with_the_same_sentences() {
    let mut run = crate::synthetic_run::run();
    run.info.clearance_m = Some(0.02);
    let [still, moving] = [html(&run), softlimb_rig::report::html(&run)];
    let sentences = |page: &str| between(between(page, "<div class=\"verdict", "</div>")[0], "<p>", "</p>").join("\n");
    assert_eq!(sentences(&still), sentences(&moving));
    assert!(sentences(&still).contains("below the required 20.0\u{a0}mm"), "{}", sentences(&still));
    assert!(still.contains("<th>achieved clearance</th>") && still.contains(", below required</td>"));
}

#[test]
fn states_of_the_device_are_told() {
    let mut run = crate::synthetic_run::run();
    run.samples[0].state = 1;
    run.samples[1500..].iter_mut().for_each(|sample| sample.state = 3);
    assert!(html(&run).contains("Device: ready from 0.000 s, running from 0.010 s, holding from 15.000 s."));
}

#[test]
fn lone_samples_are_drawn_as_dots() {
    let mut run = crate::synthetic_run::run();
    run.samples.truncate(1);
    let page = html(&run);
    assert_sound(&page);
    assert!(drawings(&page).iter().filter(|svg| svg.contains("h0\"")).count() >= 8);
}

#[test]
fn unobserved_quantities_are_not_in_the_legend() {
    let legend = |run: &RunLog| between(&html(run), "class=\"legend\"", "</text>").join(" ");
    let mut run = crate::synthetic_run::run();
    assert!(legend(&run).contains(">achieved") && legend(&run).contains(">chamber"));
    for sample in &mut run.samples {
        sample.tip_achieved_m = None;
        sample.modules.iter_mut().for_each(|module| module.achieved = None);
        sample.channels.iter_mut().for_each(|channel| channel.true_pressure_pa = None);
    }
    run.shapes.iter_mut().for_each(|shape| shape.achieved = None);
    assert!(!legend(&run).contains("achieved") && !legend(&run).contains("chamber"));
}

/// Pixels per unit between the first and the last tick of an axis.
fn scale(svg: &str, class: &str, coordinate: &str) -> f64 {
    let ticks: Vec<(f64, f64)> = between(svg, &format!("class=\"{class}\""), "</text>")
        .into_iter()
        .map(|tick| {
            (
                between(tick, &format!(" {coordinate}=\""), "\"")[0].parse().unwrap(),
                tick.split('>').nth(1).unwrap().parse().unwrap(),
            )
        })
        .collect();
    let ((from, low), (to, high)) = (ticks[0], ticks[ticks.len() - 1]);
    (to - from).abs() / (high - low)
}

#[test]
fn tip_views_have_equal_axes_and_one_scale() {
    let page = html(&crate::synthetic_run::run());
    let views: Vec<_> = drawings(&page).into_iter().filter(|svg| svg.contains("view\"")).collect();
    assert_eq!(views.len(), 2);
    let scales: Vec<f64> =
        views.iter().flat_map(|svg| [scale(svg, "tick-x", "x"), scale(svg, "tick-y", "y")]).collect();
    for other in &scales {
        assert!((other / scales[0] - 1.0).abs() < 2e-3, "{scales:?}");
    }
}

#[test]
fn phases_are_bands_over_the_time_charts() {
    let page = html(&crate::synthetic_run::run());
    let tip_error = drawings(&page).into_iter().find(|svg| svg.contains("aria-label=\"Tip error\"")).unwrap();
    // Four phases, every second one shaded: 5 of 20 s each.
    let widths: Vec<f64> = between(tip_error, "class=\"band\"", "/>")
        .iter()
        .map(|band| between(band, " width=\"", "\"")[0].parse().unwrap())
        .collect();
    assert_eq!(widths, [172.5, 172.5]);
    for phase in ["reach", "grasp", "lift", "return"] {
        assert!(tip_error.contains(&format!(">{phase}</text>")), "{phase}");
    }
    assert_eq!(tip_error.matches("class=\"mark\"").count(), 1);
}

#[test]
fn views_of_obstacles_are_a_pair_a_phase_to_one_scale() {
    use softlimb_rig::record::{NearestInfo, SolidInfo};
    let mut run = crate::synthetic_run::run();
    assert!(!html(&run).contains("Among the obstacles"));
    let line = vec![[0.1, 0.2, 0.3], [0.15, 0.2, 0.3]];
    run.info.solids = vec![SolidInfo { name: "post".into(), region: false, lines_m: vec![line], shape: None }];
    let time_s = run.info.phases[1].start_s;
    run.info.phases[1].nearest = Some(NearestInfo { obstacle: "post".into(), distance_m: 0.012, time_s });
    let page = html(&run);
    assert_sound(&page);
    let views: Vec<_> = drawings(&page).into_iter().filter(|svg| svg.contains(", from the ")).collect();
    assert_eq!(views.len(), 2 * run.info.phases.len());
    for phase in &run.info.phases {
        assert!(views.iter().any(|svg| svg.contains(&format!("{}, from the side", phase.name))), "{}", phase.name);
    }
    // The limb at its nearest is drawn where it is known when that is: in one phase, from two sides.
    assert_eq!(views.iter().filter(|svg| svg.contains("planned, nearest")).count(), 2);
    assert!(page.contains("12.0\u{a0}mm from post"), "the table says how near");
    assert!(views.iter().all(|svg| svg.contains(">post</text>")), "the obstacle has its name");
    let scales: Vec<f64> =
        views.iter().flat_map(|svg| [scale(svg, "tick-x", "x"), scale(svg, "tick-y", "y")]).collect();
    assert!(scales.iter().all(|other| (other / scales[0] - 1.0).abs() < 2e-3), "{scales:?}");
}

/// Relative luminance of a color by WCAG 2.
fn luminance(hex: &str) -> f64 {
    let part = |at: usize| f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0;
    let linear = |part: f64| if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) };
    0.2126 * linear(part(1)) + 0.7152 * linear(part(3)) + 0.0722 * linear(part(5))
}

#[test]
fn lines_and_texts_have_the_contrast_of_aa_in_both_schemes() {
    let page = html(&crate::synthetic_run::run());
    let schemes = between(&page, ":root {", "}");
    assert_eq!(schemes.len(), 2, "light and dark");
    for scheme in schemes {
        let color = |name: &str| between(scheme, &format!("--{name}: "), ";")[0];
        for ground in ["page", "band"].map(|name| luminance(color(name))) {
            for name in ["ink", "soft", "mark", "c1", "c2", "c3", "c4"] {
                let [low, high] = [luminance(color(name)).min(ground), luminance(color(name)).max(ground)];
                let contrast = (high + 0.05) / (low + 0.05);
                // Texts stand on the page and on the bands; lines need 3 by WCAG, and have more.
                let needed = if name.starts_with('c') { 4.0 } else { 4.5 };
                assert!(contrast >= needed, "{name}: {contrast}");
            }
        }
    }
}

#[test]
fn measured_pressures_are_nested_and_equal_references_are_one_line() {
    let mut run = crate::synthetic_run::run();
    for sample in &mut run.samples {
        let reference_pa = sample.channels[0].reference_pa;
        sample.channels[..3].iter_mut().for_each(|channel| channel.reference_pa = reference_pa);
        sample.channels[4].reference_pa += 1e3;
    }
    let page = html(&run);
    assert_sound(&page);
    let charts = drawings(&page);
    let of = |title: &str| charts.iter().find(|svg| svg.contains(&format!("aria-label=\"{title}"))).unwrap();
    for (title, references) in [("proximal: pressures", 1), ("elbow: pressures", 3)] {
        let widths = between(of(title), "stroke-width:", "\"");
        // Three lines in the key and three in the chart, the widest first.
        assert_eq!(widths, ["5.5", "3.5", "1.5", "5.5", "3.5", "1.5"], "{title}");
        assert_eq!(of(title).matches(">reference").count(), references, "{title}");
    }
}
