//! Fails, and says what to do, unless `make setup` has run.

use std::{env, path::Path};

fn main() {
    println!("cargo::rerun-if-env-changed=BIELA_FMI_HEADERS");
    let headers = env::var_os("BIELA_FMI_HEADERS").unwrap_or_default();
    let header = Path::new(&headers).join("fmi2Functions.h");
    println!("cargo::rerun-if-changed={}", header.display());
    if !header.is_file() {
        println!(
            "cargo::error=this folder is not set up: run `make setup` in it, then build again \
             (BIELA_FMI_HEADERS names no folder with fmi2Functions.h)"
        );
    }
}
