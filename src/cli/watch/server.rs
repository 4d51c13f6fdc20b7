//! A server for one browser on this machine.

use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::time::Duration;

use crate::cli::error::Error;

/// Largest size of a request.
const MOST_BYTES: u64 = 16 * 1024;
/// Time after which a silent connection is closed.
const PATIENCE: Duration = Duration::from_secs(2);

/// A server that listens on the loopback address only.
pub(super) struct Server {
    listener: TcpListener,
    port: u16,
}

/// The answer to a request.
pub(super) struct Answer {
    status: &'static str,
    kind: &'static str,
    body: String,
}

impl Answer {
    pub(super) fn page(body: String) -> Self {
        Self {
            status: "200 OK",
            kind: "text/html",
            body,
        }
    }

    pub(super) fn text(body: String) -> Self {
        Self {
            status: "200 OK",
            kind: "text/plain",
            body,
        }
    }

    pub(super) fn missing() -> Self {
        Self::refusal("404 Not Found")
    }

    fn refusal(status: &'static str) -> Self {
        Self {
            status,
            kind: "text/plain",
            body: status.to_owned(),
        }
    }
}

impl Server {
    pub(super) fn new(port: u16) -> Result<Self, Error> {
        let listen = || {
            let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
            let port = listener.local_addr()?.port();
            Ok(Self { listener, port })
        };
        listen().map_err(|source| Error::Listen { port, source })
    }

    pub(super) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/", self.port)
    }

    /// Answers requests by their paths, one after the other, until accepting one fails.
    pub(super) fn serve(&self, mut answer: impl FnMut(&str) -> Answer) -> Result<(), Error> {
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
        answer: &mut dyn FnMut(&str) -> Answer,
    ) -> io::Result<()> {
        stream.set_read_timeout(Some(PATIENCE))?;
        stream.set_write_timeout(Some(PATIENCE))?;
        let mut lines = BufReader::new(stream.take(MOST_BYTES)).lines();
        let request = lines.next().transpose()?.unwrap_or_default();
        let mut host = None;
        for line in lines {
            let line = line?;
            if line.is_empty() {
                break;
            }
            if let Some((name, value)) = line.split_once(':')
                && name.eq_ignore_ascii_case("host")
            {
                host = Some(value.trim().to_owned());
            }
        }
        let mut words = request.split(' ');
        let (method, path) = (words.next(), words.next());
        // A request under another name may come from a page of another site.
        let own = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        let known = host.is_some_and(|host| own.contains(&host));
        let Answer { status, kind, body } = match (method, path) {
            _ if !known => Answer::refusal("403 Forbidden"),
            (Some("GET"), Some(path)) => answer(path),
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
