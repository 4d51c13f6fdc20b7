//! Only its build script matters.
