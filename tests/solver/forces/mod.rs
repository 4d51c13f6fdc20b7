//! Forces of mechanisms whose motion is known, against laws of mechanics that the solver does not
//! use, closed forms and published figures.

mod balance;
mod cases;
mod change_points;
mod energy;
mod fmu;
mod friction;
mod invariance;
mod joint_friction;
mod loaded;
mod published;
mod redundant;
mod sliding;
