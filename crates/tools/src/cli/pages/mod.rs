//! Pages for a browser, and the server that gives them.
//!
//! | file | subject |
//! |---|---|
//! | `live` | the part on which a mechanism is moved by hand |
//! | `page_solver` | the solvers, compiled to WebAssembly |
//! | `studio_page` | the page of the studio |
//! | `documentation` | the page, the picture and the licences inside an FMU |
//! | `server` | a server for one browser on this machine |

pub(super) mod documentation;
pub(super) mod live;
pub(super) mod page_solver;
pub(super) mod server;
pub(super) mod studio_page;
