//! Errors and times of the models.

use std::array;
use std::hint::black_box;

use fra_model::{Actuator, Load, StateQuantity, Status};
use softlimb_fea::cross_section::{CALIBRATED_FROM, EndLoad, Mesh, Options, Section, SectionError};
use softlimb_limb::StateCurve;
use softlimb_motion::inverse_table::{Subject, device_tables};
use softlimb_numerics::statistics::percentile;

use super::benders::{Bender, benders};
use super::{Choice, Row, Seconds};
use crate::accuracy::entry::{Work, nanoseconds};

/// Pressures of a curve.
const PRESSURES: usize = 6;
/// Mesh of the reference: six times as fine as the default one in both directions.
pub(super) const REFERENCE: Mesh = Mesh { radial: 24, around: 96 };
/// Largest error of a table, as a share of the highest pressure: the default `inverse_error` of a scene.
const BUDGET: f64 = 1e-4;
const ATMOSPHERE_PA: f64 = 101_325.0;

/// Seconds, of any origin.
type Clock<'a> = Option<&'a dyn Fn() -> f64>;

/// Asks the models about the first benders of a seed; with a `clock` also how long each takes. CalculiX is left out.
///
/// # Errors
/// A sentence about the bender that has no reference.
pub fn measure(seed: u64, count: usize, clock: Clock<'_>, mut progress: impl FnMut(usize)) -> Result<Choice, String> {
    let (mut rows, mut all) = (Vec::new(), Vec::new());
    for (index, bender) in benders(seed, count)?.iter().enumerate() {
        progress(index);
        let (row, seconds) = measured(bender, clock).map_err(|error| format!("{}: {error}", bender.name))?;
        rows.push(row);
        all.push(seconds);
    }
    let median = |model: usize, of: fn(&Seconds) -> Option<f64>| {
        percentile(all.iter().filter_map(|seconds| seconds.get(model).and_then(of)), 50)
    };
    let seconds = array::from_fn(|model| Seconds {
        preparation: median(model, |seconds| seconds.preparation),
        answer: median(model, |seconds| seconds.answer),
    });
    Ok(Choice { seed, rows, seconds })
}

fn measured(bender: &Bender, clock: Clock<'_>) -> Result<(Row, [Seconds; 4]), String> {
    let Bender { parameters, pressure_max_pa, name } = bender;
    let length_m = parameters.length_m;
    let pressures_pa: [f64; PRESSURES] = array::from_fn(|k| pressure_max_pa * (k + 1) as f64 / PRESSURES as f64);
    let actuator = Actuator::new(parameters).map_err(|error| error.to_string())?;
    let section = |mesh| Section::new(parameters, &Options { mesh, ..Options::default() });
    let refused = |error: SectionError| error.to_string();
    let (finer, section) = (section(REFERENCE).map_err(refused)?, section(Mesh::default()).map_err(refused)?);
    let reference = bends(&finer, &pressures_pa, length_m).map_err(refused)?.ok_or("the reference has no bend")?;
    let largest = |found: &dyn Fn(usize) -> Option<f64>| {
        let mut errors = reference.iter().enumerate().map(|(k, [bend, _])| Some((found(k)? / bend - 1.0).abs()));
        errors.try_fold(0.0, |most, error| Some(f64::max(most, error?)))
    };

    let solved = |pressure_pa: f64| {
        let found = actuator.forward(pressure_pa, &Load::none()).ok()?;
        (found.status == Status::Solved).then_some(found.state.bend_angle_rad)
    };
    let (calibration, cubic_s) =
        timed(clock, || section.calibrate([CALIBRATED_FROM * pressure_max_pa, *pressure_max_pa]));
    let cubic = calibration.ok().map(|calibration| calibration.polynomial);
    let (tables, table_s) = timed(clock, || {
        let curve = StateCurve::by_section(parameters, None, *pressure_max_pa)?;
        let subject = Subject { by_curve: true, ..Subject::new(&actuator, StateQuantity::BendAngle, &curve) };
        let tables = device_tables(&subject, BUDGET, ATMOSPHERE_PA).map_err(|error| error.to_string())?;
        let table = tables.inverse.and_then(|fit| fit.table()).ok_or("no table")?;
        Ok::<_, String>((curve, table))
    });
    let tables = tables.ok();
    let by_section = bends(&section, &pressures_pa, length_m).map_err(refused)?;
    let errors = [
        largest(&|k| solved(pressures_pa[k])),
        cubic.and_then(|cubic| largest(&|k| Some(cubic.bend_rate_rad_per_m(pressures_pa[k]) * length_m))),
        tables.as_ref().and_then(|(curve, table)| {
            let bend = |pressure_pa: f64| curve.at(pressure_pa).bend_angle_rad;
            // The wrong pressure for the right bend, as the bend that this pressure leads to.
            largest(&|k| {
                let found = table.lookup(reference[k][0] as f32).ok()?;
                Some(reference[k][0] + bend(f64::from(found.pressure_pa)) - bend(pressures_pa[k]))
            })
        }),
        by_section.and_then(|found| largest(&|k| Some(found[k][0]))),
    ];

    let per_answer = |curve: &dyn Fn()| clock.map(|clock| 1e-9 * nanoseconds(&Curve(curve), clock));
    let one_by_one = |answer: &dyn Fn(usize) -> f64| {
        per_answer(&|| {
            black_box((0..PRESSURES).map(|k| answer(black_box(k))).sum::<f64>());
        })
    };
    let bends_f32: [f32; PRESSURES] = array::from_fn(|k| reference[k][0] as f32);
    let seconds = [
        Seconds { preparation: None, answer: one_by_one(&|k| solved(pressures_pa[k]).unwrap_or(0.0)) },
        Seconds {
            preparation: cubic_s,
            answer: cubic.and_then(|cubic| one_by_one(&|k| cubic.pressure_pa(reference[k][0] / length_m))),
        },
        Seconds {
            preparation: table_s,
            answer: tables.as_ref().and_then(|(_, table)| {
                one_by_one(&|k| table.lookup(bends_f32[k]).map_or(0.0, |found| f64::from(found.pressure_pa)))
            }),
        },
        Seconds {
            preparation: None,
            answer: per_answer(&|| drop(black_box(section.curve(&pressures_pa, &EndLoad::default())))),
        },
    ];
    let doubt = reference.iter().map(|[bend, error]| error / bend).fold(0.0, f64::max);
    Ok((Row { bender: name.clone(), errors, reference: doubt }, seconds))
}

/// Bends and their estimated errors, rad; `None` where one is missing.
fn bends(section: &Section, pressures_pa: &[f64], length_m: f64) -> Result<Option<Vec<[f64; 2]>>, SectionError> {
    let curve = section.curve(pressures_pa, &EndLoad::default())?;
    let bends = curve.answers.iter().map(|answer| {
        let found = answer.equilibrium()?;
        let rates = [found.state.bend_rates_rad_per_m[0], found.error?.bend_rates_rad_per_m[0]];
        Some(rates.map(|rate| rate * length_m))
    });
    Ok(bends.collect())
}

/// A result, and its seconds.
fn timed<T>(clock: Clock<'_>, work: impl FnOnce() -> T) -> (T, Option<f64>) {
    let begin = clock.map(|clock| clock());
    let result = work();
    (result, clock.zip(begin).map(|(clock, begin)| clock() - begin))
}

/// A curve of pressures.
struct Curve<'a>(&'a dyn Fn());

impl Work for Curve<'_> {
    fn answers(&self) -> usize {
        PRESSURES
    }

    fn run(&self) {
        (self.0)();
    }
}
