//! The reference values that `hard_cases.py` and `two_windings.py` write.

use fra_model::*;

/// One row of a table.
pub(crate) struct Row {
    names: Vec<&'static str>,
    fields: Vec<&'static str>,
}

pub(crate) const HARD_CASES: &str = include_str!("hard_cases.tsv");
pub(crate) const TWO_WINDINGS: &str = include_str!("two_windings.tsv");

/// The rows of a group in one scalar.
pub(crate) fn rows(table: &'static str, group: &str, scalar: &str) -> Vec<Row> {
    let mut lines = table.lines().map(|line| line.split('\t').collect::<Vec<_>>());
    let names = lines.next().unwrap_or_default();
    let all = lines.map(|fields| Row { names: names.clone(), fields });
    all.filter(|row| row.text("group") == group && row.text("scalar") == scalar).collect()
}

/// The names of all groups, in the order of the table.
pub(crate) fn groups(table: &'static str) -> Vec<&'static str> {
    let mut groups: Vec<&str> = table.lines().skip(1).filter_map(|line| line.split('\t').next()).collect();
    groups.dedup();
    groups
}

impl Row {
    pub(crate) fn text(&self, column: &str) -> &'static str {
        let at = self.names.iter().position(|name| *name == column);
        self.fields[at.unwrap_or_else(|| panic!("no column {column}"))]
    }

    pub(crate) fn number(&self, column: &str) -> f64 {
        self.text(column).parse().unwrap_or_else(|_| panic!("{column}: {}", self.text(column)))
    }

    /// The actuator; every number is exact in the scalar of the row.
    pub(crate) fn parameters<T>(&self, exact: impl Fn(f64) -> T + Copy) -> ActuatorParameters<T> {
        let value = |column: &str| exact(self.number(column));
        let material = match self.text("material") {
            "nh" => Material::NeoHookean { shear_modulus_pa: exact(2.0 * self.number("c1")) },
            _ => Material::Yeoh { c_pa: ["c1", "c2", "c3"].map(value) },
        };
        ActuatorParameters {
            motion: match self.text("motion") {
                "bending" => Motion::Bending,
                "twisting" => Motion::Twisting,
                _ => Motion::Extension,
            },
            inner_radius_m: value("inner"),
            outer_radius_m: value("outer"),
            length_m: value("length"),
            material,
            fiber: self.fiber("", exact),
        }
    }

    /// The winding whose columns have this ending.
    pub(crate) fn fiber<T>(&self, ending: &str, exact: impl Fn(f64) -> T) -> Option<Fiber<T>> {
        let column = |name: &str| format!("{name}{ending}");
        let value = |name: &str| exact(self.number(&column(name)));
        let placement = match self.text(&column("placement")) {
            "sheet" => Placement::Sheet,
            "layer" => Placement::Layer,
            "smeared" => Placement::Smeared,
            _ => return None,
        };
        Some(Fiber {
            angle_rad: value("angle"),
            families: if self.text(&column("families")) == "2" { Families::Two } else { Families::One },
            modulus_pa: value("mu2"),
            placement,
            thickness_m: value("thickness"),
            radius_m: value("winding"),
        })
    }

    pub(crate) fn load<T>(&self, exact: impl Fn(f64) -> T) -> Load<T> {
        Load { force_n: exact(self.number("force")), torque_nm: exact(self.number("torque")) }
    }

    pub(crate) fn target<T>(&self, exact: impl Fn(f64) -> T) -> Target<T> {
        let value = exact(self.number("target_value"));
        match self.text("target") {
            "stretch" => Target::AxialStretch(value),
            "twist" => Target::Twist(value),
            "inner_radius" => Target::InnerRadius(value),
            "outer_radius" => Target::OuterRadius(value),
            _ => Target::BendAngle(value),
        }
    }
}
