//! How the time of the tools grows with the number of cells: each step doubles it, so that a factor
//! of 2 is linear and one of 4 quadratic. `cargo bench -p geobench-report`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use geobench_harness::exec::limits::DecompressionLimit;
use geobench_harness::measure::statistics;
use geobench_harness::plan::suite::{self, ModelChoice, Settings, Suite};
use geobench_harness::run::Records;
use geobench_harness::run::mock::result;
use geobench_harness::schema::{Cell, ModelRecord, ResultFile};
use geobench_report::history::compare::{Rules, compare};
use geobench_report::history::join;
use geobench_report::page::{self, Input, Options, PictureChoice, Tables};
use geobench_report::table::{ComparisonFormat, Look, ResultFormat};

/// A result of two algorithms on half as many models as `cells`, with a sample a cell.
fn made(cells: usize) -> ResultFile {
    let mut file = result(Records::default());
    for number in 0..cells / 2 {
        let name = format!("model {number}");
        for (algorithm, seconds) in [("mmp", 2.0), ("vtp", 1.0)] {
            let mut cell = Cell::new(&name, algorithm);
            let seconds = seconds + (number % 7) as f64 / 10.0;
            cell.time = statistics::time(vec![seconds], None);
            file.cells.push(cell);
        }
        file.models.push(ModelRecord {
            sha256: Some(format!("{number:064x}")),
            vertices: Some(100),
            faces: Some(196),
            name,
            ..ModelRecord::default()
        });
    }
    file
}

/// A step, by the number of cells.
type Step = (&'static str, fn(usize));

const STEPS: &[Step] = &[
    ("plan a suite", |cells| {
        let models = (0..cells / 2).map(|n| format!("\"gen:cube,n=1,side={}\"", n + 1));
        let models = models.collect::<Vec<_>>().join(", ");
        let text = format!(
            "[[group]]\nname = \"g\"\nalgorithms = [\"mmp\", \"vtp\"]\nmodels = [{models}]"
        );
        let suite = Suite::parse(Path::new("s.toml"), &text).unwrap();
        let plans = suite::plans(Some(&suite), &Settings::default(), &ModelChoice::default());
        assert_eq!(plans.unwrap().plans[0].models.len(), cells / 2);
    }),
    ("compare", |cells| {
        let file = made(cells);
        let compared = compare(("old", &file), ("new", &file), &Rules::default()).unwrap();
        let text = ComparisonFormat::Markdown.render(&compared, Look::default());
        assert!(text.unwrap().len() > cells);
    }),
    ("join", |cells| {
        let files = ["a", "b"].map(|name| (name.to_owned(), made(cells)));
        assert_eq!(join::join(files.to_vec()).unwrap().file.cells.len(), cells);
    }),
    ("Markdown", |cells| {
        assert!(ResultFormat::Markdown.render(&made(cells)).unwrap().len() > cells);
    }),
    ("report", |cells| {
        let options = Options {
            ratio_to: None,
            picture: PictureChoice::None,
            decompressed: DecompressionLimit::default(),
            tables: Tables::None,
        };
        let input = Input::new(PathBuf::from("r.json"), made(cells));
        let report = page::build(&[input], &options).unwrap();
        assert!(page::page(&report).len() > cells);
    }),
];

fn main() {
    const LEAST: usize = 1000;
    println!("seconds at {LEAST} cells, and the factors of each doubling");
    for (name, step) in STEPS {
        let mut before = None;
        print!("{name:14}");
        for cells in [LEAST, 2 * LEAST, 4 * LEAST, 8 * LEAST] {
            let start = Instant::now();
            step(cells);
            let seconds = start.elapsed().as_secs_f64();
            match before.replace(seconds) {
                None => print!(" {seconds:8.4}"),
                Some(before) => print!(" x{:.1}", seconds / before),
            }
        }
        println!();
    }
}
