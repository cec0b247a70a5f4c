//! What the plots of a group share.

use super::chart::{LinePoint, Series};

/// The context of the plots of a group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting<'a> {
    /// The prefix of the ids of plots.
    pub(super) prefix: &'a str,
    /// The algorithms of the whole result. The index of an algorithm is its style: marker and
    /// colour.
    pub(super) styles: &'a [&'a str],
    /// The base of ratios.
    pub(super) base: Option<&'a str>,
}

impl Setting<'_> {
    pub(super) fn style(&self, algorithm: &str) -> usize {
        let found = self.styles.iter().position(|name| *name == algorithm);
        found.unwrap_or(0)
    }

    /// The line of an algorithm in a chart.
    pub(super) fn series(&self, algorithm: &str, points: Vec<LinePoint>) -> Series {
        Series {
            style: self.style(algorithm),
            name: algorithm.to_owned(),
            algorithm: algorithm.to_owned(),
            joined: true,
            hollow: false,
            points,
            fit: None,
        }
    }
}
