//! `biela_tools::page` for a browser.

mod abi;

use biela_tools::page::Host;
