//! Relations between the window counts of the papers' algorithms, on the papers' horse model.
//!
//! Each relation is a ratio of two counts, with the paper's value and a band around ours. Counts
//! follow the papers: a propagation is a child that was tried. Bands are asserted where the
//! relation holds; `results/paper-relations.md` lists all relations, with counts and reasons.
//! Counts do not depend on the machine, so a value outside its band means that an algorithm has
//! changed.

use std::collections::BTreeMap;
use std::io::Write;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::{env, io};

use geobench_mesh::{Mesh, VertexId, io as mesh_io};
use geobench_registry as registry;
use geobench_window::{Counter, Counters};

/// A ratio of two sums of counts.
struct Relation {
    what: &'static str,
    count: Count,
    of: Count,
    /// The paper's value.
    paper: f64,
    band: RangeInclusive<f64>,
}

/// A sum of counters of an algorithm.
#[derive(Clone, Copy)]
struct Count(&'static str, &'static [Counter]);

use Counter::{Children, Iterations, Kept, Parents, PeakWavefront, PeakWindows, Prime, Propagated};
use Counter::{Reinserted, Secondary, Spawned, StoredWindows};

const fn propagated(algorithm: &'static str) -> Count {
    Count(algorithm, &[Propagated])
}

const RELATIONS: &[Relation] = &[
    Relation {
        what: "VTP propagates fewer windows than MMP (Qin et al. 2016, Table 2: 20 % fewer)",
        count: propagated("vtp"),
        of: propagated("mmp"),
        paper: 0.80,
        band: 0.60..=0.80,
    },
    Relation {
        what: "VTP propagates fewer than half of ICH's windows (Table 2: 56 % fewer)",
        count: propagated("vtp"),
        of: propagated("ich"),
        paper: 0.44,
        band: 0.34..=0.50,
    },
    Relation {
        what: "FWP-CH and ICH propagate alike (report of February 2016, Table 5.2)",
        count: propagated("fwp-ch"),
        of: propagated("ich"),
        paper: 7_963_743.0 / 7_944_632.0,
        band: 0.95..=1.05,
    },
    Relation {
        what: "FWP-MMP and MMP propagate alike (report of February 2016, Table 5.2)",
        count: propagated("fwp-mmp"),
        of: propagated("mmp"),
        paper: 4_384_441.0 / 4_404_114.0,
        band: 0.95..=1.05,
    },
    Relation {
        what: "MMP propagates little more with whole lists at a time (ours, of no paper)",
        count: propagated("mmp{turn=list}"),
        of: propagated("mmp"),
        paper: 1.0,
        band: 1.0005..=1.01,
    },
    Relation {
        what: "the vertex filter saves MMP a twelfth of its propagations (ours, of no paper)",
        count: propagated("mmp{turn=list,filter=vertices}"),
        of: propagated("mmp{turn=list}"),
        paper: 1.0,
        band: 0.90..=0.95,
    },
    Relation {
        what: "FWP-MMP propagates as many with whole lists at a time (ours, of no paper)",
        count: propagated("fwp-mmp{turn=list}"),
        of: propagated("fwp-mmp"),
        paper: 1.0,
        band: 0.95..=1.01,
    },
    Relation {
        what: "VTP-MMP saves no propagations (Qin et al. 2016, section 6.2)",
        count: propagated("vtp-mmp"),
        of: propagated("mmp"),
        paper: 1.0,
        band: 0.95..=1.05,
    },
    Relation {
        what: "VTP-CH saves no propagations (section 6.2)",
        count: propagated("vtp-ch"),
        of: propagated("ich"),
        paper: 1.0,
        band: 0.95..=1.05,
    },
    Relation {
        what: "some 96 % of VTP's propagations are prime (section 6.2)",
        count: Count("vtp", &[Prime]),
        of: Count("vtp", &[Prime, Secondary]),
        paper: 0.9625,
        band: 0.95..=0.995,
    },
    Relation {
        what: "MMP takes fewer windows than ICH (Xu et al. 2015, Table 1)",
        count: Count("mmp", &[Parents]),
        of: Count("ich", &[Parents]),
        paper: 0.714,
        band: 0.68..=0.78,
    },
    Relation {
        what: "FWP-MMP and FWP-CH take the same number of rounds (Xu et al. 2015, Table 1)",
        count: Count("fwp-mmp", &[Iterations]),
        of: Count("fwp-ch", &[Iterations]),
        paper: 775.0 / 772.0,
        band: 0.95..=1.11,
    },
    Relation {
        what: "about half of ICH's propagations leave a valid window (report, Table 5.2)",
        count: Count("ich", &[Kept]),
        of: propagated("ich"),
        paper: 4_151_326.0 / 7_944_632.0,
        band: 0.48..=0.56,
    },
    Relation {
        what: "nearly all of VTP's propagations leave a valid window (report, Table 5.2)",
        count: Count("vtp", &[Kept]),
        of: propagated("vtp"),
        paper: 3_283_055.0 / 3_304_586.0,
        band: 0.93..=1.0,
    },
    Relation {
        what: "MMP's valid windows, those queued again included, are close to its propagations (report)",
        count: Count("mmp", &[Kept, Reinserted]),
        of: propagated("mmp"),
        paper: 4_841_219.0 / 4_404_114.0,
        band: 0.85..=1.15,
    },
    Relation {
        what: "VTP propagates little more than MMP keeps in the end (report, Table 5.2)",
        count: propagated("vtp"),
        of: Count("mmp", &[StoredWindows]),
        paper: 3_304_586.0 / 2_893_843.0,
        band: 0.95..=1.15,
    },
    Relation {
        what: "VTP's wavefront is smaller than ICH's (Qin et al. 2016, Table 2: 17 % less memory)",
        count: Count("vtp", &[PeakWindows]),
        of: Count("ich", &[PeakWindows]),
        paper: 0.83,
        band: 0.65..=0.85,
    },
    Relation {
        what: "MMP's wavefront is smaller than ICH's (report, Table 5.2)",
        count: Count("mmp", &[PeakWavefront]),
        of: Count("ich", &[PeakWavefront]),
        paper: 0.735,
        band: 0.68..=0.79,
    },
    Relation {
        what: "ICH1 makes several times as many windows as ICH (Xin, Wang 2009, Table I)",
        count: Count("ich1", &[Children, Spawned]),
        of: Count("ich", &[Children, Spawned]),
        paper: 19_528_130.0 / 4_526_478.0,
        band: 2.5..=5.0,
    },
    Relation {
        what: "rule 1 saves half of the propagations (Qin et al. 2016, section 6.2)",
        count: propagated("vtp"),
        of: propagated("vtp-no-rule1"),
        paper: 0.5,
        band: 0.45..=0.55,
    },
    Relation {
        what: "rules 2 and 3 save a third of the propagations (section 6.2: 30 %)",
        count: propagated("vtp"),
        of: propagated("vtp-no-rules23"),
        paper: 0.7,
        band: 0.58..=0.72,
    },
];

/// Reports on standard error what is not tested. Bypasses the capture of test output, which would
/// hide it.
fn say(what: &str) {
    let _ = writeln!(io::stderr(), "SKIPPED: {what}");
}

fn horse() -> Option<Mesh> {
    let shared = env::var_os("GEOBENCH_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let path = shared.join("models/horse.obj");
    if !path.exists() {
        say(&format!(
            "{} is missing; set GEOBENCH_SHARED to the folder with models/",
            path.display()
        ));
        return None;
    }
    let soup = mesh_io::read(&path).unwrap();
    Some(Mesh::from_soup(soup).unwrap().0)
}

fn count(name: &str, mesh: &Mesh) -> Counters {
    let mut solver = registry::select_one(name).unwrap().build(mesh);
    let (_, counters) = solver.count(&[VertexId::new(0)]).unwrap();
    counters
}

#[test]
fn relations_of_the_papers_hold_on_the_horse() {
    let Some(mesh) = horse() else { return };
    let mut counts = BTreeMap::new();
    let mut left = Vec::new();
    for relation in RELATIONS {
        let sides = [relation.count, relation.of];
        let missing = sides.iter().find(|side| registry::select(side.0).is_err());
        if let Some(Count(name, _)) = missing {
            say(&format!("there is no {name} yet: {}", relation.what));
            continue;
        }
        let [count, of] = sides.map(|Count(name, counters)| {
            let counts = counts
                .entry(name)
                .or_insert_with(|| self::count(name, &mesh));
            let values = counters.iter().map(|&counter| {
                let value = counts.get(counter);
                value.unwrap_or_else(|| panic!("{name} does not count {}", counter.key()))
            });
            values.sum::<u64>()
        });
        let ratio = count as f64 / of as f64;
        if !relation.band.contains(&ratio) {
            left.push(format!(
                "{}: {count} / {of} = {ratio:.3}, not within {:?} (paper {:.3})",
                relation.what, relation.band, relation.paper
            ));
        }
    }
    assert!(left.is_empty(), "{}", left.join("\n"));
}
