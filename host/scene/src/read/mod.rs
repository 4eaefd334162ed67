//! From the text of a scene to the checked scene.

mod arrangement;
mod check;
mod corrections;
mod design;
mod grip;
mod limb;
mod markers;
mod module;
mod parts;
mod phase;
mod plant;
mod segments;
mod series;
mod settings;
mod supply;
mod task;

use toml::de::DeTable;

use super::data::Scene;
use super::error::{Problem, Problems, SceneError};
use super::reader::{Log, Reader};
use super::schema;
use super::source::{Source, Span};

pub use parts::{check_creep, check_law};

/// Reads all of a scene, then gives it or everything that is wrong with it.
pub(super) fn scene(source: Source) -> Result<Scene, SceneError> {
    let empty = || Problem::new("the scene is empty").help("start from one of the files in scenes/");
    document(source, empty, read)
}

/// Parses a file and reads its tables; the error has all problems found.
pub(super) fn document<T>(
    source: Source,
    empty: impl FnOnce() -> Problem,
    read: impl for<'a> FnOnce(&'a Log, &Source, &'a DeTable<'a>) -> Option<T>,
) -> Result<T, SceneError> {
    let text = source.text.clone();
    let (table, errors) = DeTable::parse_recoverable(&text);
    let log = Log::default();
    let found = if !errors.is_empty() {
        note_syntax(&log, &source, errors)
    } else if table.get_ref().is_empty() {
        log.note(empty())
    } else {
        read(&log, &source, table.get_ref())
    };
    let problems = log.into_problems();
    match found {
        Some(found) if problems.is_empty() => Ok(found),
        _ => Err(SceneError::Invalid(Problems::new(source, problems))),
    }
}

/// Notes what is no TOML, once for each line, because one slip often breaks the rest of its line.
fn note_syntax<T>(log: &Log, source: &Source, mut errors: Vec<toml::de::Error>) -> Option<T> {
    errors.sort_by_key(|error| error.span().map_or(0, |span| span.start));
    let mut seen_to = 0;
    for error in errors {
        let range = error.span().unwrap_or(0..0);
        if seen_to > range.start {
            continue;
        }
        let line_end = source.text[range.start..].find('\n').map_or(source.text.len(), |at| range.start + at);
        seen_to = line_end + 1;
        let line_begin = source.text[..range.start].rfind('\n').map_or(0, |at| at + 1);
        let (line, written) = (&source.text[line_begin..line_end], source.text.get(range.clone()).unwrap_or(""));
        let problem = Problem::at(Span::from(range), "this is not TOML", error.message());
        log.note::<()>(match syntax_help(error.message(), line, written) {
            Some(help) => problem.help(help),
            None => problem,
        });
    }
    None
}

/// What to write in place of a line that is not TOML, where that can be guessed.
fn syntax_help(message: &str, line: &str, written: &str) -> Option<String> {
    let number = written.starts_with(|c: char| c.is_ascii_digit());
    if message.contains("must be quoted") && number {
        return Some(format!("write a number with its unit as a string: \"{}\"", written.trim_end()));
    }
    if let Some(found) = line.chars().find(|&c| is_from_a_word_processor(c)) {
        let code = u32::from(found);
        return Some(format!("this line holds the character U+{code:04X}: type \", - or a space by the keyboard"));
    }
    let is_table = line.starts_with('[') && !line.starts_with("[[");
    (message.contains("duplicate") && is_table)
        .then(|| format!("each of several tables of one name begins with two brackets: [{}]", line.trim_end()))
}

/// Typographic quotes, dashes and spaces.
fn is_from_a_word_processor(c: char) -> bool {
    matches!(c, '\u{a0}' | '\u{2007}' | '\u{202f}' | '\u{2010}'..='\u{2015}' | '\u{2018}'..='\u{201f}' | '\u{2212}')
}

fn read<'a>(log: &'a Log, source: &Source, table: &'a DeTable<'a>) -> Option<Scene> {
    check_format(log, table)?;
    let root = Reader::new(log, table, &schema::scene::SECTION, Span::NOWHERE);
    let name = root.text(&schema::scene::NAME);
    let description = root.text(&schema::scene::DESCRIPTION);
    let seed = root.integer(&schema::scene::SEED);
    let materials = parts::materials(&root);
    let windings = parts::windings(&root);
    let limb = limb::limb(&root);
    let limits = settings::limits(&root);
    let controller = settings::controller(&root);
    let weight = settings::weight(&root);
    let swing = settings::swing(&root, weight.as_ref());
    let camera = settings::camera(&root);
    let imu = settings::imu(&root, camera.as_ref().and_then(Option::as_ref));
    let plant = plant::plant(&root);
    let mut drafts = module::modules(&root, &materials, &windings, limits.as_ref());
    let obstacles = task::obstacles(&root);
    let regions = task::regions(&root);
    let objects = task::objects(&root);
    let design = design::design(&root, &drafts, regions.as_deref());
    let markers = markers::markers(&root, &source.name);
    let phases =
        phase::phases(&root, &mut drafts, (regions.as_deref(), objects.as_deref()), markers.as_ref(), weight.as_ref());
    let corrections = corrections::corrections(&root, &source.name, &drafts, phases.as_deref());
    check::channels(log, &drafts);
    check::pressures(log, &drafts, phases.as_deref(), limits.as_ref(), plant.as_ref());
    if let Some(plant) = &plant {
        supply::sensor(&root, limits.as_ref(), plant);
        supply::reservoir(&root, &drafts, plant);
    }
    let modules = drafts.into_iter().map(|draft| draft.module).collect::<Option<Vec<_>>>();
    Some(Scene {
        source: source.clone(),
        name: name?.value.to_owned(),
        description: description?.value.to_owned(),
        seed: u64::try_from(*seed?).ok()?,
        limb: limb?,
        modules: modules?,
        phases: phases?,
        markers: markers?,
        corrections: corrections?,
        obstacles: obstacles?,
        regions: regions?,
        objects: objects?,
        design: design?,
        limits: limits?,
        controller: controller?,
        weight: weight?,
        swing: swing?,
        camera: camera?,
        imu: imu?,
        plant: plant?,
    })
}

/// A scene of another format is not looked into: its other keys need not be ours.
fn check_format<'a>(log: &'a Log, table: &'a DeTable<'a>) -> Option<()> {
    let key = &schema::scene::FORMAT;
    let Some(value) = table.get(key.name) else {
        let title = "missing key `format`";
        return log.note(Problem::new(title).help(format!("write `format = {}` at the top of the file", key.max)));
    };
    let found = value.get_ref().as_integer().and_then(|n| i64::from_str_radix(n.as_str(), n.radix()).ok());
    let span = Span::from(value.span());
    match found {
        Some(format) if (key.min..=key.max).contains(&format) => Some(()),
        Some(format) if format > key.max => {
            let title = format!("the scene has format {format}, newer than this softlimb knows");
            let label = format!("the newest known format is {}", key.max);
            log.note(Problem::at(span, title, label).help("update softlimb, or write the scene in an older format"))
        }
        _ => log.note(Problem::at(span, "unknown `format`", format!("write {}", key.max))),
    }
}
