//! Why data give no answer.

use std::fmt::Write;

use super::Property;

/// Why a fit gives no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// There are no more points than unknowns, so that nothing is left to judge them by.
    #[error(
        "{unknowns} unknown{} from {points} point{}: {needed} points are the fewest, at different loads, \
         because confidence needs one more than there are unknowns", plural(*.unknowns), plural(*.points)
    )]
    TooFewPoints {
        /// Number of unknowns.
        unknowns: usize,
        /// Number of points.
        points: usize,
        /// Least number of points.
        needed: usize,
    },
    /// The data cannot tell some of the unknowns.
    #[error("{}", confusion(.names, .changes, *.moved, .advice))]
    NotIdentified {
        /// The unknowns that are confused, the strongest first; one alone is hardly seen by the data at all.
        names: Vec<String>,
        /// A change of each, in words, that the data do not see.
        changes: Vec<String>,
        /// Largest effect of these changes together on the deformations, in units of their accuracy.
        moved: f64,
        /// Advice.
        advice: String,
    },
    /// The model follows the data with no value of the unknowns.
    #[error(
        "no value{} of {} reproduce{} these data: in the best fit point {} is still {off:.1} times its accuracy off. Check the units and signs of the \
         columns, the sizes in the scene, and that point. More points help only if the measurements scatter as much",
        plural(.names.len()), .names.join(" and "), if .names.len() == 1 { "s" } else { "" }, .point + 1
    )]
    NotReproduced {
        /// The unknowns.
        names: Vec<String>,
        /// Largest residual of the best fit, in units of the accuracy.
        off: f64,
        /// Index of its point in the data.
        point: usize,
    },
    /// The measured deformations go the other way than those of the model.
    #[error(
        "the measured {quantity} of {body} changes with the opposite sign of the model's: by {measured} at {reading_pa:.0} Pa, in the model by \
         {modelled}. Check the signs of the column and of the pressure"
    )]
    OppositeSign {
        /// The body.
        body: String,
        /// The deformation.
        quantity: &'static str,
        /// The reading of the sensor, Pa.
        reading_pa: f64,
        /// Measured change from rest, with its unit.
        measured: String,
        /// Change of the model at the start, with its unit.
        modelled: String,
    },
    /// An unknown that a body does not have.
    #[error("{body} has no {property}: {because}")]
    NoSuchProperty {
        /// The body.
        body: String,
        /// The missing property.
        property: Property,
        /// Why.
        because: &'static str,
    },
    /// One unknown for bodies that differ in it.
    #[error(
        "one {property} for {first} and {other}, which start with different ones ({first_value} and {other_value} {unit}): fit it for each"
    )]
    Different {
        /// The property.
        property: Property,
        /// A body.
        first: String,
        /// Its value.
        first_value: f64,
        /// Another body.
        other: String,
        /// Its value.
        other_value: f64,
        /// Unit of both.
        unit: &'static str,
    },
    /// A value that is not accepted.
    #[error("{field} = {value} of {place} is not allowed: {allowed}")]
    Invalid {
        /// The field, with its unit.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Its place.
        place: String,
        /// Accepted values.
        allowed: &'static str,
    },
    /// The model has no deformation at a pressure of the data, even with a harder wall.
    #[error("{body} has no equilibrium at {reading_pa:.0} Pa{}: {hint}", limit(*.limit_pa))]
    NoEquilibrium {
        /// The body.
        body: String,
        /// The reading of its sensor, Pa.
        reading_pa: f64,
        /// Limit pressure of its branch, Pa.
        limit_pa: Option<f64>,
        /// Advice.
        hint: &'static str,
    },
    /// The limb has no equilibrium in a hold.
    #[error(
        "in phase `{phase}` the limb of the start does not carry its weight: {cause}: check the parameters of the start, the scene's masses and what it \
         carries"
    )]
    Falls {
        /// The phase.
        phase: String,
        /// Why it falls.
        cause: String,
    },
    /// An unknown that is not fitted to a limb under its weight.
    #[error("{property} is not fitted to a run under weight: {}", by_itself(*.property))]
    NotUnderWeight {
        /// The unknown.
        property: Property,
    },
    /// The descent did not end.
    #[error("the fit did not settle after {steps} steps: start it nearer to the answer, or ask for fewer unknowns")]
    NotSettled {
        /// Steps made.
        steps: usize,
    },
}

fn by_itself(property: Property) -> &'static str {
    match property {
        Property::Length => "measure it with a ruler",
        _ => "read the sensor at ambient pressure, or use `calibrate pressure` with a table of actuators without load",
    }
}

fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

fn limit(limit_pa: Option<f64>) -> String {
    limit_pa.map_or(String::new(), |limit| format!(" (its limit point is at {limit:.0} Pa)"))
}

fn confusion(names: &[String], changes: &[String], moved: f64, advice: &str) -> String {
    let mut text = match names {
        [one] => format!("the data do not determine {one}: changing {}", changes.join(" and ")),
        _ => format!("the data do not tell {} apart: changing {} together", names.join(" and "), changes.join(" and ")),
    };
    // Writing to a string cannot fail.
    let _ = write!(text, " moves no point by more than {} of its accuracy. {advice}", share(moved));
    text
}

fn share(moved: f64) -> String {
    if moved < 1e-3 { format!("{moved:.1e}") } else { format!("{moved:.3}") }
}

/// Measurements that tell confused unknowns apart.
pub(super) fn advice(confused: &[Property]) -> String {
    let has = |property| confused.contains(&property);
    let modulus = has(Property::ShearModulus) || has(Property::YeohC1);
    let of_winding = |property: &&Property| property.is_of_winding() || property.is_of_second_winding();
    let unknowns_of_windings = confused.iter().filter(of_winding).count();
    let text = match () {
        () if modulus && has(Property::PressureGain) => {
            "Only their ratio counts: measure the modulus in a tensile test, or the gain against a gauge, and fit the other."
        }
        () if modulus && (has(Property::Wall) || has(Property::InnerRadius)) => {
            "A harder wall acts like a thicker one: measure the wall, or the modulus in a tensile test."
        }
        () if has(Property::SeatingPressure) && has(Property::PressureOffset) => {
            "Beyond the seating pressure both act alike: readings without pressure, or below the seating pressure, tell them apart."
        }
        () if modulus && has(Property::SeatingPressure) => {
            "Points over a wider range of pressures help: the seating pressure moves all of them alike, the modulus the higher ones more."
        }
        () if modulus && has(Property::PressureOffset) => {
            "Points over a wider range of pressures help, and one without pressure fixes the offset."
        }
        () if unknowns_of_windings > 1 => {
            "A second deformation of the same runs helps: the outer radius or the twist beside the stretch."
        }
        () if has(Property::YeohC2) || has(Property::YeohC3) => {
            "Larger stretches help: the second coefficient needs a stretch of about 1.5, the third of about 2."
        }
        () if has(Property::FiberModulus) || has(Property::SecondFiberModulus) => {
            "The fibers of these actuators hardly strain: an actuator that pulls at its fibers helps (angle near the neutral \
             35 deg, higher pressure), or a tensile test of the thread."
        }
        () if has(Property::PressureOffset) || has(Property::PressureGain) => {
            "Points over a wider range of pressures help, and one without pressure fixes the offset."
        }
        () => {
            "More points help, at other pressures, of other deformations, or of larger ones; or fix one of the unknowns."
        }
    };
    text.into()
}
