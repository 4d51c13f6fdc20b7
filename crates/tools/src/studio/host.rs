//! Requests in JSON, and their answers.

use serde::Deserialize as _;
use serde_json::{Value, json};

use super::document::Document;
use super::gesture::Refusal;
use super::inspect::inspect;
use super::request::Request;
use crate::page;

/// Scale of a picture for which no one has asked \[units per metre\].
const USUAL_SCALE: f64 = 1_000.0;
/// Decimals of lengths for which no one has asked, and most decimals.
const USUAL_DECIMALS: usize = 4;
const MOST_DECIMALS: usize = 9;

/// A studio that is asked in JSON: by the requests in `src/studio/request.rs`, and by those of
/// [`page::Host`]. `crates/page/scripts/messages.d.ts` tells them to the scripts.
#[derive(Default)]
pub struct Host {
    document: Document,
    page: page::Host,
}

impl Host {
    /// Answers a request, which is JSON.
    pub fn answer(&mut self, request: &str) -> Value {
        match serde_json::from_str(request) {
            Ok(request) => self.answer_to(&request),
            Err(error) => json!({ "error": error.to_string() }),
        }
    }

    /// Answers a request.
    pub fn answer_to(&mut self, request: &Value) -> Value {
        match Request::deserialize(request) {
            Ok(Request::OfPage) => self.page.answer_to(request),
            Ok(own) => {
                let answer = self.act(own);
                answer.unwrap_or_else(|refusal| refused(&refusal))
            }
            Err(error) => json!({ "error": error.to_string() }),
        }
    }

    fn act(&mut self, request: Request) -> Result<Value, Refusal> {
        let scale = match request {
            Request::Begin {
                name,
                text,
                files,
                history,
                scale,
            } => {
                self.document = Document::new(&name, &text, files);
                self.document.restore(&history.unwrap_or_default());
                scale
            }
            Request::Type {
                text,
                joined,
                scale,
            } => {
                self.document.type_text(&text, joined);
                scale
            }
            Request::Gesture {
                gesture,
                keep,
                decimals,
                scale,
            } => {
                let decimals = decimals.unwrap_or(USUAL_DECIMALS).min(MOST_DECIMALS);
                if !keep {
                    return self.document.preview(&gesture, decimals, drawn_at(scale));
                }
                self.document.gesture(&gesture, decimals)?;
                scale
            }
            Request::TextUndo { scale } => {
                self.document.undo();
                scale
            }
            Request::TextRedo { scale } => {
                self.document.redo();
                scale
            }
            Request::History {} => return Ok(json!({ "history": self.document.history() })),
            Request::View { scale } => scale,
            Request::Inspect { names } => {
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                return inspect(&self.document, &names);
            }
            Request::OfPage => None,
        };
        Ok(self.document.view(drawn_at(scale)))
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

/// Returns the scale at which a picture is drawn.
fn drawn_at(scale: Option<f64>) -> f64 {
    scale.filter(|scale| *scale > 0.0).unwrap_or(USUAL_SCALE)
}
