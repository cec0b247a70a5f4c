//! Which windows of a list are compared with each other.

use geobench_window::Window;

use crate::pairs::{Edge, Verdict, check_pair};
use crate::trim::trim_pair;

/// Which windows of a list are compared before it crosses its face, and how.
pub trait Pairs: Send {
    /// Appends `new` to the windows of a list that have been checked so far, or drops it, and cuts
    /// or drops those with which it is compared. Returns how many windows died.
    fn push(checked: &mut Vec<Window>, new: Window, edge: &Edge) -> u64;
}

/// Neighbours in the list: rules 2 and 3 (Qin et al. 2016, sections 4.2 and 4.3). A window is
/// compared with the last one until both of them stay or it dies, so a whole list takes linear
/// time.
#[derive(Clone, Copy, Debug)]
pub struct Neighbours;

impl Pairs for Neighbours {
    #[inline]
    fn push(checked: &mut Vec<Window>, mut new: Window, edge: &Edge) -> u64 {
        let mut died = 0;
        while let Some(last) = checked.last_mut() {
            match check_pair(last, &mut new, edge) {
                Verdict::BothStay => break,
                Verdict::FirstDies => {
                    checked.pop();
                    died += 1;
                }
                Verdict::SecondDies => return died + 1,
            }
        }
        checked.push(new);
        died
    }
}

/// None: rules 2 and 3 switched off.
#[derive(Clone, Copy, Debug)]
pub struct NoPairs;

impl Pairs for NoPairs {
    #[inline]
    fn push(checked: &mut Vec<Window>, new: Window, _: &Edge) -> u64 {
        checked.push(new);
        0
    }
}

/// Every pair, once: quadratic in the length of the list.
#[derive(Clone, Copy, Debug)]
pub struct AllPairs;

impl Pairs for AllPairs {
    fn push(checked: &mut Vec<Window>, mut new: Window, edge: &Edge) -> u64 {
        let before = checked.len();
        let mut alive = true;
        checked.retain_mut(|w| {
            if !alive {
                return true;
            }
            let verdict = check_pair(w, &mut new, edge);
            alive = verdict != Verdict::SecondDies;
            verdict != Verdict::FirstDies
        });
        let died = before - checked.len() + usize::from(!alive);
        if alive {
            checked.push(new);
        }
        died as u64
    }
}

/// Neighbours in the list, as in rules 2 and 3; what these leave of an overlap is cut at the tie
/// points, as in MMP, so that neighbours never overlap.
#[derive(Clone, Copy, Debug)]
pub struct TiePoints;

impl Pairs for TiePoints {
    fn push(checked: &mut Vec<Window>, mut new: Window, edge: &Edge) -> u64 {
        let mut died = 0;
        while let Some(last) = checked.last_mut() {
            match check_pair(last, &mut new, edge) {
                Verdict::BothStay => {}
                Verdict::FirstDies => {
                    checked.pop();
                    died += 1;
                    continue;
                }
                Verdict::SecondDies => return died + 1,
            }
            let Some((of_last, of_new)) = trim_pair(last, &new, edge.l) else {
                break;
            };
            if of_new.is_empty() {
                return died + 1;
            }
            checked.pop();
            if of_last.is_empty() {
                died += 1;
                continue;
            }
            let start = checked.len();
            checked.extend(of_last.iter().chain(of_new.iter()));
            checked[start..].sort_by(|a, b| a.b0.total_cmp(&b.b0));
            return died;
        }
        checked.push(new);
        died
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGE: Edge = Edge {
        l: 1.0,
        behind: [0.5, -1.0],
    };

    fn window(b0: f64, b1: f64, px: f64, py: f64, sigma: f64) -> Window {
        Window {
            b0,
            b1,
            px,
            py,
            sigma,
        }
    }

    fn push_all<P: Pairs>(windows: &[Window]) -> (Vec<Window>, u64) {
        let mut checked = Vec::new();
        let died = windows
            .iter()
            .map(|&w| P::push(&mut checked, w, &EDGE))
            .sum();
        (checked, died)
    }

    #[test]
    fn a_new_window_is_compared_with_all_that_it_kills() {
        let dear = [0.1, 0.2, 0.3].map(|b0| window(b0, b0 + 0.1, 0.9, -1.0, 3.0));
        let better = window(0.0, 0.6, 0.1, -1.0, 0.0);
        let list = [&dear[..], &[better]].concat();
        assert_eq!(push_all::<Neighbours>(&list), (vec![better], 3));
        assert_eq!(push_all::<AllPairs>(&list), (vec![better], 3));
        assert_eq!(push_all::<TiePoints>(&list), (vec![better], 3));
        assert_eq!(push_all::<NoPairs>(&list), (list, 0));
    }

    #[test]
    fn only_the_exhaustive_check_looks_past_a_neighbour() {
        let best = window(0.0, 0.5, 0.1, -1.0, 0.0);
        let beside = window(0.9, 1.0, 0.95, -1.0, 0.0);
        let beaten = window(0.2, 0.4, 0.9, -1.0, 3.0);
        let list = [best, beside, beaten];
        assert_eq!(push_all::<Neighbours>(&list).1, 0);
        assert_eq!(push_all::<AllPairs>(&list), (vec![best, beside], 1));
    }

    #[test]
    fn equal_windows_survive_each_other_under_every_rule() {
        let w = window(0.2, 0.4, 0.9, -1.0, 1.0);
        let noisy = Window {
            px: w.px + 2e-16,
            ..w
        };
        for list in [[w, w], [w, noisy], [noisy, w]] {
            assert_eq!(push_all::<Neighbours>(&list), (list.to_vec(), 0));
            assert_eq!(push_all::<AllPairs>(&list), (list.to_vec(), 0));
            assert_eq!(push_all::<TiePoints>(&list), (list.to_vec(), 0));
        }
    }

    #[test]
    fn trimmed_neighbours_meet_at_their_tie_point_in_order() {
        let left = window(0.0, 0.8, 0.0, -1.0, 0.0);
        let right = window(0.2, 1.0, 1.0, -1.0, 0.0);
        for list in [[left, right], [right, left]] {
            let (checked, died) = push_all::<TiePoints>(&list);
            let ends: Vec<_> = checked.iter().map(|w| [w.b0, w.b1]).collect();
            assert_eq!((ends, died), (vec![[0.0, 0.5], [0.5, 1.0]], 0));
        }
    }

    #[test]
    fn a_better_window_in_the_middle_parts_the_other_one() {
        let dear = window(0.0, 1.0, 0.5, -1.0, 5.0);
        let cheap = window(0.4, 0.6, 0.5, -0.5, 0.0);
        let (checked, died) = push_all::<TiePoints>(&[dear, cheap]);
        let ends: Vec<_> = checked.iter().map(|w| [w.b0, w.b1]).collect();
        assert_eq!((ends, died), (vec![[0.0, 0.4], [0.4, 0.6], [0.6, 1.0]], 0));
    }
}
