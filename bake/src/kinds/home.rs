//! A chromosome → the kinds that it belongs to. Computed from its genes alone, so that edits by hand and old worlds need
//! nothing stored.

use genescape_schema::{Bounds, Category, Chromosome, Demand, Kind, Kinds, Space};

/// Where a chromosome lies among the kinds of its category.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Home<'a> {
    /// A member, perhaps with a few genes that a person set to something else.
    Of(&'a Kind),
    /// Between two that mix; it is nearer to the first.
    Between(&'a Kind, &'a Kind),
    /// Like no kind.
    Wild,
}

/// How much of a chromosome may be outside a kind that it is still a member of, see [`Bounds::excess`]. What one has more
/// of may be a mixture.
const MEMBER: f32 = 0.08;
/// The same where no two kinds hold it better: beyond, it is wild.
const LIKE: f32 = 0.25;

impl<'a> Home<'a> {
    /// The kinds of its category that hold a chromosome best; of two that hold it alike, a person's own.
    pub fn of(space: &Space, kinds: &'a Kinds, category: Category, genes: &Chromosome) -> Self {
        let mut near: Vec<(f32, f32, &Kind)> = kinds
            .of(category)
            .map(|kind| (kind.bounds.excess(space, genes), kind.bounds.deviation(space, genes), kind))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.ships.cmp(&b.2.ships)));
        let Some(&(excess, _, nearest)) = near.first() else { return Self::Wild };
        if excess == 0.0 {
            return Self::Of(nearest);
        }
        near.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.2.ships.cmp(&b.2.ships)));
        let pair = nearest_pair(space, genes, &near).filter(|(outside, _, _)| *outside < excess);
        match pair {
            Some((outside, a, b)) if outside == 0.0 || excess > MEMBER && outside <= MEMBER => {
                Self::Between(a, b)
            }
            _ if excess <= LIKE => Self::Of(nearest),
            _ => Self::Wild,
        }
    }

    /// The kind that it is, or is nearest to.
    pub fn main(self) -> Option<&'a Kind> {
        self.kinds().next()
    }

    /// The name in files of the kind that it is, or is nearest to.
    pub fn id(self) -> Option<&'a str> {
        self.main().map(|kind| kind.id.as_str())
    }

    pub fn kinds(self) -> impl Iterator<Item = &'a Kind> {
        let (one, other) = match self {
            Self::Of(kind) => (Some(kind), None),
            Self::Between(a, b) => (Some(a), Some(b)),
            Self::Wild => (None, None),
        };
        one.into_iter().chain(other)
    }

    /// What genes of other categories must be. Between two kinds, where both ask for something, either or what lies between.
    pub fn demands(self) -> Vec<Demand> {
        let mut demands: Vec<Demand> = Vec::new();
        for demand in self.kinds().flat_map(|kind| &kind.goes_with) {
            match demands.iter_mut().find(|known| known.gene == demand.gene) {
                Some(Demand { codes, .. }) => {
                    *codes = *codes.start().min(demand.codes.start())..=*codes.end().max(demand.codes.end());
                }
                None => demands.push(demand.clone()),
            }
        }
        demands
    }

    /// Where its relatives may be; `None` for what is wild.
    pub fn bounds(self) -> Option<Bounds> {
        match self {
            Self::Of(kind) => Some(kind.bounds.clone()),
            Self::Between(a, b) => Some(a.bounds.hull(&b.bounds)),
            Self::Wild => None,
        }
    }
}

/// Of the pairs of kinds that mix, the one that holds most of a chromosome and, of several, the one that it is most typical
/// of. `near` is sorted by how unusual the chromosome is for each.
fn nearest_pair<'a>(
    space: &Space,
    genes: &Chromosome,
    near: &[(f32, f32, &'a Kind)],
) -> Option<(f32, &'a Kind, &'a Kind)> {
    let mut best: Option<(f32, f32, &Kind, &Kind)> = None;
    for (at, &(_, a_deviation, a)) in near.iter().enumerate() {
        for &(_, b_deviation, b) in near[at + 1..].iter().filter(|(_, _, b)| a.mixes_with(b)) {
            let key = (a.bounds.hull(&b.bounds).excess(space, genes), a_deviation + b_deviation);
            if best.is_none_or(|best| key < (best.0, best.1)) {
                best = Some((key.0, key.1, a, b));
            }
        }
    }
    best.map(|(outside, _, a, b)| (outside, a, b))
}
