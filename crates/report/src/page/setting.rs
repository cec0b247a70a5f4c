//! What the plots of a group share.

use geobench_harness::figures::CLAIMED;

use super::chart::{Lane, LinePoint, Series};

/// The context of the plots of a group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting<'a> {
    /// The prefix of the ids of plots.
    pub(crate) prefix: &'a str,
    /// The algorithms of the whole result. The index of an algorithm is its style: marker and
    /// colour.
    pub(crate) styles: &'a [&'a str],
    /// Those whose times are claims that nothing confirms.
    pub(crate) claimed: &'a [&'a str],
    /// The base of ratios.
    pub(crate) base: Option<&'a str>,
}

impl Setting<'_> {
    pub(crate) fn style(&self, algorithm: &str) -> usize {
        let found = self.styles.iter().position(|name| *name == algorithm);
        found.unwrap_or(0)
    }

    /// The name of an algorithm in a chart.
    pub(super) fn shown(&self, algorithm: &str) -> String {
        if self.claimed.contains(&algorithm) {
            format!("{algorithm} {CLAIMED}")
        } else {
            algorithm.to_owned()
        }
    }

    /// A lane of an algorithm in a chart.
    pub(super) fn lane(&self, algorithm: &str) -> Lane {
        Lane {
            label: self.shown(algorithm),
            algorithm: Some(algorithm.to_owned()),
            ..Lane::default()
        }
    }

    /// The line of an algorithm in a chart.
    pub(crate) fn series(&self, algorithm: &str, points: Vec<LinePoint>) -> Series {
        Series {
            style: self.style(algorithm),
            name: self.shown(algorithm),
            algorithm: algorithm.to_owned(),
            joined: true,
            hollow: false,
            points,
            fit: None,
        }
    }
}
