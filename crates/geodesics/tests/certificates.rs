//! The page of certificates shows its record.

use std::path::Path;

#[path = "../examples/certificates/table.rs"]
mod table;

use table::{Record, table};

#[test]
fn the_page_is_that_of_the_record() {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results");
    let files = results.read_dir().unwrap().map(|file| file.unwrap().path());
    let is_record = |path: &std::path::PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.ends_with("-certificates.json")
    };
    // Names begin with the day.
    let newest = files.filter(is_record).max().unwrap();
    let record: Record = serde_json::from_slice(&std::fs::read(&newest).unwrap()).unwrap();
    assert_eq!(record.schema, "geobench-certificates/1");
    assert_eq!(record.tolerance, table::TOLERANCE);
    let page = std::fs::read_to_string(results.join("certificates.md")).unwrap();
    let (_, rest) = page.split_once("<!-- BEGIN: certificates -->\n").unwrap();
    let (kept, _) = rest.split_once("<!-- END: certificates -->").unwrap();
    let name = newest.file_name().unwrap_or_default().to_string_lossy();
    assert!(
        kept == table(&record),
        "results/certificates.md is not the page of {name}: run the example `certificates` with \
         --table, as scripts/certificates does"
    );
}
