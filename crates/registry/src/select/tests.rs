use geobench_mesh::{Mesh, TriangleSoup, VertexId};
use geobench_window::Counter;

use super::*;
use crate::Numbers;

/// The names that scripts may rely on.
const PROMISED: &str = "ch ich1 ich mmp mmp-edge fwp-mmp fwp-ch lc-mmp lc-ch ftp opftp vtp opvtp \
    vtp-exhaustive vtp-trimming vtp-mmp vtp-ch edge-based vtp-no-rule1 vtp-no-rules23 vtp-fast \
    mmp-fast pvtp window-vtp lct11 xls14 dijkstra fmm fmm-untidy vsp heat svg avtp \
    mmp-approx pch ich-fast";

fn names(list: &str) -> Vec<String> {
    let selected = select(list).unwrap();
    selected.iter().map(|s| s.label().to_owned()).collect()
}

#[test]
fn names_are_unique_and_promised() {
    for (i, algorithm) in algorithms().iter().enumerate() {
        let name = algorithm.name;
        assert!(
            PROMISED.split_whitespace().any(|promised| promised == name),
            "`{name}` is not one of the promised names"
        );
        assert!(
            algorithms()[..i].iter().all(|a| a.name != name),
            "`{name}` stands twice in the table"
        );
        assert_eq!(name, name.to_lowercase());
        assert!(algorithms().iter().all(|a| a.name != algorithm.family));
        for fact in [
            algorithm.paper,
            algorithm.summary,
            algorithm.complexity,
            algorithm.keeps,
            algorithm.choose,
            algorithm.departs,
        ] {
            assert!(!fact.is_empty(), "`{name}` lacks a fact");
        }
    }
}

/// All words and bounds of a parameter, in the notation of users.
fn extremes(parameter: &Parameter) -> Vec<String> {
    let words = parameter.allowed.words.iter().map(|w| (*w).to_owned());
    let numbers = match parameter.allowed.numbers {
        Numbers::None => vec![],
        Numbers::Integers(least, most) => vec![least.to_string(), most.to_string()],
        Numbers::Reals(least, most) => vec![least.to_string(), most.to_string()],
    };
    words.chain(numbers).collect()
}

#[test]
fn every_algorithm_solves_with_every_extreme_of_its_parameters() {
    let positions = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let (mesh, _) = Mesh::from_soup(TriangleSoup::new(positions, vec![[0, 1, 2]])).unwrap();
    let check = |item: &str| {
        let selection = select_one(item).unwrap();
        let solution = selection.build(&mesh).solve(&[VertexId::new(1)]).unwrap();
        let found = solution.distances;
        if selection.is_approximate() {
            assert!(
                found[1] == 0.0 && found.iter().all(|d| d.is_finite()),
                "{item}"
            );
        } else {
            assert_eq!(found, [3.0, 0.0, 5.0], "{item}");
        }
    };
    for algorithm in algorithms() {
        check(algorithm.name);
        for (i, parameter) in algorithm.parameters.iter().enumerate() {
            let name = parameter.name;
            assert_eq!(name, name.to_lowercase());
            assert!(algorithm.parameters[..i].iter().all(|p| p.name != name));
            assert!(!parameter.meaning.is_empty());
            let default = parameter.default.to_string();
            assert_eq!(parameter.parse(&default), Some(parameter.default), "{name}");
            for value in extremes(parameter) {
                let needed = parameter
                    .only_with
                    .map(|(other, words)| format!("{other}={},", words[0]));
                let needed = needed.unwrap_or_default();
                check(&format!("{}{{{needed}{name}={value}}}", algorithm.name));
            }
        }
    }
}

#[test]
fn names_families_and_groups_in_any_case() {
    assert_eq!(names("vtp,mmp"), ["vtp", "mmp"]);
    assert_eq!(names(" VTP , Ich "), ["vtp", "ich"]);
    assert!(names("vtp-family").contains(&"vtp".to_owned()));
    assert!(!names("vtp-family").contains(&"mmp".to_owned()));
    assert_eq!(names("all").len(), algorithms().len());
    assert!(names("approximate").contains(&"dijkstra".to_owned()));
    assert!(!names("exact").contains(&"dijkstra".to_owned()));
    assert!(names("approximate").contains(&"svg".to_owned()));
    assert!(!names("exact").contains(&"svg".to_owned()));
    assert!(!names("exact").contains(&"test-wrong".to_owned()));
    assert_eq!(names("ich,all").len(), algorithms().len());
    assert_eq!(names("ich,all")[0], "ich");
    assert_eq!(names("mmp,MMP,mmp{}"), ["mmp"]);
    assert_eq!(
        names("mmp{turn=window,queue=heap},fwp-mmp{lists=keep},lc-mmp{turn=window}"),
        ["mmp", "fwp-mmp", "lc-mmp"]
    );
    assert_eq!(
        select_one("mmp,vtp").unwrap_err().to_string(),
        "`mmp,vtp` asks for 2 algorithms; name one algorithm"
    );
}

#[test]
fn the_queue_has_the_word_of_earlier_versions() {
    assert_eq!(names("mmp{queue=priority}"), ["mmp{queue=calendar}"]);
    assert_eq!(names("ich{queue=Priority}"), ["ich{queue=calendar}"]);
    assert!(select("mmp-fast{queue=priority}").is_err());
}

#[test]
fn in_a_table_auto_is_scalar_except_for_fast_forms() {
    let widest = Instructions::detect();
    for algorithm in algorithms() {
        let one = || select_one(algorithm.name).unwrap();
        assert_eq!(one().with_simd(SimdChoice::Auto).instructions(), widest);
        let in_table = one().with_simd_in_table(SimdChoice::Auto).instructions();
        let is_fast = algorithm.name == "pvtp" || algorithm.name.ends_with("-fast");
        assert_eq!(algorithm.fast, is_fast);
        assert_eq!(
            in_table,
            if is_fast {
                widest
            } else {
                Instructions::Scalar
            }
        );
        let asked = SimdChoice::AtMost(Instructions::Avx2);
        let both = [one().with_simd(asked), one().with_simd_in_table(asked)];
        assert_eq!(both[0].instructions(), both[1].instructions());
    }
}

#[test]
fn an_unknown_name_brings_the_nearest_one() {
    let message = select("vtq").unwrap_err().to_string();
    assert!(message.starts_with("there is no algorithm `vtq` (did you mean `vtp`?)"));
    assert!(message.contains("known are mmp, "));
    let message = select("a-b-c-d").unwrap_err().to_string();
    assert!(message.starts_with("there is no algorithm `a-b-c-d`; known are"));
}

#[test]
fn lists_that_are_not_understood() {
    for item in [
        "mmp{",
        "mmp}",
        "mmp{x}",
        "mmp{=1}",
        "mmp{a=}",
        "mmp{a=1}x",
        "mmp=1",
    ] {
        assert_eq!(
            select(item).unwrap_err().to_string(),
            format!("`{item}` is not understood: parameters are written `name{{key=value,...}}`")
        );
    }
    for list in ["", ",", "mmp,", "mmp,,vtp", "{a=1}"] {
        assert_eq!(
            select(list).unwrap_err().to_string(),
            format!("an algorithm name is missing in `{list}`; give names separated by commas")
        );
    }
}

const NO_ONE: Algorithm = Algorithm {
    name: "no-one",
    parameters: &[
        Parameter::integer("kmax", 20_000, 1..=1_000_000, ""),
        Parameter::real("bucket", 1.0, 0.01..=100.0, "").only_with("order", &["fifo"]),
        Parameter::word("order", &["fifo", "nearest"], ""),
    ],
    ..Algorithm::EXACT
};

/// The label of `no-one` with these settings, or the error.
fn set(item: &str) -> Result<String, String> {
    let (_, settings) = split_parameters(item).unwrap();
    let selection = with_settings(&NO_ONE, &settings).map_err(|e| e.to_string())?;
    Ok(selection.label().to_owned())
}

#[test]
fn a_label_is_the_same_however_values_are_written() {
    assert_eq!(
        set("no-one{Order=NEAREST}").unwrap(),
        "no-one{order=nearest}"
    );
    assert_eq!(set("no-one").unwrap(), "no-one");
    assert_eq!(set("no-one{kmax=20000,bucket=1.0}").unwrap(), "no-one");
    assert_eq!(
        set("no-one{ORDER=Fifo, bucket = 2.50 ,kmax=05000}").unwrap(),
        "no-one{kmax=5000,bucket=2.5}"
    );
}

#[test]
fn wrong_parameters_are_refused_with_the_valid_ones() {
    for (item, message) in [
        (
            "no-one{kmx=1}",
            "algorithm `no-one` has no parameter `kmx` (did you mean `kmax`?); it has kmax, bucket, order",
        ),
        (
            "no-one{kmax=0}",
            "algorithm `no-one`: `0` is not a value of `kmax`, which is a whole number from 1 to 1000000",
        ),
        (
            "no-one{bucket=wide}",
            "algorithm `no-one`: `wide` is not a value of `bucket`, which is a number from 0.01 to 100",
        ),
        (
            "no-one{order=last}",
            "algorithm `no-one`: `last` is not a value of `order`, which is `fifo` or `nearest`",
        ),
        (
            "no-one{kmax=1,KMAX=2}",
            "algorithm `no-one`: parameter `kmax` is given twice",
        ),
        (
            "no-one{bucket=2,order=nearest}",
            "algorithm `no-one`: `bucket` does nothing without `order=fifo`; leave it out",
        ),
    ] {
        assert_eq!(set(item).unwrap_err(), message);
    }
    // Otherwise two rows of different names would show the same algorithm.
    assert!(select("mmp{turn=window,slack=2}").is_err());
    assert!(select("mmp{slack=2,turn=list}").is_ok());
    // If an item selects several algorithms, all must have the parameter.
    assert_eq!(
        select("mmp{k=5},vtp").unwrap_err().to_string(),
        "algorithm `mmp` has no parameter `k`; it has turn, queue, slack, filter, lists, threshold"
    );
    assert!(select("all{k=5}").is_err());
    for name in ["mmp", "fwp-mmp", "lc-mmp", "vtp-mmp"] {
        assert!(select(&format!("{name}{{filter=vertices}}")).is_err());
        assert!(select(&format!("{name}{{turn=list,filter=vertices}}")).is_ok());
    }
    assert!(select("mmp{turn=list,queue=fifo}").is_err());
    assert!(select("mmp{queue=fifo,lists=evict}").is_err());
    assert!(select("mmp{turn=list,lists=evict}").is_ok());
}

/// Vector code executes the same steps as scalar code.
#[test]
fn answers_and_counts_do_not_depend_on_the_instructions() {
    for spec in [
        "gen:torus,faces=600,bump=0.2,seed=1",
        "gen:anisotropic,faces=1000,g=4",
        "gen:cube,n=4",
    ] {
        let soup = geobench_mesh::generate::generate(&spec.parse().unwrap()).unwrap();
        let (mesh, _) = Mesh::from_soup(soup).unwrap();
        for algorithm in algorithms() {
            let run = |widest| {
                let selection = select_one(algorithm.name).unwrap().at_most(widest);
                let (solution, mut counters) =
                    selection.build(&mesh).count(&[VertexId::new(7)]).unwrap();
                if algorithm.name == "vtp-trimming" {
                    // The borders of registers depend on their width.
                    counters.set(Counter::PairChecks, 0);
                }
                let bits: Vec<u64> = solution.distances.iter().map(|d| d.to_bits()).collect();
                (bits, counters)
            };
            let scalar = run(Instructions::Scalar);
            for wider in [Instructions::Avx2, Instructions::Avx512] {
                assert!(run(wider) == scalar, "{}, {wider}, {spec}", algorithm.name);
            }
        }
    }
}

#[test]
fn algorithms_of_a_set_are_optional_unless_they_are_named_too() {
    let optional = |list: &str| -> Vec<String> {
        let selected = select(list).unwrap().into_iter();
        let optional = selected.filter(Selection::is_optional);
        optional.map(|one| one.label().to_owned()).collect()
    };
    assert_eq!(optional("mmp,ext:a,VTP").len(), 0);
    assert_eq!(optional("lc-family"), ["lc-mmp", "lc-ch"]);
    assert_eq!(optional("lc-ch,lc-family"), ["lc-mmp"]);
    assert_eq!(optional("lc-family,lc-ch"), ["lc-mmp"]);
    // Other parameters are another selection.
    assert_eq!(optional("lc-family,lc-ch{threshold=1e-9}").len(), 2);
    assert_eq!(optional("all").len(), algorithms().len());
}
