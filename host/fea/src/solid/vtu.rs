//! Deformed meshes for ParaView: VTK XML, one file for each pressure and one that lists them.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::gauge::Displacements;
use super::mesh::{Kind, Part};
use super::{FemError, Model, Run};
use softlimb_files::range::require;
use softlimb_files::{make_folder, write_whole};

/// Types of cells: line, quadratic brick, quadratic wedge. Their nodes are in the order of a deck.
const LINE: u8 = 3;
const BRICK: u8 = 25;
const WEDGE: u8 = 26;

impl Run {
    /// Writes the deformed mesh at each pressure that converged to a folder, and `NAME.pvd`, which lists them by pressure in kPa. Returns
    /// its path. Only a run whose options asked for all nodes can be drawn.
    ///
    /// # Errors
    /// [`FemError::File`]; [`FemError::Invalid`] where the run has printed its gauges alone.
    pub fn write_vtu(&self, folder: &Path, name: &str) -> Result<PathBuf, FemError> {
        require(self.model.all_nodes, "all_nodes", 0.0, "all nodes must be printed to draw a mesh")?;
        make_folder(folder)?;
        let pressures = self.points.iter().filter(|point| point.middle.is_some()).map(|point| point.pressure_pa);
        let mut list = String::from("<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
        for (number, (pressure, moved)) in pressures.zip(&self.moved).enumerate() {
            let file = format!("{name}-{:03}.vtu", number + 1);
            write_whole(&folder.join(&file), &grid(&self.model, moved))?;
            let kpa = pressure * 1e-3;
            let _ = writeln!(list, "<DataSet timestep=\"{kpa}\" file=\"{file}\"/>");
        }
        list.push_str("</Collection>\n</VTKFile>\n");
        let path = folder.join(format!("{name}.pvd"));
        write_whole(&path, &list)?;
        Ok(path)
    }
}

/// One deformed mesh. Writing to a text cannot fail.
fn grid(model: &Model, moved: &Displacements) -> String {
    let mesh = &model.mesh;
    let still = [0.0; 3];
    let shifts: Vec<&[f64; 3]> = (0..mesh.nodes.len()).map(|node| moved.get(&node).unwrap_or(&still)).collect();
    let now = mesh.nodes.iter().zip(&shifts).map(|(at, by)| [0, 1, 2].map(|n| at[n] + by[n]));
    let solids = mesh.elements.iter().map(|element| {
        let kind = if element.kind == Kind::Brick { BRICK } else { WEDGE };
        let part = match element.part {
            Part::Wall => 0,
            Part::Layer => 1,
            Part::Cap => 2,
            Part::Plate => 3,
        };
        (kind, part, element.nodes.clone())
    });
    let trusses = model.trusses.iter().flat_map(|trusses| &trusses.pairs).map(|ends| (LINE, 4, ends.to_vec()));
    let cells: Vec<(u8, u8, Vec<usize>)> = solids.chain(trusses).collect();
    let mut text = String::from("<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n");
    let _ = writeln!(
        text,
        "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">",
        mesh.nodes.len(),
        cells.len()
    );
    text.push_str("<PointData Vectors=\"displacement_mm\">\n");
    array(&mut text, "Float64\" Name=\"displacement_mm\" NumberOfComponents=\"3", shifts.iter().map(|by| triple(by)));
    text.push_str("</PointData>\n<CellData Scalars=\"part\">\n");
    array(&mut text, "UInt8\" Name=\"part", cells.iter().map(|(_, part, _)| part.to_string()));
    text.push_str("</CellData>\n<Points>\n");
    array(&mut text, "Float64\" NumberOfComponents=\"3", now.map(|at| triple(&at)));
    text.push_str("</Points>\n<Cells>\n");
    let nodes = |(_, _, nodes): &(u8, u8, Vec<usize>)| nodes.iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
    array(&mut text, "Int64\" Name=\"connectivity", cells.iter().map(nodes));
    let ends = cells.iter().scan(0, |end, (_, _, nodes)| {
        *end += nodes.len();
        Some(end.to_string())
    });
    array(&mut text, "Int64\" Name=\"offsets", ends);
    array(&mut text, "UInt8\" Name=\"types", cells.iter().map(|(kind, _, _)| kind.to_string()));
    text.push_str("</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    text
}

fn array(text: &mut String, head: &str, lines: impl Iterator<Item = String>) {
    let _ = writeln!(text, "<DataArray type=\"{head}\" format=\"ascii\">");
    lines.for_each(|line| {
        text.push_str(&line);
        text.push('\n');
    });
    text.push_str("</DataArray>\n");
}

fn triple([x, y, z]: &[f64; 3]) -> String {
    format!("{x:.7e} {y:.7e} {z:.7e}")
}
