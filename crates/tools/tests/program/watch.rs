//! `biela watch`: a page that follows its file.

use std::process::Command;

use crate::served::Served;

#[test]
fn the_page_follows_the_file() {
    let text = crate::common::text("mechanisms/pendulum.toml");
    let watched = Served::start(&["watch"], &text);
    assert!(watched.address.starts_with("127.0.0.1:"));
    let page = watched.get("/");
    assert!(page.contains("<h1>pendulum</h1>") && page.contains("class=\"film\""));
    assert!(!page.contains("class=\"error\""));
    let version = watched.get("/version");
    assert_eq!(watched.get("/version"), version);
    assert!(page.contains(&format!("!== \"{version}\"")));

    // Warnings stand beside the picture.
    let unused = text.replace("[parameters]\n", "[parameters]\nidle = 1\n");
    std::fs::write(watched.file(), unused).unwrap();
    let warned = watched.get("/");
    assert!(warned.contains("class=\"warnings\"") && warned.contains("class=\"film\""));
    assert!(
        warned.contains("nothing uses the parameter `idle`"),
        "{warned}"
    );

    // A broken file shows its error with the last good picture.
    std::fs::write(watched.file(), text.replace("ground.O\"", "ground.Oo\"")).unwrap();
    assert_ne!(watched.get("/version"), version);
    let broken = watched.get("/");
    assert!(broken.contains("no marker `Oo` on `ground`"), "{broken}");
    assert!(!broken.contains("class=\"warnings\""));
    assert!(broken.contains("class=\"film\"") && broken.contains("<h1>pendulum</h1>"));
    std::fs::remove_file(watched.file()).unwrap();
    assert!(watched.get("/").contains("cannot read"));
    // The terminal is told once of each.
    assert!(watched.get("/").contains("cannot read"));
    let told = watched.told();
    assert!(
        told.starts_with("note: no solver for pages was found"),
        "{told}"
    );
    for error in ["watched.toml:20:45", "error: cannot read "] {
        assert_eq!(told.matches(error).count(), 1, "{told}");
    }

    let renamed = text.replace("name = \"pendulum\"", "name = \"another\"");
    std::fs::write(watched.file(), renamed).unwrap();
    let mended = watched.get("/");
    assert!(mended.contains("<h1>another</h1>") && !mended.contains("class=\"error\""));
}

#[test]
fn only_this_machine_is_answered_and_only_what_there_is() {
    // A file that is broken from the start has no picture.
    let watched = Served::start(&["watch"], "format = 1");
    let page = watched.get("/");
    assert!(page.contains("class=\"error\"") && !page.contains("class=\"film\""));
    let host = watched.address.clone();
    for (request, expected) in [
        (
            format!("GET /../Cargo.toml HTTP/1.1\r\nHost: {host}\r\n\r\n"),
            "404",
        ),
        (format!("POST / HTTP/1.1\r\nHost: {host}\r\n\r\n"), "405"),
        // Only its own page may write the file.
        (
            format!("PUT /file HTTP/1.1\r\nHost: {host}\r\nContent-Length: 1\r\n\r\nx"),
            "403",
        ),
        (
            format!("PUT /file HTTP/1.1\r\nHost: {host}\r\nX-Biela-Token: 0\r\n\r\n"),
            "403",
        ),
        (
            format!("PUT / HTTP/1.1\r\nHost: {host}\r\nContent-Length: 1\r\n\r\n\u{fffd}"),
            "400",
        ),
        (
            "GET / HTTP/1.1\r\nHost: elsewhere.example\r\n\r\n".to_owned(),
            "403",
        ),
        ("GET / HTTP/1.1\r\n\r\n".to_owned(), "403"),
        ("\r\n\r\n".to_owned(), "403"),
    ] {
        let (status, _) = watched.ask(&request);
        assert!(
            status.starts_with(&format!("HTTP/1.1 {expected} ")),
            "{request}: {status}"
        );
    }
    // It goes on after that.
    assert!(watched.get("/version").parse::<u64>().is_ok());
}

#[test]
fn a_port_that_is_taken_is_named() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let ended = Command::new(env!("CARGO_BIN_EXE_biela"))
        .current_dir(set_up::root())
        .args(["watch", "mechanisms/pendulum.toml", "--port", &port])
        .output()
        .unwrap();
    assert_eq!(ended.status.code(), Some(2));
    assert!(ended.stdout.is_empty());
    let message = String::from_utf8(ended.stderr).unwrap();
    assert!(
        message.starts_with(&format!("error: cannot listen on port {port}: ")),
        "{message}"
    );
    assert!(message.contains("--port names another"), "{message}");
}
