//! What is wrong with a mechanism that does not close on all its rows.

use super::Solver;
use super::closing::Closing;
use crate::kinematics::constraint::Incidence;
use crate::kinematics::minimise::STARTS;
use crate::kinematics::structure::Matching;
use crate::kinematics::{Element, Error};

/// An element with less than this part of the largest residual has no part in the gap.
const TAKES_PART: f64 = 1e-3;
/// Elements are left out one by one to find the smallest set that cannot be satisfied, unless
/// they are more than this.
const MOST_ELEMENTS: usize = 100;
/// How much more than an element left open all others count when the gap is gathered in it.
const HOLD_CLOSED: f64 = 1e3;

impl Solver {
    /// The verdict on a mechanism that stands at a nearest pose, where its rows are open by up to
    /// `gap`, scaled.
    pub(super) fn explain_open(&mut self, gap: f64, estimate: &[f64]) -> Error {
        if !gap.is_finite() {
            return Error::NotFinite {
                what: "an equation of the mechanism".to_owned(),
            };
        }
        let all: Vec<_> = (0..self.system.equations().len()).collect();
        let mut open = self.elements_open(&all, gap);
        // Drivers too many ask for what the constraints, closed by themselves, do not give.
        let constraints = self.constraint_rows();
        let without_drivers = self.close_on(&constraints, estimate);
        if without_drivers.is_none()
            && let Err(error) = self.find_freedom()
        {
            return error;
        }
        if let Some(gap) = without_drivers {
            open = self.elements_open(&constraints, gap);
        }
        if self.close_on(&self.rows_of(&open), estimate).is_none() {
            open = self.elements_open(&all, 0.0);
        }
        if open.len() <= MOST_ELEMENTS {
            for element in open.clone() {
                let others: Vec<_> = open.iter().copied().filter(|e| *e != element).collect();
                if self.close_on(&self.rows_of(&others), estimate).is_some() {
                    open = others;
                }
            }
        }
        let rows = self.rows_of(&open);
        let mechanism = self.system.mechanism();
        let names = |elements: &[Element]| {
            let names = elements.iter().map(|element| element.describe(mechanism));
            names.collect::<Vec<_>>()
        };
        let elements = names(&open);
        // A loop that is too short has no more equations than unknowns; it just does not close.
        let contradict = self.are_too_many(&rows);
        // People look for one joint that does not meet: the one declared last.
        let is_driver = |element: &Element| matches!(element, Element::Driver(_));
        let last = open.iter().rfind(|element| !is_driver(element));
        let last = last.or(open.last()).copied();
        self.close_on(&rows, estimate);
        let gathered = last.and_then(|last| {
            let weight = |row: usize| {
                let of_last = self.system.equations()[row].element == last;
                if of_last { 1.0 } else { HOLD_CLOSED }
            };
            let mut closing = Closing::new(&self.system, &rows).weigh(weight);
            closing.close(&mut self.work().1);
            let joints = self.open_joints(&self.rows_of(&[last]), 0.0);
            joints.into_iter().next().map(|(_, joint)| joint)
        });
        match gathered {
            Some(open) if contradict => Error::Contradiction { elements, open },
            gathered => Error::NotAssembled {
                starts: STARTS,
                open: gathered.into_iter().collect(),
            },
        }
    }

    /// The elements with a noticeable part of a largest residual where the mechanism is.
    fn elements_open(&self, rows: &[usize], largest: f64) -> Vec<Element> {
        let mut elements: Vec<_> = rows
            .iter()
            .filter(|&&row| {
                let Self {
                    system,
                    at,
                    targets,
                    pose,
                    ..
                } = self;
                let value = system.evaluate_row(row, at, targets, &pose.drivers, |_, _| {});
                value.value.abs() >= TAKES_PART * largest
            })
            .map(|&row| self.system.equations()[row].element)
            .collect();
        elements.sort_unstable();
        elements.dedup();
        elements
    }

    fn rows_of(&self, elements: &[Element]) -> Vec<usize> {
        let equations = self.system.equations().iter().enumerate();
        let theirs = equations.filter(|(_, e)| elements.contains(&e.element));
        theirs.map(|(row, _)| row).collect()
    }

    /// Whether rows cannot all have an unknown of their own.
    fn are_too_many(&self, rows: &[usize]) -> bool {
        let incidences: Vec<_> = rows
            .iter()
            .map(|&row| {
                let mut incidence = Incidence::default();
                let constraint = &self.system.equations()[row].constraint;
                constraint.incidence(self.system.mechanism(), &mut incidence);
                incidence
            })
            .collect();
        let order = 0..rows.len();
        let matching = Matching::new(&incidences, self.system.unknowns(), order);
        !matching.pairs_all_rows()
    }
}
