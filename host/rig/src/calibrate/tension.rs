//! Hyperelastic laws from tensile tests.
//!
//! Uniaxial tension of an incompressible wall: `sigma = 2 (l - 1/l^2) W'(I1)` per undeformed section, `I1 = l^2 + 2/l`. It is linear in the
//! coefficients of the laws, so that least squares are one linear system and the intervals exact for normal errors.

use fra_model::Material;
use nalgebra::{DMatrix, DVector};

use super::estimate::{Column, Shown, Value, enough, judge};
use super::{CalibrationError, Settings};
use softlimb_files::table::{Known, Row, Table, TableError};

/// A law of the elastomer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// `W = mu/2 (I1-3)`.
    NeoHookean,
    /// `C1 (I1-3) + C2 (I1-3)^2`.
    YeohTwo,
    /// `C1 (I1-3) + C2 (I1-3)^2 + C3 (I1-3)^3`.
    Yeoh,
}

impl Law {
    /// The name of the law, as a scene has it.
    pub fn word(self) -> &'static str {
        match self {
            Self::NeoHookean => "neo-hookean",
            Self::YeohTwo | Self::Yeoh => "yeoh",
        }
    }

    fn names(self) -> &'static [&'static str] {
        match self {
            Self::NeoHookean => &["shear_modulus_pa"],
            Self::YeohTwo => &["c1_pa", "c2_pa"],
            Self::Yeoh => &["c1_pa", "c2_pa", "c3_pa"],
        }
    }

    fn material(self, values: &[f64]) -> Material<f64> {
        let at = |k: usize| values.get(k).copied().unwrap_or(0.0);
        match self {
            Self::NeoHookean => Material::NeoHookean { shear_modulus_pa: at(0) },
            Self::YeohTwo | Self::Yeoh => Material::Yeoh { c_pa: [at(0), at(1), at(2)] },
        }
    }
}

/// A tensile test: stretches and nominal stresses, force by undeformed section, Pa.
#[derive(Clone, Debug, PartialEq)]
pub struct Tension {
    points: Vec<[f64; 2]>,
}

/// A law that fits a tensile test.
#[derive(Clone, Debug, PartialEq)]
pub struct TensionFit {
    /// The law.
    pub law: Law,
    /// Its coefficients, Pa.
    pub values: Vec<Value>,
    /// The same for the model.
    pub material: Material<f64>,
    /// The law's nominal stress at each point of the test, Pa.
    pub modelled_pa: Vec<f64>,
    /// Half width of the confidence interval of that, Pa.
    pub half_widths_pa: Vec<f64>,
    /// Root mean square of the residuals, Pa.
    pub rms_pa: f64,
    /// Least and largest stretch of the test, the undeformed state included.
    pub tested: [f64; 2],
    /// Stretch beyond rest at which the law's nominal stress stops growing, up to 8; `None` where it does not.
    pub softens_at: Option<f64>,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Stretch,
    Stress,
    Force,
}

const COLUMNS: [Known<Kind>; 7] = [
    Known { name: "stretch", kind: Kind::Stretch, factor: 1.0, shift: 0.0, range: [0.2, 20.0] },
    Known { name: "strain", kind: Kind::Stretch, factor: 1.0, shift: 1.0, range: [-0.8, 19.0] },
    Known { name: "strain_percent", kind: Kind::Stretch, factor: 0.01, shift: 1.0, range: [-80.0, 1900.0] },
    Known { name: "nominal_stress_pa", kind: Kind::Stress, factor: 1.0, shift: 0.0, range: [-1e9, 1e9] },
    Known { name: "nominal_stress_kpa", kind: Kind::Stress, factor: 1e3, shift: 0.0, range: [-1e6, 1e6] },
    Known { name: "nominal_stress_mpa", kind: Kind::Stress, factor: 1e6, shift: 0.0, range: [-1e3, 1e3] },
    Known { name: "force_n", kind: Kind::Force, factor: 1.0, shift: 0.0, range: [-1e5, 1e5] },
];

/// Remedy for forces without a section: a table of one test takes an option.
const SECTION_OF_ONE: &str = "a force needs the undeformed section: give it as `--section \"6 mm2\"`";
/// The same for a table of several materials, whose specimens may have different sections.
const SECTION_OF_SEVERAL: &str =
    "a force needs the undeformed section, for which this table has no place: give nominal stresses";

/// The column that names a material.
const MATERIAL: &str = "material";

impl Tension {
    /// Reads a test from a table with one column of stretch or strain and one of stress or force; `section_m2` is the undeformed section,
    /// which a force needs and a stress has no use for.
    ///
    /// # Errors
    /// [`TableError`] with line, column, value and what is accepted.
    pub fn read(text: &str, section_m2: Option<f64>) -> Result<Self, TableError> {
        let table = Table::cut(text)?;
        table.only(&COLUMNS, &[])?;
        let points = points(&table, section_m2, SECTION_OF_ONE)?;
        Ok(Self { points: points.into_iter().map(|(_, point)| point).collect() })
    }

    /// Reads the tests of several materials from a table that has a column `material`, too; in the order of their first rows.
    ///
    /// # Errors
    /// [`TableError`] with line, column, value and what is accepted.
    pub fn read_by_name(text: &str) -> Result<Vec<(String, Self)>, TableError> {
        let table = Table::cut(text)?;
        table.only(&COLUMNS, &[MATERIAL])?;
        let place = table.place(MATERIAL).ok_or_else(|| table.header_error(format!("no column `{MATERIAL}`")))?;
        let mut tests: Vec<(String, Self)> = Vec::new();
        for (row, point) in points(&table, None, SECTION_OF_SEVERAL)? {
            let name = row.text(place);
            if name.is_empty() {
                return Err(row.refused(place, MATERIAL, "a name".into()));
            }
            match tests.iter_mut().find(|(known, _)| known == name) {
                Some((_, test)) => test.points.push(point),
                None => tests.push((name.into(), Self { points: vec![point] })),
            }
        }
        Ok(tests)
    }

    /// The points: stretch and nominal stress, Pa.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// The part of the test up to a stretch.
    pub fn up_to(&self, stretch: f64) -> Self {
        Self { points: self.points.iter().filter(|point| point[0] <= stretch).copied().collect() }
    }
}

/// The rows of a table, each with its stretch and nominal stress, Pa; `no_section` is the error of forces without a section.
fn points<'a>(
    table: &'a Table,
    section_m2: Option<f64>,
    no_section: &str,
) -> Result<Vec<(&'a Row, [f64; 2])>, TableError> {
    let there = table.columns(&COLUMNS);
    let one_of = |wanted: &[Kind], what: &str| match there.iter().filter(|c| wanted.contains(&c.1.kind)).count() {
        1 => Ok(*there.iter().find(|c| wanted.contains(&c.1.kind)).unwrap_or(&there[0])),
        count => {
            let names = COLUMNS.iter().filter(|c| wanted.contains(&c.kind)).map(|c| c.name).collect::<Vec<_>>();
            Err(table.header_error(format!("{count} columns of {what}; give one of {}", names.join(", "))))
        }
    };
    let stretch = one_of(&[Kind::Stretch], "stretch")?;
    let stress = one_of(&[Kind::Stress, Kind::Force], "stress or force")?;
    let divisor = match (stress.1.kind, section_m2) {
        (Kind::Force, Some(section)) => section,
        (Kind::Force, None) => return Err(table.header_error(no_section.into())),
        (_, Some(_)) => return Err(table.header_error("a stress is already per section: give a force".into())),
        (_, None) => 1.0,
    };
    let mut points = Vec::with_capacity(table.rows().len());
    for row in table.rows() {
        let number = |(place, column): (usize, &Known<Kind>)| {
            let missing = || row.refused(place, column.name, "a number".into());
            row.number(place, column)?.ok_or_else(missing)
        };
        points.push((row, [number(stretch)?, number(stress)? / divisor]));
    }
    Ok(points)
}

/// Contribution of each coefficient to the nominal stress at a stretch.
pub(super) fn shares(law: Law, stretch: f64) -> Vec<f64> {
    let lever = stretch - 1.0 / (stretch * stretch);
    let x = stretch * stretch + 2.0 / stretch - 3.0;
    match law {
        Law::NeoHookean => vec![lever],
        Law::YeohTwo => vec![2.0 * lever, 4.0 * lever * x],
        Law::Yeoh => vec![2.0 * lever, 4.0 * lever * x, 6.0 * lever * x * x],
    }
}

/// Finds the coefficients of a law. `accuracy` is that of the stresses, as a share of the largest; what the data cannot tell at this
/// accuracy is refused.
///
/// # Errors
/// [`CalibrationError`].
pub fn fit_tension(
    test: &Tension,
    law: Law,
    accuracy: f64,
    settings: &Settings,
) -> Result<TensionFit, CalibrationError> {
    settings.check()?;
    let points = &test.points;
    let most_pa = points.iter().map(|point| point[1].abs()).fold(0.0, f64::max);
    if most_pa == 0.0 {
        let (field, place) = ("nominal_stress_pa", "every row of the tensile test".into());
        return Err(CalibrationError::Invalid { field, value: 0.0, place, allowed: "one row at least with a stress" });
    }
    let accuracy_pa = accuracy * most_pa;
    if !(accuracy_pa.is_finite() && accuracy_pa > 0.0) {
        let (place, allowed) = ("the tensile test".into(), "finite and > 0");
        return Err(CalibrationError::Invalid { field: "accuracy", value: accuracy, place, allowed });
    }
    let names = law.names();
    // The undeformed state says nothing: any law is free of stress there.
    let loaded = points.iter().filter(|point| point[0] != 1.0).count();
    enough(loaded, names.len(), settings.noise)?;
    let rows: Vec<Vec<f64>> = points.iter().map(|point| shares(law, point[0])).collect();
    let plain = DMatrix::from_fn(points.len(), names.len(), |i, k| rows[i][k] / accuracy_pa);
    let measured = DVector::from_iterator(points.len(), points.iter().map(|point| point[1] / accuracy_pa));
    let values = solve(&plain, &measured);
    let residuals = &plain * &values - &measured;
    let columns = columns(law, &values);
    let scaled = DMatrix::from_fn(points.len(), names.len(), |i, k| plain[(i, k)] * columns[k].tolerance);
    let judged = judge(&columns, &residuals, &scaled, settings, |_| advice(law))?;
    let material = law.material(values.as_slice());
    if material.shear_modulus_pa() <= 0.0 {
        let (field, value) = ("shear_modulus_pa", material.shear_modulus_pa());
        return Err(CalibrationError::Invalid { field, value, place: "the fitted law".into(), allowed: "> 0" });
    }
    let stretches = || points.iter().map(|point| point[0]);
    Ok(TensionFit {
        law,
        values: judged.values(names, &columns),
        material,
        modelled_pa: rows.iter().map(|row| row.iter().zip(&values).map(|(share, c)| share * c).sum()).collect(),
        half_widths_pa: judged.curve.iter().map(|width| accuracy_pa * width).collect(),
        rms_pa: accuracy_pa * (residuals.norm_squared() / points.len() as f64).sqrt(),
        tested: [stretches().fold(1.0, f64::min), stretches().fold(1.0, f64::max)],
        softens_at: softens_at(law, values.as_slice()),
    })
}

/// Linear least squares, columns made equally long first.
pub(super) fn solve(matrix: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let lengths: Vec<f64> = matrix.column_iter().map(|column| column.norm().max(f64::MIN_POSITIVE)).collect();
    let equal = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, k| matrix[(i, k)] / lengths[k]);
    let found = equal.svd(true, true).solve(right, 1e-14).unwrap_or_else(|_| DVector::zeros(lengths.len()));
    DVector::from_fn(lengths.len(), |k, _| found[k] / lengths[k])
}

/// The unknowns with the half widths beyond which they are not worth having: half of a modulus; of C2 and C3 their own size, or where
/// that is less what elastomers have, a tenth and a hundredth of C1.
fn columns(law: Law, values: &DVector<f64>) -> Vec<Column> {
    let c1 = values[0].abs();
    let least = [0.5 * c1, 0.1 * c1, 0.01 * c1];
    let one = |(k, name): (usize, &&'static str)| Column {
        name: (*name).into(),
        shown: if k == 0 { Shown::Percent } else { Shown::Kilopascals },
        value: values[k],
        tolerance: (if k == 0 { least[0] } else { least[k].max(values[k].abs()) }).max(f64::MIN_POSITIVE),
    };
    law.names().iter().enumerate().map(one).collect()
}

fn advice(law: Law) -> String {
    match law {
        Law::NeoHookean => "Points at larger stretches help.",
        Law::YeohTwo => "Larger stretches help, to about 1.5; or fit a neo-Hookean law.",
        Law::Yeoh => "Larger stretches help, to about 2; or fit a law with fewer coefficients: yeoh-2, neo-hookean.",
    }
    .into()
}

/// The first stretch above 1 at which the nominal stress does not grow any more.
fn softens_at(law: Law, values: &[f64]) -> Option<f64> {
    let stress = |stretch: f64| shares(law, stretch).iter().zip(values).map(|(share, c)| share * c).sum::<f64>();
    let step = 1e-3;
    (0..7000).map(|index| 1.0 + step * f64::from(index)).find(|stretch| stress(stretch + step) <= stress(*stretch))
}
