//! Expressions over figures, with confidence intervals.
//!
//! An expression is a tree. Its leaves are numbers with their uncertainty: counts are exact, times
//! are medians of samples, and shares of phases have a standard error. `measure::statistics`
//! computes the interval of the whole expression.

use geobench_harness::measure::statistics::{
    Variable, exponent_of_growth, interval_of, median, range_of,
};

use crate::table::group::Estimate;

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Expression {
    /// A number, by its index in [`ExpressionLeaves`].
    Leaf(usize),
    /// The product.
    Product(Box<Self>, Box<Self>),
    /// The first divided by the second.
    Ratio(Box<Self>, Box<Self>),
    /// One minus the value: the share saved, if the value is the share that remains.
    Saving(Box<Self>),
    /// The value divided by a number.
    Per(Box<Self>, f64),
    /// The least.
    Least(Vec<Self>),
    /// The number that is paired with the least value.
    Best(Vec<(f64, Self)>),
    /// The median.
    Median(Vec<Self>),
    /// The arithmetic mean.
    Mean(Vec<Self>),
    /// The geometric mean.
    GeometricMean(Vec<Self>),
    /// The greatest divided by the least.
    Spread(Vec<Self>),
    /// The factor by which a power law grows from the least to the greatest x. The law is fitted to
    /// the points (x, value) by least squares on logarithms.
    Growth(Vec<(f64, Self)>),
    /// The power of that law.
    Exponent(Vec<(f64, Self)>),
}

impl Expression {
    fn of(&self, values: &[f64]) -> f64 {
        let all = |nodes: &[Self]| -> Vec<f64> { nodes.iter().map(|n| n.of(values)).collect() };
        match self {
            Self::Leaf(index) => values[*index],
            Self::Product(a, b) => a.of(values) * b.of(values),
            Self::Ratio(over, under) => over.of(values) / under.of(values),
            Self::Saving(node) => 1.0 - node.of(values),
            Self::Per(node, size) => node.of(values) / size,
            Self::Least(nodes) => all(nodes).into_iter().fold(f64::INFINITY, f64::min),
            Self::Best(nodes) => {
                let nodes = nodes
                    .iter()
                    .map(|(beside, node)| (*beside, node.of(values)));
                let best = nodes.min_by(|a, b| a.1.total_cmp(&b.1));
                best.map_or(f64::NAN, |(beside, _)| beside)
            }
            Self::Median(nodes) => median(&all(nodes)).unwrap_or(f64::NAN),
            Self::Mean(nodes) => mean(all(nodes).into_iter()),
            Self::GeometricMean(nodes) => libm::exp(mean(all(nodes).into_iter().map(libm::log))),
            Self::Spread(nodes) => {
                range_of(all(nodes)).map_or(f64::NAN, |[least, most]| most / least)
            }
            Self::Growth(points) => {
                let [least, most] = range_of(points.iter().map(|(x, _)| *x)).unwrap_or_default();
                // `powf` would give 1 for a range of one point, where the exponent is NaN.
                libm::exp(exponent(points, values) * libm::log(most / least))
            }
            Self::Exponent(points) => exponent(points, values),
        }
    }
}

/// The power of the law that fits the points.
fn exponent(points: &[(f64, Expression)], values: &[f64]) -> f64 {
    let points = points.iter().map(|(x, node)| [*x, node.of(values)]);
    exponent_of_growth(points).unwrap_or(f64::NAN)
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

/// The leaves of an expression.
#[derive(Clone, Debug, Default)]
pub(super) struct ExpressionLeaves(Vec<UncertainNumber>);

/// A number with its uncertainty.
#[derive(Clone, Debug, PartialEq)]
enum UncertainNumber {
    Exact(f64),
    Samples(Vec<f64>),
    /// A share, and the number of profile samples that it is estimated from.
    Share(f64, u64),
}

/// A figure of a cell.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Quantity {
    /// An exact number.
    Exact(f64),
    /// Timed samples in the order of the rounds.
    Samples(Vec<f64>),
    /// A share and the number of samples that it is estimated from.
    Share(f64, u64),
    /// A share of timed samples: the samples, the share, and the number of profile samples that the
    /// share is estimated from.
    TimeShare(Vec<f64>, f64, u64),
}

impl UncertainNumber {
    fn variable(&self) -> Variable<'_> {
        match *self {
            Self::Exact(value) => Variable::Exact(value),
            Self::Samples(ref samples) => Variable::Samples(samples),
            Self::Share(value, samples) => Variable::Estimate {
                value,
                error: (value * (1.0 - value) / samples.max(1) as f64).sqrt(),
            },
        }
    }
}

impl ExpressionLeaves {
    fn push(&mut self, leaf: UncertainNumber) -> Expression {
        self.0.push(leaf);
        Expression::Leaf(self.0.len() - 1)
    }

    /// Adds the leaves of a figure. Returns its node.
    pub(super) fn node(&mut self, quantity: Quantity) -> Expression {
        match quantity {
            Quantity::Exact(value) => self.push(UncertainNumber::Exact(value)),
            Quantity::Samples(samples) => self.push(UncertainNumber::Samples(samples)),
            Quantity::Share(share, samples) => self.push(UncertainNumber::Share(share, samples)),
            Quantity::TimeShare(times, share, samples) => {
                let times = self.push(UncertainNumber::Samples(times));
                let share = self.push(UncertainNumber::Share(share, samples));
                Expression::Product(Box::new(times), Box::new(share))
            }
        }
    }

    /// The ratio of two figures of one model and source. The algorithms ran in turns, so their
    /// samples are divided pair by pair, as in `table::group`.
    pub(super) fn ratio(&mut self, over: Quantity, under: Quantity) -> Expression {
        match (over, under) {
            (Quantity::Samples(over), Quantity::Samples(under)) if over.len() == under.len() => {
                let pairs = over.iter().zip(&under).map(|(a, b)| a / b);
                self.push(UncertainNumber::Samples(pairs.collect()))
            }
            (Quantity::TimeShare(over, a, m), Quantity::TimeShare(under, b, n)) => {
                let times = self.ratio(Quantity::Samples(over), Quantity::Samples(under));
                let shares = self.ratio(Quantity::Share(a, m), Quantity::Share(b, n));
                Expression::Product(Box::new(times), Box::new(shares))
            }
            (over, under) => {
                let (over, under) = (self.node(over), self.node(under));
                Expression::Ratio(Box::new(over), Box::new(under))
            }
        }
    }

    /// Whether all leaves are exact.
    pub(super) fn are_exact(&self) -> bool {
        self.0
            .iter()
            .all(|leaf| matches!(leaf, UncertainNumber::Exact(_)))
    }

    /// The least number of samples of a time; 0 if there are no times.
    pub(super) fn fewest_samples(&self) -> usize {
        let counts = self.0.iter().filter_map(|leaf| match leaf {
            UncertainNumber::Samples(samples) => Some(samples.len()),
            _ => None,
        });
        counts.min().unwrap_or(0)
    }

    /// The value of `node` with its interval; `None` if the value is not finite.
    pub(super) fn value(&self, node: &Expression) -> Option<Estimate> {
        let variables: Vec<Variable<'_>> = self.0.iter().map(UncertainNumber::variable).collect();
        let values = variables.iter().map(Variable::value);
        let value = node.of(&values.collect::<Option<Vec<f64>>>()?);
        let interval = if self.are_exact() {
            None
        } else {
            interval_of(&variables, |values| node.of(values))
        };
        value.is_finite().then_some(Estimate { value, interval })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(values: &[f64]) -> (ExpressionLeaves, Vec<Expression>) {
        let mut leaves = ExpressionLeaves::default();
        let nodes = values
            .iter()
            .map(|&value| leaves.node(Quantity::Exact(value)));
        let nodes = nodes.collect();
        (leaves, nodes)
    }

    #[test]
    fn each_expression_is_computed() {
        let (leaves, nodes) = exact(&[4.0, 1.0, 16.0]);
        let value = |node: Expression| leaves.value(&node).unwrap().value;
        let [a, b, c] = [0, 1, 2].map(|i: usize| Box::new(nodes[i].clone()));
        assert_eq!(value(Expression::Ratio(a.clone(), c.clone())), 0.25);
        assert_eq!(
            value(Expression::Saving(Box::new(Expression::Ratio(
                b,
                a.clone()
            )))),
            0.75
        );
        assert_eq!(value(Expression::Per(c, 8.0)), 2.0);
        assert_eq!(value(Expression::Least(nodes.clone())), 1.0);
        assert_eq!(value(Expression::Median(nodes.clone())), 4.0);
        assert_eq!(value(Expression::Mean(nodes.clone())), 7.0);
        assert!((value(Expression::GeometricMean(nodes.clone())) - 4.0).abs() < 1e-12);
        assert_eq!(value(Expression::Spread(nodes.clone())), 16.0);
        let beside = |places: [f64; 3]| places.into_iter().zip(nodes.clone()).collect();
        assert_eq!(
            value(Expression::Best(beside([100.0, 200.0, 300.0]))),
            200.0
        );
        // The values 4, 1 and 16 at x = 2, 1 and 4 are x²; the range is 1 to 4.
        let growth = value(Expression::Growth(beside([2.0, 1.0, 4.0])));
        assert!((growth - 16.0).abs() < 1e-9, "{growth}");
        let exponent = value(Expression::Exponent(beside([2.0, 1.0, 4.0])));
        assert!((exponent - 2.0).abs() < 1e-9, "{exponent}");
    }

    #[test]
    fn the_growth_is_that_of_the_whole_range_and_not_of_its_ends() {
        let (leaves, nodes) = exact(&[1.0, 2.0, 4.0, 2.0]);
        let points = [1.0, 2.0, 4.0, 8.0].into_iter().zip(nodes).collect();
        let growth = leaves.value(&Expression::Growth(points)).unwrap().value;
        // The fitted exponent is 0.4. The end points alone would give a factor of 2.
        assert!((growth - 8_f64.powf(0.4)).abs() < 1e-9, "{growth}");
    }

    #[test]
    fn times_have_an_interval_from_six_samples_on_and_pairs_are_divided_first() {
        let drifting = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let double = drifting.map(|x| 2.0 * x);
        let of = |over: &[f64], under: &[f64]| {
            let mut leaves = ExpressionLeaves::default();
            let samples = |set: &[f64]| Quantity::Samples(set.to_vec());
            let node = leaves.ratio(samples(over), samples(under));
            (leaves.value(&node).unwrap(), leaves.fewest_samples())
        };
        let (value, samples) = of(&double, &drifting);
        assert_eq!(
            (value.value, value.interval, samples),
            (2.0, Some([2.0, 2.0]), 6)
        );
        let (value, samples) = of(&double[..1], &drifting[..1]);
        assert_eq!((value.value, value.interval, samples), (2.0, None, 1));
        let (value, _) = of(&double, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let [low, high] = value.interval.unwrap();
        assert!(low < 1.0 && high > 2.0, "{low} {high}");
    }

    #[test]
    fn expressions_that_are_not_finite_have_no_value() {
        let (leaves, nodes) = exact(&[1.0, 0.0]);
        let [one, zero] = [0, 1].map(|i: usize| Box::new(nodes[i].clone()));
        assert_eq!(leaves.value(&Expression::Ratio(one, zero)), None);
        let same = nodes.into_iter().map(|node| (3.0, node)).collect();
        assert_eq!(leaves.value(&Expression::Growth(same)), None);
    }
}
