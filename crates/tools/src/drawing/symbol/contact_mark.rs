//! Contacts of shapes: a dot where they touch, a line across an open gap.

use super::dimension::told;
use super::*;
use biela::kinematics::Solver;
use biela::mechanism::DisplayUnit;

/// The nearest places of a contact's two shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactMark {
    /// The contact's name and its clearance.
    pub text: String,
    /// The place on each shape, on ground.
    pub at: [Anchor; 2],
    /// Whether the shapes touch.
    pub touches: bool,
}

/// Radius of the dot.
const DOT: f64 = 3.0;

/// Composes all contacts at the solver's pose, about the symbols of its mechanism.
pub(in crate::drawing) fn compose(symbols: &[Symbol], solver: &Solver) -> Vec<Symbol> {
    let mechanism = solver.mechanism();
    let Bounds { low, high } = bounds(symbols, &solver.pose().q);
    // Far more than rounding, far less than any gap of a part.
    let near = 1e-9 * (high - low).max();
    let unit = mechanism.length_display();
    let unit_name = unit.unwrap_or(DisplayUnit::METRE).name;
    let contacts = mechanism.stops.iter();
    let marks = contacts.filter_map(|contact| {
        let (clearance, places) = solver.clearance(contact.coordinate.shapes()?)?;
        let touches = clearance.abs() <= near;
        let clearance = told(if touches { 0.0 } else { clearance }, unit);
        Some(ContactMark {
            text: format!("{} {clearance} {unit_name}", contact.name),
            at: places.map(|place| Anchor::origin(None).moved_to(place)),
            touches,
        })
    });
    marks.map(Symbol::from).collect()
}

impl Shape for ContactMark {
    fn draw(&self, pen: &mut Pen) {
        let ends = self.at.map(|end| pen.on(end).0);
        let places = if self.touches {
            let dot = Outline::circle(ends[0], DOT);
            pen.area(Layer::Point, dot, (Colour::INK, 1.0), None);
            Candidate::around(ends[0], DOT)
        } else {
            pen.line(Layer::Point, Outline::line(&ends), Colour::INK, LINE);
            Candidate::around(ends[0].lerp(&ends[1], 0.5), DOT)
        };
        pen.label(Named::Point, &self.text, Colour::INK, places);
    }

    fn extent(&self) -> Vec<Disc> {
        self.at.map(Disc::from).to_vec()
    }
}
