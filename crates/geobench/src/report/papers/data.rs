//! Reading the papers' tables.

use crate::schema::Status;
use crate::table::figures::{Figure, figure};

/// A table of a paper.
#[derive(Clone, Debug)]
pub(crate) struct PaperTable {
    /// The authors and the year.
    pub(crate) paper: String,
    /// What the paper calls it.
    pub(crate) table: String,
    /// What was measured, in the paper's order.
    pub(crate) measured: Vec<Measured>,
    /// Ratios of which the paper prints nothing else.
    pub(crate) ratios: Vec<Ratio>,
    /// Rows that hold other numbers than figures of ours.
    pub(crate) others: usize,
}

/// A figure of an algorithm on a model.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    pub(crate) model: String,
    pub(crate) faces: Option<u64>,
    /// Our name of the algorithm.
    pub(crate) algorithm: String,
    pub(crate) figure: &'static Figure,
    pub(crate) value: f64,
}

/// How many times as much of a figure an algorithm takes as another.
#[derive(Clone, Debug)]
pub(crate) struct Ratio {
    /// The model, or what the ratio is a mean of.
    pub(crate) model: String,
    pub(crate) faces: Option<u64>,
    pub(crate) algorithm: String,
    /// The algorithm with which it is compared.
    pub(crate) to: String,
    pub(crate) figure: &'static Figure,
    pub(crate) value: f64,
    /// Standard deviation if it is a mean.
    pub(crate) deviation: Option<f64>,
}

/// Columns that hold numbers which are not figures of ours.
const OTHERS: [&str; 2] = ["log_b_n", "b"];

/// Reads the table in the file `name`.
///
/// # Errors
///
/// Says in which line something is not as the README of the papers' tables defines it.
pub(super) fn parse(name: &str, text: &str) -> anyhow::Result<PaperTable> {
    use anyhow::{Context, bail};

    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let head: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
    let column = |wanted: &str| head.iter().position(|h| h == wanted);
    let mut table = PaperTable {
        paper: String::new(),
        table: String::new(),
        measured: Vec::new(),
        ratios: Vec::new(),
        others: 0,
    };
    for (i, record) in reader.records().enumerate() {
        let line = i + 2;
        let record = record.with_context(|| format!("{name}, line {line}"))?;
        let field = |wanted: &str| {
            let text = column(wanted)
                .and_then(|c| record.get(c))
                .unwrap_or_default();
            (!text.is_empty()).then(|| text.to_owned())
        };
        let text = |wanted: &str| {
            field(wanted).with_context(|| format!("{name}, line {line}: `{wanted}` is missing"))
        };
        let number = |wanted: &str| -> anyhow::Result<Option<f64>> {
            let Some(text) = field(wanted) else {
                return Ok(None);
            };
            let value: f64 = text
                .parse()
                .with_context(|| format!("{name}, line {line}: `{wanted}` is no number"))?;
            if !(value.is_finite() && value > 0.0) {
                bail!("{name}, line {line}: `{wanted}` is not above 0");
            }
            Ok(Some(value))
        };
        (table.paper, table.table) = (text("paper")?, text("table")?);
        let (model, algorithm) = (text("model")?, text("algorithm")?);
        // Our name of it, which must be one.
        crate::registry::select_one(&algorithm).with_context(|| format!("{name}, line {line}"))?;
        text("printed")?;
        let faces = number("faces")?.map(|faces| faces as u64);
        if column("to").is_some() {
            let to = text("to")?;
            crate::registry::select_one(&to).with_context(|| format!("{name}, line {line}"))?;
            table.ratios.push(Ratio {
                model,
                faces,
                algorithm,
                to,
                figure: figure(&text("figure")?)?,
                value: number("ratio")?
                    .with_context(|| format!("{name}, line {line}: `ratio` is missing"))?,
                deviation: number("deviation")?,
            });
            continue;
        }
        let ended_well = match text("status")?.as_str() {
            status if status == Status::Ok.name() => true,
            "timeout" | "out_of_memory" | "refused" => false,
            other => bail!("{name}, line {line}: `status` is `{other}`"),
        };
        let known = [
            "paper",
            "table",
            "model",
            "vertices",
            "faces",
            "algorithm",
            "printed",
            "status",
            "note",
        ];
        let mut numbers = 0;
        for key in head.iter().filter(|key| !known.contains(&key.as_str())) {
            let Some(value) = number(key)? else {
                continue;
            };
            numbers += 1;
            if OTHERS.contains(&key.as_str()) {
                table.others += 1;
            } else if ended_well {
                table.measured.push(Measured {
                    model: model.clone(),
                    faces,
                    algorithm: algorithm.clone(),
                    figure: figure(key)?,
                    value,
                });
            }
        }
        if ended_well && numbers == 0 {
            bail!("{name}, line {line}: it ended well and has no numbers");
        }
    }
    Ok(table)
}

impl PaperTable {
    #[cfg(test)]
    pub(super) fn is_empty(&self) -> bool {
        self.measured.is_empty() && self.ratios.is_empty() && self.others == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        format!("{:#}", parse("x", text).unwrap_err())
    }

    #[test]
    fn what_is_not_understood_is_refused_with_its_line() {
        let head = "paper,table,model,vertices,faces,algorithm,printed,status,time,note\n";
        let line = |fields: &str| refused(&format!("{head}P,T,m,,10,mmp,MMP,ok,1.5,\n{fields}\n"));
        assert!(line("P,T,m,,10,mpp,MMP,ok,1.5,").starts_with("x, line 3: there is no algorithm"));
        assert_eq!(
            line("P,T,m,,10,mmp,MMP,ok,,"),
            "x, line 3: it ended well and has no numbers"
        );
        assert_eq!(
            line("P,T,m,,10,mmp,MMP,fine,1,"),
            "x, line 3: `status` is `fine`"
        );
        assert_eq!(
            line("P,T,m,,10,mmp,MMP,ok,0,"),
            "x, line 3: `time` is not above 0"
        );
        assert!(
            line("P,T,m,,10,mmp,MMP,ok,\"1,5\",").starts_with("x, line 3: `time` is no number")
        );
        assert_eq!(
            line("P,T,,,10,mmp,MMP,ok,1,"),
            "x, line 3: `model` is missing"
        );
    }
}
