//! A fast reader of the usual line about one actuator.
//!
//! It accepts a part of what the strict reader accepts, with the same result: known fields, none twice and none `null`, strings without
//! escapes. Of any other line it says nothing, and the strict reader decides.

use serde_json::Value;

use super::request::{FiberSpec, Law, MaterialSpec, Model, MotionName, PlacementName, Problem, Request, TargetSpec};
use softlimb_files::object::Object;

/// The request in a line; `None` where the strict reader has to decide.
pub(super) fn request(line: &[u8]) -> Option<Request> {
    let mut scan = Scan(line);
    let request = scan.request()?;
    scan.peek().is_none().then_some(request)
}

/// The bytes that are left to be read.
struct Scan<'a>(&'a [u8]);

/// Fills a field that is empty so far.
fn put<T>(field: &mut Option<T>, value: T) -> Option<()> {
    field.replace(value).is_none().then_some(())
}

impl<'a> Scan<'a> {
    fn request(&mut self) -> Option<Request> {
        let (mut id, mut model, mut motion, mut problem) = (None, None, None, None);
        let (mut inner_radius_m, mut outer_radius_m, mut length_m) = (None, None, None);
        let (mut material, mut fiber, mut pressure_pa, mut target) = (None, None, None, None);
        let (mut external_force_n, mut external_torque_nm) = (None, None);
        self.object(|scan, field| match field {
            b"id" => put(&mut id, scan.id()?),
            b"model" => put(&mut model, scan.model()?),
            b"motion" => put(&mut motion, scan.motion()?),
            b"problem" => put(&mut problem, scan.problem()?),
            b"inner_radius_m" => put(&mut inner_radius_m, scan.number()?),
            b"outer_radius_m" => put(&mut outer_radius_m, scan.number()?),
            b"length_m" => put(&mut length_m, scan.number()?),
            b"material" => put(&mut material, scan.material()?),
            b"fiber" => put(&mut fiber, scan.fiber()?),
            b"pressure_pa" => put(&mut pressure_pa, scan.number()?),
            b"target" => put(&mut target, scan.target()?),
            b"external_force_n" => put(&mut external_force_n, scan.number()?),
            b"external_torque_nm" => put(&mut external_torque_nm, scan.number()?),
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
            material: Object(material?),
            fiber: fiber.map(Object),
            pressure_pa,
            target: target.map(Object),
            external_force_n,
            external_torque_nm,
        })
    }

    fn material(&mut self) -> Option<MaterialSpec> {
        let (mut law, mut shear_modulus_pa, mut c_pa) = (None, None, None);
        self.object(|scan, field| match field {
            b"law" => put(&mut law, scan.law()?),
            b"shear_modulus_pa" => put(&mut shear_modulus_pa, scan.number()?),
            b"c_pa" => put(&mut c_pa, scan.three_numbers()?),
            _ => None,
        })?;
        Some(MaterialSpec { law: law?, shear_modulus_pa, c_pa })
    }

    fn fiber(&mut self) -> Option<FiberSpec> {
        let (mut angle_deg, mut families, mut modulus_pa) = (None, None, None);
        let (mut placement, mut thickness_m, mut radius_m) = (None, None, None);
        self.object(|scan, field| match field {
            b"angle_deg" => put(&mut angle_deg, scan.number()?),
            b"families" => put(&mut families, scan.families()?),
            b"modulus_pa" => put(&mut modulus_pa, scan.number()?),
            b"placement" => put(&mut placement, scan.placement()?),
            b"thickness_m" => put(&mut thickness_m, scan.number()?),
            b"radius_m" => put(&mut radius_m, scan.number()?),
            _ => None,
        })?;
        let placement = placement.unwrap_or_default();
        Some(FiberSpec { angle_deg, families, modulus_pa, placement, thickness_m, radius_m })
    }

    fn target(&mut self) -> Option<TargetSpec> {
        let (mut axial_stretch, mut outer_radius_m, mut inner_radius_m) = (None, None, None);
        let (mut twist_rad, mut bend_angle_rad) = (None, None);
        self.object(|scan, field| match field {
            b"axial_stretch" => put(&mut axial_stretch, scan.number()?),
            b"outer_radius_m" => put(&mut outer_radius_m, scan.number()?),
            b"inner_radius_m" => put(&mut inner_radius_m, scan.number()?),
            b"twist_rad" => put(&mut twist_rad, scan.number()?),
            b"bend_angle_rad" => put(&mut bend_angle_rad, scan.number()?),
            _ => None,
        })?;
        Some(TargetSpec { axial_stretch, outer_radius_m, inner_radius_m, twist_rad, bend_angle_rad })
    }

    /// A string or a natural number.
    fn id(&mut self) -> Option<Value> {
        if self.peek()? != b'"' {
            return Some(self.number_text()?.parse::<u64>().ok()?.into());
        }
        let text = std::str::from_utf8(self.word()?).ok()?;
        text.bytes().all(|byte| byte >= b' ' && byte != b'\\').then(|| text.into())
    }

    fn model(&mut self) -> Option<Model> {
        match self.word()? {
            b"analytic" => Some(Model::Analytic),
            b"section-fe" => Some(Model::SectionFe),
            _ => None,
        }
    }

    fn motion(&mut self) -> Option<MotionName> {
        match self.word()? {
            b"extension" => Some(MotionName::Extension),
            b"expansion" => Some(MotionName::Expansion),
            b"bending" => Some(MotionName::Bending),
            b"twisting" => Some(MotionName::Twisting),
            _ => None,
        }
    }

    fn problem(&mut self) -> Option<Problem> {
        match self.word()? {
            b"forward" => Some(Problem::Forward),
            b"inverse" => Some(Problem::Inverse),
            _ => None,
        }
    }

    fn law(&mut self) -> Option<Law> {
        match self.word()? {
            b"neo-hookean" => Some(Law::NeoHookean),
            b"yeoh" => Some(Law::Yeoh),
            _ => None,
        }
    }

    fn placement(&mut self) -> Option<PlacementName> {
        match self.word()? {
            b"sheet" => Some(PlacementName::Sheet),
            b"layer" => Some(PlacementName::Layer),
            b"smeared" => Some(PlacementName::Smeared),
            _ => None,
        }
    }

    fn families(&mut self) -> Option<u8> {
        match self.number_text()? {
            "1" => Some(1),
            "2" => Some(2),
            _ => None,
        }
    }

    fn three_numbers(&mut self) -> Option<[f64; 3]> {
        self.token(b'[')?;
        let first = self.number()?;
        self.token(b',')?;
        let second = self.number()?;
        self.token(b',')?;
        let third = self.number()?;
        self.token(b']')?;
        Some([first, second, third])
    }

    /// An object, whose values `value` reads by the name of their field.
    #[inline(always)]
    fn object(&mut self, mut value: impl FnMut(&mut Self, &'a [u8]) -> Option<()>) -> Option<()> {
        self.token(b'{')?;
        loop {
            let field = self.word()?;
            self.token(b':')?;
            value(self, field)?;
            if self.token(b',').is_none() {
                return self.token(b'}');
            }
        }
    }

    fn number(&mut self) -> Option<f64> {
        // A number too large is no number of the strict reader.
        self.number_text()?.parse().ok().filter(|number: &f64| number.is_finite())
    }

    /// A number, for a parser that takes more than JSON does: numbers without digits on both sides of the point, and with zeros or a plus
    /// in front.
    #[inline(always)]
    fn number_text(&mut self) -> Option<&'a str> {
        self.peek()?;
        let text = self.until(|byte| !byte.is_ascii_digit() && !matches!(byte, b'.' | b'-' | b'+' | b'e' | b'E'))?;
        let digits = text.strip_prefix(b"-").unwrap_or(text);
        let is_json = match digits {
            [b'0'] | [b'0', b'e' | b'E', ..] | [b'0', b'.', b'0'..=b'9', ..] => true,
            [b'1'..=b'9', rest @ ..] => match rest.iter().position(|byte| !byte.is_ascii_digit()) {
                Some(end) if rest[end] == b'.' => rest.get(end + 1).is_some_and(u8::is_ascii_digit),
                _ => true,
            },
            _ => false,
        };
        is_json.then(|| std::str::from_utf8(text).ok())?
    }

    /// What stands in quotes, as it stands there: with a quote that is escaped it ends too early, and is no word of the interface.
    #[inline(always)]
    fn word(&mut self) -> Option<&'a [u8]> {
        self.token(b'"')?;
        let word = self.until(|byte| byte == b'"')?;
        self.0 = self.0.get(1..)?;
        Some(word)
    }

    /// The bytes up to one.
    #[inline(always)]
    fn until(&mut self, is_end: impl Fn(u8) -> bool) -> Option<&'a [u8]> {
        let end = self.0.iter().position(|byte| is_end(*byte))?;
        let (bytes, rest) = self.0.split_at_checked(end)?;
        self.0 = rest;
        Some(bytes)
    }

    #[inline(always)]
    fn token(&mut self, token: u8) -> Option<()> {
        (self.peek()? == token).then(|| self.0 = &self.0[1..])
    }

    /// The next byte that is no white space.
    #[inline(always)]
    fn peek(&mut self) -> Option<u8> {
        while let [b' ' | b'\t' | b'\r' | b'\n', rest @ ..] = self.0 {
            self.0 = rest;
        }
        self.0.first().copied()
    }
}
