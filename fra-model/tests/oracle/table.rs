//! The reference values that `hard_cases.py` writes.

use fra_model::*;

/// One row of `hard_cases.tsv`.
pub(crate) struct Row {
    fields: Vec<String>,
}

const TABLE: &str = include_str!("hard_cases.tsv");

/// The rows of a group in one scalar.
pub(crate) fn rows(group: &str, scalar: &str) -> Vec<Row> {
    let all = TABLE.lines().skip(1).map(|line| Row { fields: line.split('\t').map(str::to_owned).collect() });
    all.filter(|row| row.text("group") == group && row.text("scalar") == scalar).collect()
}

/// The names of all groups, in the order of the table.
pub(crate) fn groups() -> Vec<&'static str> {
    let mut groups: Vec<&str> = TABLE.lines().skip(1).filter_map(|line| line.split('\t').next()).collect();
    groups.dedup();
    groups
}

impl Row {
    pub(crate) fn text(&self, column: &str) -> &str {
        let at = TABLE.lines().next().and_then(|head| head.split('\t').position(|name| name == column));
        &self.fields[at.unwrap_or_else(|| panic!("no column {column}"))]
    }

    pub(crate) fn number(&self, column: &str) -> f64 {
        self.text(column).parse().unwrap_or_else(|_| panic!("{column}: {}", self.text(column)))
    }

    /// The actuator; every number is exact in the scalar of the row.
    pub(crate) fn parameters<T>(&self, exact: impl Fn(f64) -> T) -> ActuatorParameters<T> {
        let value = |column: &str| exact(self.number(column));
        let material = match self.text("material") {
            "nh" => Material::NeoHookean { shear_modulus_pa: exact(2.0 * self.number("c1")) },
            _ => Material::Yeoh { c_pa: ["c1", "c2", "c3"].map(value) },
        };
        let placement = match self.text("placement") {
            "sheet" => Some(Placement::Sheet),
            "layer" => Some(Placement::Layer),
            "smeared" => Some(Placement::Smeared),
            _ => None,
        };
        let fiber = placement.map(|placement| Fiber {
            angle_rad: value("angle"),
            families: if self.text("families") == "2" { Families::Two } else { Families::One },
            modulus_pa: value("mu2"),
            placement,
            thickness_m: value("thickness"),
            radius_m: value("winding"),
        });
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
            fiber,
        }
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
