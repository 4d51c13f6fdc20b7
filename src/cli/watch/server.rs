//! A server for one browser on this machine.

use std::io::{self, BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::time::Duration;

use crate::cli::error::Error;

/// A request is not longer than this.
const MOST_BYTES: u64 = 16 * 1024;
/// Whoever says nothing for so long keeps nobody waiting.
const PATIENCE: Duration = Duration::from_secs(2);

/// Listens on the loopback address alone.
pub(super) struct Server {
    listener: TcpListener,
    port: u16,
}

/// What a request is answered with.
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

    /// Answers one request after the other, by their paths, for as long as it can.
    pub(super) fn serve(&self, mut answer: impl FnMut(&str) -> Answer) -> Result<(), Error> {
        loop {
            let (stream, _) = self.listener.accept().map_err(|source| Error::Listen {
                port: self.port,
                source,
            })?;
            // A browser that goes away is no error.
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
        // Under another name it may be a page from elsewhere that asks.
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
