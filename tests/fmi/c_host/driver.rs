//! Sends requests to the C host and takes its answers; `tests/host.c` says how they look.

use std::fmt::Debug;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Arc;

use biela::fmi::{Causality, Kind, Quantity, RESOURCE, Status, value_reference};
use biela::mechanism::{Mechanism, Source};
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use set_up::runtime_library;
use tempfile::TempDir;

type Variable = biela::fmi::Variable<Quantity>;

/// A place for an instance in the host.
pub(crate) const A: &str = "0";
/// Another one.
pub(crate) const B: &str = "1";
/// A null pointer: as an instance, an array, a string.
pub(crate) const NULL: &str = r"\N";

/// The unpacked FMU of a mechanism, as far as its library looks at it.
pub(crate) struct Fmu {
    pub(crate) mechanism: Arc<Mechanism>,
    pub(crate) guid: String,
    pub(crate) resources: PathBuf,
    variables: Vec<Variable>,
    _folder: TempDir,
}

impl Fmu {
    pub(crate) fn of(name: &str) -> Self {
        Self::in_folder(name, "resources")
    }

    pub(crate) fn in_folder(name: &str, folder: &str) -> Self {
        let file = format!("{}/mechanisms/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(file).expect("shipped mechanisms can be read");
        let (mechanism, _) =
            Mechanism::parse(&Source::new(RESOURCE, text.as_str())).expect("they have no errors");
        let mechanism = Arc::new(mechanism);
        let unpacked = tempfile::tempdir().expect("there is room for temporary files");
        let resources = unpacked.path().join(folder);
        std::fs::create_dir(&resources)
            .and_then(|()| std::fs::write(resources.join(RESOURCE), text))
            .expect("the folder is ours");
        Self {
            guid: biela::fmi::guid(&mechanism),
            variables: biela::fmi::variables(&mechanism),
            mechanism,
            resources,
            _folder: unpacked,
        }
    }

    pub(crate) fn path(&self) -> &str {
        self.resources
            .to_str()
            .expect("temporary folders have UTF-8 names")
    }

    pub(crate) fn uri(&self) -> String {
        format!("file://{}", percent_encoded(self.path()))
    }

    /// The value reference of a variable, as text.
    pub(crate) fn vr(&self, name: &str) -> String {
        let mut all = self.variables.iter();
        let found = all.position(|variable| variable.name == name);
        value_reference(found.unwrap_or_else(|| panic!("no `{name}`"))).to_string()
    }

    /// The value references of all Reals.
    pub(crate) fn reals(&self) -> Vec<u32> {
        self.all(|variable| matches!(variable.kind, Kind::Real { .. }))
    }

    /// The value references of all outputs, which are Reals.
    pub(crate) fn outputs(&self) -> Vec<u32> {
        self.all(|variable| variable.causality == Causality::Output)
    }

    fn all(&self, which: impl Fn(&Variable) -> bool) -> Vec<u32> {
        (1..)
            .zip(&self.variables)
            .filter(|(_, variable)| which(variable))
            .map(|(value_reference, _)| value_reference)
            .collect()
    }
}

pub(crate) fn percent_encoded(path: &str) -> String {
    const SPECIAL: AsciiSet = CONTROLS.add(b' ').add(b'#').add(b'%').add(b'?');
    utf8_percent_encode(path, &SPECIAL).to_string()
}

/// The arguments of `fmi2Instantiate`; `None` is a null pointer.
#[derive(Clone)]
pub(crate) struct Instantiate {
    pub(crate) name: Option<String>,
    pub(crate) guid: Option<String>,
    pub(crate) uri: Option<String>,
    pub(crate) model_exchange: bool,
    pub(crate) logging_on: bool,
    /// `"full"`, `"no logger"`, `"none"`, or `"calls back"` for a logger that makes calls itself.
    pub(crate) callbacks: &'static str,
}

impl Instantiate {
    /// Arguments of a host that does everything right.
    pub(crate) fn right(fmu: &Fmu) -> Self {
        Self {
            name: Some("instance".to_owned()),
            guid: Some(fmu.guid.clone()),
            uri: Some(fmu.uri()),
            model_exchange: false,
            logging_on: false,
            callbacks: "full",
        }
    }
}

/// End of a call.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Answer {
    pub(crate) status: Status,
    pub(crate) results: Vec<String>,
    /// Messages to the logger during the call.
    pub(crate) log: Vec<Message>,
}

/// One call of the logger.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Message {
    /// The place of the instance, by the environment pointer.
    pub(crate) slot: String,
    pub(crate) instance: String,
    pub(crate) status: Status,
    pub(crate) category: String,
    pub(crate) text: String,
}

/// A running host. Dropping it ends the host, which must not have had anything to complain of.
pub(crate) struct Host {
    process: Child,
    requests: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    /// Whether calls are made from a thread of their own each.
    pub(crate) in_threads: bool,
}

impl Host {
    pub(crate) fn start() -> Self {
        Self::start_with(Command::new(env!("BIELA_C_HOST")))
    }

    /// Starts it through another program, to which `command` leads.
    pub(crate) fn start_with(mut command: Command) -> Self {
        let mut process = command
            .arg(runtime_library())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the host starts");
        Self {
            requests: process.stdin.take(),
            answers: BufReader::new(process.stdout.take().expect("it is piped")),
            process,
            in_threads: false,
        }
    }

    /// Makes the call whose name, without `fmi2`, and arguments are given.
    ///
    /// Whatever the library itself would print to stdout is no answer, and fails here.
    pub(crate) fn call(&mut self, request: &[impl AsRef<str>]) -> Answer {
        let request: Vec<_> = request.iter().map(AsRef::as_ref).collect();
        let request = request.join("\t");
        let thread = if self.in_threads { "in-thread\t" } else { "" };
        // A host that ended in between is told from its missing answer.
        let requests = self.requests.as_mut().expect("it is open until the drop");
        let _ = writeln!(requests, "{thread}{request}");
        let mut log = Vec::new();
        loop {
            let mut line = String::new();
            self.answers.read_line(&mut line).expect("UTF-8 comes back");
            let line = line.trim_end_matches('\n');
            let fields: Vec<_> = line.split('\t').map(unescaped).collect();
            match fields.iter().map(String::as_str).collect::<Vec<_>>()[..] {
                ["answer", code, ..] => {
                    return Answer {
                        status: status(code),
                        results: fields[2..].to_vec(),
                        log,
                    };
                }
                ["log", slot, instance, code, category, text] => log.push(Message {
                    slot: slot.to_owned(),
                    instance: instance.to_owned(),
                    status: status(code),
                    category: category.to_owned(),
                    text: text.to_owned(),
                }),
                _ => panic!("{request:?}: the host answers {line:?}"),
            }
        }
    }

    /// Makes a call that has to succeed without a word, and gives its results.
    #[track_caller]
    pub(crate) fn ok(&mut self, request: &[impl AsRef<str> + Debug]) -> Vec<String> {
        let answer = self.call(request);
        assert_eq!(answer.status, Status::Ok, "{request:?}: {answer:?}");
        assert_eq!(answer.log, [], "{request:?}");
        answer.results
    }

    /// Makes a call that must be refused, and returns the reason that was logged.
    #[track_caller]
    pub(crate) fn refused(&mut self, request: &[impl AsRef<str> + Debug]) -> String {
        self.failed(request, Status::Error, (Status::Error, "logStatusError"))
    }

    /// Makes a call that must be discarded, and returns the reason that was logged.
    #[track_caller]
    pub(crate) fn discarded(&mut self, request: &[impl AsRef<str> + Debug]) -> String {
        self.failed(
            request,
            Status::Discard,
            (Status::Warning, "logStatusWarning"),
        )
    }

    #[track_caller]
    fn failed(
        &mut self,
        request: &[impl AsRef<str> + Debug],
        status: Status,
        logged: (Status, &str),
    ) -> String {
        let answer = self.call(request);
        assert_eq!(answer.status, status, "{request:?}: {answer:?}");
        let [message] = &answer.log[..] else {
            panic!("{request:?}: not one message: {answer:?}")
        };
        let found = (message.status, message.category.as_str());
        assert_eq!(found, logged, "{request:?}");
        let call = format!("fmi2{}: ", request[0].as_ref());
        assert!(message.text.starts_with(&call), "{request:?}: {message:?}");
        message.text.clone()
    }

    /// Returns whether there is an instance then, and what was logged.
    pub(crate) fn instantiate(&mut self, slot: &str, with: &Instantiate) -> (bool, Vec<Message>) {
        let text = |text: &Option<String>| text.as_deref().map_or(NULL.to_owned(), escaped);
        let answer = self.call(&[
            "Instantiate",
            slot,
            &text(&with.name),
            &text(&with.guid),
            &text(&with.uri),
            if with.model_exchange { "0" } else { "1" },
            if with.logging_on { "1" } else { "0" },
            with.callbacks,
        ]);
        (answer.results == ["1"], answer.log)
    }

    /// The memory that the host has in use \[bytes\], where the system tells.
    pub(crate) fn resident_memory(&self) -> Option<u64> {
        let status = format!("/proc/{}/status", self.process.id());
        let status = std::fs::read_to_string(status).ok()?;
        let line = status
            .lines()
            .find_map(|line| line.strip_prefix("VmRSS:"))?;
        let kilobytes: u64 = line.trim().trim_end_matches(" kB").parse().ok()?;
        Some(1024 * kilobytes)
    }

    #[track_caller]
    pub(crate) fn instantiated(&mut self, slot: &str, fmu: &Fmu) {
        let made = self.instantiate(slot, &Instantiate::right(fmu));
        assert_eq!(made, (true, vec![]));
    }

    /// Goes from a new instance to the first communication point, at 0 s.
    #[track_caller]
    pub(crate) fn initialize(&mut self, slot: &str) {
        self.ok(&["SetupExperiment", slot, "0", NULL]);
        self.ok(&["EnterInitializationMode", slot]);
        self.ok(&["ExitInitializationMode", slot]);
    }

    #[track_caller]
    pub(crate) fn set_real(&mut self, slot: &str, value_reference: &str, value: f64) {
        self.ok(&["SetReal", slot, "1", value_reference, &value.to_string()]);
    }

    #[track_caller]
    pub(crate) fn get_reals(&mut self, slot: &str, value_references: &[u32]) -> Vec<f64> {
        let n = value_references.len().to_string();
        let list: Vec<_> = value_references.iter().map(u32::to_string).collect();
        let values = self.ok(&["GetReal", slot, &n, &list.join(","), "room"]);
        let number = |value: &String| value.parse().expect("the host prints numbers");
        values.iter().map(number).collect()
    }

    #[track_caller]
    pub(crate) fn get_real(&mut self, slot: &str, value_reference: &str) -> f64 {
        let values = self.ok(&["GetReal", slot, "1", value_reference, "room"]);
        values[0].parse().expect("the host prints numbers")
    }

    pub(crate) fn do_step(&mut self, slot: &str, point: f64, size: f64) -> Answer {
        let (point, size) = (point.to_string(), size.to_string());
        self.call(&["DoStep", slot, &point, &size, "1"])
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        drop(self.requests.take());
        let (mut out, mut err) = (String::new(), String::new());
        let stderr = self.process.stderr.as_mut().expect("it is piped");
        let read = stderr.read_to_string(&mut err);
        let read = read.and_then(|_| self.answers.read_to_string(&mut out));
        let status = read.and_then(|_| self.process.wait());
        let status = status.expect("the host ends and writes UTF-8");
        let end = format!("{status}; stdout: {out:?}; stderr: {err:?}");
        if std::thread::panicking() {
            // Why the test fails may stand here; another panic would end all tests.
            let _ = writeln!(std::io::stderr(), "the host's end: {end}");
        } else {
            assert!(
                status.success() && out.is_empty() && err.is_empty(),
                "{end}"
            );
        }
    }
}

fn status(code: &str) -> Status {
    [
        Status::Ok,
        Status::Warning,
        Status::Discard,
        Status::Error,
        Status::Fatal,
    ]
    .into_iter()
    .find(|status| (*status as u8).to_string() == code)
    .unwrap_or_else(|| panic!("no fmi2Status: {code}"))
}

fn escaped(text: &str) -> String {
    text.replace('\\', r"\\")
        .replace('\t', r"\t")
        .replace('\n', r"\n")
}

fn unescaped(text: &str) -> String {
    let mut characters = text.chars();
    let mut plain = String::new();
    while let Some(character) = characters.next() {
        plain.push(match character {
            '\\' => match characters.next() {
                Some('t') => '\t',
                Some('n') => '\n',
                // A null pointer is told by this character, which no text of the library has.
                Some('N') => '\0',
                Some(other) => other,
                None => panic!("half an escape: {text:?}"),
            },
            other => other,
        });
    }
    plain
}

/// Returns whether a program is there to be run.
pub(crate) fn has(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| Path::join(&folder, program).is_file())
}
