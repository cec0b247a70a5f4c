//! Rules that define regressions, such as `time=10%,propagated=0,heap_peak_bytes=5%`.

use std::fmt;
use std::str::FromStr;

use geobench_harness::schema::Time;
use geobench_mesh::did_you_mean;
use geobench_registry::UsageError;

use super::Measure;

/// The subject of a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Times.
    Time(TimeKind),
    /// Cells of the old file that the new one lacks.
    Missing,
    /// A figure that is compared exactly.
    Figure(Measure),
}

/// A time of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeKind {
    /// The time that all outputs show.
    Time,
    /// Of an outside program: the time by the clock of the harness.
    Outside,
    /// Of an outside program: the time that it claims.
    Claimed,
}

impl TimeKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Time, Self::Outside, Self::Claimed];

    /// The name in rules, as in the rows of tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Outside => "outside_time",
            Self::Claimed => "claimed_time",
        }
    }

    /// Its samples.
    pub const fn of(self, time: &Time) -> &Vec<f64> {
        match self {
            Self::Time => &time.samples,
            Self::Outside => &time.outside,
            Self::Claimed => &time.claimed,
        }
    }
}

impl Subject {
    fn all() -> impl Iterator<Item = Self> {
        (TimeKind::ALL.map(Self::Time).into_iter())
            .chain([Self::Missing])
            .chain(Measure::all().map(Self::Figure))
    }

    /// The name in rules.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Time(kind) => kind.name(),
            Self::Missing => "missing",
            Self::Figure(measure) => measure.name(),
        }
    }

    /// Whether only an increase is worse.
    fn is_cost(self) -> bool {
        match self {
            Self::Time(_) | Self::Missing => true,
            Self::Figure(measure) => measure.is_cost(),
        }
    }
}

/// A limit on the change of a subject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparisonRule {
    /// The subject.
    pub subject: Subject,
    /// The largest change that passes, as a share of the old value. For missing cells, their
    /// largest share of the cells of the old file.
    pub limit: f64,
    /// Whether every decrease passes.
    pub only_more: bool,
}

/// A set of rules, at most one for each subject.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rules(Vec<ComparisonRule>);

impl ComparisonRule {
    /// Whether the change of an exactly compared figure from `old` to `new` breaks the rule.
    pub fn is_broken(&self, old: f64, new: f64) -> bool {
        // A change from 0 is infinite and breaks every limit.
        let change = if new == old { 0.0 } else { (new - old) / old };
        change > self.limit || (!self.only_more && change < -self.limit)
    }
}

impl ComparisonRule {
    /// Whether a figure of which less is better has decreased beyond the limit.
    pub(crate) fn is_surpassed(&self, old: f64, new: f64) -> bool {
        self.subject.is_cost() && old > 0.0 && (old - new) / old > self.limit
    }
}

impl Rules {
    /// The rule on `subject`.
    pub fn on(&self, subject: Subject) -> Option<&ComparisonRule> {
        self.0.iter().find(|rule| rule.subject == subject)
    }

    /// All rules.
    pub fn iter(&self) -> impl Iterator<Item = &ComparisonRule> {
        self.0.iter()
    }
}

impl FromStr for Rules {
    type Err = UsageError;

    fn from_str(text: &str) -> Result<Self, UsageError> {
        let mut rules: Vec<ComparisonRule> = Vec::new();
        for item in text.split(',') {
            let rule: ComparisonRule = item.parse()?;
            if rules.iter().any(|other| other.subject == rule.subject) {
                let name = rule.subject.name();
                return Err(UsageError(format!("there are two rules for `{name}`")));
            }
            rules.push(rule);
        }
        Ok(Self(rules))
    }
}

impl FromStr for ComparisonRule {
    type Err = UsageError;

    fn from_str(item: &str) -> Result<Self, UsageError> {
        let (name, limit) = item.split_once('=').ok_or_else(|| {
            let item = item.trim();
            UsageError(format!(
                "`{item}` is not a rule; write NAME=LIMIT, such as time=10%"
            ))
        })?;
        let name = name.trim().to_lowercase();
        let Some(subject) = Subject::all().find(|subject| subject.name() == name) else {
            return Err(unknown(&name));
        };
        let (sign, size) = match limit.trim().strip_prefix('+') {
            Some(size) => (true, size),
            None => (false, limit.trim()),
        };
        let percent = match size.strip_suffix('%') {
            Some(percent) => percent.trim().parse().ok(),
            None => size.parse().ok().filter(|number: &f64| *number == 0.0),
        };
        match percent.filter(|p: &f64| p.is_finite() && *p >= 0.0) {
            Some(percent) => Ok(Self {
                subject,
                limit: percent / 100.0,
                only_more: sign || subject.is_cost(),
            }),
            None => Err(UsageError(format!(
                "`{name}={}`: a limit is 0 or a percentage such as 5%; +5% lets any decrease pass",
                limit.trim()
            ))),
        }
    }
}

fn unknown(name: &str) -> UsageError {
    let known: Vec<&str> = Subject::all().map(Subject::name).collect();
    UsageError(format!(
        "there is no rule `{name}`{}; known are {}",
        did_you_mean(name, &known),
        known.join(", ")
    ))
}

impl fmt::Display for ComparisonRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.only_more && !self.subject.is_cost() {
            "+"
        } else {
            ""
        };
        write!(f, "{}={sign}", self.subject.name())?;
        if self.limit == 0.0 {
            f.write_str("0")
        } else {
            // Rounded, because the division by 100 in the parser has a rounding error.
            write!(f, "{}%", (self.limit * 1e8).round() / 1e6)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules(text: &str) -> Rules {
        text.parse().unwrap()
    }

    fn refused(text: &str) -> String {
        text.parse::<Rules>().unwrap_err().to_string()
    }

    #[test]
    fn rules_are_read_and_shown_as_they_were_written() {
        let text =
            "time=10%,missing=0,propagated=0,heap_peak_bytes=5%,kept=+2.5%,instructions=0.1%";
        let shown: Vec<String> = rules(text).iter().map(ComparisonRule::to_string).collect();
        assert_eq!(shown.join(","), text);
        assert_eq!(rules(" Time = 10 % "), rules("time=10%"));
        for subject in Subject::all() {
            let rules = rules(&format!("{}=1%", subject.name()));
            assert_eq!(rules.on(subject).unwrap().limit, 0.01);
            let others = Subject::all().filter(|other| *other != subject);
            assert!(
                others
                    .map(|other| rules.on(other))
                    .all(|rule| rule.is_none())
            );
        }
    }

    #[test]
    fn invalid_rules_are_refused() {
        assert_eq!(
            refused("time"),
            "`time` is not a rule; write NAME=LIMIT, such as time=10%"
        );
        assert!(refused("").contains("is not a rule"));
        assert!(refused("time=10%,").contains("is not a rule"));
        let unknown = refused("propogated=0");
        assert!(
            unknown.starts_with(
                "there is no rule `propogated` (did you mean `propagated`?); known are time, outside_time, claimed_time, missing, "
            ),
            "{unknown}"
        );
        for limit in ["10", "-5%", "%", "x%", "nan%", "inf%", ""] {
            assert!(
                refused(&format!("time={limit}"))
                    .starts_with(&format!("`time={limit}`: a limit is 0 or a percentage")),
                "{limit}"
            );
        }
        assert_eq!(refused("time=1%,time=2%"), "there are two rules for `time`");
    }

    #[test]
    fn counts_may_not_change_and_costs_may_not_rise() {
        let broken = |text: &str, old: f64, new: f64| {
            let rule: ComparisonRule = text.parse().unwrap();
            rule.is_broken(old, new)
        };
        assert!(!broken("propagated=0", 100.0, 100.0));
        assert!(broken("propagated=0", 100.0, 101.0));
        assert!(broken("propagated=0", 100.0, 99.0));
        assert!(!broken("propagated=+0", 100.0, 99.0));
        assert!(broken("propagated=+0", 100.0, 101.0));
        assert!(!broken("kept=1%", 100.0, 101.0) && broken("kept=1%", 100.0, 102.0));
        assert!(broken("instructions=2%", 100.0, 103.0));
        assert!(!broken("instructions=2%", 100.0, 90.0));
        assert!(!broken("heap_peak_bytes=2%", 100.0, 102.0));
        // 0 may stay 0. A change from 0 breaks every limit.
        assert!(!broken("trimmed=5%", 0.0, 0.0) && broken("trimmed=5%", 0.0, 1.0));
    }
}
