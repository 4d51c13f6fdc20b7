//! A mechanism file that is drawn and typed, with its undo.

use serde_json::{Value, json};

use super::drawn::Drawn;
use super::four_bar;
use super::gesture::{self, Editing, Refusal};
use super::request::{Change, Gesture, History};
use super::sketch::sketch;
use super::status::{State, sentence};
use crate::write::TomlText;
use biela::mechanism::{Diagnostic, Severity, Source};

/// Most texts to which undo returns.
const MOST: usize = 1_000;
/// Most of them that a history has: what a browser keeps stays small.
const MOST_KEPT: usize = 200;

/// The file of a studio.
#[derive(Debug, Default)]
pub(super) struct Document {
    name: String,
    files: Vec<(String, String)>,
    text: String,
    /// The mechanism of the text; while that has an error, of the last text without one.
    drawn: Option<Drawn>,
    /// Whether `drawn` is of another text.
    is_stale: bool,
    problems: Vec<Problem>,
    /// The texts before, the oldest first.
    before: Vec<String>,
    /// The texts in the order in which they were undone.
    undone: Vec<String>,
}

/// A problem at its place in the text, in bytes.
#[derive(Debug)]
struct Problem {
    place: std::ops::Range<usize>,
    severity: Severity,
    message: String,
    help: Option<String>,
}

impl From<Diagnostic> for Problem {
    fn from(diagnostic: Diagnostic) -> Self {
        let place = diagnostic.labels.first().map(|label| label.span.clone());
        Self {
            place: place.unwrap_or(0..0),
            severity: diagnostic.severity,
            message: diagnostic.message,
            help: diagnostic.help,
        }
    }
}

impl Document {
    /// Begins with a file.
    pub(super) fn new(name: &str, text: &str, files: Vec<(String, String)>) -> Self {
        let mut document = Self {
            name: name.to_owned(),
            files,
            ..Self::default()
        };
        document.take(text.to_owned());
        document
    }

    /// Returns the text.
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// Takes over a text that was typed; `joined` to the last one, which undo then passes over.
    pub(super) fn type_text(&mut self, text: &str, joined: bool) {
        if text == self.text {
            return;
        }
        if !joined || self.before.is_empty() {
            self.keep();
        }
        self.undone.clear();
        self.take(text.to_owned());
    }

    /// Does a gesture.
    ///
    /// # Errors
    ///
    /// The reason why it cannot be done.
    pub(super) fn gesture(&mut self, gesture: &Gesture, decimals: usize) -> Result<(), Refusal> {
        let (text, drawn) = self.tried(gesture, decimals)?;
        let text = if gesture::moves(gesture) {
            let mut editing = Editing::new(text, &drawn, &self.files, decimals);
            gesture::settle(&mut editing);
            editing.text
        } else {
            text
        };
        if text.as_str() != self.text {
            self.keep();
            self.undone.clear();
            self.take(text.as_str().to_owned());
        }
        Ok(())
    }

    /// Returns what a gesture would draw, with `scale` and without labels; nothing is changed.
    ///
    /// # Errors
    ///
    /// The reason why it cannot be done.
    pub(super) fn preview(
        &self,
        gesture: &Gesture,
        decimals: usize,
        scale: f64,
    ) -> Result<Value, Refusal> {
        let (_, drawn) = self.tried(gesture, decimals)?;
        Ok(glimpse(&drawn, scale))
    }

    /// Begins to change the text.
    ///
    /// # Errors
    ///
    /// The text has an error.
    pub(super) fn editing(&self, decimals: usize) -> Result<Editing<'_>, Refusal> {
        let Some(drawn) = self.drawn.as_ref().filter(|_| !self.is_stale) else {
            return Err("the text has an error: mend it first".into());
        };
        let text = TomlText::new(&*self.text).map_err(|error| error.to_string())?;
        Ok(Editing::new(text, drawn, &self.files, decimals))
    }

    fn tried(&self, gesture: &Gesture, decimals: usize) -> Result<(TomlText, Drawn), Refusal> {
        let mut editing = self.editing(decimals)?;
        gesture::act(gesture, &mut editing)?;
        let text = editing.text;
        let (drawn, problems) = Drawn::read(&self.source(text.as_str()));
        let drawn = drawn.ok_or_else(|| {
            let error = problems.iter().find(|p| p.severity == Severity::Error);
            Refusal::Because(match error {
                Some(Diagnostic {
                    message,
                    help: Some(help),
                    ..
                }) => format!("{message}; {help}"),
                Some(Diagnostic { message, .. }) => message.clone(),
                None => "this would leave a file with an error".to_owned(),
            })
        })?;
        Ok((text, drawn))
    }

    /// Returns to the text before; false if there is none.
    pub(super) fn undo(&mut self) -> bool {
        let Some(text) = self.before.pop() else {
            return false;
        };
        self.undone.push(std::mem::take(&mut self.text));
        self.take(text);
        true
    }

    /// Returns to the text that undo left; false if there is none.
    pub(super) fn redo(&mut self) -> bool {
        let Some(text) = self.undone.pop() else {
            return false;
        };
        self.before.push(std::mem::take(&mut self.text));
        self.take(text);
        true
    }

    /// Returns the history of the text.
    pub(super) fn history(&self) -> History {
        let changes = |texts: &[String]| {
            let texts = &texts[texts.len().saturating_sub(MOST_KEPT)..];
            let later = texts.iter().skip(1).chain([&self.text]);
            let mut changes: Vec<Change> = Vec::new();
            changes.extend(
                texts
                    .iter()
                    .zip(later)
                    .map(|(text, later)| change(later, text)),
            );
            changes
        };
        History {
            before: changes(&self.before),
            undone: changes(&self.undone),
        }
    }

    /// Takes over the history of this text; of one whose changes do not fit, the part that does. A text
    /// with an error has the last drawing before it.
    pub(super) fn restore(&mut self, history: &History) {
        let texts = |changes: &[Change]| {
            let mut texts = vec![self.text.clone()];
            for (from, to, with) in changes.iter().rev() {
                let last = texts.last().map_or("", String::as_str);
                let (Some(head), Some(tail), true) =
                    (last.get(..*from), last.get(*to..), from <= to)
                else {
                    break;
                };
                texts.push(format!("{head}{with}{tail}"));
            }
            texts.remove(0);
            texts.reverse();
            texts
        };
        (self.before, self.undone) = (texts(&history.before), texts(&history.undone));
        if self.drawn.is_none() {
            let mut before = self.before.iter().rev();
            self.drawn = before.find_map(|text| Drawn::read(&self.source(text)).0);
        }
    }

    /// Describes the document: its text, its problems, what is drawn at a scale.
    pub(super) fn view(&self, scale: f64) -> Value {
        let problems: Vec<Value> = self.problems.iter().map(|p| self.problem(p)).collect();
        let mut view = match &self.drawn {
            Some(drawn) => shown(drawn, scale),
            None => json!({}),
        };
        if self.drawn.is_some()
            && let Ok(text) = TomlText::new(&*self.text)
        {
            for section in ["measures", "friction", "contacts"] {
                let names = text.keys(&[section]).into_iter();
                let things = names.map(|name| json!({ "name": name }));
                view["sketch"][section] = things.collect();
            }
        }
        let first = self.problems.iter().find(|p| p.severity == Severity::Error);
        if let Some(problem) = first {
            let line = self.text[..problem.place.start.min(self.text.len())]
                .matches('\n')
                .count();
            view["status"] = json!({
                "state": "broken",
                "text": format!("line {}: {}", line + 1, problem.message),
            });
        }
        view["text"] = json!(self.text);
        view["problems"] = json!(problems);
        view["is_stale"] = json!(self.is_stale);
        view["can_undo"] = json!(!self.before.is_empty());
        view["can_redo"] = json!(!self.undone.is_empty());
        view
    }

    fn keep(&mut self) {
        if self.before.len() == MOST {
            self.before.remove(0);
        }
        self.before.push(self.text.clone());
    }

    fn take(&mut self, text: String) {
        let (drawn, problems) = Drawn::read(&self.source(&text));
        self.text = text;
        self.problems = problems.into_iter().map(Problem::from).collect();
        self.is_stale = drawn.is_none();
        if drawn.is_some() {
            self.drawn = drawn;
        }
    }

    fn source(&self, text: &str) -> Source {
        Source::new(&*self.name, text).with_files(self.files.clone())
    }

    fn problem(&self, problem: &Problem) -> Value {
        // Scripts count in units of UTF-16.
        let offset = |byte: usize| {
            let byte = self.text.floor_char_boundary(byte);
            self.text[..byte].encode_utf16().count()
        };
        json!({
            "from": offset(problem.place.start),
            "to": offset(problem.place.end),
            "severity": problem.severity.as_str(),
            "message": problem.message,
            "help": problem.help,
        })
    }
}

/// Returns the one change that makes another text of a text.
fn change(text: &str, other: &str) -> Change {
    let head = (text.bytes().zip(other.bytes()))
        .take_while(|(a, b)| a == b)
        .count();
    let head = text
        .floor_char_boundary(head)
        .min(other.floor_char_boundary(head));
    let rests = [&text[head..], &other[head..]];
    let tail = rests[0].chars().rev().zip(rests[1].chars().rev());
    let tail: usize = tail
        .take_while(|(a, b)| a == b)
        .map(|(a, _)| a.len_utf8())
        .sum();
    (
        head,
        text.len() - tail,
        rests[1][..rests[1].len() - tail].to_owned(),
    )
}

/// Describes what is drawn: status, sketch and picture.
fn shown(drawn: &Drawn, scale: f64) -> Value {
    json!({
        "status": status(drawn),
        "sketch": sketch(drawn),
        "picture": picture(drawn, scale, true),
    })
}

/// Describes what is drawn while something is dragged: status and picture.
fn glimpse(drawn: &Drawn, scale: f64) -> Value {
    json!({ "status": status(drawn), "picture": picture(drawn, scale, false) })
}

fn status(drawn: &Drawn) -> Value {
    json!({
        "state": State::of(drawn).word(),
        "text": sentence(drawn),
        "note": four_bar::describe(drawn),
    })
}

fn picture(drawn: &Drawn, scale: f64, labelled: bool) -> Option<Value> {
    let picture = drawn.picture(scale, labelled)?;
    let mut places = Vec::new();
    picture.add_places(&drawn.q, &mut places);
    let mut description = picture.description();
    description["places"] = json!(places);
    Some(description)
}
