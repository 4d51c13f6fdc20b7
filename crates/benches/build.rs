//! Compiles the yardsticks as their users would for speed, in every profile alike: -O3 for the
//! plain x86-64 of any machine, without `-march=native` or `-ffast-math`.

use std::path::Path;
use std::{env, process};

fn main() {
    println!("cargo::rerun-if-changed=yardstick");
    println!("cargo::rerun-if-env-changed=BIELA_FMI_HEADERS");
    let headers = env::var_os("BIELA_FMI_HEADERS").expect("the package `set-up` has checked it");
    let mut build = cc::Build::new();
    build
        .std("c11")
        .opt_level(3)
        .debug(false)
        .include(headers)
        .warnings(true)
        .extra_warnings(true)
        .warnings_into_errors(true)
        .flag_if_supported("-pedantic");

    let library =
        Path::new(&env::var_os("OUT_DIR").expect("cargo sets it")).join("four_bar_fmu.so");
    let mut command = build.get_compiler().to_command();
    command.args(["-shared", "-fPIC", "-fvisibility=hidden"]);
    command.args(["yardstick/fmu.c", "yardstick/four_bar.c", "-lm", "-o"]);
    match command.arg(&library).status() {
        Ok(status) if status.success() => {
            println!("cargo::rustc-env=YARDSTICK_FMU={}", library.display());
        }
        Ok(_) => process::exit(1),
        Err(error) => println!("cargo::error=cannot run the C compiler: {error}"),
    }

    for source in [
        "four_bar.c",
        "slider_crank.c",
        "cam.c",
        "chain.c",
        "clock.c",
        "cycle.c",
    ] {
        build.file(format!("yardstick/{source}"));
    }
    build.compile("yardstick");
}
