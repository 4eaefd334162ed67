//! A closed surface of triangles, and the file that printers read.

/// Triangles between shared corners, counter-clockwise as seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners, m.
    pub points_m: Vec<[f64; 3]>,
    /// Corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    pub(super) fn add(&mut self, point_m: [f64; 3]) -> u32 {
        self.points_m.push(point_m);
        self.points_m.len() as u32 - 1
    }

    /// Volume inside, m3, by the divergence theorem.
    pub fn volume_m3(&self) -> f64 {
        let six = |[a, b, c]: [[f64; 3]; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        self.triangles.iter().map(|corners| six(self.corners(corners))).sum::<f64>() / 6.0
    }

    /// The surface as a binary STL file, in mm.
    pub fn stl(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(84 + 50 * self.triangles.len());
        let mut header = [b' '; 80];
        let words = b"softlimb, mm";
        header[..words.len()].copy_from_slice(words);
        bytes.extend(header);
        bytes.extend((self.triangles.len() as u32).to_le_bytes());
        for triangle in &self.triangles {
            let corners = self.corners(triangle);
            for vector in [normal(corners)].iter().chain(&corners.map(|corner| corner.map(|m| m * 1e3))) {
                vector.iter().for_each(|value| bytes.extend((*value as f32).to_le_bytes()));
            }
            bytes.extend([0, 0]);
        }
        bytes
    }

    fn corners(&self, triangle: &[u32; 3]) -> [[f64; 3]; 3] {
        triangle.map(|corner| self.points_m[corner as usize])
    }
}

/// Unit normal of a triangle; zero where it has no area.
fn normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|end| [end[0] - a[0], end[1] - a[1], end[2] - a[2]]);
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { cross.map(|x| x / length) } else { [0.0; 3] }
}

/// A point by radius, angle and height.
pub(super) fn at(radius_m: f64, angle_rad: f64, height_m: f64) -> [f64; 3] {
    let (sin, cos) = angle_rad.sin_cos();
    [radius_m * cos, radius_m * sin, height_m]
}
