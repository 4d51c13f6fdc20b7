//! Names of Python stay open when the module is linked, on macOS by a flag.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
