//! What votes have taught, in words: for `bake explain`.

use std::fmt;

use genescape_schema::{Category, Kinds, Parameter, Scale, Space};

use super::learned::Learned;
use crate::kinds::{Home, name};
use crate::seed::Dice;

/// Kinds and genes that are told, at most.
const KINDS: usize = 3;
const GENES: usize = 5;
/// What is told of a gene leaves out as many of the samples at either end.
const TAIL: f32 = 0.1;
/// Points that say how wide a gene lies before any vote.
const DRAWS: usize = 256;
/// The least part of what was open that votes have settled, for a gene to be told.
const SETTLED: f32 = 0.25;

/// Of one category.
#[derive(Clone, Debug, PartialEq)]
pub struct Account {
    pub category: Category,
    /// How many votes it rests on.
    pub votes: usize,
    /// Names of likely kinds, with how likely each is; what is like none has no name.
    pub kinds: Vec<(Option<String>, f32)>,
    /// All genes whose values are no names; what votes have settled most comes first.
    pub genes: Vec<Settled>,
}

/// What votes have taught of a gene.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    pub gene: String,
    /// In the gene's unit: in four of five cases what is wanted lies between these.
    pub range: [f64; 2],
    /// The range in words: "12 … 14 m".
    pub text: String,
    /// The part of what was open before any vote that votes have closed: up to 1, and 0 or less where they say nothing.
    pub part: f32,
}

impl Settled {
    /// Whether votes say enough to be told.
    pub fn is_told(&self) -> bool {
        self.part > SETTLED
    }
}

impl Account {
    pub fn of(space: &Space, kinds: &Kinds, learned: &Learned<'_>, category: Category) -> Self {
        let taste = learned.taste(category);
        let mut shares: Vec<(Option<String>, f32)> = Vec::new();
        for ideal in &taste.ideals {
            let chromosome = learned.member(category, ideal);
            let called = name::part(category, Home::of(space, kinds, category, &chromosome));
            let part = 1.0 / taste.ideals.len() as f32;
            match shares.iter_mut().find(|(name, _)| *name == called) {
                Some((_, share)) => *share += part,
                None => shares.push((called, part)),
            }
        }
        shares.sort_by(|a, b| b.1.total_cmp(&a.1));
        shares.truncate(KINDS);
        let mut dice = Dice::new(0u32, "account", 0);
        let before: Vec<usize> = (0..DRAWS).map(|_| taste.prior.any(&mut dice)).collect();
        let mut genes: Vec<(f32, &Parameter, [f32; 2])> = space
            .traits(category)
            .enumerate()
            .map(|(number, gene)| {
                let open = before.iter().map(|one| taste.prior.draw(*one, number, &mut dice)).collect();
                let [open, wanted] =
                    [open, taste.ideals.iter().map(|one| one.at[number]).collect()].map(middle);
                let settled = 1.0 - (wanted[1] - wanted[0]) / (open[1] - open[0]).max(1e-3);
                (settled, gene, wanted)
            })
            .filter(|(_, gene, _)| gene.scale != Scale::Choice)
            .collect();
        genes.sort_by(|a, b| b.0.total_cmp(&a.0));
        let told = |(part, gene, ends): (f32, &Parameter, [f32; 2])| {
            let codes = ends.map(|x| gene.code_at(x));
            let [low, high] = codes.map(|code| gene.text(code));
            let text = if low == high { low } else { format!("{low} … {high}") };
            let text = [text, gene.unit.clone()].join(" ").trim_end().to_owned();
            Settled {
                gene: gene.name.clone(),
                range: codes.map(|code| gene.text(code).parse().unwrap_or(gene.value(code))),
                text,
                part,
            }
        };
        let genes = genes.into_iter().map(told).collect();
        Self { category, votes: taste.votes, kinds: shares, genes }
    }
}

/// The values between which all but both tails lie.
fn middle(mut values: Vec<f32>) -> [f32; 2] {
    values.sort_unstable_by(f32::total_cmp);
    let last = values.len().saturating_sub(1) as f32;
    [TAIL, 1.0 - TAIL].map(|part| values.get((part * last).round() as usize).copied().unwrap_or_default())
}

impl fmt::Display for Account {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { category, votes, kinds, genes } = self;
        let s = if *votes == 1 { "" } else { "s" };
        write!(f, "{:<9} {votes} vote{s}:", category.name())?;
        for (number, (name, share)) in kinds.iter().enumerate() {
            let (comma, name) =
                (if number > 0 { "," } else { "" }, name.as_deref().unwrap_or("like no kind"));
            write!(f, "{comma} {name} ({:.0} %)", 100.0 * share)?;
        }
        let told = genes.iter().filter(|gene| gene.is_told()).take(GENES);
        for (number, Settled { gene, text, .. }) in told.enumerate() {
            write!(f, "{} {gene} {text}", if number > 0 { "," } else { "; surest:" })?;
        }
        Ok(())
    }
}
