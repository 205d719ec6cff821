//! What goes together in one landscape: palms with warm lands, fog with wet ones. The parts that are decided already say
//! what the others may be, and the others say what they go with.

use genescape_schema::{Bounds, Category, Chromosome, Kind, Space};

use super::Home;

/// The parts of a landscape that are decided.
#[derive(Clone)]
pub struct Company<'a> {
    space: &'a Space,
    parts: Vec<(Category, Chromosome, Home<'a>)>,
}

impl<'a> Company<'a> {
    pub fn new(space: &'a Space) -> Self {
        Self { space, parts: Vec::new() }
    }

    /// All parts of a landscape but that of one category.
    pub fn beside(
        space: &'a Space,
        category: Category,
        parts: [&Chromosome; 3],
        homes: [Home<'a>; 3],
    ) -> Self {
        let mut company = Self::new(space);
        for other in Category::ALL.into_iter().filter(|other| *other != category) {
            company.add(other, parts[other as usize].clone(), homes[other as usize]);
        }
        company
    }

    /// How many of a landscape's categories have a kind that does not go with its other parts.
    pub fn discord(space: &Space, parts: [&Chromosome; 3], homes: [Home<'_>; 3]) -> usize {
        let disagrees = |category: &Category| {
            let company = Company::beside(space, *category, parts, homes);
            !company.suits_all(homes[*category as usize])
        };
        Category::ALL.iter().filter(|category| disagrees(category)).count()
    }

    pub fn add(&mut self, category: Category, chromosome: Chromosome, home: Home<'a>) {
        self.parts.push((category, chromosome, home));
    }

    /// Whether a kind goes with all parts, and they with some of its members.
    pub fn suits(&self, kind: &Kind) -> bool {
        let goes = |(category, genes, _): &(_, _, _)| kind.goes_with(self.space, *category, genes);
        self.parts.iter().all(goes) && self.demand(&mut kind.bounds.clone())
    }

    /// Whether all kinds of a home do; what is like no kind goes with everything.
    pub fn suits_all(&self, home: Home<'_>) -> bool {
        home.kinds().all(|kind| self.suits(kind))
    }

    /// Keeps of what a chromosome may be as much as the parts go with; `false` if they demand of a gene what it may not be,
    /// and then that gene is left as it is.
    pub fn demand(&self, bounds: &mut Bounds) -> bool {
        let category = bounds.category;
        let demands = self.parts.iter().flat_map(|(_, _, home)| home.demands());
        let mut all = true;
        for demand in demands.filter(|demand| demand.category == category) {
            all &= bounds.cut(self.space, &demand.gene, &demand.codes);
        }
        all
    }
}
