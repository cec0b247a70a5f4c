//! The result of a command, from which the exit status follows.

use geobench_harness::schema::{Cell, Status};

use crate::terminal;

/// The result of a command that completed, from which the exit status follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// All work is done and every check passed.
    Passed,
    /// A check, a comparison or a cell failed. The others are reported.
    Failed,
    /// Some input could not be used. Results of the rest are reported.
    BadInput,
    /// A signal ended the command. Finished work is reported.
    Interrupted,
}

impl Verdict {
    /// The verdict of a command with one check.
    pub(crate) const fn of(has_passed: bool) -> Self {
        if has_passed {
            Self::Passed
        } else {
            Self::Failed
        }
    }
}

/// Counts of the cells of a plan by result.
pub(crate) struct Tally {
    cells: usize,
    failed: usize,
    refused: usize,
    /// Whether a reference is proven wrong, which may have no cell.
    has_wrong_reference: bool,
}

impl Tally {
    /// Counts `cells` by result. If they are `checked`, a cell without a comparison counts as
    /// failed.
    pub(crate) fn of<'c>(checked: bool, cells: impl IntoIterator<Item = &'c Cell>) -> Self {
        let mut tally = Self {
            cells: 0,
            failed: 0,
            refused: 0,
            has_wrong_reference: false,
        };
        for cell in cells {
            tally.cells += 1;
            tally.has_wrong_reference |= cell.check.replaced.is_some();
            match cell.status {
                Status::Ok => {
                    tally.failed += usize::from(checked && cell.check.reference.is_none());
                }
                Status::Refused => tally.refused += 1,
                _ => tally.failed += 1,
            }
        }
        tally
    }
}

/// The verdict on all cells. Failed cells take precedence over refused models. Prints the number of
/// failed cells.
pub(crate) fn of_cells(tallies: &[Tally]) -> Verdict {
    let sum = |of: fn(&Tally) -> usize| tallies.iter().map(of).sum::<usize>();
    let failed = sum(|tally| tally.failed);
    if failed > 0 {
        terminal::error(&format!(
            "{failed} of {} cells failed or could not be checked",
            sum(|tally| tally.cells)
        ));
        Verdict::Failed
    } else if tallies.iter().any(|tally| tally.has_wrong_reference) {
        terminal::error("a reference is proven wrong");
        Verdict::Failed
    } else if sum(|tally| tally.refused) > 0 {
        Verdict::BadInput
    } else {
        Verdict::Passed
    }
}
