//! Random lines for `softlimb eval --batch`, the same for a seed.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// One in so many lines is damaged, among [`Lines::any`].
const DAMAGED: usize = 8;
/// One in so many bends is computed by finite elements, among [`Lines::any`].
const BY_SECTION: usize = 200;

const PLACES: [&str; 4] = ["axial_stretch", "outer_radius_m", "inner_radius_m", "twist_rad"];

/// Pressures of a tube, among [`Lines::sweep`].
const PRESSURES: usize = 100;

pub(crate) struct Lines(ChaCha8Rng, Option<Tube>);

/// The tube of a line.
struct Tube {
    motion: &'static str,
    inner_m: f64,
    outer_m: f64,
    length_m: f64,
    shear_pa: f64,
    fields: String,
}

impl Lines {
    pub(crate) fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed), None)
    }

    /// A forward question of a straight neo-Hookean tube with a sheet.
    pub(crate) fn tube(&mut self, number: usize) -> Vec<u8> {
        let tube = self.plain();
        self.pressed(&tube, number)
    }

    /// As [`Lines::tube`], with many pressures of each tube, one after the other.
    pub(crate) fn sweep(&mut self, number: usize) -> Vec<u8> {
        let tube = self.1.take().filter(|_| !number.is_multiple_of(PRESSURES)).unwrap_or_else(|| self.plain());
        let line = self.pressed(&tube, number);
        self.1 = Some(tube);
        line
    }

    fn plain(&mut self) -> Tube {
        let motion = self.one_of(&["extension", "expansion", "twisting"]);
        self.wound(motion, (6e-3, 8e-3), true)
    }

    fn pressed(&mut self, tube: &Tube, number: usize) -> Vec<u8> {
        let pressure_pa = self.between(0.02, 0.4) * tube.shear_pa * (tube.outer_m / tube.inner_m).ln();
        format!("{{\"id\":{number},\"problem\":\"forward\",{},\"pressure_pa\":{pressure_pa}}}", tube.fields)
            .into_bytes()
    }

    /// Any line: questions of all kinds, with and without answers, and damaged ones.
    pub(crate) fn any(&mut self, number: usize) -> Vec<u8> {
        let line = if self.once_in(6) { self.series() } else { self.single(number) };
        if self.once_in(DAMAGED) { self.damaged(line) } else { line.into_bytes() }
    }

    fn single(&mut self, number: usize) -> String {
        let motion = self.one_of(&["extension", "expansion", "bending", "twisting"]);
        let inner_m = self.between(1e-3, 15e-3);
        let outer_m = inner_m * self.between(1.05, 2.0);
        let is_plain = self.once_in(2);
        let tube = self.wound(motion, (inner_m, outer_m), is_plain);
        let id = self.id(number);
        let question =
            if self.once_in(2) { self.forward_question(tube.shear_pa) } else { self.inverse_question(&tube) };
        let load = self.load();
        let model = match motion {
            "bending" if self.once_in(BY_SECTION) => ",\"model\":\"section-fe\"",
            _ if self.once_in(10) => ",\"model\":\"analytic\"",
            _ => "",
        };
        let fields = &tube.fields;
        match self.below(3) {
            0 => format!("{{{id}{fields},{question}{load}{model}}}"),
            1 => format!("{{{question},{fields}{load}{model},\"id\":{number}}}"),
            _ => format!("{{ \"id\" : {number}, {question} , {fields}{model}\t{load} }} \r"),
        }
    }

    fn series(&mut self) -> String {
        let inner_m = self.between(1e-3, 15e-3);
        let radii = (inner_m, inner_m * self.between(1.05, 2.0));
        let count = 1 + self.below(3);
        let segments: Vec<String> = (0..count)
            .map(|_| {
                let motion = self.one_of(&["extension", "expansion", "bending", "twisting"]);
                let is_plain = self.once_in(2);
                let direction = if self.once_in(3) {
                    format!(",\"bend_direction_deg\":{}", self.between(-180.0, 180.0))
                } else {
                    String::new()
                };
                format!("{{{}{direction}}}", self.wound(motion, radii, is_plain).fields)
            })
            .collect();
        let question = if self.once_in(2) {
            self.forward_question(2e5)
        } else {
            let target = match self.below(3) {
                0 => format!("\"extension_m\":{}", self.between(-0.01, 0.03)),
                1 => format!("\"twist_rad\":{}", self.between(-1.0, 1.0)),
                _ => format!("\"bend_angle_rad\":{}", self.between(-0.1, 2.0)),
            };
            format!("\"problem\":\"inverse\",\"target\":{{{target}}}")
        };
        let load = if self.once_in(4) { self.load() } else { String::new() };
        format!("{{\"id\":\"series\",{question},\"segments\":[{}]{load}}}", segments.join(","))
    }

    fn wound(&mut self, motion: &'static str, radii: (f64, f64), is_plain: bool) -> Tube {
        // Now and then a size that is not accepted.
        let sign = if !is_plain && self.once_in(40) { -1.0 } else { 1.0 };
        let (inner_m, outer_m) = radii;
        let length_m = sign * self.between(0.02, 0.3);
        let shear_pa = self.between(5e4, 1e6);
        let material = if is_plain || self.once_in(2) {
            format!("{{\"law\":\"neo-hookean\",\"shear_modulus_pa\":{shear_pa:e}}}")
        } else {
            let c = [0.5, self.between(-0.01, 0.1), self.between(-0.01, 0.02)].map(|c| c * shear_pa);
            format!("{{\"law\":\"yeoh\",\"c_pa\":[{},{},{}]}}", c[0], c[1], c[2])
        };
        let fiber = match (motion, is_plain) {
            ("bending", true) => String::new(),
            (_, true) => self.sheet(motion),
            _ if self.once_in(8) => ",\"fiber\":null".into(),
            _ => self.fiber(motion, radii),
        };
        let fields = format!(
            "\"motion\":\"{motion}\",\"inner_radius_m\":{inner_m},\"outer_radius_m\":{outer_m},\"length_m\":{length_m},\
             \"material\":{material}{fiber}"
        );
        Tube { motion, inner_m, outer_m, length_m, shear_pa, fields }
    }

    fn sheet(&mut self, motion: &str) -> String {
        let (from_deg, to_deg) = match motion {
            "extension" => (0.0, 20.0),
            "expansion" => (70.0, 90.0),
            _ => (15.0, 60.0),
        };
        let families = if motion == "twisting" { 1 } else { 2 };
        format!(
            ",\"fiber\":{{\"angle_deg\":{},\"families\":{families},\"modulus_pa\":{:e},\"thickness_m\":0.000178}}",
            self.between(from_deg, to_deg),
            self.between(1e6, 4e8)
        )
    }

    fn fiber(&mut self, motion: &str, (inner_m, outer_m): (f64, f64)) -> String {
        let mut fields = vec![];
        let mut maybe = |this: &mut Self, one_in: usize, field: String| {
            if !this.once_in(one_in) {
                fields.push(field);
            }
        };
        let is_bend = motion == "bending";
        let seldom = if is_bend { 2 } else { 30 };
        let angle_deg = self.between(-92.0, 92.0);
        maybe(self, seldom, format!("\"angle_deg\":{angle_deg}"));
        let families = if self.once_in(40) { 3 } else { 1 + self.below(2) };
        maybe(self, seldom, format!("\"families\":{families}"));
        let modulus_pa = self.between(0.0, 1e8);
        maybe(self, seldom, format!("\"modulus_pa\":{modulus_pa}"));
        let placement = self.one_of(&["sheet", "layer", "smeared", "sheet"]);
        maybe(self, 4, format!("\"placement\":\"{placement}\""));
        maybe(self, 5, "\"thickness_m\":2E-4".into());
        let radius_m = inner_m + (outer_m - inner_m) * self.between(-0.02, 1.02);
        maybe(self, 2, format!("\"radius_m\":{radius_m}"));
        format!(",\"fiber\":{{{}}}", fields.join(", "))
    }

    fn forward_question(&mut self, shear_pa: f64) -> String {
        let pressure_pa = shear_pa * self.between(-0.2, 0.6);
        format!("\"problem\":\"forward\",\"pressure_pa\":{pressure_pa}")
    }

    fn inverse_question(&mut self, tube: &Tube) -> String {
        let field = if tube.motion == "bending" && !self.once_in(20) { "bend_angle_rad" } else { self.one_of(&PLACES) };
        let value = match field {
            "axial_stretch" => self.between(0.9, 1.3),
            "outer_radius_m" => tube.outer_m * self.between(0.95, 1.2),
            "inner_radius_m" => tube.inner_m * self.between(0.95, 1.3),
            "twist_rad" => self.between(-2.0, 1.0),
            _ => tube.length_m / tube.outer_m * self.between(-0.01, 0.5),
        };
        format!("\"problem\":\"inverse\",\"target\":{{\"{field}\":{value}}}")
    }

    fn load(&mut self) -> String {
        match self.below(6) {
            0 => format!(",\"external_force_n\":{}", self.between(-1.0, 2.0)),
            1 => format!(",\"external_torque_nm\":{}", self.between(-0.005, 0.005)),
            2 => ",\"external_force_n\":null,\"external_torque_nm\":0".into(),
            _ => String::new(),
        }
    }

    fn id(&mut self, number: usize) -> String {
        match self.below(8) {
            0 => String::new(),
            1 => "\"id\":\"\\u00e9\\n\\\"\\\\ \\ud83d\\ude00\",".into(),
            2 => format!("\"id\":{{\"b\":[1,2.50,null,true],\"a\":{{}},\"segments\":{number}}},"),
            3 => format!("\"id\":{},", self.between(-1e9, 1e9) * 1e300_f64.powf(self.between(-1.0, 1.0))),
            4 => "\"id\":123456789012345678901234567890,".into(),
            5 => "\"id\":\"\\\"segments\\\"\",".into(),
            _ => format!("\"id\":{number},"),
        }
    }

    /// A line with one thing wrong, or none by chance.
    fn damaged(&mut self, line: String) -> Vec<u8> {
        const FIELDS: [&str; 15] = [
            "\"presure_pa\":1",
            "\"pressure_pa\":1e3",
            "\"pressure_pa\":null",
            "\"pressure_pa\":\"3 kPa\"",
            "\"pressure_pa\":1e999",
            "\"pressure_pa\":-0",
            "\"target\":{}",
            "\"target\":{\"twist_rad\":null}",
            "\"target\":{\"twist_rad\":1,\"axial_stretch\":1}",
            "\"target\":[1]",
            "\"segments\":[]",
            "\"\\u0073egments\":[{}]",
            "\"model\":\"section\"",
            "\"id\":1",
            "\"material\":[\"neo-hookean\",1e5]",
        ];
        const WORDS: [(&str, &str); 12] = [
            ("\"motion\":\"", "\"motion\":\"s"),
            ("\"motion\"", "\"Motion\""),
            ("\"law\"", "\"laws\""),
            ("\"families\":", "\"families\":1."),
            ("\"families\":1", "\"families\":300"),
            ("\"length_m\":", "\"length_m\":null,\"x\":"),
            ("neo-hookean", "yeoh"),
            ("yeoh", "neo-hookean"),
            ("forward", "inverse"),
            ("inverse", "forward"),
            ("e5", "e400"),
            ("\"material\":{", "\"material\":[{"),
        ];
        let at = self.below(line.len());
        match self.below(8) {
            0 => line.as_bytes()[..at].to_vec(),
            1 => {
                let mut bytes = line.into_bytes();
                bytes[at] = self.below(256) as u8;
                bytes
            }
            2 => {
                let mut bytes = line.into_bytes();
                bytes.remove(at);
                bytes
            }
            3 => line.replacen('{', &format!("{{{},", self.one_of(&FIELDS)), 1).into_bytes(),
            4 => format!("[{line}]").into_bytes(),
            5 => [line.as_bytes(), self.one_of(&["}", " {}", "\u{0}", ",", "  "]).as_bytes()].concat(),
            6 => self.one_of(&["", " \t\r", "null", "{}", "[1, 2]", "trux", "\"segments\"", "\u{feff}{}"]).into(),
            _ => {
                let (from, to) = WORDS[self.below(WORDS.len())];
                line.replace(from, to).into_bytes()
            }
        }
    }

    /// Evenly between two numbers; of each a share with few digits.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        let share = (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let value = low + (high - low) * share;
        if !self.once_in(4) {
            return value;
        }
        let unit = 10_f64.powi(value.abs().max(TAU * 1e-9).log10().floor() as i32 - 2);
        (value / unit).round() * unit
    }

    fn once_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count as u64) as usize
    }

    fn one_of<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }
}
