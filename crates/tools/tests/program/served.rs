//! A command that serves a page, asked as a browser asks it.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

/// A running command, which ends with the test.
pub(crate) struct Served {
    child: Child,
    /// `127.0.0.1:port`.
    pub(crate) address: String,
    folder: tempfile::TempDir,
}

impl Drop for Served {
    fn drop(&mut self) {
        // It may have ended by itself, which the test has told.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Served {
    /// Starts a command on a file with this text.
    pub(crate) fn start(arguments: &[&str], text: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("watched.toml");
        std::fs::write(&file, text).expect("it can be written");
        let told = std::fs::File::create(folder.path().join("stderr")).expect("a file");
        let mut child = Command::new(env!("CARGO_BIN_EXE_biela"))
            .args(arguments)
            .arg(file)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::from(told))
            .spawn()
            .expect("the program runs");
        let mut line = String::new();
        let mut output = BufReader::new(child.stdout.take().expect("it is piped"));
        output.read_line(&mut line).expect("it says where it is");
        let address = line.trim().strip_prefix("http://").expect("an address");
        Self {
            child,
            address: address.trim_end_matches('/').to_owned(),
            folder,
        }
    }

    /// Text on stderr so far.
    pub(crate) fn told(&self) -> String {
        std::fs::read_to_string(self.folder.path().join("stderr")).expect("it is text")
    }

    pub(crate) fn file(&self) -> PathBuf {
        self.folder.path().join("watched.toml")
    }

    /// Status and body that answer a request.
    pub(crate) fn ask(&self, request: &str) -> (String, String) {
        let mut stream = TcpStream::connect(&self.address).expect("it listens");
        stream.write_all(request.as_bytes()).expect("it listens");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("it answers");
        let (head, body) = answer.split_once("\r\n\r\n").expect("a head and a body");
        let status = head.lines().next().expect("a status");
        (status.to_owned(), body.to_owned())
    }

    pub(crate) fn get(&self, path: &str) -> String {
        let host = &self.address;
        let (status, body) = self.ask(&format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n"));
        assert_eq!(status, "HTTP/1.1 200 OK");
        body
    }
}
