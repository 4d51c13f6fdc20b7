//! The kinds of generated mechanisms.

mod cams;
mod couplings;
mod curves;
mod groups;
mod linkages;
mod machines;
mod redundant;
mod ropes;
mod sliders;
mod wheels;

use super::Case;
use super::text::Text;
use crate::mutation::Chance;

/// Draws a mechanism and the jump of its drivers into an empty text, which may turn lengths into
/// parameters that jump.
pub type Draw = fn(&mut Chance, Text<'_>) -> Case;

/// The kinds with their names.
pub const KINDS: [(&str, Draw); 36] = [
    ("four_bar", linkages::four_bar),
    ("six_bar", linkages::six_bar),
    ("slider_crank", sliders::slider_crank),
    ("cylinder", sliders::cylinder),
    ("cylinder_and_four_bar", sliders::cylinder_and_four_bar),
    ("scotch_yoke", sliders::scotch_yoke),
    ("oldham_coupling", sliders::oldham_coupling),
    ("trammel", sliders::trammel),
    ("quick_return", sliders::quick_return),
    ("excavator", machines::excavator),
    ("five_bar", machines::five_bar),
    ("two_loops_of_cylinders", machines::two_loops_of_cylinders),
    ("scissor_lift", machines::scissor_lift),
    ("geared_five_bar", wheels::geared_five_bar),
    ("planet_crank", wheels::planet_crank),
    ("rack_in_loop", wheels::rack_in_loop),
    ("rolling_wheel", wheels::rolling_wheel),
    ("wheel_on_coupler", wheels::wheel_on_coupler),
    ("coupled_cranks", couplings::coupled_cranks),
    ("differential", couplings::differential),
    ("screw", couplings::screw),
    ("cam_slide", cams::cam_slide),
    ("cam_arm", cams::cam_arm),
    ("cam_in_loop", cams::cam_in_loop),
    ("platform", groups::platform),
    ("triad", groups::triad),
    ("ring_of_four", groups::ring_of_four),
    ("any_group", groups::any_group),
    ("bar_in_groove", curves::bar_in_groove),
    ("carriage", curves::carriage),
    ("rope_on_arm", ropes::rope_on_arm),
    ("counterweight", ropes::counterweight),
    ("three_cranks", redundant::three_cranks),
    ("double_guide", redundant::double_guide),
    ("cardan", redundant::cardan),
    ("twin_slider_cranks", redundant::twin_slider_cranks),
];
