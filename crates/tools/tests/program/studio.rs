//! `biela studio`: a page that keeps its file in step, and a folder for any web server.

use serde_json::Value;

use crate::cli::program::{biela, stderr, stdout};
use crate::served::Served;

/// A file that begins as a solver does.
fn solver(folder: &tempfile::TempDir) -> String {
    let path = folder.path().join("studio.wasm");
    std::fs::write(&path, b"\0asm").expect("it can be written");
    path.to_str().expect("it is text").to_owned()
}

/// The data that the page begins with.
fn beginning(page: &str) -> Value {
    let (_, rest) = page
        .split_once("<script type=\"application/json\" id=\"studio-data\">")
        .expect("the page has its data");
    let (data, _) = rest.split_once("</script>").expect("the data end");
    serde_json::from_str(data).expect("they are JSON")
}

#[test]
fn the_file_is_written_unless_another_program_has_changed_it() {
    let folder = tempfile::tempdir().unwrap();
    let solver = solver(&folder);
    let text = crate::common::text("mechanisms/cam_points.toml");
    let table = crate::common::text("mechanisms/cam_points.csv");
    let served = Served::start(&["studio", "--solver", &solver], &text);
    let beside = served.file().with_file_name("cam_points.csv");
    std::fs::write(beside, &table).unwrap();
    let data = beginning(&served.get("/"));
    assert_eq!(data["file"]["text"], text.as_str());
    assert_eq!(data["file"]["files"][0][0], "cam_points.csv");
    assert_eq!(data["file"]["files"][0][1], table.as_str());
    assert!(
        data["parts"]
            .as_array()
            .is_some_and(|parts| !parts.is_empty())
    );
    assert!(
        data["templates"]
            .as_array()
            .is_some_and(|templates| templates.len() > 50)
    );
    assert_eq!(data["schema"]["properties"]["format"]["const"], 1);

    let word = |key: &str| data[key].as_str().expect("a word").to_owned();
    let (host, token) = (&served.address, word("token"));
    let put = |version: &str, body: &str| {
        served.ask(&format!(
            "PUT /file HTTP/1.1\r\nHost: {host}\r\nX-Biela-Token: {token}\r\nX-Biela-Version: \
             {version}\r\nContent-Length: {}\r\n\r\n{body}",
            body.len()
        ))
    };
    let (status, version) = put(&word("version"), "format = 1\n");
    assert_eq!(status, "HTTP/1.1 200 OK");
    assert_eq!(
        std::fs::read_to_string(served.file()).unwrap(),
        "format = 1\n"
    );
    // The version of the first answer is out of date, the one of the last is not.
    let (status, why) = put(&word("version"), "lost");
    assert_eq!(status, "HTTP/1.1 409 Conflict");
    assert!(why.contains("another program has changed it"), "{why}");
    assert_eq!(put(&version, "format = 2\n").0, "HTTP/1.1 200 OK");
    std::fs::write(served.file(), "mine").unwrap();
    assert_eq!(put(&version, "lost").0, "HTTP/1.1 409 Conflict");
    assert_eq!(std::fs::read_to_string(served.file()).unwrap(), "mine");

    // Only its own page writes; parts that do not exist are not found.
    for (request, expected) in [
        (
            format!("PUT /file HTTP/1.1\r\nHost: {host}\r\nContent-Length: 1\r\n\r\nx"),
            "403",
        ),
        (
            format!("GET /parts/../../x.js HTTP/1.1\r\nHost: {host}\r\n\r\n"),
            "404",
        ),
        (
            format!("GET /parts/amiga.js HTTP/1.1\r\nHost: {host}\r\n\r\n"),
            "404",
        ),
    ] {
        let (status, _) = served.ask(&request);
        assert!(
            status.starts_with(&format!("HTTP/1.1 {expected} ")),
            "{request}: {status}"
        );
    }
}

#[test]
fn a_folder_holds_the_page_and_a_script_for_each_part() {
    let folder = tempfile::tempdir().unwrap();
    let solver = solver(&folder);
    let out = folder.path().join("out");
    let out = out.to_str().unwrap();
    let wrote = biela(&["studio", "--solver", &solver, "--write", out]).success();
    assert!(stderr(&wrote).starts_with("wrote "), "{}", stderr(&wrote));
    let page = std::fs::read_to_string(format!("{out}/index.html")).unwrap();
    let data = beginning(&page);
    assert!(data["file"].is_null() && data["token"].is_null());
    for part in data["parts"].as_array().unwrap() {
        let part = part.as_str().unwrap();
        let script = std::fs::read_to_string(format!("{out}/parts/{part}.js")).unwrap();
        assert!(script.contains(&format!("[\"{part}\"] = \"H4sI")), "{part}");
    }
}

#[test]
fn a_name_that_is_no_mechanism_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let solver = solver(&folder);
    let refused = biela(&["studio", "--solver", &solver, "linkage.txt"]).code(2);
    assert_eq!(stdout(&refused), "");
    assert!(
        stderr(&refused).contains("it must end in .toml"),
        "{}",
        stderr(&refused)
    );
}

#[test]
fn a_file_that_the_page_cannot_show_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let solver = solver(&folder);
    let path = folder.path().join("old.toml");
    let latin = b"# cig\xfce\xf1al\nformat = 1\n";
    std::fs::write(&path, latin).unwrap();
    let refused = biela(&["studio", "--solver", &solver, path.to_str().unwrap()]).code(2);
    assert_eq!(stdout(&refused), "");
    assert!(
        stderr(&refused).contains("it is not UTF-8"),
        "{}",
        stderr(&refused)
    );
    assert_eq!(std::fs::read(path).unwrap(), latin);
}
