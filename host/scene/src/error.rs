//! Errors of a scene, shown in the lines of the file, underlined.

use std::fmt::{self, Write as _};
use std::io::ErrorKind;
use std::path::PathBuf;

use annotate_snippets::{AnnotationKind, Element, Group, Level, Origin, Renderer, Snippet};

use super::source::{SCENE_BYTES_MAX, Source, Span, boundary_before};

/// Most problems that are shown; the rest is counted.
const SHOWN_MAX: usize = 20;

/// Why there is no [`Scene`](super::Scene).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// The file could not be read as text.
    #[error("cannot read {}: {reason}", path.display())]
    Unreadable {
        /// The path as given.
        path: PathBuf,
        /// Reason.
        reason: Unreadable,
    },
    /// The text is not a scene. Every problem found is in it, in the order of the text.
    #[error("{0}")]
    Invalid(Problems),
}

/// Reason why a file cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unreadable {
    /// The operating system refused.
    Io(ErrorKind),
    /// The path names a directory.
    Directory,
    /// The file is larger than [`SCENE_BYTES_MAX`].
    TooLarge,
    /// The bytes are not UTF-8.
    NotUtf8 {
        /// Offset of the first bad byte, from 0.
        offset: usize,
        /// Line of that byte, from 1.
        line: usize,
    },
}

impl Unreadable {
    fn line(self) -> Option<usize> {
        match self {
            Self::NotUtf8 { line, .. } => Some(line),
            _ => None,
        }
    }

    fn help(self) -> Option<String> {
        match self {
            Self::Io(ErrorKind::NotFound) => Some("check the spelling and the current directory".into()),
            Self::Io(_) => None,
            Self::Directory => Some("give a scene file inside it, such as scene.toml".into()),
            Self::TooLarge => {
                Some(format!("a scene has at most {} KiB; is this a log or a mesh?", SCENE_BYTES_MAX >> 10))
            }
            Self::NotUtf8 { .. } => Some("save the scene as UTF-8 text".into()),
        }
    }
}

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(ErrorKind::NotFound) => write!(f, "there is no such file"),
            Self::Io(kind) => write!(f, "{kind}"),
            Self::Directory => write!(f, "it is a directory"),
            Self::TooLarge => write!(f, "it is too large"),
            Self::NotUtf8 { offset, line } => write!(f, "it is not UTF-8 text at byte {offset} (line {line})"),
        }
    }
}

/// One thing that is wrong, with the places that show it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Problem {
    title: String,
    /// First the place of the problem, then places that explain it.
    labels: Vec<(Span, String)>,
    /// Labels of what is not written.
    notes: Vec<String>,
    help: Option<String>,
}

impl Problem {
    pub(super) fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), labels: Vec::new(), notes: Vec::new(), help: None }
    }

    /// A problem at one place.
    pub(super) fn at(span: Span, title: impl Into<String>, label: impl Into<String>) -> Self {
        Self::new(title).label(span, label)
    }

    pub(super) fn label(mut self, span: Span, label: impl Into<String>) -> Self {
        if span == Span::NOWHERE {
            self.notes.push(format!("{}, by default", label.into()));
        } else {
            self.labels.push((span, label.into()));
        }
        self
    }

    pub(super) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    fn start(&self) -> usize {
        self.labels.first().map_or(0, |(span, _)| span.range().start)
    }

    fn report<'a>(&'a self, source: &'a Source) -> Group<'a> {
        let title = Level::ERROR.primary_title(self.title.as_str());
        let picture: Element<'_> = if self.labels.is_empty() {
            Origin::path(source.name.as_ref()).into()
        } else {
            let annotations = self.labels.iter().enumerate().map(|(i, (span, label))| {
                let kind = if i == 0 { AnnotationKind::Primary } else { AnnotationKind::Context };
                kind.span(within(&source.text, *span)).label(label.as_str())
            });
            Snippet::source(source.text.as_ref()).path(source.name.as_ref()).annotations(annotations).into()
        };
        let help = self.help.as_deref().map(|text| Level::HELP.message(text));
        let notes = self.notes.iter().map(|text| Level::NOTE.message(text.as_str()));
        title.element(picture).elements(notes).elements(help)
    }
}

/// The span cut to the text and to whole characters, so that any span can be drawn.
fn within(text: &str, span: Span) -> std::ops::Range<usize> {
    let range = span.range();
    let start = boundary_before(text, range.start);
    let end = (range.end..text.len()).find(|at| text.is_char_boundary(*at)).unwrap_or(text.len());
    start..end.max(start)
}

/// A problem of a scene, for programs: [`SceneError::render`] draws it for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// The problem.
    pub message: String,
    /// Line of the text, from 1; `None` where it is of no line.
    pub line: Option<usize>,
    /// Column in characters, from 1; `None` where it is of no line.
    pub column: Option<usize>,
    /// The words beside the underlined place.
    pub label: Option<String>,
    /// A remedy.
    pub help: Option<String>,
}

/// The problems of one scene, in the order of its text.
#[derive(Clone, Debug, PartialEq)]
pub struct Problems {
    source: Source,
    problems: Vec<Problem>,
}

impl Problems {
    pub(super) fn new(source: Source, mut problems: Vec<Problem>) -> Self {
        problems.sort_by_key(Problem::start);
        Self { source, problems }
    }

    /// Number of problems, those that are not shown included.
    pub fn count(&self) -> usize {
        self.problems.len()
    }

    fn diagnostics(&self) -> Vec<Diagnostic> {
        let of = |problem: &Problem| {
            let place = problem.labels.first().map(|(span, _)| self.source.position(span.range().start));
            Diagnostic {
                message: problem.title.clone(),
                line: place.map(|(line, _)| line),
                column: place.map(|(_, column)| column),
                label: problem.labels.first().map(|(_, label)| label.clone()),
                help: problem.help.clone(),
            }
        };
        self.problems.iter().map(of).collect()
    }

    fn render(&self, renderer: &Renderer) -> String {
        let shown = self.problems.iter().take(SHOWN_MAX);
        let mut pictures: Vec<String> = shown.map(|problem| renderer.render(&[problem.report(&self.source)])).collect();
        let count = self.count();
        if count > 1 {
            let rest = if count > SHOWN_MAX { format!(", the first {SHOWN_MAX} are shown") } else { String::new() };
            let summary = format!("{count} problems in {}{rest}", self.source.name);
            pictures.push(renderer.render(&[Group::with_title(Level::ERROR.primary_title(summary))]));
        }
        pictures.join("\n\n")
    }
}

impl fmt::Display for Problems {
    /// One line for a log: the first problem with its place, and how many more there are.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.source.name)?;
        if let Some(problem) = self.problems.first() {
            if let Some((span, _)) = problem.labels.first() {
                let (line, column) = self.source.position(span.range().start);
                write!(f, ":{line}:{column}")?;
            }
            write!(f, ": {}", problem.title)?;
        }
        match self.count() {
            0 | 1 => Ok(()),
            count => write!(f, " (and {} more)", count - 1),
        }
    }
}

impl SceneError {
    /// Every problem, in the order of the text.
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        match self {
            Self::Invalid(problems) => problems.diagnostics(),
            Self::Unreadable { reason, .. } => {
                let (line, help) = (reason.line(), reason.help());
                vec![Diagnostic { message: self.to_string(), line, column: None, label: None, help }]
            }
        }
    }

    /// The full diagnostic, as rustc draws it, with ANSI colors if asked for. It does not end with a line break.
    pub fn render(&self, color: bool) -> String {
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        match self {
            Self::Invalid(problems) => problems.render(&renderer),
            Self::Unreadable { path, reason } => {
                let title = format!("cannot read {}: {reason}", quoted(&path.display().to_string()));
                let help = reason.help();
                let help = help.as_deref().map(|text| Level::HELP.message(text));
                renderer.render(&[Level::ERROR.primary_title(title).elements(help)])
            }
        }
    }
}

/// Longest piece of the user's text that a message repeats, in characters.
const QUOTED_MAX: usize = 60;

/// A piece of the user's text between backticks: control characters escaped, long text cut.
pub(super) fn quoted(text: &str) -> String {
    let mut out = String::from("`");
    for (i, c) in text.chars().enumerate() {
        if i == QUOTED_MAX {
            out.push_str("...");
            break;
        }
        if c.is_control() {
            // Writing to a string cannot fail.
            let _ = write!(out, "{}", c.escape_default());
        } else {
            out.push(c);
        }
    }
    out.push('`');
    out
}
