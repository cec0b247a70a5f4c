//! Bar charts of times in a terminal.

use geobench_export::escape::printable;
use geobench_harness::figures::time;
use geobench_harness::measure::number;
use geobench_harness::schema::{Cell, GroupRecord, ModelRecord};

use crate::table::group::GroupCells;

/// An algorithm with its bar.
#[derive(Debug)]
struct TimeBar {
    /// Its label.
    label: String,
    /// Its time in seconds, if known.
    seconds: Option<f64>,
    /// The status in words, if it failed.
    failure: Option<String>,
}

/// The least width that is given to bars, in characters. With less, there are none.
const SHORTEST: usize = 8;

/// The most characters of a label. Longer labels are cut.
const LONGEST_LABEL: usize = 32;

/// One line for each algorithm, no wider than `width`: its time, the ratio to the time of `base`
/// and a bar. The longest bar fills the width. A narrow terminal has no bars.
fn lines(bars: &[TimeBar], base: Option<&str>, width: usize) -> Vec<String> {
    let known = || bars.iter().filter_map(|bar| bar.seconds);
    let longest = known().fold(0.0, f64::max);
    let base = base.and_then(|base| bars.iter().find(|bar| bar.label == base)?.seconds);
    let times: Vec<String> = bars
        .iter()
        .map(|bar| match (&bar.failure, bar.seconds) {
            (Some(failure), _) => failure.clone(),
            (None, Some(seconds)) => format!("{} s", number::seconds(seconds, 6)),
            (None, None) => String::new(),
        })
        .collect();
    let ratio = |bar: &TimeBar| match (bar.seconds, base) {
        (Some(seconds), Some(base)) if base > 0.0 => number::ratio(seconds / base),
        _ => String::new(),
    };
    let ratios: Vec<String> = bars.iter().map(ratio).collect();
    let widest = |texts: &mut dyn Iterator<Item = usize>| texts.max().unwrap_or(0);
    let label_width = widest(&mut bars.iter().map(|bar| bar.label.chars().count()))
        .min(LONGEST_LABEL)
        .min(width / 3);
    let time_width = widest(&mut times.iter().map(|text| text.chars().count()));
    let ratio_width = widest(&mut ratios.iter().map(|text| text.chars().count()));
    // Two spaces stand before each column.
    let used = 2 + label_width + 2 + time_width + 2 + ratio_width;
    let room = width.saturating_sub(used + 2 + 1);
    bars.iter()
        .zip(times.iter().zip(&ratios))
        .map(|(bar, (time, ratio))| {
            let label = shortened(&bar.label, label_width);
            let mut line =
                format!("  {label:label_width$}  {time:>time_width$}  {ratio:>ratio_width$}");
            if room >= SHORTEST
                && let Some(seconds) = bar.seconds.filter(|_| longest > 0.0)
            {
                line += "  ";
                line += &blocks(seconds / longest, room);
            }
            let end = line.trim_end().len();
            line.truncate(end);
            line.chars().take(width).collect()
        })
        .collect()
}

/// The times of all algorithms on one model as bars, with a heading before and an empty line after
/// them. Empty if fewer than two algorithms have a time. `cells` are those of the model.
pub fn model_bars(
    group: &GroupRecord,
    model: &ModelRecord,
    cells: &[Cell],
    width: usize,
) -> String {
    let group = GroupCells::new(group, std::slice::from_ref(model), cells);
    let Some(base) = group.base() else {
        return String::new();
    };
    let bar = |name: &&str| TimeBar {
        label: printable(&group.shown(name)).into_owned(),
        seconds: group
            .value(time(), &model.name, name)
            .map(|time| time.value),
        failure: group.failure(&model.name, name),
    };
    let bars: Vec<TimeBar> = group.algorithms.iter().map(bar).collect();
    if bars.iter().filter(|bar| bar.seconds.is_some()).count() < 2 {
        return String::new();
    }
    let head = format!("  time, and as a multiple of that of {}", printable(base));
    let lines = lines(&bars, Some(&printable(&group.shown(base))), width);
    let head = std::iter::once(head.chars().take(width).collect());
    head.chain(lines).collect::<Vec<String>>().join("\n") + "\n\n"
}

fn shortened(label: &str, width: usize) -> String {
    if label.chars().count() <= width {
        return label.to_owned();
    }
    let kept = label.chars().take(width.saturating_sub(1));
    kept.chain(std::iter::once('\u{2026}')).collect()
}

/// A bar over a share of `room` characters, rounded to an eighth of a character.
fn blocks(share: f64, room: usize) -> String {
    const EIGHTHS: [&str; 8] = [
        "", "\u{258f}", "\u{258e}", "\u{258d}", "\u{258c}", "\u{258b}", "\u{258a}", "\u{2589}",
    ];
    // The conversion saturates at 0. Even the shortest bar is visible.
    #[expect(clippy::cast_sign_loss, reason = "a share is not negative")]
    let eighths = ((share * 8.0 * room as f64).round() as usize).clamp(1, 8 * room);
    "\u{2588}".repeat(eighths / 8) + EIGHTHS[eighths % 8]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bars() -> Vec<TimeBar> {
        let bar = |label: &str, seconds: Option<f64>| TimeBar {
            label: label.to_owned(),
            seconds,
            failure: None,
        };
        vec![
            bar("mmp", Some(1.35)),
            bar("vtp", Some(0.296)),
            bar("vtp-fast", Some(0.0601)),
            TimeBar {
                failure: Some("timeout".to_owned()),
                ..bar("ich", None)
            },
            bar("fwp-mmp{k=200,bucket=0.25}", None),
        ]
    }

    #[test]
    fn bars_fit_any_width() {
        insta::assert_snapshot!("wide", lines(&bars(), Some("vtp"), 90).join("\n"));
        insta::assert_snapshot!("narrow", lines(&bars(), Some("vtp"), 44).join("\n"));
        for width in 1..120 {
            for base in [None, Some("vtp"), Some("ich"), Some("none")] {
                for line in lines(&bars(), base, width) {
                    assert!(line.chars().count() <= width, "{width}: {line}");
                }
            }
        }
        assert!(lines(&[], Some("vtp"), 80).is_empty());
    }

    #[test]
    fn bars_are_as_long_as_their_shares() {
        assert_eq!(blocks(1.0, 4), "\u{2588}".repeat(4));
        assert_eq!(blocks(0.5, 3), "\u{2588}\u{258c}");
        assert_eq!(blocks(0.0, 3), "\u{258f}");
    }
}
