//! Requests in JSON, and their answers.

use serde::Deserialize as _;
use serde_json::{Value, json};

use super::along::Over;
use super::files::Files;
use super::outcome::Outcome;
use super::request::Request;
use super::session::Session;
use biela::mechanism::{BodyId, DriverId, ParameterId, Source};

/// Answer to a request that needs a mechanism.
const NONE: &str = "no mechanism is open";

/// A session that is asked in JSON: by the requests in `src/page/request.rs`, which
/// `crates/page/scripts/messages.d.ts` tells the scripts.
#[derive(Default)]
pub struct Host {
    files: Files,
    frame: Vec<f64>,
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
        let request = Request::deserialize(request).map_err(|error| error.to_string());
        let answer = request.and_then(|request| self.act(request));
        self.write_frame();
        answer.unwrap_or_else(|error| json!({ "error": error }))
    }

    /// Moves a driver and writes the frame; returns whether the value was reached.
    pub fn drive(&mut self, driver: usize, value: f64) -> bool {
        let Some(session) = &mut self.files.now else {
            return false;
        };
        let reached = session.drive(DriverId(driver), value) == Outcome::Reached;
        self.write_frame();
        reached
    }

    /// Returns the numbers of the present picture; see [`Session::layout`].
    #[must_use]
    pub fn frame(&self) -> &[f64] {
        &self.frame
    }

    fn write_frame(&mut self) {
        if let Some(session) = &mut self.files.now {
            session.write_frame(&mut self.frame);
        }
    }

    fn act(&mut self, request: Request) -> Result<Value, String> {
        let session = self.files.now.as_mut().ok_or(NONE);
        Ok(match request {
            Request::Open {
                name,
                text,
                files,
                kept,
            } => self.open(Source::new(name, text).with_files(files), kept),
            Request::Picture {} => session?.picture(),
            Request::Redraw { keep } => {
                let session = session?;
                session.redraw(keep);
                json!({ "picture": session.picture(), "page": session.description() })
            }
            Request::Drive { driver, value } => {
                moved(session?, |session| session.drive(DriverId(driver), value))
            }
            Request::Speed {
                driver,
                velocity,
                acceleration,
            } => {
                session?.set_speed(DriverId(driver), velocity, acceleration);
                json!({})
            }
            Request::Load { input, value } => {
                let session = session?;
                let mut answer = moved(session, |session| session.set_load(input, value));
                answer["value"] = json!(session.load(input));
                answer
            }
            Request::Time { value } => moved(session?, |session| session.go_to(value)),
            Request::Set {
                parameter,
                value,
                anew,
            } => moved(session?, |session| {
                session.set(ParameterId(parameter), value, anew)
            }),
            Request::Grab { body, at } => {
                let session = session?;
                let body = known(session, body)?;
                json!({ "grip": session.grip(body, global(session, at)) })
            }
            Request::Drag { body, grip, at } => {
                let session = session?;
                let (body, target) = (known(session, body)?, global(session, at));
                moved(session, |session| session.drag(body, grip, target))
            }
            Request::Hold { body, grip, at } => {
                let session = session?;
                let (body, hand) = (known(session, body)?, global(session, at));
                moved(session, |session| session.hold(body, grip, hand))
            }
            Request::LetGo {} => {
                session?.let_go();
                json!({})
            }
            Request::Keep {} => {
                self.changed()?.keep();
                json!({ "done": true })
            }
            Request::Reset {} => {
                self.changed()?.reset();
                json!({ "done": true })
            }
            Request::Undo {} => self.files.undo(),
            Request::Redo {} => self.files.redo(),
            Request::Assemblies {} => session?.assemblies(),
            Request::Choose { index } => moved(self.changed()?, |session| session.choose(index)),
            Request::Chart {
                driver,
                variables,
                samples,
            } => session?.chart(over(driver), &variables, samples),
            Request::Trace { body, grip } => {
                let session = session?;
                let body = body.and_then(|body| known(session, body).ok());
                session.trace(body.zip(grip));
                json!({ "done": true })
            }
            Request::Path { driver, samples } => {
                json!({ "points": session?.path(over(driver), samples) })
            }
            Request::Poses { driver, samples } => {
                json!({ "poses": session?.poses(over(driver), samples) })
            }
            Request::Diagram {} => json!({ "svg": session?.diagram() }),
            Request::Text { parameters } => {
                let session = session?;
                let text = if parameters {
                    session.text_with_parameters()
                } else {
                    session.text()
                };
                json!({ "text": text.map_err(|error| error.to_string())? })
            }
        })
    }

    /// Returns the session, whose state is to change: undo no longer returns to another file.
    fn changed(&mut self) -> Result<&mut Session, &'static str> {
        self.files.change();
        self.files.now.as_mut().ok_or(NONE)
    }

    fn open(&mut self, source: Source, kept: bool) -> Value {
        match Session::open(source) {
            Ok(session) => {
                let page = session.description();
                self.files.open(session, kept);
                json!({ "page": page })
            }
            // The mechanism that was open stays.
            Err(problems) => json!({ "problems": problems }),
        }
    }
}

/// Returns the driver along which poses are taken, or time.
fn over(driver: Option<usize>) -> Over {
    driver.map_or(Over::Time, |driver| Over::Driver(DriverId(driver)))
}

/// Returns a body of the mechanism.
fn known(session: &Session, body: usize) -> Result<BodyId, String> {
    let is_there = body < session.mechanism().bodies.len();
    let body = is_there.then_some(BodyId(body));
    body.ok_or_else(|| "the mechanism has no such body".to_owned())
}

/// Returns the global point \[m\] at a place of the picture.
fn global(session: &Session, [x, y]: [f64; 2]) -> [f64; 2] {
    let scale = session.picture.scale();
    [x / scale, -y / scale]
}

/// Moves the mechanism and tells the outcome.
fn moved(session: &mut Session, act: impl FnOnce(&mut Session) -> Outcome) -> Value {
    let outcome = act(session);
    outcome.answer(|at| session.picture.place(at))
}
