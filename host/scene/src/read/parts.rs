//! Materials and windings by name.

use std::collections::BTreeMap;

use fra_model::{Families, Material, Placement};
use toml::de::DeValue;

use crate::data::Thread;
use crate::elastomers::CastableElastomer;
use crate::error::{Problem, quoted};
use crate::reader::{Log, Reader, Value};
use crate::schema;
use crate::schema::{Section, Unit};
use crate::source::{Located, Span};
use crate::suggest::closest;
use crate::value::{bad_name, is_name, number_in, triple, wrong_type};

/// Parts by name. A part with a problem keeps its name, so that its users are not blamed.
pub(super) struct Parts<'a, T> {
    kind: &'static str,
    by_name: BTreeMap<&'a str, Option<T>>,
}

impl<T> Parts<'_, T> {
    pub(super) fn has(&self, name: &str) -> bool {
        self.by_name.contains_key(name)
    }

    /// The part a module names.
    pub(super) fn find(&self, log: &Log, name: Located<&str>) -> Option<&T> {
        if let Some(part) = self.by_name.get(name.value) {
            return part.as_ref();
        }
        let known = || self.by_name.keys().copied();
        let help = match closest(name.value, known()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None if self.by_name.is_empty() => format!("define it under `[{}s.{}]`", self.kind, name.value),
            None => format!("known {}s: {}", self.kind, known().collect::<Vec<_>>().join(", ")),
        };
        let title = format!("unknown {} {}", self.kind, quoted(name.value));
        log.note(Problem::at(name.span, title, format!("no such {}", self.kind)).help(help))
    }
}

/// An elastomer.
#[derive(Clone, Copy)]
pub(super) struct Elastomer {
    pub(super) law: Material<f64>,
    /// Largest stretch of the test behind the law.
    pub(super) stretch_max: Option<f64>,
    pub(super) density_kg_per_m3: f64,
}

impl From<&CastableElastomer> for Elastomer {
    fn from(castable: &CastableElastomer) -> Self {
        let [_, most] = castable.stretch;
        Self { law: castable.material(), stretch_max: Some(most), density_kg_per_m3: schema::DENSITY_KG_PER_M3 }
    }
}

/// A winding whose radius may still depend on the actuator.
pub(super) struct Winding {
    pub(super) angle_rad: f64,
    pub(super) families: Located<Families>,
    /// Modulus and thickness of the sheet follow from it and the wall.
    pub(super) thread: Option<Thread>,
    /// 0 with a thread.
    pub(super) modulus_pa: f64,
    pub(super) placement: Located<Placement>,
    /// 0 with a thread.
    pub(super) thickness_m: f64,
    pub(super) radius_m: Option<Located<f64>>,
    /// The header of its table.
    pub(super) span: Span,
}

pub(super) fn materials<'a>(root: &Reader<'a>) -> Parts<'a, Elastomer> {
    let name = schema::scene::MATERIALS.name;
    Parts { kind: "material", by_name: named(root, name, &schema::material::SECTION, material) }
}

pub(super) fn windings<'a>(root: &Reader<'a>) -> Parts<'a, Winding> {
    Parts { kind: "winding", by_name: named(root, schema::scene::WINDINGS.name, &schema::winding::SECTION, winding) }
}

fn named<'a, T>(
    root: &Reader<'a>,
    name: &str,
    section: &'static Section,
    read: impl Fn(&Reader<'a>) -> Option<T>,
) -> BTreeMap<&'a str, Option<T>> {
    let Some(value) = root.value(name) else { return BTreeMap::new() };
    let DeValue::Table(table) = value.get_ref() else {
        root.log().note::<()>(wrong_type(value.span().into(), &quoted(name), section.header, value.get_ref()));
        return BTreeMap::new();
    };
    let one = |(key, value): (&'a toml::Spanned<toml::de::DeString<'a>>, &'a Value<'a>)| {
        let part_name = key.get_ref().as_ref();
        if !is_name(part_name) {
            root.log().note::<()>(bad_name(key.span().into(), part_name));
        }
        let reader = Reader::open(root.log(), value, section, &quoted(part_name));
        (part_name, reader.and_then(|reader| read(&reader)))
    };
    table.iter().map(one).collect()
}

fn material(reader: &Reader<'_>) -> Option<Elastomer> {
    use schema::material::{C, DENSITY, LAW, SHEAR_MODULUS, STRETCH_MAX};
    let density = reader.quantity(&DENSITY);
    let stretch_max = reader.maybe(&STRETCH_MAX);
    let is_yeoh = *reader.choice(&LAW, &[false, true])?;
    let law = if is_yeoh {
        reader.forbid(&[SHEAR_MODULUS.name], "with `law = \"yeoh\"`")?;
        Material::Yeoh { c_pa: yeoh_coefficients(reader, C.name)? }
    } else {
        reader.forbid(&[C.name], "with `law = \"neo-hookean\"`")?;
        let modulus = reader.maybe(&SHEAR_MODULUS)?;
        let modulus = modulus.or_else(|| reader.missing(SHEAR_MODULUS.name, " with `law = \"neo-hookean\"`"))?;
        Material::NeoHookean { shear_modulus_pa: *modulus }
    };
    let stretch_max = stretch_max?.map(|stretch| *stretch);
    Some(Elastomer { law, stretch_max, density_kg_per_m3: *density? })
}

/// Names of the coefficients of a Yeoh law, each with its range, MPa.
const YEOH_MPA: [(&str, [f64; 2]); 3] = [("C1", [0.0005, 50.0]), ("C2", [-50.0, 50.0]), ("C3", [-50.0, 50.0])];

fn yeoh_coefficients(reader: &Reader<'_>, name: &str) -> Option<[f64; 3]> {
    let Some(value) = reader.value(name) else { return reader.missing(name, " with `law = \"yeoh\"`") };
    let [c1, c2, c3] = triple(reader.log(), value, name)?;
    let coefficient =
        |value, (_, [min, max]): (&str, [f64; 2])| number_in(reader.log(), value, name, &Unit::MPA, min, max);
    let all = (coefficient(c1, YEOH_MPA[0]), coefficient(c2, YEOH_MPA[1]), coefficient(c3, YEOH_MPA[2]));
    Some([*all.0?, *all.1?, *all.2?])
}

/// Refuses a law that a scene refuses: a fit knows no such ranges.
///
/// # Errors
/// The first coefficient out of range, with its value and the range.
pub fn check_law(law: &Material<f64>) -> Result<(), String> {
    match law {
        Material::NeoHookean { shear_modulus_pa } => {
            let schema::Quantity { name, unit, min, max, .. } = schema::material::SHEAR_MODULUS;
            check_value((name, unit), *shear_modulus_pa, [min, max])
        }
        Material::Yeoh { c_pa } => YEOH_MPA
            .iter()
            .zip(c_pa)
            .try_for_each(|((name, range), c_pa)| check_value((name, Unit::MPA), *c_pa, *range)),
    }
}

/// Refuses creep of a chamber that a scene does not take: its share of the volume's change, and its time constant, s.
///
/// # Errors
/// The key, the value and the accepted range.
pub fn check_creep(share: f64, time_s: f64) -> Result<(), String> {
    use schema::chamber::{CREEP_SHARE, CREEP_TIME};
    let check = |schema::Quantity { name, unit, min, max, .. }, value| check_value((name, unit), value, [min, max]);
    check(CREEP_SHARE, share).and_then(|()| check(CREEP_TIME, time_s))
}

/// Refuses a value in the SI unit out of a range in the other.
fn check_value((name, unit): (&str, Unit), si: f64, [min, max]: [f64; 2]) -> Result<(), String> {
    if (unit.scale.to_si(min)..=unit.scale.to_si(max)).contains(&si) {
        return Ok(());
    }
    let (value, min, max) = (unit.show_si(si), unit.show(min), unit.show(max));
    Err(format!("{name} = {value} is not allowed in a scene: {min} to {max}"))
}

fn winding(reader: &Reader<'_>) -> Option<Winding> {
    use schema::winding::{ANGLE, FAMILIES, MODULUS, PLACEMENT, RADIUS, THICKNESS};
    let angle = reader.quantity(&ANGLE);
    let families = reader.integer(&FAMILIES);
    let thread = thread(reader, angle);
    let modulus = reader.maybe(&MODULUS);
    let radius = reader.maybe(&RADIUS);
    let thickness = reader.maybe(&THICKNESS);
    let placement = reader.choice(&PLACEMENT, &[Placement::Sheet, Placement::Layer, Placement::Smeared])?;
    let thread = thread?;
    let (modulus_pa, thickness_m) = match thread {
        Some(_) => {
            if *placement != Placement::Sheet {
                let problem = Problem::at(placement.span, "a `thread` lies on one radius", "not at this placement");
                return reader.log().note(problem.help("leave `placement` out: it is `sheet`"));
            }
            match (modulus?, thickness?) {
                (None, None) => (0.0, 0.0),
                (Some(modulus), Some(thickness)) => (*modulus, *thickness),
                (None, Some(_)) => return reader.missing(MODULUS.name, " beside `thickness` and `thread`"),
                (Some(_), None) => return reader.missing(THICKNESS.name, " beside `modulus` and `thread`"),
            }
        }
        None => (stated_modulus(reader, modulus?)?, stated_thickness(reader, *placement, thickness?)?),
    };
    match (*placement, radius?) {
        (Placement::Layer, None) => return reader.missing(RADIUS.name, " for a layer"),
        (Placement::Smeared, Some(_)) => reader.forbid(&[RADIUS.name], "for a smeared winding")?,
        _ => {}
    }
    Some(Winding {
        angle_rad: *angle?,
        families: families?.map(|n| if n == 1 { Families::One } else { Families::Two }),
        thread,
        modulus_pa,
        placement,
        thickness_m,
        radius_m: radius?,
        span: reader.span(),
    })
}

fn stated_modulus(reader: &Reader<'_>, modulus: Option<Located<f64>>) -> Option<f64> {
    let name = schema::winding::MODULUS.name;
    modulus.map_or_else(|| reader.missing(name, ", or a `thread`"), |modulus| Some(*modulus))
}

fn stated_thickness(reader: &Reader<'_>, placement: Placement, thickness: Option<Located<f64>>) -> Option<f64> {
    let name = schema::winding::THICKNESS.name;
    match (placement, thickness) {
        (Placement::Sheet, Some(thickness)) => Some(*thickness),
        (Placement::Sheet, None) => reader.missing(name, " for a sheet"),
        (_, None) => Some(0.0),
        (_, Some(_)) => {
            reader.forbid(&[name], "for this placement: only a sheet has a thickness")?;
            Some(0.0)
        }
    }
}

/// The thread of a winding; `None` inside where it has none.
fn thread(winding: &Reader<'_>, angle: Option<Located<f64>>) -> Option<Option<Thread>> {
    use schema::thread::{DIAMETER, SECTION, STARTS, STIFFNESS};
    let name = schema::winding::THREAD.name;
    let Some(value) = winding.value(name) else { return Some(None) };
    let reader = Reader::open(winding.log(), value, &SECTION, &quoted(name))?;
    let (stiffness, diameter, starts) =
        (reader.quantity(&STIFFNESS), reader.quantity(&DIAMETER), reader.integer(&STARTS));
    let angle = angle?;
    if *angle == 0.0 {
        let problem = Problem::at(angle.span, "a thread does not climb at 0 deg from the hoop", "`angle` of a thread");
        return reader.log().note(problem.help("state the angle of one thread: atan(rise of a turn / circumference)"));
    }
    let starts = u32::try_from(*starts?).ok()?;
    Some(Some(Thread { stiffness_n: *stiffness?, diameter_m: *diameter?, starts }))
}
