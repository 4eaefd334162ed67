//! The fields of a question about one actuator, read by the fast reader.
//!
//! Fields, words and defaults are those of the types in `request`; what is missing, unknown or given twice is `serde_json`'s to refuse.

use softlimb_files::object::{NamedOr, Object};

use super::request::{
    FiberSpec, Fibers, Law, MaterialSpec, Model, MotionName, PlacementName, Problem, Request, Solutions, TargetSpec,
};
use super::scan::Scan;

/// The question on the first line of a text, and the text after the line; `None` where `serde_json` has to decide.
pub(super) fn read(text: &[u8]) -> Option<(Request, &[u8])> {
    let mut scan = Scan::new(text);
    let request = request(&mut scan)?;
    Some((request, scan.after_line()?))
}

/// Puts a value in its place, unless that is taken.
#[inline(always)]
fn put<T>(place: &mut Option<T>, value: Option<T>) -> Option<()> {
    (place.is_none() && value.is_some()).then(|| *place = value)
}

fn request(scan: &mut Scan) -> Option<Request> {
    let (mut id, mut model, mut motion, mut problem) = (None, None, None, None);
    let (mut inner_radius_m, mut outer_radius_m, mut length_m) = (None, None, None);
    let (mut material, mut fiber, mut pressure_pa, mut target) = (None, None, None, None);
    let (mut external_force_n, mut external_torque_nm) = (None, None);
    let (mut pressure_range, mut solutions) = (None, None);
    let mut tolerance = None;
    scan.object(|scan, name| match name {
        b"id" => put(&mut id, scan.id()),
        b"model" => put(&mut model, scan.word().and_then(model_named)),
        b"motion" => put(&mut motion, scan.word().and_then(motion_named)),
        b"problem" => put(&mut problem, scan.word().and_then(problem_named)),
        b"inner_radius_m" => put(&mut inner_radius_m, scan.number()),
        b"outer_radius_m" => put(&mut outer_radius_m, scan.number()),
        b"length_m" => put(&mut length_m, scan.number()),
        b"material" => put(&mut material, material_spec(scan)),
        b"fiber" => put(&mut fiber, fiber_spec(scan)),
        b"pressure_pa" => put(&mut pressure_pa, scan.number()),
        b"target" => put(&mut target, target_spec(scan)),
        b"pressure_range" => put(&mut pressure_range, scan.numbers()),
        b"solutions" => put(&mut solutions, scan.word().and_then(solutions_named)),
        b"tolerance" => put(&mut tolerance, scan.number()),
        b"external_force_n" => put(&mut external_force_n, scan.number()),
        b"external_torque_nm" => put(&mut external_torque_nm, scan.number()),
        _ => None,
    })?;
    Some(Request {
        id: id.unwrap_or_default(),
        model: model.unwrap_or_default(),
        motion: motion?,
        problem: problem?,
        inner_radius_m: inner_radius_m?,
        outer_radius_m: outer_radius_m?,
        length_m: length_m?,
        material: NamedOr::Object(material?),
        fiber: fiber.map(Fibers::One),
        pressure_pa,
        target: target.map(Object),
        pressure_range,
        solutions,
        tolerance,
        errors: None,
        external_force_n,
        external_torque_nm,
    })
}

fn material_spec(scan: &mut Scan) -> Option<MaterialSpec> {
    let (mut law, mut shear_modulus_pa, mut c_pa) = (None, None, None);
    scan.object(|scan, name| match name {
        b"law" => put(&mut law, scan.word().and_then(law_named)),
        b"shear_modulus_pa" => put(&mut shear_modulus_pa, scan.number()),
        b"c_pa" => put(&mut c_pa, scan.numbers()),
        _ => None,
    })?;
    Some(MaterialSpec { law: law?, shear_modulus_pa, c_pa })
}

fn fiber_spec(scan: &mut Scan) -> Option<FiberSpec> {
    let (mut angle_deg, mut families, mut modulus_pa) = (None, None, None);
    let (mut placement, mut thickness_m, mut radius_m) = (None, None, None);
    scan.object(|scan, name| match name {
        b"angle_deg" => put(&mut angle_deg, scan.number()),
        b"families" => put(&mut families, scan.natural().and_then(|count| u8::try_from(count).ok())),
        b"modulus_pa" => put(&mut modulus_pa, scan.number()),
        b"placement" => put(&mut placement, scan.word().and_then(placement_named)),
        b"thickness_m" => put(&mut thickness_m, scan.number()),
        b"radius_m" => put(&mut radius_m, scan.number()),
        _ => None,
    })?;
    let placement = placement.unwrap_or_default();
    Some(FiberSpec { angle_deg, families, modulus_pa, placement, thickness_m, radius_m })
}

fn target_spec(scan: &mut Scan) -> Option<TargetSpec> {
    let (mut axial_stretch, mut outer_radius_m, mut inner_radius_m) = (None, None, None);
    let (mut twist_rad, mut bend_angle_rad) = (None, None);
    scan.object(|scan, name| match name {
        b"axial_stretch" => put(&mut axial_stretch, scan.number()),
        b"outer_radius_m" => put(&mut outer_radius_m, scan.number()),
        b"inner_radius_m" => put(&mut inner_radius_m, scan.number()),
        b"twist_rad" => put(&mut twist_rad, scan.number()),
        b"bend_angle_rad" => put(&mut bend_angle_rad, scan.number()),
        _ => None,
    })?;
    Some(TargetSpec { axial_stretch, outer_radius_m, inner_radius_m, twist_rad, bend_angle_rad })
}

fn model_named(name: &[u8]) -> Option<Model> {
    match name {
        b"auto" => Some(Model::Auto),
        b"analytic" => Some(Model::Analytic),
        b"section-fe" => Some(Model::SectionFe),
        _ => None,
    }
}

fn motion_named(name: &[u8]) -> Option<MotionName> {
    match name {
        b"extension" => Some(MotionName::Extension),
        b"expansion" => Some(MotionName::Expansion),
        b"bending" => Some(MotionName::Bending),
        b"twisting" => Some(MotionName::Twisting),
        _ => None,
    }
}

fn problem_named(name: &[u8]) -> Option<Problem> {
    match name {
        b"forward" => Some(Problem::Forward),
        b"inverse" => Some(Problem::Inverse),
        _ => None,
    }
}

fn solutions_named(name: &[u8]) -> Option<Solutions> {
    match name {
        b"first" => Some(Solutions::First),
        b"all" => Some(Solutions::All),
        _ => None,
    }
}

fn law_named(name: &[u8]) -> Option<Law> {
    match name {
        b"neo-hookean" => Some(Law::NeoHookean),
        b"yeoh" => Some(Law::Yeoh),
        _ => None,
    }
}

fn placement_named(name: &[u8]) -> Option<PlacementName> {
    match name {
        b"sheet" => Some(PlacementName::Sheet),
        b"layer" => Some(PlacementName::Layer),
        b"smeared" => Some(PlacementName::Smeared),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both readers' fields; the bits of numbers are in their text.
    fn same(text: &str) {
        let scanned = read(text.as_bytes()).map(|(request, rest)| (request, rest.len()));
        let (scanned, rest) = scanned.unwrap_or_else(|| panic!("not read: {text}"));
        let Object(parsed): Object<Request> = serde_json::from_str(text).expect("a question");
        assert_eq!((format!("{scanned:?}"), rest), (format!("{parsed:?}"), 0), "{text}");
    }

    const TUBE: &str = r#""inner_radius_m":0.006,"outer_radius_m":8e-3,"length_m":0.1"#;

    #[test]
    fn every_field_and_word_is_read_as_by_serde_json() {
        let material = r#""material":{"law":"neo-hookean","shear_modulus_pa":2e5}"#;
        for motion in ["extension", "expansion", "bending", "twisting"] {
            same(&format!(r#"{{"motion":"{motion}","problem":"forward",{TUBE},{material},"pressure_pa":-0}}"#));
        }
        for target in ["axial_stretch", "outer_radius_m", "inner_radius_m", "twist_rad", "bend_angle_rad"] {
            same(&format!(
                r#" {{"target":{{"{target}":1.25}},"motion":"bending","problem":"inverse",{TUBE},{material}}} "#
            ));
        }
        for solutions in ["first", "all"] {
            same(&format!(
                r#"{{"target":{{"axial_stretch":1.25}},"pressure_range":[-1e4, 2e5],"solutions":"{solutions}","motion":"twisting",
                    "problem":"inverse",{TUBE},{material}}}"#
            ).replace('\n', ""));
        }
        for placement in ["sheet", "layer", "smeared"] {
            let fiber = format!(
                r#""fiber":{{"placement":"{placement}","angle_deg":3,"families":2,"modulus_pa":1e6,"thickness_m":1e-4,
                    "radius_m":7e-3}}"#
            );
            same(
                &format!(
                    r#"{{"id":"a","model":"analytic","motion":"extension","problem":"forward",{TUBE},"material":{{"c_pa":
                        [1,2,3],"law":"yeoh"}},{fiber},"external_force_n":1,"external_torque_nm":-1e-3}}"#
                )
                .replace('\n', ""),
            );
        }
        same(&format!(r#"{{"model":"section-fe","id":7,"motion":"bending","problem":"forward",{TUBE},{material}}}"#));
    }

    #[test]
    fn doubtful_lines_are_left_to_serde_json() {
        let good = format!(
            r#"{{"motion":"bending","problem":"forward",{TUBE},"material":{{"law":"yeoh","c_pa":[1,2,3]}},"pressure_pa":1}}"#
        );
        same(&good);
        for (from, to) in [
            (r#""motion":"bending","#, ""),
            ("bending", "bent"),
            ("}", ",\"id\":1,\"id\":1}"),
            ("\"problem\"", "\"model\":null,\"problem\""),
            ("pressure_pa\":1", "pressure_pa\":null"),
            ("pressure_pa\":1", "presure_pa\":1"),
            ("\"law\":", "\"law\":\"yeoh\",\"law\":"),
            ("[1,2,3]", "[1,2]"),
            ("bending", "bend\\u0069ng"),
            ("{\"motion", "{},{\"motion"),
            ("pressure_pa\":1}", "pressure_pa\":1}}"),
            ("pressure_pa\":1}", "pressure_pa\":1"),
            ("pressure_pa\":1}", "pressure_pa\":1,}"),
            (",", ",\n"),
        ] {
            assert!(read(good.replace(from, to).as_bytes()).is_none(), "{from} -> {to}");
        }
    }

    #[test]
    fn text_goes_on_after_the_end_of_the_line() {
        let line = format!(
            r#"{{"motion":"bending","problem":"forward",{TUBE},"material":{{"law":"yeoh","c_pa":[1,2,3]}},"pressure_pa":1}}"#
        );
        for end in ["\n", " \r\n", "\t\n"] {
            let text = format!("{line}{end}  \n{{");
            assert_eq!(read(text.as_bytes()).map(|(_, rest)| rest), Some(&b"  \n{"[..]), "{end:?}");
        }
    }
}
