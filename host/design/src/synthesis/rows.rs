//! Sums of squares of one pose, over the few variables that move it.

use super::chain::COLUMNS;

/// Rows of one pose, gathered over its few variables.
pub(super) struct Rows {
    pub(super) width: usize,
    row: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    /// Lower triangle, row by row.
    pub(super) normal: Vec<f64>,
    pub(super) value: f64,
}

impl Rows {
    pub(super) fn new(modules: usize) -> Self {
        let width = modules * COLUMNS;
        Self { width, row: vec![0.0; width], gradient: vec![0.0; width], normal: vec![0.0; width * width], value: 0.0 }
    }

    pub(super) fn clear(&mut self) {
        self.gradient.fill(0.0);
        self.normal.fill(0.0);
        self.value = 0.0;
    }

    /// Adds the square of a residual whose derivatives are `scale` times what `fill` writes.
    pub(super) fn add(&mut self, residual: f64, scale: f64, fill: impl FnOnce(&mut [f64])) {
        self.row.fill(0.0);
        fill(&mut self.row);
        self.value += residual * residual;
        for i in 0..self.width {
            let at = scale * self.row[i];
            if at == 0.0 {
                continue;
            }
            self.gradient[i] += at * residual;
            let line = &mut self.normal[i * self.width..][..=i];
            line.iter_mut().zip(&self.row).for_each(|(sum, other)| *sum += at * scale * other);
        }
    }
}
