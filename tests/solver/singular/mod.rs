//! Dead points, change points and touches: they are located, crossed or refused by name.
//!
//! | file | subject |
//! |---|---|
//! | `four_bars` | parallelograms and four-bars, on the smooth motion and at their limits |
//! | `kinds` | mechanisms of all kinds of blocks |
//! | `accuracy` | outputs on both sides of change points |

mod accuracy;
mod four_bars;
mod kinds;
