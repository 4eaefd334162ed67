//! Deformations of a bending body by finite elements of its cross-section.

use fra_model::{InvalidParameter, State, StateQuantity};
use softlimb_fea::cross_section::{EndLoad, Options, Outcome, Section, SectionError};

use super::Body;
use super::body::NoAnswer;

/// Most readings that are solved one by one. More are interpolated between solutions along a curve.
const ONE_BY_ONE: usize = 24;

impl From<SectionError> for NoAnswer {
    fn from(error: SectionError) -> Self {
        match error {
            SectionError::Parameter(error) | SectionError::SecondWinding(error) => Self::Invalid(error),
            // The options are the default ones, and a pressure is left.
            SectionError::Option(error) => Self::Invalid(InvalidParameter {
                field: "pressure_pa",
                value: error.value,
                allowed: "up to 100 times the shear modulus in finite elements",
            }),
            SectionError::NoBend { pressure_pa, .. } => Self::BeyondLimit(Some(pressure_pa)),
        }
    }
}

/// The deformation of a body at each reading, Pa, and quantity.
pub(super) fn deformations(body: &Body, seen: &[(f64, StateQuantity)]) -> Result<Vec<Result<f64, NoAnswer>>, NoAnswer> {
    let options = Options::default();
    let section = match &body.second_fiber {
        None => Section::new(&body.parameters, &options),
        Some(second) => Section::with_two_windings(&body.parameters, second, &options),
    }?;
    let mirrored: Vec<(f64, f64)> = seen.iter().map(|(reading_pa, _)| body.mirrored(*reading_pa)).collect();
    let pressures_pa: Vec<f64> = mirrored.iter().map(|(pressure_pa, _)| body.deforming_pa(*pressure_pa)).collect();
    let states = states(&section, body.parameters.length_m, &pressures_pa)?;
    let signed = mirrored.iter().zip(seen).map(|((_, sign), (_, quantity))| (*sign, *quantity));
    let of = |state: Result<State<f64>, NoAnswer>, (sign, quantity): (f64, StateQuantity)| {
        state.map(|state| sign * quantity.of(&state))
    };
    Ok(states.into_iter().zip(signed).map(|(state, signed)| of(state, signed)).collect())
}

/// The states at gauge pressures, Pa.
fn states(
    section: &Section,
    length_m: f64,
    pressures_pa: &[f64],
) -> Result<Vec<Result<State<f64>, NoAnswer>>, NoAnswer> {
    let mut distinct_pa = pressures_pa.to_vec();
    distinct_pa.sort_by(f64::total_cmp);
    distinct_pa.dedup();
    let highest_pa = distinct_pa.last().copied().unwrap_or(0.0);
    if distinct_pa.len() > ONE_BY_ONE {
        let curve = section.interpolated(length_m, highest_pa)?.ok_or(NoAnswer::BeyondLimit(None))?;
        let at = |pressure_pa: &f64| {
            let reached = *pressure_pa <= curve.pressure_max_pa();
            reached.then(|| curve.at(*pressure_pa)).ok_or(NoAnswer::BeyondLimit(curve.limit_pressure_pa()))
        };
        return Ok(pressures_pa.iter().map(at).collect());
    }
    let curve = section.curve(&distinct_pa, &EndLoad::default())?;
    let at = |pressure_pa: &f64| {
        let answer = &curve.answers[distinct_pa.partition_point(|distinct_pa| distinct_pa < pressure_pa)];
        match &answer.outcome {
            Outcome::Equilibrium(equilibrium) => Ok(equilibrium.state.over(length_m)),
            Outcome::NoEquilibrium { limit_pressure_pa } => Err(NoAnswer::BeyondLimit(Some(*limit_pressure_pa))),
            Outcome::LoadNotCarried | Outcome::NotConverged { .. } => Err(NoAnswer::BeyondLimit(None)),
        }
    };
    Ok(pressures_pa.iter().map(at).collect())
}
