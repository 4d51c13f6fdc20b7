//! The number of sub-steps that a path may take, and their pace.

/// Most sub-steps of a path: some thousand turns.
const MOST_SUBSTEPS: f64 = 100_000.0;
/// The same for a mechanism of any size.
const FEWEST_SUBSTEPS: f64 = 1_000.0;
/// Most work of a path between these limits, in that of one row in closed form: about a second.
const WORK_OF_PATH: f64 = 5e7;
/// The work of bounding the numbers of a row at each sub-step, while parameters move.
const WORK_OF_NUMBERS: f64 = 10.0;
/// The work of checking a cam's profile at each sub-step, while parameters move it.
const WORK_OF_PROFILE: f64 = 5e4;
/// A path is given up if, at the pace of this part of the most sub-steps, twice the most would be
/// needed ahead, unless it is faster than that of the part before by this factor: one place says
/// little of the whole path. The first part is not judged.
const PART_TO_JUDGE: f64 = 0.02;
const FASTER: f64 = 1.5;
/// Fewest sub-steps that a pace is judged by.
const ENOUGH_TO_JUDGE: u32 = 200;

/// The pace of the sub-steps since it was judged last.
#[derive(Debug, Default)]
pub(super) struct Pace {
    /// The number of sub-steps at that time, and the place on the path.
    judged: (u32, f64),
    /// The pace up to that time.
    before: f64,
}

/// The verdict on a pace.
pub(super) enum Verdict {
    /// It may go on.
    Fair,
    /// The most sub-steps would not do.
    Slow,
    /// They are used up.
    Exhausted,
}

impl Pace {
    /// Judges the pace after this number of sub-steps at a place on the path, from time to time.
    pub(super) fn judge(&mut self, substeps: u32, s: f64, most: impl FnOnce() -> f64) -> Verdict {
        let (judged, from) = self.judged;
        if substeps - judged < ENOUGH_TO_JUDGE {
            return Verdict::Fair;
        }
        let most = most();
        let since = f64::from(substeps - judged);
        if since < PART_TO_JUDGE * most {
            return Verdict::Fair;
        }
        self.judged = (substeps, s);
        let pace = (s - from) / since;
        let before = std::mem::replace(&mut self.before, pace);
        if f64::from(substeps) >= most {
            Verdict::Exhausted
        } else if pace * 2.0 * most < 1.0 - s && pace <= FASTER * before {
            Verdict::Slow
        } else {
            Verdict::Fair
        }
    }
}

/// Returns the most sub-steps of a path: fewer where one takes more work, in that of one row in
/// closed form. `moved` are the numbers of rows and of profiles of cams, if parameters move.
pub(in crate::kinematics) fn most_substeps(work: f64, moved: Option<[usize; 2]>) -> f64 {
    let of_moved = moved.map_or(0.0, |[rows, profiles]| {
        WORK_OF_NUMBERS * rows as f64 + WORK_OF_PROFILE * profiles as f64
    });
    (WORK_OF_PATH / (work + of_moved)).clamp(FEWEST_SUBSTEPS, MOST_SUBSTEPS)
}
