//! Space seen from afar, as a picture has it.

/// The direction of the view, rad: from which side, and from how high.
const AZIMUTH: f64 = -1.0;
const ELEVATION: f64 = 0.35;

/// A parallel projection to px, fitted to what it shows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Projection {
    /// px per m.
    scale: f64,
    /// The place of the origin, px.
    origin: [f64; 2],
}

impl Projection {
    /// The largest one that shows balls, by their centers and radii in m, in the middle of an area whose corner and size are given in px.
    pub(super) fn fitted(balls: impl Iterator<Item = ([f64; 3], f64)>, corner: [f64; 2], area: [f64; 2]) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (at, radius) in balls {
            for (axis, place) in flat(&at).into_iter().enumerate().filter(|(_, place)| place.is_finite()) {
                low[axis] = low[axis].min(place - radius);
                high[axis] = high[axis].max(place + radius);
            }
        }
        let size = [0, 1].map(|axis| (high[axis] - low[axis]).max(1e-6));
        let scale = (area[0] / size[0]).min(area[1] / size[1]);
        let middle = [0, 1].map(|axis| corner[axis] + 0.5 * area[axis] - 0.5 * scale * (low[axis] + high[axis]));
        Self { scale, origin: middle }
    }

    /// Where a point is, px.
    pub(super) fn at(&self, point_m: &[f64; 3]) -> [f64; 2] {
        let place = flat(point_m);
        [0, 1].map(|axis| self.origin[axis] + self.scale * place[axis])
    }

    /// The same in the words of an SVG.
    pub(super) fn text(&self, point_m: &[f64; 3]) -> String {
        let [x, y] = self.at(point_m);
        format!("{x:.1},{y:.1}")
    }

    /// A length across the view, px.
    pub(super) fn length(&self, length_m: f64) -> f64 {
        self.scale * length_m
    }
}

/// How far a point is from the eye beyond the origin, m.
pub(super) fn depth(point_m: &[f64; 3]) -> f64 {
    ahead(point_m) * ELEVATION.cos() - point_m[2] * ELEVATION.sin()
}

/// Height over width of a level circle.
pub(super) fn flatness() -> f64 {
    ELEVATION.sin()
}

fn ahead(point_m: &[f64; 3]) -> f64 {
    -(AZIMUTH.cos() * point_m[0] + AZIMUTH.sin() * point_m[1])
}

/// To the right, and down, m.
fn flat(point_m: &[f64; 3]) -> [f64; 2] {
    let right = AZIMUTH.cos() * point_m[1] - AZIMUTH.sin() * point_m[0];
    [right, -(point_m[2] * ELEVATION.cos() + ahead(point_m) * ELEVATION.sin())]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_the_view_are_at_right_angles_and_lengths_across_it_are_kept() {
        let view = Projection { scale: 100.0, origin: [0.0; 2] };
        // Columns of right, down and depth over the axes of space: a rotation.
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let rows = axes.map(|axis| [flat(&axis)[0], flat(&axis)[1], depth(&axis)]);
        for a in 0..3 {
            for b in 0..3 {
                let product: f64 = (0..3).map(|axis| rows[axis][a] * rows[axis][b]).sum();
                assert!((product - f64::from(u8::from(a == b))).abs() < 1e-12, "{a} {b}");
            }
        }
        // Higher is up in the picture.
        assert!(view.at(&[0.0, 0.0, 1.0])[1] < 0.0);
    }

    #[test]
    fn what_is_shown_fills_one_side_of_its_area_and_lies_within_the_other() {
        let balls = [([0.0, 0.0, 0.0], 0.1), ([1.0, 0.3, 0.2], 0.05), ([0.4, -0.5, 0.9], 0.0)];
        let view = Projection::fitted(balls.into_iter(), [10.0, 20.0], [300.0, 200.0]);
        let ends = [0, 1].map(|axis| {
            let sides = balls
                .iter()
                .flat_map(|(at, radius)| [-1.0, 1.0].map(|sign| view.at(at)[axis] + sign * view.length(*radius)));
            sides.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], side| [low.min(side), high.max(side)])
        });
        let [width, height] = ends.map(|[low, high]| high - low);
        assert!(
            (width - 300.0).abs().min((height - 200.0).abs()) < 1e-9 && width < 300.0 + 1e-9 && height < 200.0 + 1e-9
        );
        assert!(ends[0][0] > 10.0 - 1e-9 && ends[1][0] > 20.0 - 1e-9, "{ends:?}");
    }
}
