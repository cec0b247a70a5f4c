//! Tests of every output format, on mock results.

use geobench_export::FileFormat;
use geobench_harness::exec::mock::{MockBackend, crash_ich, spoil_vtp};
use geobench_harness::run::mock::{plan, result, run_mock};
use geobench_harness::schema::{GroupRecord, ResultFile};

use crate::table::{Look, ResultFormat};

/// A result with three models: a good one, one named `spoilt` with a wrong answer, and a refused
/// one.
pub(crate) fn mixed_with(spoilt: &str) -> ResultFile {
    let mut good = run_mock(
        &plan(&["horse"], "mmp,ich,vtp", "0"),
        &MockBackend::default(),
    );
    let backend = MockBackend {
        alter: Some(spoil_vtp),
        refuse: vec!["broken_mesh"],
        ..MockBackend::default()
    };
    let bad = plan(&[spoilt, "broken_mesh"], "mmp,ich,vtp", "3");
    let bad = run_mock(&bad, &backend);
    good.models.extend(bad.models);
    good.cells.extend(bad.cells);
    result(good)
}

fn mixed() -> ResultFile {
    mixed_with("cow|2")
}

#[test]
fn table() {
    insta::assert_snapshot!(ResultFormat::Table.render(&mixed()).unwrap(), @r#"
    horse  (V: 4, F: 96,966)  source 0
    ┌─────────────────────────────────┬─────────────┬────────┬────────┐
    │                                 ┆         mmp ┆    ich ┆    vtp │
    ╞═════════════════════════════════╪═════════════╪════════╪════════╡
    │ Time (s)                        ┆      1.216  ┆ 1.216  ┆ 0.342* │
    │ Window propagations             ┆  3,000,009  ┆     9* ┆     9* │
    │ Peak memory, papers' count (MB) ┆     80.000  ┆ 0.001* ┆ 0.001* │
    │ Peak memory, measured (MB)      ┆ 100000.300  ┆ 0.300* ┆ 0.300* │
    └─────────────────────────────────┴─────────────┴────────┴────────┘
      checked against mmp: largest relative difference 0
      times: 95 % intervals within 2.4 % of the medians
      instructions: scalar
      unreachable vertices: 1

    cow|2  (V: 4, F: 96,966)  source 3
    ┌─────────────────────────────────┬─────────────┬────────┬────────┐
    │                                 ┆         mmp ┆    ich ┆    vtp │
    ╞═════════════════════════════════╪═════════════╪════════╪════════╡
    │ Time (s)                        ┆        1.21 ┆   1.21 ┆  wrong │
    │ Window propagations             ┆  3,000,009  ┆     9* ┆ wrong  │
    │ Peak memory, papers' count (MB) ┆     80.000  ┆ 0.001* ┆ wrong  │
    │ Peak memory, measured (MB)      ┆ 100000.300  ┆ 0.300* ┆ wrong  │
    └─────────────────────────────────┴─────────────┴────────┴────────┘
      checked against mmp: largest relative difference 0
      times: 95 % intervals within 0.4 % of the medians
      instructions: scalar
      unreachable vertices: 1
      vtp, source 3: wrong: differs from mmp: vertex 2 is at 1.75 instead of 1.5 (difference 2.500e-1, relative 1.429e-1); 1 of 4 vertices differ by more than 1e-9 relative and rounding; 3 algorithms: 2 with the reference's answer, 1 with this one

    broken_mesh  (refused)
      refused: broken_mesh.obj: edge 3-7 has 3 faces

    Time, and in brackets its ratio to that of the fastest exact algorithm of the row.

    ┌─────────────────────────────────────────┬────────────────┬────────────────┬────────────────┐
    │ Model                                   ┆            mmp ┆            ich ┆            vtp │
    ╞═════════════════════════════════════════╪════════════════╪════════════════╪════════════════╡
    │ horse                                   ┆ 1.22 s (3.55)  ┆ 1.22 s (3.55)  ┆ 342 ms (1.00)* │
    │ cow|2                                   ┆ 1.21 s (1.00)* ┆ 1.21 s (1.00)* ┆         wrong  │
    │ broken_mesh                             ┆        refused ┆        refused ┆        refused │
    │ geometric mean of the 1 that all solved ┆          3.55  ┆          3.55  ┆          1.00* │
    └─────────────────────────────────────────┴────────────────┴────────────────┴────────────────┘

    time: median of 6 runs; papers' count: 80 bytes per window; measured: heap of the algorithm without the mesh; MB = 10^6 bytes; * best
    "#);
}

#[test]
fn markdown() {
    insta::assert_snapshot!(ResultFormat::Markdown.render(&mixed()).unwrap(), @r#"
    | Model | | mmp | ich | vtp |
    |---|---|--:|--:|--:|
    | horse (V: 4, F: 96,966) | Time (s) | 1.216 | 1.216 | **0.342** |
    | | Window propagations | 3,000,009 | **9** | **9** |
    | | Peak memory, papers' count (MB) | 80.000 | **0.001** | **0.001** |
    | | Peak memory, measured (MB) | 100000.300 | **0.300** | **0.300** |
    | cow\|2 (V: 4, F: 96,966) | Time (s) | 1.21 | 1.21 | wrong |
    | | Window propagations | 3,000,009 | **9** | wrong |
    | | Peak memory, papers' count (MB) | 80.000 | **0.001** | wrong |
    | | Peak memory, measured (MB) | 100000.300 | **0.300** | wrong |
    | broken_mesh (refused) | | refused | refused | refused |

    - horse: source 0; checked against mmp: largest relative difference 0; times: 95 % intervals within 2.4 % of the medians; instructions: scalar; unreachable vertices: 1
    - cow\|2: source 3; checked against mmp: largest relative difference 0; times: 95 % intervals within 0.4 % of the medians; instructions: scalar; unreachable vertices: 1; vtp, source 3: wrong: differs from mmp: vertex 2 is at 1.75 instead of 1.5 (difference 2.500e-1, relative 1.429e-1); 1 of 4 vertices differ by more than 1e-9 relative and rounding; 3 algorithms: 2 with the reference's answer, 1 with this one
    - broken_mesh: source 3; refused: broken_mesh.obj: edge 3-7 has 3 faces

    Time, and in brackets its ratio to that of the fastest exact algorithm of the row.

    | Model | mmp | ich | vtp |
    |---|--:|--:|--:|
    | horse | 1.22 s (3.55) | 1.22 s (3.55) | **342 ms (1.00)** |
    | cow\|2 | **1.21 s (1.00)** | **1.21 s (1.00)** | wrong |
    | broken_mesh | refused | refused | refused |
    | geometric mean of the 1 that all solved | 3.55 | 3.55 | **1.00** |
    "#);
}

#[test]
fn latex() {
    insta::assert_snapshot!(ResultFormat::Latex.render(&mixed()).unwrap(), @r#"
    % Needs \usepackage{booktabs}.
    \begin{tabular}{llrrr}
    \toprule
    Model &  & mmp & ich & vtp \\
    \midrule
    % horse: source 0
    % horse: checked against mmp: largest relative difference 0
    % horse: times: 95 % intervals within 2.4 % of the medians
    % horse: instructions: scalar
    % horse: unreachable vertices: 1
    horse & Time (s) & 1.216 & 1.216 & \textbf{0.342} \\
    (V: 4, F: 96,966) & Window propagations & 3,000,009 & \textbf{9} & \textbf{9} \\
     & Peak memory, papers' count (MB) & 80.000 & \textbf{0.001} & \textbf{0.001} \\
     & Peak memory, measured (MB) & 100000.300 & \textbf{0.300} & \textbf{0.300} \\
    \midrule
    % cow|2: source 3
    % cow|2: checked against mmp: largest relative difference 0
    % cow|2: times: 95 % intervals within 0.4 % of the medians
    % cow|2: instructions: scalar
    % cow|2: unreachable vertices: 1
    % cow|2: vtp, source 3: wrong: differs from mmp: vertex 2 is at 1.75 instead of 1.5 (difference 2.500e-1, relative 1.429e-1); 1 of 4 vertices differ by more than 1e-9 relative and rounding; 3 algorithms: 2 with the reference's answer, 1 with this one
    cow|2 & Time (s) & 1.21 & 1.21 & \emph{wrong} \\
    (V: 4, F: 96,966) & Window propagations & 3,000,009 & \textbf{9} & \emph{wrong} \\
     & Peak memory, papers' count (MB) & 80.000 & \textbf{0.001} & \emph{wrong} \\
     & Peak memory, measured (MB) & 100000.300 & \textbf{0.300} & \emph{wrong} \\
    \midrule
    % broken_mesh: source 3
    % broken_mesh: refused: broken_mesh.obj: edge 3-7 has 3 faces
    broken\_mesh (refused) &  & \emph{refused} & \emph{refused} & \emph{refused} \\
    \bottomrule
    \end{tabular}

    % Time, and in brackets its ratio to that of the fastest exact algorithm of the row.
    \begin{tabular}{lrrr}
    \toprule
    Model & mmp & ich & vtp \\
    \midrule
    horse & 1.22 s (3.55) & 1.22 s (3.55) & \textbf{342 ms (1.00)} \\
    cow|2 & \textbf{1.21 s (1.00)} & \textbf{1.21 s (1.00)} & \emph{wrong} \\
    broken\_mesh & \emph{refused} & \emph{refused} & \emph{refused} \\
    \midrule
    geometric mean of the 1 that all solved & 3.55 & 3.55 & \textbf{1.00} \\
    \bottomrule
    \end{tabular}
    "#);
}

#[test]
fn csv() {
    insta::assert_snapshot!(ResultFormat::Csv.render(&mixed()).unwrap(), @r#"
    model,algorithm,source,goal,threads,approximate,status,message,time_samples,time_median,time_min,time_mad,time_ci95,time_note,time_setup,time_extraction,time_outliers,time_places,time_solves,time_precision,time_outside,time_claimed,time_ping,time_doubted,time_unconfirmed,counters_propagated,counters_parents,counters_children,counters_kept,counters_spawned,counters_reinserted,counters_trimmed,counters_filtered,counters_peak_windows,counters_peak_wavefront,counters_stored_windows,counters_window_bytes,counters_queue_pushes,counters_queue_peak,counters_iterations,counters_k_peak,counters_levels,counters_pseudo_sources,counters_prime,counters_secondary,counters_secondary_near,counters_compared_windows,counters_pair_checks,counters_rule_1,counters_case_1,counters_case_2,counters_case_3,counters_case_4,counters_case_5,counters_case_6,counters_graph_bytes,counters_negative,counters_wavefront_deviation,memory_papers_bytes,memory_windows_peak_bytes,memory_heap_peak_bytes,memory_rss_peak_bytes,phases_propagation,phases_pruning,phases_management,phases_samples,check_reference,check_max_abs,check_max_rel,check_unreachable,check_compared,check_worst_vertex,check_mean_rel,check_rms_rel,check_edge_excess,check_doubt,check_cluster,check_wrong_labels,check_least_tolerance,check_proven,check_proof,check_replaced,group,instructions,instructions_simd,shard,simd,vertices,faces,edges,machine
    horse,mmp,0,,1,false,ok,,1.209859375;1.2118125;1.2147421875;1.2166953125;1.219625;1.2245078125,1.21571875,1.209859375,0.00390625,1.2105569196428572;1.2227639508928572,,0.125,,0,2;1;1;0;0;2,,,,,,false,false,3000009,,,,,,,,10,,1000003,64,,,,,,,,,,,,,,,,,,,,,,80000240,640,100000300000,1073741824,0.6946964285714285,0.3473482142857143,0.17367410714285714,1000,mmp,0,0,1,4,,0,0,,,0,,0,,,,,,,,scalar,4,96966,5,"unknown processor, 2 cores, some system"
    horse,ich,0,,1,false,ok,,1.2088828125;1.2127890625;1.213765625;1.217671875;1.221578125;1.2225546875,1.21571875,1.2088828125,0.00439453125,1.2102779017857141;1.2222059151785714,,0.125,,0,1;2;0;1;2;0,,,,,,false,false,9,,,,,,,,10,,3,64,,,,,,,,,,,,,,,,,,,,,,800,640,300000,1073741824,0.6946964285714285,0.3473482142857143,0.17367410714285714,1000,mmp,0,0,1,4,,0,0,,,0,,0,,,,,,,,scalar,4,96966,5,"unknown processor, 2 cores, some system"
    horse,vtp,0,,1,false,ok,,0.33290625;0.3358359375;0.34071875;0.3436484375;0.3456015625;0.34853125,0.34218359375,0.33290625,0.0048828125,0.3339525669642857;0.3474849330357143,,0.125,,0,0;0;2;2;1;1,,,,,,false,false,9,,,,,,,,10,,3,64,,,,,,,,,,,,,,,,,,,,,,800,640,300000,1073741824,0.19553348214285715,0.09776674107142858,0.04888337053571429,1000,mmp,0,0,1,4,,0,0,,,0,,0,,,,,,,,scalar,4,96966,5,"unknown processor, 2 cores, some system"
    cow|2,mmp,3,,1,false,ok,,1.2088828125;1.2118125;1.213765625;1.2147421875;1.2166953125;1.219625,1.21425390625,1.2088828125,0.00244140625,1.2099291294642858;1.2185786830357141,,0.125,,0,1;1;2;0;0;2,,,,,,false,false,3000009,,,,,,,,10,,1000003,64,,,,,,,,,,,,,,,,,,,,,,80000240,640,100000300000,1073741824,0.693859375,0.3469296875,0.17346484375,1000,mmp,0,0,1,4,,0,0,,,0,,0,,nothing is proven: the model has 96966 faces; up to 50000 are proven unasked,,,,,,scalar,4,96966,5,"unknown processor, 2 cores, some system"
    cow|2,ich,3,,1,false,ok,,1.209859375;1.2108359375;1.2127890625;1.21571875;1.217671875;1.2186484375,1.21425390625,1.209859375,0.00341796875,1.2102081473214286;1.2182996651785714,,0.125,,0,2;0;0;2;1;1,,,,,,false,false,9,,,,,,,,10,,3,64,,,,,,,,,,,,,,,,,,,,,,800,640,300000,1073741824,0.693859375,0.3469296875,0.17346484375,1000,mmp,0,0,1,4,,0,0,,,0,,0,,nothing is proven: the model has 96966 faces; up to 50000 are proven unasked,,,,,,scalar,4,96966,5,"unknown processor, 2 cores, some system"
    cow|2,vtp,3,,1,false,wrong,"differs from mmp: vertex 2 is at 1.75 instead of 1.5 (difference 2.500e-1, relative 1.429e-1); 1 of 4 vertices differ by more than 1e-9 relative and rounding; 3 algorithms: 2 with the reference's answer, 1 with this one",,,,,,,,,,,,,,,,false,false,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,mmp,0.25,0.14285714285714285,1,4,2,0.08333333333333333,0.11785113019775792,,,1,,0.16666666666656668,,nothing is proven: the model has 96966 faces; up to 50000 are proven unasked,,,,,,scalar,4,96966,5,"unknown processor, 2 cores, some system"
    broken_mesh,mmp,3,,1,false,refused,broken_mesh.obj: edge 3-7 has 3 faces,,,,,,,,,,,,,,,,false,false,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,scalar,,,,"unknown processor, 2 cores, some system"
    broken_mesh,ich,3,,1,false,refused,broken_mesh.obj: edge 3-7 has 3 faces,,,,,,,,,,,,,,,,false,false,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,scalar,,,,"unknown processor, 2 cores, some system"
    broken_mesh,vtp,3,,1,false,refused,broken_mesh.obj: edge 3-7 has 3 faces,,,,,,,,,,,,,,,,false,false,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,scalar,,,,"unknown processor, 2 cores, some system"
    "#);
}

#[test]
#[allow(clippy::too_many_lines)] // A whole file is shown.
fn json() {
    let records = run_mock(&plan(&["horse"], "vtp", "0"), &MockBackend::default());
    insta::assert_snapshot!(ResultFormat::Json.render(&result(records)).unwrap(), @r#"
    {
      "schema": "geobench/1",
      "tool": {
        "version": "1.2.3",
        "commit": null,
        "rustc": "rustc 1.89.0",
        "rustflags": "-C opt-level=3",
        "profile": "release",
        "features": []
      },
      "host": {
        "cpu": null,
        "cores": 2,
        "memory_bytes": 17179869184,
        "os": "some system",
        "kernel": null,
        "load_start": 0.5,
        "simd": "avx2"
      },
      "command": [
        "geobench",
        "run"
      ],
      "started": "2025-01-01T00:00:00Z",
      "finished": "2025-01-01T00:00:01Z",
      "isolation": null,
      "groups": [],
      "models": [
        {
          "name": "horse",
          "path": "horse.obj",
          "sha256": "00ff",
          "vertices": 4,
          "faces": 96966,
          "edges": 5,
          "boundary_edges": 4,
          "components": 1,
          "genus": 0,
          "saddles": 0,
          "anisotropy": 1.25,
          "longest_edge": 2.0,
          "load_seconds": 0.5,
          "build_seconds": 0.25
        }
      ],
      "cells": [
        {
          "model": "horse",
          "algorithm": "vtp",
          "source": 0,
          "goal": null,
          "threads": 1,
          "simd": "scalar",
          "approximate": false,
          "status": "ok",
          "message": null,
          "time": {
            "samples": [
              0.330953125,
              0.3319296875,
              0.33290625,
              0.3338828125,
              0.334859375,
              0.3358359375
            ],
            "median": 0.33339453125,
            "min": 0.330953125,
            "mad": 0.00146484375,
            "ci95": [
              0.33130189732142856,
              0.33548716517857147
            ],
            "note": null,
            "setup": 0.125,
            "extraction": null,
            "outliers": 0,
            "places": [
              0,
              0,
              0,
              0,
              0,
              0
            ],
            "solves": [],
            "precision": null,
            "outside": [],
            "claimed": [],
            "ping": [],
            "doubted": false,
            "unconfirmed": false
          },
          "counters": {
            "propagated": 9,
            "parents": null,
            "children": null,
            "kept": null,
            "spawned": null,
            "reinserted": null,
            "trimmed": null,
            "filtered": null,
            "peak_windows": 10,
            "peak_wavefront": null,
            "stored_windows": 3,
            "window_bytes": 64,
            "queue_pushes": null,
            "queue_peak": null,
            "iterations": null,
            "k_peak": null,
            "levels": null,
            "pseudo_sources": null,
            "prime": null,
            "secondary": null,
            "secondary_near": null,
            "compared_windows": null,
            "pair_checks": null,
            "rule_1": null,
            "case_1": null,
            "case_2": null,
            "case_3": null,
            "case_4": null,
            "case_5": null,
            "case_6": null,
            "graph_bytes": null,
            "negative": null,
            "wavefront_deviation": null
          },
          "memory": {
            "papers_bytes": 800,
            "windows_peak_bytes": 640,
            "heap_peak_bytes": 300000,
            "rss_peak_bytes": 1073741824
          },
          "phases": {
            "propagation": 0.1905111607142857,
            "pruning": 0.09525558035714285,
            "management": 0.047627790178571425,
            "samples": 1000
          },
          "check": {
            "reference": "vtp",
            "max_abs": 0.0,
            "max_rel": 0.0,
            "unreachable": 1,
            "compared": 4,
            "worst_vertex": null,
            "mean_rel": 0.0,
            "rms_rel": 0.0,
            "edge_excess": null,
            "doubt": null,
            "cluster": 0,
            "wrong_labels": null,
            "least_tolerance": 0.0,
            "proven": null,
            "proof": null,
            "replaced": null
          },
          "group": null,
          "instructions": null,
          "instructions_simd": null,
          "shard": null
        }
      ],
      "pairing": null,
      "conditions": null,
      "plan": null,
      "sessions": []
    }
    "#);
}

#[test]
fn several_sources_are_shown_by_their_median() {
    let records = run_mock(
        &plan(&["horse"], "mmp,vtp", "0,1,2"),
        &MockBackend::default(),
    );
    insta::assert_snapshot!(ResultFormat::Table.render(&result(records)).unwrap(), @r#"
    horse  (V: 4, F: 96,966)  median of 3 sources
    ┌─────────────────────────────────┬─────────────┬────────┐
    │                                 ┆         mmp ┆    vtp │
    ╞═════════════════════════════════╪═════════════╪════════╡
    │ Time (s)                        ┆      1.230  ┆ 0.355* │
    │ Window propagations             ┆  3,000,009  ┆     9* │
    │ Peak memory, papers' count (MB) ┆     80.000  ┆ 0.001* │
    │ Peak memory, measured (MB)      ┆ 100000.300  ┆ 0.300* │
    └─────────────────────────────────┴─────────────┴────────┘
      checked against mmp: largest relative difference 0
      times: 95 % intervals within 1.2 % of the medians
      instructions: scalar
      unreachable vertices: 1

    time: median of 6 runs; papers' count: 80 bytes per window; measured: heap of the algorithm without the mesh; MB = 10^6 bytes; * best
    "#);
}

#[test]
fn the_number_of_checked_vertices_is_shown() {
    let mut file = result(run_mock(
        &plan(&["horse"], "mmp,vtp", "0,1"),
        &MockBackend::default(),
    ));
    assert!(file.cells.iter().all(|c| c.check.compared == Some(4)));
    file.cells.last_mut().unwrap().check.compared = Some(3);
    let shown = ResultFormat::Table.render(&file).unwrap();
    assert!(
        shown.contains("checked against mmp at 3 of 4 vertices: largest relative difference 0\n"),
        "{shown}"
    );
}

#[test]
fn one_failed_source_spoils_the_column() {
    let backend = MockBackend {
        alter: Some(crash_ich),
        ..MockBackend::default()
    };
    let records = run_mock(&plan(&["horse"], "mmp,ich", "0,1"), &backend);
    insta::assert_snapshot!(ResultFormat::Table.render(&result(records)).unwrap(), @r#"
    horse  (V: 4, F: 96,966)  median of 2 sources
    ┌─────────────────────────────────┬───────────┬─────────┐
    │                                 ┆       mmp ┆     ich │
    ╞═════════════════════════════════╪═══════════╪═════════╡
    │ Time (s)                        ┆      1.22 ┆ crashed │
    │ Window propagations             ┆ 3,000,009 ┆ crashed │
    │ Peak memory, papers' count (MB) ┆      80.0 ┆ crashed │
    │ Peak memory, measured (MB)      ┆    100000 ┆ crashed │
    └─────────────────────────────────┴───────────┴─────────┘
      times: 95 % intervals within 0.2 % of the medians
      instructions: scalar
      unreachable vertices: 1
      ich, source 0: crashed: the algorithm panicked: index out of bounds
      ich, source 1: crashed: the algorithm panicked: index out of bounds

    time: median of 6 runs; papers' count: 80 bytes per window; measured: heap of the algorithm without the mesh; MB = 10^6 bytes; * best
    "#);
}

#[test]
fn colour_marks_the_best_and_the_failed() {
    let result = mixed();
    let text = super::model_table(
        &GroupRecord::default(),
        &result.models[1],
        &result.cells,
        Look {
            styled: true,
            width: None,
        },
    );
    assert!(text.contains("\u{1b}["));
    assert!(!text.contains('*'));
}

#[test]
fn a_json_file_reads_back_as_it_was() {
    let result = mixed();
    let text = ResultFormat::Json.render(&result).unwrap();
    assert_eq!(serde_json::from_str::<ResultFile>(&text).unwrap(), result);
}

#[test]
fn endings_tell_the_form() {
    let of = |path: &str| ResultFormat::of_path(std::path::Path::new(path));
    assert_eq!(of("a/b.JSON"), Ok(ResultFormat::Json));
    assert_eq!(of("b.tex"), Ok(ResultFormat::Latex));
    assert!(of("b").is_err() && of("b.txt").is_err());
}

#[test]
fn ratios_of_times_are_those_of_pairs() {
    let mut plan = plan(&["horse", "cow"], "mmp,ich,vtp", "0,1");
    plan.group.ratios_to = Some("vtp".into());
    let group = plan.group.clone();
    let mut result = result(run_mock(&plan, &MockBackend::default()));
    result.groups.push(group);
    // The machine slows down; mmp always takes three times as long as vtp.
    for source in [0, 1] {
        let slower: Vec<f64> = (0..5).map(|i| f64::from(1 + i + source)).collect();
        for cell in &mut result.cells {
            let factor = match cell.algorithm.as_str() {
                "mmp" => 3.0,
                "vtp" => 1.0,
                _ => continue,
            };
            if cell.model == "horse" && cell.source == Some(source.into()) {
                cell.time = geobench_harness::measure::statistics::time(
                    slower.iter().map(|t| factor * t).collect(),
                    None,
                );
            }
        }
    }
    insta::assert_snapshot!(ResultFormat::Table.render(&result).unwrap());
}

#[test]
fn a_set_up_within_each_solve_is_not_the_best() {
    let mut plan = plan(&["horse"], "mmp,vtp,ich", "0");
    plan.group.rows = vec!["setup".to_owned()];
    let group = plan.group.clone();
    let mut result = result(run_mock(&plan, &MockBackend::default()));
    result.groups.push(group);
    let setups = [("mmp", 0.2), ("vtp", 0.1), ("ext:gdist", 0.0)];
    for (cell, (name, setup)) in result.cells.iter_mut().zip(setups) {
        cell.algorithm = name.to_owned();
        cell.time.setup = Some(setup);
    }
    let text = ResultFormat::Markdown.render(&result).unwrap();
    let row = text.lines().find(|line| line.contains("Set-up")).unwrap();
    assert!(
        row.contains("**0.1") && row.matches("**").count() == 2,
        "{row}"
    );
}

#[test]
fn doubts_about_times_are_noted() {
    let mut plan = plan(&["horse"], "mmp,vtp", "0");
    plan.group.ratios_to = Some("vtp".into());
    plan.sampling = geobench_harness::plan::sampling::Sampling::Fixed(3);
    let group = plan.group.clone();
    let mut few = result(run_mock(&plan, &MockBackend::default()));
    few.groups.push(group.clone());
    let mut outlier = few.clone();
    for cell in &mut outlier.cells {
        cell.time = geobench_harness::measure::statistics::time(
            vec![1.0, 1.01, 0.99, 1.02, 0.98, 40.0],
            None,
        );
    }
    outlier.cells[1].time.outliers = Some(0);
    insta::assert_snapshot!(
        ResultFormat::Markdown.render(&few).unwrap()
            + &ResultFormat::Markdown.render(&outlier).unwrap()
    );
}

#[test]
fn instructions_that_are_counted_in_different_ways_are_named() {
    let mut file = result(run_mock(
        &plan(&["horse"], "mmp,vtp", "0,1"),
        &MockBackend::default(),
    ));
    for cell in &mut file.cells {
        cell.instructions = Some(7);
        cell.instructions_simd = Some("avx2".to_owned());
    }
    let note = "instructions are counted with avx2: mmp; with scalar: vtp\n";
    assert!(
        !ResultFormat::Table
            .render(&file)
            .unwrap()
            .contains("are counted")
    );
    for cell in file.cells.iter_mut().filter(|c| c.algorithm == "vtp") {
        cell.instructions_simd = Some("scalar".to_owned());
    }
    assert!(ResultFormat::Table.render(&file).unwrap().contains(note));
}
