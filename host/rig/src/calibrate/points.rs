//! Tables of pressures and deformations.

use super::Branch;
use fra_model::StateQuantity;
use softlimb_files::table::{Known, Table, TableError};

/// One cell of a deformation with the pressure of its row.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The line of the table, from 1.
    pub line: usize,
    /// The module or actuator, as the table names it.
    pub name: String,
    /// The specimen, where the table tells several apart.
    pub specimen: Option<String>,
    /// Reading of the pressure sensor, Pa gauge.
    pub reading_pa: f64,
    /// The way to it.
    pub branch: Branch,
    /// Measured quantity.
    pub quantity: StateQuantity,
    /// Its value, in the SI unit of the quantity.
    pub value: f64,
    /// Time since the pressure was raised, s, where the table has it.
    pub time_s: Option<f64>,
}

/// A table of pressures and deformations.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// Its cells, in order.
    pub points: Vec<Point>,
    /// Whether it has times: then it is a response to a step and not a series of equilibria.
    pub timed: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Pressure,
    Time,
    Deformation(StateQuantity),
}

const fn column(name: &'static str, kind: Kind, factor: f64, range: [f64; 2]) -> Known<Kind> {
    Known { name, kind, factor, shift: 0.0, range }
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const STRETCH: Kind = Kind::Deformation(StateQuantity::AxialStretch);
const OUTER: Kind = Kind::Deformation(StateQuantity::OuterRadius);
const INNER: Kind = Kind::Deformation(StateQuantity::InnerRadius);
const BEND: Kind = Kind::Deformation(StateQuantity::BendAngle);
const TWIST: Kind = Kind::Deformation(StateQuantity::Twist);

const COLUMNS: [Known<Kind>; 12] = [
    column("pressure_pa", Kind::Pressure, 1.0, [-101_325.0, 2e6]),
    column("pressure_kpa", Kind::Pressure, 1e3, [-101.325, 2e3]),
    column("time_s", Kind::Time, 1.0, [0.0, 1e7]),
    column("axial_stretch", STRETCH, 1.0, [0.1, 20.0]),
    column("outer_radius_m", OUTER, 1.0, [1e-4, 1.0]),
    column("outer_radius_mm", OUTER, 1e-3, [0.1, 1e3]),
    column("inner_radius_m", INNER, 1.0, [1e-4, 1.0]),
    column("inner_radius_mm", INNER, 1e-3, [0.1, 1e3]),
    column("bend_angle_rad", BEND, 1.0, [-1.0, 100.0]),
    column("bend_angle_deg", BEND, DEGREE, [-60.0, 6e3]),
    column("twist_rad", TWIST, 1.0, [-100.0, 100.0]),
    column("twist_deg", TWIST, DEGREE, [-6e3, 6e3]),
];

/// Accepted headings of the column of names.
const NAMES: [&str; 2] = ["module", "actuator"];

/// Column of the branches of a loop.
const BRANCH: &str = "branch";

/// Column of the names of specimens.
const SPECIMEN: &str = "specimen";

impl Points {
    /// Reads a table: a column `module` or `actuator`, one of pressure, at least one of a deformation, `specimen` if it
    /// has several, `branch` if it has both of a loop, and `time_s` if it is a response to a step. `known` are the names that may be used; a table without names is about the only one of them.
    ///
    /// # Errors
    /// [`TableError`] with line, column, value and what is accepted.
    pub fn read(text: &str, known: &[&str]) -> Result<Self, TableError> {
        let table = Table::cut(text)?;
        table.only(&COLUMNS, &[NAMES[0], NAMES[1], SPECIMEN, BRANCH])?;
        let specimen = table.place(SPECIMEN);
        let branches = table.place(BRANCH);
        let there = table.columns(&COLUMNS);
        let of = |kind: Kind| there.iter().copied().filter(move |(_, column)| column.kind == kind).collect::<Vec<_>>();
        let [pressure] = of(Kind::Pressure)[..] else {
            return Err(table.header_error("give one of pressure_pa, pressure_kpa".into()));
        };
        let time = of(Kind::Time).first().copied();
        let deformations: Vec<_> =
            there.iter().copied().filter(|(_, column)| matches!(column.kind, Kind::Deformation(_))).collect();
        if deformations.is_empty() {
            let names: Vec<_> = COLUMNS[3..].iter().map(|column| column.name).collect();
            return Err(table.header_error(format!("give a deformation: {}", names.join(", "))));
        }
        let named = NAMES.iter().find_map(|name| Some((table.place(name)?, *name)));
        if named.is_none() && known.len() != 1 {
            let problem = format!("give a column `module`: there are {}", known.join(", "));
            return Err(table.header_error(problem));
        }
        let mut points = Vec::new();
        for row in table.rows() {
            let required = |(place, column): (usize, &Known<Kind>)| {
                row.number(place, column)?.ok_or_else(|| row.refused(place, column.name, "a number".into()))
            };
            let name = match named {
                Some((place, column)) => {
                    let text = row.text(place);
                    let refused = || row.refused(place, column, format!("one of {}", known.join(", ")));
                    *known.iter().find(|name| **name == text).ok_or_else(refused)?
                }
                None => known[0],
            };
            let specimen = match specimen.map(|place| (place, row.text(place))) {
                Some((place, "")) => return Err(row.refused(place, SPECIMEN, "a name".into())),
                named => named.map(|(_, name)| name.to_owned()),
            };
            let branch = match branches.map(|place| (place, row.text(place))) {
                None | Some((_, "loading")) => Branch::Loading,
                Some((_, "unloading")) => Branch::Unloading,
                Some((place, _)) => return Err(row.refused(place, BRANCH, "loading or unloading".into())),
            };
            let reading_pa = required(pressure)?;
            let time_s = time.map(required).transpose()?;
            for (place, column) in &deformations {
                let (Kind::Deformation(quantity), Some(value)) = (column.kind, row.number(*place, column)?) else {
                    continue;
                };
                let specimen = specimen.clone();
                let (line, name) = (row.line, name.into());
                points.push(Point { line, name, specimen, reading_pa, branch, quantity, value, time_s });
            }
        }
        Ok(Self { points, timed: time.is_some() })
    }
}
