//! What stands on a page: quantities in words.

use fra_model::{Material, Motion};

use super::mold::{CAP_M, HOLD_M, SPIGOT_M, connector_m, connector_radius_m, hose_m, nipple_m};
use super::sheet::{CopyRow, Page, Row, Table};
use super::winding::Worth;
use super::{Hand, Piece, SecondWinding, Settings, Thread, TubeSegment, Winding};

pub(super) fn page(piece: &Piece, settings: &Settings) -> Page {
    let copies = piece.copies.iter().map(|copy| {
        // Hundredths of a millimetre; adding 0 takes the sign of a zero.
        let [up, side] = copy.place_m.map(|m| (m * 1e5).round() / 1e2 + 0.0);
        CopyRow { channel: copy.channel, place: format!("{up:.2} mm towards up, {side:.2} mm to the side") }
    });
    let mut tables = vec![dimensions(piece, settings), winding(piece, settings)];
    tables.extend(piece.second.as_ref().map(|second| second_winding(second, settings)));
    tables.extend(worth(&piece.winding));
    tables.extend((piece.parameters.motion == Motion::Bending).then(|| layer(piece)));
    tables.push(elastomer(piece, settings));
    tables.extend(piece.has_ends().then(|| ends(piece, settings)));
    Page {
        module: piece.name.clone(),
        motion: piece.parameters.motion.name().to_owned(),
        count: piece.copies.len(),
        warnings: piece.warnings.clone(),
        tables,
        copies: copies.collect(),
        files: Vec::new(),
    }
}

fn row(what: &str, value: String, note: impl Into<String>) -> Row {
    Row { what: what.to_owned(), value, note: note.into() }
}

fn table(title: &str, rows: Vec<Row>) -> Table {
    Table { title: title.to_owned(), rows }
}

fn mm(value_m: f64) -> String {
    format!("{:.3} mm", value_m * 1e3)
}

fn dimensions(piece: &Piece, settings: &Settings) -> Table {
    let p = &piece.parameters;
    let tolerances = &settings.tolerances;
    // Both radii together make the wall.
    let radius = format!("± {}", mm(0.5 * tolerances.wall_m));
    let mut rows = vec![
        row("inner radius (core)", mm(p.inner_radius_m), radius.clone()),
        row("outer radius", mm(p.outer_radius_m), radius),
        row("wall", mm(piece.wall_m()), format!("± {}", mm(tolerances.wall_m))),
        row(
            if piece.segment.is_some() { "length of the segment" } else { "length between the caps" },
            mm(p.length_m),
            "shells are as long".to_owned(),
        ),
        row("core", mm(piece.tube_m() + 2.0 * HOLD_M), format!("{} beyond the shells on either side", mm(HOLD_M))),
        row("outer radius of the first cast", mm(piece.cast_radius_m), "carries the groove"),
    ];
    if let Some(TubeSegment { number, count, start_m, tube_m }) = piece.segment {
        rows.insert(0, row("segment", format!("{number} of {count}"), "one core, shells end to end, cast at once"));
        let place = format!("{} to {}", mm(start_m), mm(start_m + p.length_m));
        rows.insert(1, row("place on the tube, from its near end", place, format!("of {}", mm(tube_m))));
    }
    if piece.cover_m() > 1e-9 {
        rows.push(row("cover, cast over the winding", mm(piece.cover_m()), "second cast"));
    }
    table("Dimensions at rest", rows)
}

/// Caps, hose and plates.
fn ends(piece: &Piece, settings: &Settings) -> Table {
    let [_, barb_m, bore_m] = nipple_m(piece, settings);
    let two_m = 2.0 * connector_m(piece);
    let rows = vec![
        row(
            "caps: disk, spigot",
            format!("{}, {}", mm(CAP_M), mm(SPIGOT_M)),
            "glued into the chamber, port at the near end",
        ),
        row(
            "hose: inner diameter",
            mm(hose_m(piece, settings)),
            format!("bore {}, barb {}", mm(2.0 * bore_m), mm(2.0 * barb_m)),
        ),
        row("connector plate: radius", mm(connector_radius_m(piece)), "one at each end of the module"),
        row(
            "connector plate: thickness",
            mm(connector_m(piece)),
            format!("two back to back: {}; the scene's connector: {}", mm(two_m), mm(piece.connector_m)),
        ),
    ];
    table("Ends", rows)
}

fn winding(piece: &Piece, settings: &Settings) -> Table {
    let groove = &piece.groove;
    let mut rows = winding_rows(&piece.winding, piece.thread, settings);
    rows.push(row(
        "groove: depth, floor, top",
        format!("{:.3}, {:.3}, {:.3} mm", groove.depth_m * 1e3, groove.floor_m * 1e3, groove.top_m * 1e3),
        format!("leaves {} of wall", mm(piece.below_groove_m())),
    ));
    if piece.segment.is_some() {
        rows.push(row("ends of the thread", "tied".to_owned(), "at both ends of the segment; the next has its own"));
    }
    table("Winding", rows)
}

fn second_winding(second: &SecondWinding, settings: &Settings) -> Table {
    let mut rows = winding_rows(&second.winding, second.thread, settings);
    rows.push(row("groove", "none".to_owned(), "laid on the first cast, over the first winding"));
    table("Second winding", rows)
}

fn winding_rows(winding: &Winding, thread: Thread, settings: &Settings) -> Vec<Row> {
    let tolerance = settings.tolerances.angle_rad;
    let hands: Vec<_> = winding.hands.iter().map(|hand| hand_word(*hand)).collect();
    let mut rows = vec![
        row("thread", format!("{} thick", mm(thread.diameter_m)), format!("E A {} N", thread.stiffness_n)),
        row("radius of its centre line", mm(winding.radius_m), ""),
        row(
            "angle from the hoop",
            format!("{:.3} deg", winding.angle_rad.to_degrees()),
            format!("± {:.2} deg", tolerance.to_degrees()),
        ),
        row("hands", hands.join(", "), "right: as a common screw"),
        row("threads side by side, each hand", winding.starts.to_string(), starts_note(winding)),
    ];
    if !winding.is_straight() {
        rows.push(row(
            "pitch of one thread",
            mm(winding.lead_m()),
            format!("2 π R tan a; {}", pitch_range(winding, tolerance)),
        ));
        rows.push(row("turns of one thread", format!("{:.3}", winding.turns()), ""));
        let note = if winding.hands.len() > 1 { "both hands" } else { "" };
        rows.push(row("one turn to the next along the axis", mm(winding.turn_spacing_m()), note));
    }
    rows.push(row("threads of one hand, measured across", mm(winding.spacing_m()), ""));
    rows.push(row("length of one thread", format!("{:.4} m", winding.thread_m()), "without its ends"));
    let all = winding.all_threads_m();
    rows.push(row("thread in all, per actuator", format!("{all:.3} m"), format!("{} threads", winding.threads())));
    rows
}

fn hand_word(hand: Hand) -> &'static str {
    match hand {
        Hand::Right => "right",
        Hand::Left => "left",
        Hand::Straight => "along the axis",
    }
}

fn starts_note(winding: &Winding) -> String {
    if winding.starts == 1 {
        return "from the direction of bending, 0 deg".to_owned();
    }
    format!("{:.3} deg apart around, the first at 0 deg", 360.0 / f64::from(winding.starts))
}

/// The pitch at the ends of the angle's tolerance.
fn pitch_range(winding: &Winding, tolerance_rad: f64) -> String {
    let pitch = |angle: f64| Winding { angle_rad: angle, ..winding.clone() }.lead_m();
    let [low, high] = [-1.0, 1.0].map(|sign| winding.angle_rad + sign * tolerance_rad);
    let high = if high < std::f64::consts::FRAC_PI_2 { mm(pitch(high)) } else { "any".to_owned() };
    format!("{} to {high} within the tolerance", mm(pitch(low.max(0.0))))
}

fn worth(winding: &Winding) -> Option<Table> {
    let worth: &Worth = winding.worth.as_ref()?.as_ref().ok()?;
    let per_mm = |n_per_m: f64| format!("{:.2} N/mm", n_per_m * 1e-3);
    let mut rows = vec![
        row(
            "stiffness of the thread in the wall",
            per_mm(worth.effective_n_per_m),
            "the elastomer gives way between turns: by finite elements of one turn",
        ),
        row(
            "stiffness of the thread alone",
            per_mm(worth.ideal_n_per_m),
            "spread evenly over the wall: E A/(4 distance)",
        ),
        row(
            "strain that the distance takes away",
            format!("{:.1} %", 100.0 * worth.strain_lost),
            "at 0.3 of the highest pressure",
        ),
    ];
    if let Some(scene) = worth.scene_n_per_m {
        let of = if worth.modulus_pa.is_some() {
            "families x modulus x thickness"
        } else {
            "by its `thread`, without finite elements"
        };
        rows.push(row("sheet of the scene", per_mm(scene), of));
    }
    if let Some(modulus) = worth.modulus_pa {
        rows.push(row("modulus to write into the scene", format!("{:.4} MPa", modulus * 1e-6), "with its thickness"));
    }
    Some(table("Stiffness of the thread", rows))
}

fn layer(piece: &Piece) -> Table {
    let p = &piece.parameters;
    let rows = vec![
        row("where", "at 0 deg, along the axis".to_owned(), "on the parting line of shell a, where its angles begin"),
        row(
            "distance from the axis",
            mm(p.outer_radius_m),
            "the model takes it as a line: as narrow as holds, inextensible",
        ),
        row("length", mm(p.length_m), if piece.segment.is_some() { "over the segment" } else { "from cap to cap" }),
        row(
            "side of the limb",
            format!("{:.2} deg from up", piece.mount_angle_rad.to_degrees()),
            "the limb bends towards it",
        ),
    ];
    table("Strain-limiting layer", rows)
}

fn elastomer(piece: &Piece, settings: &Settings) -> Table {
    let p = &piece.parameters;
    let modulus = match p.material {
        Material::NeoHookean { shear_modulus_pa } => format!("{:.4} MPa", shear_modulus_pa * 1e-6),
        Material::Yeoh { c_pa } => {
            let [a, b, c] = c_pa.map(|c| c * 1e-6);
            format!("{a:.5}, {b:.5}, {c:.5} MPa")
        }
    };
    let name = match p.material {
        Material::NeoHookean { .. } => "shear modulus",
        Material::Yeoh { .. } => "C1, C2, C3",
    };
    let (all, cover) = (piece.elastomer_m3(), piece.cover_m3());
    let ml = |m3: f64| format!("{:.3} mL", m3 * 1e6);
    let mut rows = vec![row(name, modulus, format!("± {:.1} %", 100.0 * settings.tolerances.modulus))];
    if piece.cover_m() > 1e-9 {
        rows.push(row("first cast", ml(all - cover), "one actuator; grooves not taken off"));
        rows.push(row("second cast", ml(cover), "one actuator"));
    }
    let grams = |m3: f64| format!("{:.3} g", 1e3 * piece.density_kg_per_m3 * m3);
    let count = piece.copies.len();
    rows.push(row("elastomer, one actuator", ml(all), "π (R_o² - R_i²) L; caps and waste not counted"));
    rows.push(row("mass, one actuator", grams(all), format!("{} kg/m3", piece.density_kg_per_m3)));
    rows.push(row(
        "mass, all of this page",
        grams(all * count as f64),
        if count == 1 { "1 actuator".into() } else { format!("{count} actuators") },
    ));
    rows.push(row("chamber at rest", ml(piece.chamber_m3()), "π R_i² L"));
    rows.push(row("pressure, at most", format!("{:.1} kPa", piece.pressure_max_pa * 1e-3), "gauge"));
    table("Elastomer and air", rows)
}
