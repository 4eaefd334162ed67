//! The two scalars of the model, to and from `f64`.

use fra_model::Precision;

pub(crate) trait Scalar: Precision + std::fmt::Debug {
    const NAME: &'static str;
    const EPSILON: f64;
    fn rounded(value: f64) -> Self;
    fn exact(self) -> f64;
}

impl Scalar for f64 {
    const NAME: &'static str = "f64";
    const EPSILON: f64 = f64::EPSILON;
    fn rounded(value: f64) -> Self {
        value
    }
    fn exact(self) -> f64 {
        self
    }
}

impl Scalar for f32 {
    const NAME: &'static str = "f32";
    const EPSILON: f64 = f32::EPSILON as f64;
    fn rounded(value: f64) -> Self {
        value as f32
    }
    fn exact(self) -> f64 {
        f64::from(self)
    }
}
