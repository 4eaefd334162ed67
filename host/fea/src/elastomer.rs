//! The elastomer's strain energy, for all finite elements in two dimensions.

use fra_model::Material;

/// `W = C1 x + C2 x^2 + C3 x^3` with `x = I1 - 3`, in units of the small-strain shear modulus, so that `C1` is a half.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Elastomer {
    pub(crate) c: [f64; 3],
}

impl Elastomer {
    /// That of a material.
    pub(crate) fn of(material: &Material<f64>) -> Self {
        let c_pa = match *material {
            Material::NeoHookean { shear_modulus_pa } => [0.5 * shear_modulus_pa, 0.0, 0.0],
            Material::Yeoh { c_pa } => c_pa,
        };
        let unit = material.shear_modulus_pa();
        Self { c: c_pa.map(|c| c / unit) }
    }

    /// `W` and its first two derivatives by `I1`.
    pub(crate) fn at(&self, x: f64) -> [f64; 3] {
        let [c1, c2, c3] = self.c;
        [x * (c1 + x * (c2 + x * c3)), c1 + x * (2.0 * c2 + 3.0 * c3 * x), 2.0 * c2 + 6.0 * c3 * x]
    }
}

/// A cubic by hand: 1/2 x + 3 x^2 - 2 x^3 at 2, and a material whose first constant is half its modulus.
#[test]
fn energy_and_derivatives_are_those_of_the_cubic() {
    assert_eq!(Elastomer { c: [0.5, 3.0, -2.0] }.at(2.0), [-3.0, -11.5, -18.0]);
    assert_eq!(Elastomer::of(&Material::Yeoh { c_pa: [4.0, 2.0, 1.0] }).c, [0.5, 0.25, 0.125]);
    assert_eq!(Elastomer::of(&Material::NeoHookean { shear_modulus_pa: 3.0 }).c, [0.5, 0.0, 0.0]);
}
