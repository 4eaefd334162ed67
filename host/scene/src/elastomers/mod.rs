//! Castable elastomers by their trade names.

use fra_model::Material;

use crate::suggest::closest;

/// The tensile tests behind the laws: `material`, `strain`, `nominal_stress_mpa`. Source and license are in its comments.
pub const TENSILE_TESTS: &str = include_str!("tensile.csv");

/// An elastomer whose law is fitted to a tensile test of a virgin specimen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CastableElastomer {
    /// Trade name.
    pub name: &'static str,
    /// Coefficients C1, C2, C3 of the Yeoh law, Pa.
    pub c_pa: [f64; 3],
    /// Least and largest stretch of the readings that the law describes.
    pub stretch: [f64; 2],
}

impl CastableElastomer {
    /// The law.
    pub fn material(&self) -> Material<f64> {
        Material::Yeoh { c_pa: self.c_pa }
    }
}

const fn castable(name: &'static str, c_pa: [f64; 3], stretch: [f64; 2]) -> CastableElastomer {
    CastableElastomer { name, c_pa, stretch }
}

/// All of them: fits of `softlimb_rig::calibrate::fit_range` to [`TENSILE_TESTS`], which a test there compares.
pub const CASTABLE_ELASTOMERS: [CastableElastomer; 15] = [
    castable("BodyDouble SILK", [51092.68, 13077.796, -2898.6913], [1.1, 2.0]),
    castable("Dragon Skin 10 MEDIUM", [21442.85, 2616.047, -61.6679], [1.1, 4.5]),
    castable("Dragon Skin 30", [90014.17, 7790.682, -183.9277], [1.1, 4.5]),
    castable("Dragon Skin FX Pro", [14042.79, 800.024, -12.3218], [1.1, 5.0]),
    castable("Dragon Skin FX Pro Slacker", [1369.04, 5.013, 0.2147], [1.3, 5.0]),
    castable("Ecoflex 00-10", [3546.80, 156.528, -1.2458], [1.1, 5.0]),
    castable("Ecoflex 00-30", [7160.95, 373.961, -25.4474], [1.1, 3.0]),
    castable("Ecoflex 00-50", [9921.31, 432.330, -12.3249], [1.1, 3.75]),
    castable("Mold Star 20T", [54189.40, 3488.412, -49.5334], [1.1, 5.0]),
    castable("PlatSil Gel 10", [26289.54, 3752.501, -133.2842], [1.1, 3.75]),
    castable("Psycho Paint", [58926.39, 3182.341, -46.4674], [1.1, 5.0]),
    castable("Rebound 25", [48785.29, 3999.379, -65.1297], [1.1, 5.0]),
    castable("SOLOPLAST 150318", [33002.23, 1752.436, -18.0349], [1.1, 5.0]),
    castable("SortaClear 40", [138204.74, 6155.821, -81.2118], [1.1, 5.0]),
    castable("WAGNERSIL 20 NF", [55603.34, 8712.848, -227.7902], [1.05, 4.0]),
];

/// The elastomer of a trade name.
///
/// # Errors
/// The name that may be meant, or the command that lists them.
pub fn castable_elastomer(name: &str) -> Result<&'static CastableElastomer, String> {
    CASTABLE_ELASTOMERS.iter().find(|elastomer| elastomer.name == name).ok_or_else(|| {
        let names = CASTABLE_ELASTOMERS.iter().map(|elastomer| elastomer.name);
        match closest(name, names) {
            Some(meant) => format!("did you mean \"{meant}\"?"),
            None => "`softlimb materials` lists the known ones".into(),
        }
    })
}
