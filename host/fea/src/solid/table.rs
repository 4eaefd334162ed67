//! A run as text: for people, and tab-separated for programs.

use std::fmt::Write;

use super::{Ends, Point, PointStatus, Rates, Run};

/// Columns of the tab-separated values.
const COLUMNS: &str = "pressure_pa\tstatus\taxial_stretch\touter_radius_m\tinner_radius_m\ttwist_rate_rad_per_m\tbend_rate_rad_per_m\t\
                       end_axial_stretch\tend_twist_rad\tend_bend_angle_rad\tseconds";

impl PointStatus {
    /// One word: `converged`, `beyond_jump` or `not_reached`.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::BeyondJump { .. } => "beyond_jump",
            Self::NotReached { .. } => "not_reached",
        }
    }
}

impl Run {
    /// Tab-separated values with a line of names; empty where there is no figure.
    pub fn tsv(&self) -> String {
        let mut text = format!("{COLUMNS}\n");
        for point in &self.points {
            let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
            let middle = |field: fn(&Rates) -> f64| number(point.middle.as_ref().map(field));
            let ends = |field: fn(&Ends) -> f64| number(point.ends.as_ref().map(field));
            let cells = [
                format!("{:e}", point.pressure_pa),
                point.status.word().to_owned(),
                middle(|rates| rates.axial_stretch),
                middle(|rates| rates.outer_radius_m),
                middle(|rates| rates.inner_radius_m),
                middle(|rates| rates.twist_rate_rad_per_m),
                middle(|rates| rates.bend_rate_rad_per_m),
                ends(|ends| ends.axial_stretch),
                ends(|ends| ends.twist_rad),
                ends(|ends| ends.bend_angle_rad),
                number(point.seconds),
            ];
            text.push_str(&cells.join("\t"));
            text.push('\n');
        }
        text
    }

    /// A table for people: strains in the middle of the length, and between the ends.
    pub fn table(&self) -> String {
        let mut text = String::from(
            "              middle of the length                             between the caps\n\
             pressure, kPa    stretch  outer radius, mm  twist, deg/m  bend, deg/m    stretch  twist, deg  bend, deg\n",
        );
        for point in &self.points {
            // Writing to a text cannot fail.
            let _ = match (&point.middle, &point.ends) {
                (Some(middle), Some(ends)) => writeln!(
                    text,
                    "{:13.3} {:10.5} {:17.4} {:13.3} {:12.3} {:10.5} {:11.3} {:10.3}",
                    point.pressure_pa * 1e-3,
                    middle.axial_stretch,
                    middle.outer_radius_m * 1e3,
                    degrees(middle.twist_rate_rad_per_m),
                    degrees(middle.bend_rate_rad_per_m),
                    ends.axial_stretch,
                    degrees(ends.twist_rad),
                    degrees(ends.bend_angle_rad),
                ),
                _ => writeln!(text, "{:13.3} {}", point.pressure_pa * 1e-3, why(point)),
            };
        }
        text
    }
}

/// Degrees; what the table's digits do not show is zero, and not a zero with a sign.
fn degrees(angle_rad: f64) -> f64 {
    let degrees = angle_rad.to_degrees();
    if degrees.abs() < 5e-4 { 0.0 } else { degrees }
}

/// Why a point has no figures.
fn why(point: &Point) -> String {
    match point.status {
        PointStatus::Converged => String::new(),
        PointStatus::NotReached { reached_pa } => {
            format!("  not reached: the run ended at {:.3} kPa", reached_pa * 1e-3)
        }
        PointStatus::BeyondJump { between_pa: [a, b] } => format!(
            "  not to be used: the lumen grew abruptly between {:.3} and {:.3} kPa, as when load control jumps over a limit point",
            a * 1e-3,
            b * 1e-3
        ),
    }
}
