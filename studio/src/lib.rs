//! `biela::studio` for a browser, with the export of FMUs.

#[path = "../../page/src/abi.rs"]
mod abi;

use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use biela::cli::archive_with;
use biela::fmi::{Platform, RuntimeLibrary};
use biela::mechanism::{Mechanism, Severity, Source};
use serde_json::{Value, json};

/// A studio that also writes FMUs.
///
/// The request `export` has `name`, `text`, `files`, `fmi` (`2` or `3`), `libraries` (pairs of a
/// platform and a library in base64) and maybe `page` (the solver for pages, likewise). Its answer
/// has the FMU, `fmu` in base64, or `problems`.
#[derive(Default)]
struct Host {
    studio: biela::studio::Host,
}

impl Host {
    fn answer(&mut self, request: &str) -> Value {
        if request.starts_with("{\"do\":\"export\"") {
            return match serde_json::from_str(request).map_err(|error| error.to_string()) {
                Ok(request) => export(&request).unwrap_or_else(|problem| json!({ "problems": [problem] })),
                Err(error) => json!({ "error": error }),
            };
        }
        self.studio.answer(request)
    }

    fn drive(&mut self, driver: usize, value: f64) -> bool {
        self.studio.drive(driver, value)
    }

    fn frame(&self) -> &[f64] {
        self.studio.frame()
    }
}

fn export(request: &Value) -> Result<Value, String> {
    let word = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let pairs = |key: &str| {
        let list = request[key].as_array().map_or(&[][..], Vec::as_slice);
        list.iter().map(|pair| (word(&pair[0]), word(&pair[1]))).collect::<Vec<_>>()
    };
    let source = Source::new(word(&request["name"]), word(&request["text"]));
    let source = source.with_files(pairs("files"));
    let (mechanism, _) = Mechanism::parse(&source).map_err(|problems| {
        let errors = problems.iter().filter(|problem| problem.severity == Severity::Error);
        let errors: Vec<String> = errors.map(|error| error.one_line(&source)).collect();
        errors.join("\n")
    })?;
    let unpack = |packed: &str| STANDARD.decode(packed).map_err(|error| error.to_string());
    let libraries = pairs("libraries").into_iter().map(|(platform, packed)| {
        let known = Platform::named(&platform);
        let platform = known.ok_or_else(|| format!("no platform is called `{platform}`"))?;
        let content = unpack(&packed)?;
        Ok(RuntimeLibrary { platform, content: content.into() })
    });
    let libraries = libraries.collect::<Result<Vec<_>, String>>()?;
    let page = request["page"].as_str().map(unpack).transpose()?;
    let fmi = word(&request["fmi"]);
    let fmu = archive_with(&source, &Arc::new(mechanism), &fmi, &libraries, page.as_deref())?;
    Ok(json!({ "fmu": STANDARD.encode(fmu) }))
}
