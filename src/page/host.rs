//! Requests in JSON, and their answers.

use serde_json::{Value, json};

use super::along::Over;
use super::files::Files;
use super::outcome::Outcome;
use super::session::Session;
use crate::mechanism::{BodyId, DriverId, ParameterId, Source};

/// A session that is asked in JSON.
///
/// | `do` | further keys | answer |
/// |---|---|---|
/// | `open` | `name`, `text`, `files` (names with contents), `kept` (undo returns) | `page`, or `problems` |
/// | `picture` | | the parts of the moving picture |
/// | `redraw` | `keep` (the scale) | `picture`, `page` |
/// | `drive` | `driver`, `value` | an outcome |
/// | `speed` | `driver`, `velocity`, `acceleration` | |
/// | `load` | `input`, `value` | |
/// | `time` | `value` | an outcome |
/// | `set` | `parameter`, `value`, `anew` | an outcome |
/// | `grab` | `body`, `at` (in the picture) | `grip` |
/// | `drag` | `body`, `grip`, `at` (in the picture) | an outcome |
/// | `hold` | `body`, `grip`, `at` (in the picture) | an outcome |
/// | `let_go` | | |
/// | `keep`, `reset` | | `done` |
/// | `undo`, `redo` | | `done`; of another file `page` and `file` |
/// | `assemblies` | | `pictures`, `complete` |
/// | `choose` | `index` | an outcome |
/// | `chart` | `driver` (time without one), `variables`, `samples` | `x`, `y`, `events` |
/// | `trace` | `body`, `grip`; no point without them | `done` |
/// | `path` | `driver` (time without one), `samples` | `points` of the traced point, in the picture |
/// | `poses` | `driver` (time without one), `samples` | `poses`, lists of the places of the parts |
/// | `diagram` | | `svg` |
/// | `text` | `parameters` (without the pose) | `text` |
///
/// Values are SI. An outcome has `outcome` (`reached`, `stopped`, `refused`), and unless reached
/// `message`, `at` (in the picture) and `assembles`. A request that makes no sense is answered by
/// `error`.
#[derive(Default)]
pub struct Host {
    files: Files,
    frame: Vec<f64>,
}

impl Host {
    /// Answers a request.
    pub fn answer(&mut self, request: &str) -> Value {
        let request: Value = match serde_json::from_str(request) {
            Ok(request) => request,
            Err(error) => return json!({ "error": error.to_string() }),
        };
        let answer = self.act(&request);
        self.write_frame();
        answer.unwrap_or_else(|| json!({ "error": format!("cannot do {request}") }))
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

    fn act(&mut self, request: &Value) -> Option<Value> {
        let word = request["do"].as_str()?;
        match word {
            "open" => return self.open(request),
            "undo" => return Some(self.files.undo()),
            "redo" => return Some(self.files.redo()),
            "keep" | "reset" | "choose" => self.files.change(),
            _ => {}
        }
        let session = self.files.now.as_mut()?;
        let number = |key: &str| request[key].as_f64();
        let index = |key: &str| usize::try_from(request[key].as_u64()?).ok();
        let pair = |key: &str| Some([request[key][0].as_f64()?, request[key][1].as_f64()?]);
        let flag = |key: &str| request[key].as_bool().unwrap_or(false);
        let point = |session: &Session| {
            let [x, y] = pair("at")?;
            let scale = session.picture.scale();
            Some([x / scale, -y / scale])
        };
        let body = |session: &Session| {
            let body = index("body")?;
            (body < session.mechanism().bodies.len()).then_some(BodyId(body))
        };
        let over = match index("driver") {
            Some(driver) => Over::Driver(DriverId(driver)),
            None => Over::Time,
        };
        let outcome = match word {
            "drive" => session.drive(DriverId(index("driver")?), number("value")?),
            "time" => session.go_to(number("value")?),
            "set" => {
                let parameter = ParameterId(index("parameter")?);
                session.set(parameter, number("value")?, flag("anew"))
            }
            "drag" => {
                let (body, target) = (body(session)?, point(session)?);
                session.drag(body, pair("grip")?, target)
            }
            "hold" => {
                let (body, hand) = (body(session)?, point(session)?);
                session.hold(body, pair("grip")?, hand)
            }
            "choose" => session.choose(index("index")?),
            _ => {
                return Some(match word {
                    "picture" => session.picture(),
                    "redraw" => {
                        session.redraw(flag("keep"));
                        json!({ "picture": session.picture(), "page": session.description() })
                    }
                    "speed" => {
                        let driver = DriverId(index("driver")?);
                        session.set_speed(driver, number("velocity")?, number("acceleration")?);
                        json!({})
                    }
                    "load" => {
                        session.set_load(index("input")?, number("value")?);
                        json!({})
                    }
                    "let_go" => {
                        session.let_go();
                        json!({})
                    }
                    "grab" => json!({ "grip": session.grip(body(session)?, point(session)?) }),
                    "keep" => {
                        session.keep();
                        json!({ "done": true })
                    }
                    "reset" => {
                        session.reset();
                        json!({ "done": true })
                    }
                    "assemblies" => session.assemblies(),
                    "chart" => {
                        let variables = request["variables"].as_array()?.iter();
                        let variables = variables.map(|v| usize::try_from(v.as_u64()?).ok());
                        let variables: Vec<usize> = variables.collect::<Option<_>>()?;
                        session.chart(over, &variables, index("samples")?)
                    }
                    "trace" => {
                        session.trace(body(session).zip(pair("grip")));
                        json!({ "done": true })
                    }
                    "path" => json!({ "points": session.path(over, index("samples")?) }),
                    "poses" => json!({ "poses": session.poses(over, index("samples")?) }),
                    "diagram" => json!({ "svg": session.diagram() }),
                    "text" => {
                        let text = if flag("parameters") {
                            session.text_with_parameters()
                        } else {
                            session.text()
                        };
                        match text {
                            Ok(text) => json!({ "text": text }),
                            Err(error) => json!({ "error": error.to_string() }),
                        }
                    }
                    _ => return None,
                });
            }
        };
        Some(outcome.answer(|at| session.picture.place(at)))
    }

    fn open(&mut self, request: &Value) -> Option<Value> {
        let files = request["files"].as_array().map_or(&[][..], Vec::as_slice);
        let files = files.iter().map(|file| {
            let [name, text] = [file[0].as_str()?, file[1].as_str()?];
            Some((name.to_owned(), text.to_owned()))
        });
        let files: Vec<(String, String)> = files.collect::<Option<_>>()?;
        let (name, text) = (request["name"].as_str()?, request["text"].as_str()?);
        let source = Source::new(name, text).with_files(files);
        Some(match Session::open(source) {
            Ok(session) => {
                let page = session.description();
                self.files
                    .open(session, request["kept"].as_bool().unwrap_or(false));
                json!({ "page": page })
            }
            // The mechanism that was open stays.
            Err(problems) => json!({ "problems": problems }),
        })
    }
}
