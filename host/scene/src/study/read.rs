//! From the text of a study to the study.

use std::num::NonZero;
use std::path::Path;

use toml::de::{DeTable, DeValue};
use toml_edit::DocumentMut;

use super::value::{Setting, Values, end, setting};
use super::{Experiment, Parameter, Study, VariedScene};
use crate::error::{Problem, SceneError, quoted};
use crate::read::document;
use crate::reader::{Log, Reader, Value};
use crate::schema::{parameter as keys, study as top};
use crate::source::{Source, Span};
use crate::value::wrong_type;
use crate::writer::set;

/// Largest number of rows of a study.
const ROWS_MAX: u64 = 1_000_000_000;
/// Largest number of parameters.
const PARAMETERS_MAX: usize = 64;

/// Reads a study. Paths of scenes are relative to `folder`.
pub(super) fn study(source: Source, folder: &Path) -> Result<Study, SceneError> {
    let empty = || Problem::new("the study is empty").help("it needs `format = 1` and `scenes`");
    document(source, empty, |log, source, table| read(log, source, table, folder))
}

fn read<'a>(log: &'a Log, source: &Source, table: &'a DeTable<'a>, folder: &Path) -> Option<Study> {
    let root = Reader::new(log, table, &top::SECTION, Span::NOWHERE);
    let format = root.integer(&top::FORMAT);
    let scenes = scenes(&root, folder);
    let limbs = root.integer(&top::LIMBS);
    let points = root.integer(&top::POINTS);
    let seed = root.integer(&top::SEED);
    let experiment = experiment(&root);
    let tables = root.maybe_tables(&top::PARAMETER, &keys::SECTION, PARAMETERS_MAX);
    let parameters = tables.map(|tables| tables.iter().map(|table| parameter(table, scenes.as_deref())).collect());
    let (scenes, parameters): (Vec<VariedScene>, Option<Vec<Parameter>>) = (scenes?, parameters?);
    let (parameters, points) = (parameters?, points?);
    let study = Study {
        name: Path::new(&*source.name).file_name().unwrap_or_default().to_string_lossy().into_owned(),
        hash: Study::hashed(&source.text, &scenes),
        scenes,
        parameters,
        points: u32::try_from(*points).ok()?,
        limbs: u32::try_from(*limbs?).ok()?,
        seed: u32::try_from(*seed?).ok()?,
        experiment: experiment?,
    };
    format?;
    if study.drawn_count() == 0 && study.points > 1 {
        let title = "`points` has no meaning without a `range`";
        return log.note(Problem::at(points.span, title, "nothing is drawn"));
    }
    if study.rows() > ROWS_MAX {
        let title = format!("a study has at most {ROWS_MAX} rows");
        return log.note(Problem::new(title).help(format!("this one has {}", study.rows())));
    }
    Some(study)
}

fn experiment(root: &Reader<'_>) -> Option<Experiment> {
    let learns = root.choice(&top::EXPERIMENT, &[false, true]);
    let (iterations, trials) = (root.integer(&top::ITERATIONS), root.integer(&top::TRIALS));
    let camera = root.quantity(&top::CAMERA);
    if !learns?.value {
        let given = [top::ITERATIONS.name, top::TRIALS.name, top::CAMERA.name].map(|name| (name, root.value(name)));
        let Some((name, value)) = given.into_iter().find_map(|(name, value)| Some((name, value?))) else {
            return Some(Experiment::Run);
        };
        let title = format!("`{name}` has no meaning without learning");
        let problem = Problem::at(value.span().into(), title, "of no use").help("add `experiment = \"learn\"`");
        return root.log().note(problem);
    }
    Some(Experiment::Learn {
        iterations: u32::try_from(*iterations?).ok()?,
        runs: u32::try_from(*trials?).ok().and_then(NonZero::new)?,
        camera_noise_m: camera?.value,
    })
}

fn scenes(root: &Reader<'_>, folder: &Path) -> Option<Vec<VariedScene>> {
    let name = top::SCENES.name;
    let Some(value) = root.value(name) else { return root.missing(name, "") };
    let items = items(root.log(), value, name, "an array of scene files")?;
    let source = |item: &&Value<'_>| {
        let span = item.span().into();
        let DeValue::String(file) = item.get_ref() else {
            return root.log().note(wrong_type(span, &quoted(name), "an array of texts", item.get_ref()));
        };
        let refused = |error: &dyn std::fmt::Display| Problem::at(span, error.to_string(), "this scene");
        let found = Source::read(&folder.join(file.as_ref())).map_err(|error| refused(&error));
        let found = found.and_then(|found| match found.text.parse::<DocumentMut>() {
            Ok(_) => Ok(found),
            // The reader of scenes reports the error.
            Err(_) => {
                Err(refused(&crate::read::scene(found).map_or_else(|error| error.to_string(), |_| String::new())))
            }
        });
        let scene = |source| Some(VariedScene { file: file.to_string(), source });
        found.map_or_else(|problem| root.log().note(problem), scene)
    };
    items.iter().map(source).collect()
}

/// Items of a non-empty array.
fn items<'a>(log: &Log, value: &'a Value<'a>, name: &str, expected: &str) -> Option<Vec<&'a Value<'a>>> {
    match value.get_ref() {
        DeValue::Array(items) if items.is_empty() => {
            log.note(Problem::at(value.span().into(), format!("{} needs a value", quoted(name)), "this is empty"))
        }
        DeValue::Array(items) => Some(items.iter().collect()),
        other => log.note(wrong_type(value.span().into(), &quoted(name), expected, other)),
    }
}

fn parameter(table: &Reader<'_>, scenes: Option<&[VariedScene]>) -> Option<Parameter> {
    let key = table.text(&keys::KEY);
    let values = match (table.value(keys::VALUES.name), table.value(keys::RANGE.name)) {
        (Some(values), None) => listed(table.log(), values),
        (None, Some(range)) => self::range(table.log(), range),
        (Some(_), Some(range)) => {
            let title = "a parameter has `values` or a `range`, not both";
            table.log().note(Problem::at(range.span().into(), title, "remove one of them"))
        }
        (None, None) => table.missing(keys::VALUES.name, " without `range`"),
    };
    let (key, values) = (key?, values?);
    let place: Vec<String> = key.value.split('.').map(str::to_owned).collect();
    for scene in scenes? {
        let Ok(mut document) = scene.source.text.parse::<DocumentMut>() else { continue };
        let Err(found) = set(&mut document, &place, &values.first().written) else { continue };
        let title = format!("{} has no value at {}", scene.file, quoted(key.value));
        let name = quoted(place.get(found).map_or("", String::as_str));
        let help = "tables of an array go by their `name`, as in `module.elbow.length`";
        return table.log().note(Problem::at(key.span, title, format!("{name} leads to none")).help(help));
    }
    Some(Parameter { place, values })
}

fn listed(log: &Log, value: &Value<'_>) -> Option<Values> {
    let items = items(log, value, keys::VALUES.name, "an array")?;
    let mut settings: Vec<Setting> = Vec::new();
    let mut unit: Option<String> = None;
    for item in items {
        let span = item.span().into();
        let found = setting(item.get_ref());
        let (setting, found) = found.map_or_else(|must| log.note(bad(span, keys::VALUES.name, must)), Some)?;
        let unit = unit.get_or_insert_with(|| found.clone());
        if *unit != found {
            return log.note(other_unit(span, unit, &found));
        }
        settings.push(setting);
    }
    Some(Values::Listed { settings, unit: unit? })
}

fn range(log: &Log, value: &Value<'_>) -> Option<Values> {
    let [low, high] = crate::value::pair(log, value, keys::RANGE.name)?;
    let read = |value: &Value<'_>| {
        let found = end(value.get_ref());
        found.map_or_else(|must| log.note(bad(value.span().into(), keys::RANGE.name, must)), Some)
    };
    let ((low, unit), (high, other)) = (read(low)?, read(high)?);
    if unit != other {
        return log.note(other_unit(value.span().into(), &unit, &other));
    }
    if low < high {
        return Some(Values::Range { ends: [low, high], unit });
    }
    let title = "`range` needs the lower value first";
    log.note(Problem::at(value.span().into(), title, "the first is not below the second"))
}

fn bad(span: Span, name: &str, must: &str) -> Problem {
    Problem::at(span, format!("a value of {} must be {must}", quoted(name)), "this is none")
}

fn other_unit(span: Span, unit: &str, other: &str) -> Problem {
    let shown = |unit: &str| if unit.is_empty() { "no unit".to_owned() } else { quoted(unit) };
    let title = format!("a parameter has one unit: {} and {}", shown(unit), shown(other));
    Problem::at(span, title, "another unit")
}
