//! The sheet that lies beside the work: one page for each kind of actuator, as Markdown and as a page to print.

use std::fmt::Write;

use askama::Template;
use serde::Serialize;

use super::drawing::{drawing, mold_drawing};
use super::rows;
use super::{Piece, Settings};

/// Everything on the sheet of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sheet {
    /// The scene.
    pub scene: String,
    /// One page for each module.
    pub pages: Vec<Page>,
}

/// The page of the actuators of one module.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Page {
    /// Name of the module.
    pub module: String,
    /// Its motion.
    pub motion: String,
    /// Number of actuators.
    pub count: usize,
    /// What to know before beginning.
    pub warnings: Vec<String>,
    /// Tables of quantities.
    pub tables: Vec<Table>,
    /// Each actuator, with room for what is measured on it.
    pub copies: Vec<CopyRow>,
    /// Files that belong to it.
    pub files: Vec<String>,
}

/// Some quantities under a heading.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// Heading.
    pub title: String,
    /// Quantities.
    pub rows: Vec<Row>,
}

/// One quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Its name.
    pub what: String,
    /// Its value with its unit.
    pub value: String,
    /// How far it may be off, or what it follows from; may be empty.
    pub note: String,
}

/// One actuator.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CopyRow {
    /// Its channel.
    pub channel: usize,
    /// Where its axis meets the connector.
    pub place: String,
}

/// The sheet of a scene's pieces; `files` names the files of a piece.
pub fn sheet(scene: &str, pieces: &[Piece], settings: &Settings, files: impl Fn(&Piece) -> Vec<String>) -> Sheet {
    let pages = pieces.iter().map(|piece| Page { files: files(piece), ..rows::page(piece, settings) });
    Sheet { scene: scene.to_owned(), pages: pages.collect() }
}

/// The sheet as Markdown.
pub fn markdown(sheet: &Sheet) -> String {
    let mut text = format!("# Fabrication of {}\n", sheet.scene);
    for page in &sheet.pages {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\n## {}: {}, make {}", page.module, page.motion, page.count);
        for warning in &page.warnings {
            let _ = writeln!(text, "\n**Note:** {warning}.");
        }
        for table in &page.tables {
            let _ = writeln!(text, "\n### {}\n\n| | | tolerance, origin |\n| --- | --: | --- |", table.title);
            for row in &table.rows {
                let _ = writeln!(text, "| {} | {} | {} |", row.what, row.value, row.note);
            }
        }
        text += "\n### Each actuator\n\n| channel | axis on the connector | wall measured, mm | mass, g | holds pressure |\n| --: | --- | --- | --- | --- |\n";
        for copy in &page.copies {
            let _ = writeln!(text, "| {} | {} | | | |", copy.channel, copy.place);
        }
        let _ = writeln!(text, "\nFiles: {}.", page.files.join(", "));
    }
    text
}

/// The sheet with its drawings.
#[derive(Template)]
#[template(path = "fabricate/sheet.html")]
struct Drawn<'a> {
    sheet: &'a Sheet,
    /// For each page the actuator, and its mold.
    drawings: Vec<[String; 2]>,
}

/// The sheet of pieces as one HTML file with drawings that needs nothing beside it; each page begins on a sheet of paper of its own.
pub fn html(sheet: &Sheet, pieces: &[Piece], settings: &Settings) -> String {
    let drawings = pieces.iter().map(|piece| [drawing(piece), mold_drawing(piece, settings)]).collect();
    let drawn = Drawn { sheet, drawings };
    // The name of the template ends in .html: everything but the drawings is escaped.
    drawn.render().expect("a page is written to memory")
}
