//! Provenance of outside programs.

use geobench_registry::Provenance;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::difference::first_difference;

/// An outside program of a session.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramRecord {
    /// Its name in cells, without parameters, such as `ext:vtp`.
    pub name: String,
    /// Its origin, as its table has it.
    #[serde(flatten)]
    pub provenance: Provenance,
    /// The executable, then the files that its command and its table name.
    pub files: Vec<ProgramFile>,
}

/// A file of an outside program, as it was when the session started.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramFile {
    /// The file as the table names it.
    pub path: String,
    /// SHA-256 of its bytes; null if it cannot be read.
    pub sha256: Option<String>,
}

impl ProgramRecord {
    /// The known facts, by name. A hash is followed by the name of its file, without directories.
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let Provenance {
            version,
            source,
            changes,
            compiler,
            flags,
        } = &self.provenance;
        let told = [
            ("version", version),
            ("source", source),
            ("changes", changes),
            ("compiler", compiler),
            ("flags", flags),
        ];
        let told = told.into_iter();
        let told = told.filter_map(|(name, value)| Some((name, value.clone()?)));
        let files = self.files.iter().map(|file| {
            let hash = file.sha256.as_deref().unwrap_or("unknown");
            let name = file.path.rsplit('/').next().unwrap_or_default();
            format!("{hash} {name}")
        });
        let files: Vec<String> = files.collect();
        let files = (!files.is_empty()).then(|| ("SHA-256", files.join(", ")));
        told.chain(files).collect()
    }

    /// Its facts in one line.
    pub fn in_words(&self) -> String {
        let facts = self.facts().into_iter();
        let facts: Vec<String> = facts
            .map(|(name, value)| format!("{name} {value}"))
            .collect();
        facts.join("; ")
    }
}

/// The first difference between the programs of `new` and those of the same name in `old`, in
/// words. Paths are not compared, hashes are. `None` if each program of `new` equals one of its
/// name in `old`, or `old` has none of that name.
pub fn changed_program<'p>(
    old: impl IntoIterator<Item = &'p ProgramRecord>,
    new: impl IntoIterator<Item = &'p ProgramRecord>,
) -> Option<String> {
    let old: Vec<&ProgramRecord> = old.into_iter().collect();
    let identity = |program: &ProgramRecord| {
        let hashes = program.files.iter().map(|file| &file.sha256);
        let hashes: Vec<_> = hashes.collect();
        json!({"provenance": program.provenance, "sha256": hashes})
    };
    new.into_iter().find_map(|program| {
        let same_name = old.iter().filter(|known| known.name == program.name);
        let differences =
            same_name.map(|known| first_difference(&identity(known), &identity(program)));
        // `None` if one of them is equal.
        let differences: Option<Vec<_>> = differences.collect();
        let found = differences?.pop()?;
        let name = &program.name;
        if let Some(file) = hashed(&found.place).and_then(|place| program.files.get(place)) {
            return Some(format!("the file {} of {name} has changed", file.path));
        }
        let place = found.place.trim_start_matches("provenance.");
        Some(format!(
            "`{place}` of {name} is {} and not {}",
            found.right, found.left
        ))
    })
}

/// The place in the list of files of the hash at `place`.
fn hashed(place: &str) -> Option<usize> {
    let rest = place.strip_prefix("sha256[")?;
    rest.strip_suffix(']')?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn program(version: &str, hash: &str) -> ProgramRecord {
        ProgramRecord {
            name: "ext:a".to_owned(),
            provenance: Provenance {
                version: Some(version.to_owned()),
                ..Provenance::default()
            },
            files: vec![ProgramFile {
                path: format!("../{hash}/a"),
                sha256: Some(hash.to_owned()),
            }],
        }
    }

    #[test]
    fn a_changed_program_is_named_unless_it_is_known() {
        let (first, second) = (program("1", "aa"), program("1", "bb"));
        let moved = ProgramRecord {
            files: vec![ProgramFile {
                path: "elsewhere".to_owned(),
                ..first.files[0].clone()
            }],
            ..first.clone()
        };
        assert_eq!(changed_program([&first], [&moved]), None);
        assert_eq!(changed_program([], [&first]), None);
        assert_eq!(changed_program([&first, &second], [&first]), None);
        assert_eq!(
            changed_program([&first], [&first, &second]).unwrap(),
            "the file ../bb/a of ext:a has changed"
        );
        assert_eq!(
            changed_program([&first], [&program("2", "aa")]).unwrap(),
            "`version` of ext:a is \"2\" and not \"1\""
        );
    }

    #[test]
    fn a_record_is_flat_and_reads_itself() {
        let one = program("1", "aa");
        let value = serde_json::to_value(&one).unwrap();
        assert_eq!(
            value,
            json!({"name": "ext:a", "version": "1", "files": [{"path": "../aa/a", "sha256": "aa"}]})
        );
        assert_eq!(serde_json::from_value::<ProgramRecord>(value).unwrap(), one);
        let facts = one.facts();
        assert_eq!(
            facts,
            [("version", "1".to_owned()), ("SHA-256", "aa a".to_owned())]
        );
    }
}
