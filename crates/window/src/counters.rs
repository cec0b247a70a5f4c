//! The counters of all algorithms, with their definitions.

use crate::wavefront::WavefrontRecord;

macro_rules! counters {
    ($($(#[doc = $doc:literal])+ $name:ident = $key:literal,)+) => {
        /// A quantity that a run counts. The documentation of each variant is its definition, the
        /// same for every algorithm.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum Counter {
            $($(#[doc = $doc])+ $name,)+
        }

        impl Counter {
            /// Every counter, in the order of the result file.
            pub const ALL: &[Counter] = &[$(Counter::$name),+];

            /// The name of the counter in result files.
            pub const fn key(self) -> &'static str {
                match self {
                    $(Counter::$name => $key,)+
                }
            }

            /// The definition of the counter in words.
            pub const fn definition(self) -> &'static str {
                match self {
                    $(Counter::$name => concat!($($doc),+),)+
                }
            }
        }
    };
}

counters! {
    /// Child windows tried: pairs of a window that crosses a triangle and an exit that no
    /// rule has excluded beforehand, whether or not rays of the window lead there. This is the
    /// "number of window propagations" of the papers' tables.
    Propagated = "propagated",
    /// Windows that were taken from a queue or list and crossed a triangle.
    Parents = "parents",
    /// Non-empty windows among the children tried.
    Children = "children",
    /// Children of which a part was left after the checks at their edge.
    Kept = "kept",
    /// Windows that sources and pseudo-sources sent out.
    Spawned = "spawned",
    /// Windows that wait for another turn because trimming changed their least distance. In queues
    /// of single windows each of them is queued again.
    Reinserted = "reinserted",
    /// Windows that lost a part of their interval to another window.
    Trimmed = "trimmed",
    /// Windows dropped whole, by a vertex filter, by another window or as stale. Includes spawned
    /// windows.
    Filtered = "filtered",
    /// Most windows alive at one time. For MMP: windows stored on edges, without those evicted
    /// behind the wavefront. For other algorithms: windows that wait to be propagated.
    PeakWindows = "peak_windows",
    /// Most windows that wait to be propagated at one time, in whatever structure. A window waits
    /// until its turn, or until it is trimmed away or replaced by its remainder. A window found
    /// stale at its turn has waited until then. Queue entries whose window no longer exists do not
    /// count.
    PeakWavefront = "peak_wavefront",
    /// Windows stored on edges when the run ends (the "window limit" of MMP), with those evicted
    /// behind the wavefront. Without eviction it is at most `peak_windows`.
    StoredWindows = "stored_windows",
    /// Bytes that one window takes in the structure in which it waits.
    WindowBytes = "window_bytes",
    /// Insertions into the queue that orders the run.
    QueuePushes = "queue_pushes",
    /// Most entries in that queue at one time, outdated ones included.
    QueuePeak = "queue_peak",
    /// Rounds of a queue that works in batches.
    Iterations = "iterations",
    /// Most windows, or other events, that one such round was to take: the greatest K of Xu et al.
    /// 2015.
    KPeak = "k_peak",
    /// Depth of the sequence tree: the most triangles crossed by a window and its ancestors.
    Levels = "levels",
    /// Times that a vertex sent out windows as a pseudo-source.
    PseudoSources = "pseudo_sources",
    /// Child windows tried in faces that had just joined the traversed area.
    Prime = "prime",
    /// Child windows tried in faces that were in the traversed area already.
    Secondary = "secondary",
    /// Of the secondary ones, those in faces with a vertex on the border of the traversed area.
    SecondaryNear = "secondary_near",
    /// Windows in the lists whose neighbours rules 2 and 3 compare: N in proposition 5.1 of Qin et
    /// al. 2016.
    ComparedWindows = "compared_windows",
    /// Pairs of windows of one list that are compared, each as often as it is. With trimming, a
    /// pair at the border of two vector registers may be compared once more.
    PairChecks = "pair_checks",
    /// Exits that rule 1 closed to windows before a child was tried.
    Rule1 = "rule_1",
    /// Windows that lost rays to a neighbour in case 1 of Qin et al. 2016: they overlap, in the
    /// order of the list, and came through one edge (rule 2).
    Case1 = "case_1",
    /// The same in case 2: they overlap, in the opposite order, and came through one edge.
    Case2 = "case_2",
    /// The same in case 3: they are apart, and came through one edge.
    Case3 = "case_3",
    /// The same in case 4: they overlap, in the order of the list, and came through two edges (rule
    /// 3).
    Case4 = "case_4",
    /// The same in case 5: they overlap, in the opposite order, and came through two edges.
    Case5 = "case_5",
    /// The same in case 6: they are apart, and came through two edges.
    Case6 = "case_6",
    /// Bytes of the graph that set-up builds and the run searches.
    GraphBytes = "graph_bytes",
    /// Vertices, sources aside, whose distance an approximate algorithm found negative, and set to
    /// 0.
    Negative = "negative",
}

/// The counts of one run; a counter that the algorithm does not have is `None`, never 0.
///
/// ```
/// use geobench_window::{Counter, Counters};
///
/// let mut counters = Counters::default();
/// counters.set(Counter::Propagated, 12);
/// assert_eq!(counters.get(Counter::Propagated), Some(12));
/// assert_eq!(counters.get(Counter::Trimmed), None);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Counters {
    values: [Option<u64>; Counter::ALL.len()],
    /// The value defined by [`Self::WAVEFRONT_DEVIATION_DEFINITION`].
    pub wavefront_deviation: Option<f64>,
    /// Some dozens of samples of the wavefront at even intervals of the run; empty if the algorithm
    /// has no wavefront to sample.
    pub wavefront: Vec<WavefrontRecord>,
}

impl Counters {
    /// The name of [`wavefront_deviation`](Self::wavefront_deviation) in result files.
    pub const WAVEFRONT_DEVIATION: &str = "wavefront_deviation";

    /// The definition of [`wavefront_deviation`](Self::wavefront_deviation).
    pub const WAVEFRONT_DEVIATION_DEFINITION: &str = "Standard deviation of the least distances of \
        the windows on the wavefront, averaged over samples at even intervals of the run, in the \
        units of the mesh.";

    /// The count of `counter`, if the algorithm has it.
    pub const fn get(&self, counter: Counter) -> Option<u64> {
        self.values[counter as usize]
    }

    /// Sets `counter` to `value`.
    pub const fn set(&mut self, counter: Counter, value: u64) {
        self.values[counter as usize] = Some(value);
    }

    /// Every counter with its count, in the order of the result file.
    pub fn iter(&self) -> impl Iterator<Item = (Counter, Option<u64>)> {
        Counter::ALL
            .iter()
            .map(|&counter| (counter, self.get(counter)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_that_was_not_set_is_absent() {
        let mut counters = Counters::default();
        counters.set(Counter::Kept, 7);
        assert_eq!(counters.get(Counter::Kept), Some(7));
        assert_eq!(counters.get(Counter::Levels), None);
        assert_eq!(
            counters.iter().filter(|(_, count)| count.is_some()).count(),
            1
        );
    }

    #[test]
    fn keys_are_distinct() {
        let mut keys: Vec<_> = Counter::ALL.iter().map(|c| c.key()).collect();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), Counter::ALL.len());
    }
}
