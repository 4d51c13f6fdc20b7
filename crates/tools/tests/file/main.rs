//! Mechanism files: answers to bad ones.

mod diagnostics;
