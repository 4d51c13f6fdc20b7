//! `biela::page` for a browser.

mod abi;

use biela::page::Host;
