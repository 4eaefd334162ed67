//! The schema of a scene as data. The reader checks by it and the reference page is written from it.

mod choice;
mod motion;
mod parts;
mod pneumatics;
mod sweep;
mod task;
mod units;

pub(super) use choice::{bounds, design, segment_bounds};
pub(super) use motion::{camera, controller, imu, limits, phase, swing, target, weight};
pub(super) use parts::{
    DENSITY_KG_PER_M3, connector, end_effector, limb, material, module, scene, segment, thread, winding,
};
pub(super) use pneumatics::{ambient, chamber, line, plant, sensor, spread, supply, truth, valve};
pub(super) use sweep::{parameter, study};
pub(super) use task::{corrections, markers, object, obstacle, region};
pub(super) use units::Unit;

/// Whether a key must be written, and what holds when it is not.
#[derive(Clone, Copy, Debug)]
pub(super) enum Presence<T: 'static> {
    /// It must be written.
    Required,
    /// It has this value when it is left out.
    Default(T),
    /// It may be left out; the text says what holds then.
    Optional(&'static str),
}

/// A number with a unit. Bounds and default are in [`Quantity::unit`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantity {
    pub(super) name: &'static str,
    pub(super) unit: Unit,
    pub(super) min: f64,
    pub(super) max: f64,
    pub(super) presence: Presence<f64>,
    pub(super) doc: &'static str,
}

/// Three numbers with a unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vector {
    pub(super) name: &'static str,
    pub(super) unit: Unit,
    /// Largest absolute value of a component.
    pub(super) max: f64,
    pub(super) presence: Presence<[f64; 3]>,
    pub(super) doc: &'static str,
}

/// A whole number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Integer {
    pub(super) name: &'static str,
    pub(super) min: i64,
    pub(super) max: i64,
    pub(super) presence: Presence<i64>,
    pub(super) doc: &'static str,
}

/// One word of a few.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    pub(super) name: &'static str,
    pub(super) words: &'static [&'static str],
    pub(super) presence: Presence<&'static str>,
    pub(super) doc: &'static str,
}

/// Free text, or a name: a letter, then at most 31 letters, digits, `-` or `_`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Text {
    pub(super) name: &'static str,
    pub(super) is_name: bool,
    pub(super) presence: Presence<&'static str>,
    pub(super) doc: &'static str,
}

/// A table, or an array of tables or numbers, which another section or the text explains.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nested {
    pub(super) name: &'static str,
    pub(super) shape: &'static str,
    pub(super) presence: Presence<&'static str>,
    pub(super) doc: &'static str,
}

/// Yes or no.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flag {
    pub(super) name: &'static str,
    pub(super) presence: Presence<bool>,
    pub(super) doc: &'static str,
}

/// A lower and an upper value with a unit, in this order; equal ones fix what they bound.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) name: &'static str,
    pub(super) unit: Unit,
    pub(super) min: f64,
    pub(super) max: f64,
    pub(super) presence: Presence<[f64; 2]>,
    pub(super) doc: &'static str,
}

/// One key of a section.
#[derive(Clone, Copy, Debug)]
pub(super) enum Key {
    Quantity(Quantity),
    Vector(Vector),
    Integer(Integer),
    Choice(Choice),
    Text(Text),
    Flag(Flag),
    Pair(Pair),
    Nested(Nested),
}

impl Key {
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Quantity(key) => key.name,
            Self::Vector(key) => key.name,
            Self::Integer(key) => key.name,
            Self::Choice(key) => key.name,
            Self::Text(key) => key.name,
            Self::Flag(key) => key.name,
            Self::Pair(key) => key.name,
            Self::Nested(key) => key.name,
        }
    }
}

/// One kind of table of a scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Section {
    /// Its header, as `[[module]]`; empty for the top of the file.
    pub(super) header: &'static str,
    pub(super) doc: &'static str,
    pub(super) keys: &'static [Key],
}

/// Declares a section: one constant for each key, so that the reader cannot ask for a key the reference page does not have.
macro_rules! section {
    ($(#[doc = $doc:literal])+ $module:ident, $header:literal;
     $($key:ident: $kind:ident { $($field:ident: $value:expr),* $(,)? } = $text:literal;)+) => {
        pub(crate) mod $module {
            #[allow(unused_imports)]
            use super::super::{Choice, Flag, Integer, Key, Nested, Pair, Presence::{Default, Optional, Required}, Quantity, Section, Text, Unit, Vector};

            $(pub(crate) const $key: $kind = $kind { $($field: $value,)* doc: $text };)+

            pub(crate) const SECTION: Section = Section {
                header: $header,
                doc: concat!($($doc),+),
                keys: &[$(Key::$kind($key)),+],
            };
        }
    };
}
use section;

/// All sections in the order of the reference page.
pub(super) const SECTIONS: [Section; 34] = [
    scene::SECTION,
    material::SECTION,
    winding::SECTION,
    thread::SECTION,
    limb::SECTION,
    connector::SECTION,
    end_effector::SECTION,
    module::SECTION,
    segment::SECTION,
    bounds::SECTION,
    segment_bounds::SECTION,
    phase::SECTION,
    target::SECTION,
    obstacle::SECTION,
    region::SECTION,
    object::SECTION,
    markers::SECTION,
    corrections::SECTION,
    design::SECTION,
    limits::SECTION,
    controller::SECTION,
    weight::SECTION,
    swing::SECTION,
    camera::SECTION,
    imu::SECTION,
    plant::SECTION,
    ambient::SECTION,
    supply::SECTION,
    valve::SECTION,
    line::SECTION,
    chamber::SECTION,
    sensor::SECTION,
    spread::SECTION,
    truth::SECTION,
];
