//! Deformations of a bending body by finite elements of its cross-section.

use fra_model::{InvalidParameter, State, StateQuantity};
use softlimb_fea::cross_section::{EndLoad, Options, Outcome, Section, SectionError};

use super::body::{Deforming, NoAnswer};
use super::{Body, Observation};

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

/// The deformation of a body in each observation.
pub(super) fn deformations(body: &Body, seen: &[&Observation]) -> Result<Vec<Result<f64, NoAnswer>>, NoAnswer> {
    let options = Options::default();
    let section = match &body.second_fiber {
        None => Section::new(&body.parameters, &options),
        Some(second) => Section::with_two_windings(&body.parameters, second, &options),
    }?;
    let deforming: Vec<Deforming> = seen.iter().map(|seen| body.deforming(seen.reading_pa, seen.branch)).collect();
    let pressures_pa: Vec<f64> = deforming.iter().map(|deforming| deforming.pressure_pa).collect();
    let states = states(&section, body.parameters.length_m, &pressures_pa)?;
    let signed = deforming.iter().zip(seen).map(|(deforming, seen)| (deforming.sign, seen.quantity));
    let of = |(state, (sign, quantity)): (Result<State<f64>, NoAnswer>, _)| {
        state.map(|state| sign * StateQuantity::of(quantity, &state))
    };
    Ok(states.into_iter().zip(signed).map(of).collect())
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
