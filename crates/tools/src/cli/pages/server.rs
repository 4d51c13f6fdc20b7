//! A server for one browser on this machine.

use std::hash::{BuildHasher as _, RandomState};
use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::time::Duration;

use clap::Args;

use crate::cli::told::error::Error;

/// Largest size of the head of a request, and of its body: that of a mechanism file.
const MOST_BYTES: [u64; 2] = [16 * 1024, 16 << 20];
/// Time after which a silent connection is closed.
const PATIENCE: Duration = Duration::from_secs(2);

/// Types of answers.
pub(in crate::cli) const PAGE: &str = "text/html";
pub(in crate::cli) const TEXT: &str = "text/plain";
pub(in crate::cli) const JSON: &str = "application/json";
pub(in crate::cli) const SCRIPT: &str = "text/javascript";

/// The option of commands that serve.
#[derive(Args, Debug)]
pub(in crate::cli) struct Listening {
    /// The port to listen on, 0 for a free one [default: 7433 for `studio`, a free one for `watch`].
    #[arg(long, value_name = "PORT")]
    port: Option<u16>,
}

impl Listening {
    /// Returns whether the port was named.
    pub(in crate::cli) fn is_given(&self) -> bool {
        self.port.is_some()
    }
}

/// A server that listens on the loopback address only.
pub(in crate::cli) struct Server {
    listener: TcpListener,
    port: u16,
}

/// A request.
pub(in crate::cli) struct Request {
    pub(in crate::cli) method: String,
    pub(in crate::cli) path: String,
    /// The token that the page was served with.
    pub(in crate::cli) token: Option<String>,
    /// The version of the file that the page has.
    pub(in crate::cli) version: Option<String>,
    pub(in crate::cli) body: String,
}

/// The answer to a request.
pub(in crate::cli) struct Answer {
    status: &'static str,
    kind: &'static str,
    body: String,
}

impl Answer {
    /// Makes an answer of the type `kind`.
    pub(in crate::cli) fn new(kind: &'static str, body: impl Into<String>) -> Self {
        Self {
            status: "200 OK",
            kind,
            body: body.into(),
        }
    }

    /// Makes the answer to a request that is refused.
    pub(in crate::cli) fn refusal(status: &'static str) -> Self {
        Self {
            status,
            ..Self::new(TEXT, status)
        }
    }

    /// Makes the answer that a file has changed since, so that it was not written.
    pub(in crate::cli) fn conflict(why: &str) -> Self {
        Self {
            body: why.to_owned(),
            ..Self::refusal("409 Conflict")
        }
    }

    /// Makes the answer that a file was not written, and why.
    pub(in crate::cli) fn failure(why: String) -> Self {
        Self {
            body: why,
            ..Self::refusal("500 Internal Server Error")
        }
    }
}

impl Server {
    /// Listens on the port that the option names, otherwise on the `usual` one or, where that is taken, on
    /// a free one.
    pub(in crate::cli) fn new(listening: &Listening, usual: u16) -> Result<Self, Error> {
        let listen = |port: u16| {
            let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
            let port = listener.local_addr()?.port();
            Ok(Self { listener, port })
        };
        let port = listening.port.unwrap_or(usual);
        let listened = listen(port).or_else(|error| match listening.port {
            Some(_) => Err(error),
            None => listen(0),
        });
        listened.map_err(|source| Error::Listen { port, source })
    }

    /// Returns the port.
    pub(in crate::cli) fn port(&self) -> u16 {
        self.port
    }

    pub(in crate::cli) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/", self.port)
    }

    /// Answers requests, one after the other, until accepting one fails.
    pub(in crate::cli) fn serve(
        &self,
        mut answer: impl FnMut(&Request) -> Answer,
    ) -> Result<(), Error> {
        loop {
            let (stream, _) = self.listener.accept().map_err(|source| Error::Listen {
                port: self.port,
                source,
            })?;
            // A browser may close the connection at any time.
            let _ = self.talk(&stream, &mut answer);
        }
    }

    fn talk(
        &self,
        mut stream: &TcpStream,
        answer: &mut dyn FnMut(&Request) -> Answer,
    ) -> io::Result<()> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let mut reader = BufReader::new(stream.take(MOST_BYTES[0]));
        let mut next_line = || {
            let mut line = String::new();
            reader.read_line(&mut line)?;
            io::Result::Ok(line.trim_end_matches(['\r', '\n']).to_owned())
        };
        let first = next_line()?;
        let mut words = first.split(' ').map(str::to_owned);
        let mut word = || words.next().unwrap_or_default();
        let mut request = Request {
            method: word(),
            path: word(),
            token: None,
            version: None,
            body: String::new(),
        };
        let mut host = None;
        let mut length = 0;
        loop {
            let line = next_line()?;
            if line.is_empty() {
                break;
            }
            let (name, value) = line.split_once(':').unwrap_or_default();
            let value = value.trim();
            match &*name.to_ascii_lowercase() {
                "host" => host = Some(value.to_owned()),
                "x-biela-token" => request.token = Some(value.to_owned()),
                "x-biela-version" => request.version = Some(value.to_owned()),
                "content-length" => length = value.parse().unwrap_or(0).min(MOST_BYTES[1]),
                _ => {}
            }
        }
        // A request under another name may come from a page of another site.
        let own = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        let known = host.is_some_and(|host| own.contains(&host));
        let Answer { status, kind, body } = match &*request.method {
            _ if !known => Answer::refusal("403 Forbidden"),
            "GET" => answer(&request),
            "PUT" => {
                let mut body = Vec::new();
                reader.get_mut().set_limit(length);
                reader.take(length).read_to_end(&mut body)?;
                match String::from_utf8(body) {
                    Ok(body) => answer(&Request { body, ..request }),
                    Err(_) => Answer::refusal("400 Bad Request"),
                }
            }
            _ => Answer::refusal("405 Method Not Allowed"),
        };
        write!(
            stream,
            "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {}\r\n\
             Cache-Control: no-store\r\nConnection: close\r\n\r\n{body}",
            body.len()
        )
    }
}

/// Returns a text that no other site can guess.
pub(in crate::cli) fn token() -> String {
    let part = || RandomState::new().hash_one(std::process::id());
    format!("{:016x}{:016x}", part(), part())
}
