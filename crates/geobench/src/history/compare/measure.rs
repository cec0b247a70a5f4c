//! The figures of a cell that two files can differ in, each with a name for rules.

use geobench_window::{Counter, Counters};

use crate::schema::Cell;

/// A figure that is compared as it is; times are not among them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// A count.
    Counter(Counter),
    /// The deviation of the wavefront.
    WavefrontDeviation,
    /// Instructions.
    Instructions,
    /// A figure of memory, by its place in the list of them.
    Memory(usize),
}

type MemoryFigure = (&'static str, fn(&Cell) -> Option<u64>);

/// The figures of memory by their names in result files.
const MEMORY: [MemoryFigure; 4] = [
    ("papers_bytes", |c| c.memory.papers_bytes),
    ("windows_peak_bytes", |c| c.memory.windows_peak_bytes),
    ("heap_peak_bytes", |c| c.memory.heap_peak_bytes),
    ("rss_peak_bytes", |c| c.memory.rss_peak_bytes),
];

impl Measure {
    /// All of them, in the order of the result file.
    pub fn all() -> impl Iterator<Item = Self> {
        let counters = Counter::ALL.iter().copied().map(Self::Counter);
        counters
            .chain([Self::WavefrontDeviation, Self::Instructions])
            .chain((0..MEMORY.len()).map(Self::Memory))
    }

    /// Its name, that of the field in result files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Counter(counter) => counter.key(),
            Self::WavefrontDeviation => Counters::WAVEFRONT_DEVIATION,
            Self::Instructions => "instructions",
            Self::Memory(place) => MEMORY[place].0,
        }
    }

    /// Its value in `cell`, if it has one.
    pub fn of(self, cell: &Cell) -> Option<f64> {
        match self {
            Self::Counter(counter) => cell.counters.get(counter).map(|n| n as f64),
            Self::WavefrontDeviation => cell.counters.wavefront_deviation,
            Self::Instructions => cell.instructions.map(|n| n as f64),
            Self::Memory(place) => MEMORY[place].1(cell).map(|n| n as f64),
        }
    }

    /// Whether `cell` must have it. A counter is lacking where the algorithm does not count it, and
    /// nothing is certain of outside programs.
    pub fn is_due(self, cell: &Cell) -> bool {
        // The other figures of memory follow from counters.
        let is_measured = matches!(
            self.name(),
            "instructions" | "heap_peak_bytes" | "rss_peak_bytes"
        );
        is_measured && !cell.algorithm.starts_with("ext:")
    }

    /// Whether more of it is worse and less is better. Of counters that is not so: another count
    /// means that the algorithm does something else.
    pub const fn is_cost(self) -> bool {
        matches!(self, Self::Instructions | Self::Memory(_))
    }
}
