//! What is wrong with a mechanism that does not close on all its rows.

use super::closing::Closing;
use super::rank::DEPENDENT;
use crate::kinematics::assembly::least_squares::STARTS;
use crate::kinematics::linear::Echelon;
use crate::kinematics::{Element, Error, OpenJoint, Solver, Verdict};

/// An element with less than this part of the largest residual has no part in the gap.
const TAKES_PART: f64 = 1e-3;
/// Elements are left out one by one to find the smallest set that cannot be satisfied, unless
/// they are more than this, in a mechanism that is not small.
const MOST_ELEMENTS: usize = 12;
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
        if self.is_small() || open.len() <= MOST_ELEMENTS {
            // Of two that stand in for each other the one declared first stays.
            for element in open.clone().into_iter().rev() {
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
        // People look for one joint that does not meet: the one declared last.
        let is_driver = |element: &Element| matches!(element, Element::Driver(_));
        let last = open.iter().rfind(|element| !is_driver(element));
        let Some(&last) = last.or(open.last()) else {
            return self.not_found(Vec::new());
        };
        let rows_of_last = self.rows_of(&[last]);
        open.retain(|element| *element != last);
        let others = self.rows_of(&open);
        self.close_on(&others, estimate);
        let contradict = self.depend_on(&rows_of_last, &others);
        self.close_on(&rows, estimate);
        let weight = |row: usize| {
            if rows_of_last.contains(&row) {
                1.0
            } else {
                HOLD_CLOSED
            }
        };
        let mut closing = Closing::new(&self.system, &rows).weigh(weight);
        let gap = closing.close(&mut self.work().1).unwrap_or(0.0);
        let gathered = self.open_joints(&rows_of_last, gap);
        let gathered = gathered.into_iter().next().map(|(_, joint)| joint);
        match gathered {
            Some(open) if contradict => Error::Contradiction { elements, open },
            gathered => match self.find_start(estimate) {
                // What is impossible with fewer rows is so with all.
                Some(deadlock) if deadlock.proved => {
                    let proof = self.search_at_once(deadlock, estimate);
                    let open = gathered.into_iter().collect();
                    proof.err().unwrap_or_else(|| self.not_found(open))
                }
                _ => self.not_found(gathered.into_iter().collect()),
            },
        }
    }

    /// The verdict on a mechanism that stands at the nearest pose found.
    fn not_found(&self, open: Vec<OpenJoint>) -> Error {
        let mut nearest = vec![0.0; self.system.unknowns()];
        self.at.copy_pose(&mut nearest);
        Error::NotAssembled {
            verdict: Verdict::NotFound { starts: STARTS },
            open,
            nearest,
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

    /// Whether some of these rows depend on the others where the mechanism is, which is closed on
    /// the others. A loop that is too short does not close, but could were it longer; what
    /// depends on the others has no say whatever.
    fn depend_on(&mut self, rows: &[usize], others: &[usize]) -> bool {
        let all = self.rows_here();
        let mut echelon = Echelon::new(self.system.unknowns(), &all);
        for &row in others {
            echelon.offer(row, &all[row], DEPENDENT);
        }
        let offered = rows.iter();
        let left_out = offered.filter_map(|&row| echelon.offer(row, &all[row], DEPENDENT));
        left_out.count() > 0
    }
}
