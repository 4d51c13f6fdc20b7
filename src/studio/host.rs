//! Requests in JSON, and their answers.

use serde_json::{Value, json};

use super::document::Document;
use super::gesture::Refusal;
use super::inspect::inspect;
use crate::page;

/// A studio that is asked in JSON.
///
/// | `do` | further keys | answer |
/// |---|---|---|
/// | `begin` | `name`, `text`, `files` (names with contents) | a view |
/// | `type` | `text`, `joined` (to the change before) | a view |
/// | `gesture` | `gesture`, `keep` (otherwise it is only shown) | a view, or `refused` |
/// | `text_undo`, `text_redo` | | a view |
/// | `view` | | a view |
/// | `inspect` | `names` of a thing, paths of a point's markers, or none | a form, or `refused` |
///
/// Each may have the `scale` of the picture \[units per metre\]. A view has `text`, `problems`,
/// `is_stale` (the drawing is of an earlier text), `status`, `sketch`, `picture`, `can_undo`,
/// `can_redo`; one that is only shown has status and picture. A refusal has `message`, or asks by
/// `parameter`, `formula` and `value`. A form has `title`, `kind`, `rows` and `actions`. All other
/// requests are those of
/// [`page::Host`].
#[derive(Default)]
pub struct Host {
    document: Document,
    page: page::Host,
}

impl Host {
    /// Answers a request.
    pub fn answer(&mut self, request: &str) -> Value {
        let asked: Value = match serde_json::from_str(request) {
            Ok(asked) => asked,
            Err(error) => return json!({ "error": error.to_string() }),
        };
        let scale = asked["scale"].as_f64().filter(|scale| *scale > 0.0);
        let scale = scale.unwrap_or(1_000.0);
        match asked["do"].as_str() {
            Some("begin") => {
                let files = asked["files"].as_array().map_or(&[][..], Vec::as_slice);
                let files = files.iter().filter_map(|file| {
                    Some((file[0].as_str()?.to_owned(), file[1].as_str()?.to_owned()))
                });
                let text = |key: &str| asked[key].as_str().unwrap_or_default();
                self.document = Document::new(text("name"), text("text"), files.collect());
            }
            Some("type") => {
                let text = asked["text"].as_str().unwrap_or_default();
                let joined = asked["joined"].as_bool().unwrap_or(false);
                self.document.type_text(text, joined);
            }
            Some("gesture") => {
                let gesture = &asked["gesture"];
                if asked["keep"].as_bool() == Some(true) {
                    if let Err(refusal) = self.document.gesture(gesture) {
                        return refused(&refusal);
                    }
                } else {
                    return match self.document.preview(gesture, scale) {
                        Ok(view) => view,
                        Err(refusal) => refused(&refusal),
                    };
                }
            }
            Some("text_undo") => {
                self.document.undo();
            }
            Some("text_redo") => {
                self.document.redo();
            }
            Some("view") => {}
            Some("inspect") => {
                let names = asked["names"].as_array().map_or(&[][..], Vec::as_slice);
                let names: Vec<&str> = names.iter().filter_map(Value::as_str).collect();
                return match inspect(&self.document, &names) {
                    Ok(form) => form,
                    Err(refusal) => refused(&refusal),
                };
            }
            _ => return self.page.answer(request),
        }
        self.document.view(scale)
    }

    /// Moves a driver; see [`page::Host::drive`].
    pub fn drive(&mut self, driver: usize, value: f64) -> bool {
        self.page.drive(driver, value)
    }

    /// Returns the numbers of the moving picture; see [`page::Host::frame`].
    #[must_use]
    pub fn frame(&self) -> &[f64] {
        self.page.frame()
    }

    /// Returns the text of the file.
    #[must_use]
    pub fn text(&self) -> &str {
        self.document.text()
    }
}

fn refused(refusal: &Refusal) -> Value {
    match refusal {
        Refusal::Because(message) => json!({ "refused": { "message": message } }),
        Refusal::Ask {
            parameter,
            formula,
            value,
        } => json!({
            "refused": { "parameter": parameter, "formula": formula, "value": value },
        }),
    }
}
