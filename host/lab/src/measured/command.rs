//! `softlimb-lab measured`: measured actuators and elastomers beside the models.

use clap::Args;
use serde::Serialize;
use softlimb::cli::{Failure, Outcome};
use softlimb_chart::{Axis, Chart, Color, Series, Stroke, Ticks, sheet, span};

use super::{PLACE, Set, page, sets};
use crate::published::Published;

/// Area of one chart, px, and its width with its frame.
const AREA: [f64; 2] = [322.0, 250.0];
const ROOM: f64 = 400.0;

const CAPTION: &str = "Bend of actuators of latex tubing, beside the analytic model and finite elements of the cross-section with nothing fitted. \
                       Dot: one reading, published in skim0119/BR2-simulator.";

/// Compare the models with measured actuators and elastomers, with nothing fitted and with a fitted modulus
#[derive(Args)]
#[command(
    after_help = "All of it:\n  cargo xtask lab measured --svg docs/evidence/measured.svg --page docs/evidence/measured.md"
)]
pub(crate) struct Measured {
    #[command(flatten)]
    published: Published,
}

#[derive(Serialize)]
struct Printed {
    angle_deg: f64,
    length_m: f64,
    pressure_pa: f64,
    readings_rad: Vec<f64>,
    analytic_rad: f64,
    section_rad: f64,
    default_rad: f64,
    fitted_rad: f64,
    fitted_shear_modulus_pa: f64,
}

impl Measured {
    pub(crate) fn run(&self) -> Result<Outcome, Failure> {
        let section = self.published.page(PLACE)?;
        let sets = sets()?;
        let text = page(&sets)?;
        self.published.keep(|| tsv(&sets))?;
        self.published.draw(|| picture(&sets))?;
        self.published.show(|| printed(&sets), || text.clone())?;
        section.map_or(Ok(()), |section| section.write(&text))?;
        Ok(Outcome::Done)
    }
}

fn printed(sets: &[Set]) -> Vec<Printed> {
    let rows = sets.iter().flat_map(|set| set.rows.iter().map(move |row| (set, row)));
    rows.map(|(set, row)| Printed {
        angle_deg: set.angle_deg,
        length_m: set.length_m,
        pressure_pa: row.pressure_pa,
        readings_rad: row.readings.clone(),
        analytic_rad: row.analytic,
        section_rad: row.section,
        default_rad: row.default,
        fitted_rad: row.fitted,
        fitted_shear_modulus_pa: set.fitted_pa,
    })
    .collect()
}

fn tsv(sets: &[Set]) -> String {
    let heading =
        "angle_deg\tlength_m\tpressure_pa\treadings\tmean_rad\tanalytic_rad\tsection_rad\tdefault_rad\tfitted_rad\n";
    let rows = printed(sets).into_iter().map(|row| {
        let count = row.readings_rad.len();
        let mean = row.readings_rad.iter().sum::<f64>() / count as f64;
        let Printed { angle_deg, length_m, pressure_pa, analytic_rad, section_rad, default_rad, fitted_rad, .. } = row;
        format!("{angle_deg}\t{length_m}\t{pressure_pa}\t{count}\t{mean}\t{analytic_rad}\t{section_rad}\t{default_rad}\t{fitted_rad}\n")
    });
    heading.to_owned() + &rows.collect::<String>()
}

/// A chart for each set with more than one pressure.
pub fn picture(sets: &[Set]) -> String {
    let charts = sets.iter().filter(|set| set.rows.len() > 1).map(chart).collect();
    sheet(&[charts], ROOM, CAPTION)
}

fn chart(set: &Set) -> Chart {
    let line = |label: &str, color, stroke, bend: fn(&super::Row) -> f64| Series {
        label: label.into(),
        color,
        stroke,
        points: set.rows.iter().map(|row| [1e-3 * row.pressure_pa, bend(row).to_degrees()]).collect(),
    };
    let readings = set
        .rows
        .iter()
        .flat_map(|row| row.readings.iter().map(|reading| [1e-3 * row.pressure_pa, reading.to_degrees()]));
    let series = vec![
        line("analytic", Color::nth(1), Stroke::Dotted, |row| row.analytic),
        line("cross-section", Color::First, Stroke::Solid, |row| row.section),
        Series { label: "measured".into(), color: Color::Ink, stroke: Stroke::Dots, points: readings.collect() },
    ];
    let range = |axis: usize| span(series.iter().flat_map(|series| &series.points).map(|point| point[axis]));
    let axis = |label: &str, range| Axis { label: label.into(), range, ticks: Ticks::Round };
    let (x, y) = (axis("pressure, kPa", range(0)), axis("bend, deg", range(1)));
    Chart {
        title: format!("threads at {:.0} deg from the hoop", set.angle_deg),
        area: AREA,
        x,
        y,
        series,
        bands: Vec::new(),
        marks: Vec::new(),
        notes: Vec::new(),
    }
}
