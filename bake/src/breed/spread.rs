//! What a person may want → four to choose from: one that is the best guess, and others among which a choice tells most.
//!
//! How much a choice tells is the mutual information between it and what is wanted (Lindley, "On a Measure of the
//! Information Provided by an Experiment", 1956; Houlsby and others, "Bayesian Active Learning for Classification and
//! Preference Learning", 2011), summed over the samples. The three begin as what samples want (Thompson 1933), the
//! best set of these is taken one by one, and then each is changed as long as that makes the set better. What tells most
//! would often be far from what is wanted: so what will be missed in what is chosen is set against it (as in Viappiani and
//! Boutilier, "Optimal Bayesian Recommendation Sets and Myopically Optimal Choice Query Sets", 2010).

use std::collections::BTreeSet;

use genescape_schema::INDIVIDUALS;

use super::places::{self, Places, Settings};
use super::prior::Prior;
use super::taste::Ideal;
use crate::kinds::Home;
use crate::math::exp;
use crate::phenotype::visibility::Seen;
use crate::seed::Dice;

/// Points that sets are made of at first: what samples want, and anything. Changes that are tried on a set.
const POOL: usize = 150;
const ANYTHING: usize = 60;
const CHANGES: u32 = 500;
/// How far towards the mean of its kind a sampled point is taken.
const PULLS: [f32; 3] = [0.3, 0.6, 1.0];
/// What showing something worse costs, in nats: as much as the choice would have to tell more, were all genes of what is
/// chosen to differ by all of their range.
const REGRET: f32 = 3.0;
/// What must be missed in another, as a part of what is missed in the favourite, for it to take that one's place.
const CLEARLY: f32 = 0.92;
/// How many of the four look clearly different from the best guess, where there is anything that does: votes that agree, be it by
/// chance, would else make four landscapes of one place, and what is not shown cannot be chosen.
const STRANGERS: usize = 2;
/// The least part of the samples that a kind must have for its mean to be a guess.
const MIN_SHARE: f32 = 0.08;

/// A point that somebody may be shown.
#[derive(Clone, Debug)]
struct Candidate {
    at: Vec<f32>,
    /// The component of the prior that it is a member of.
    component: usize,
}

/// Where the samples of one component lie on average, each gene by how much it matters to them.
pub struct Mean {
    component: usize,
    at: Vec<f32>,
    /// The part of all samples.
    share: f32,
}

impl Mean {
    /// Of each component that has samples.
    pub fn all(prior: &Prior<'_>, ideals: &[Ideal]) -> Vec<Self> {
        let components: BTreeSet<usize> = ideals.iter().map(|ideal| ideal.component).collect();
        let of = |component| {
            let members: Vec<&Ideal> = ideals.iter().filter(|one| one.component == component).collect();
            let share = members.len() as f32 / ideals.len() as f32;
            Self { component, at: mean(prior, &members), share }
        };
        components.into_iter().map(of).collect()
    }
}

/// What candidates are made from.
pub struct Spread<'a> {
    pub prior: &'a Prior<'a>,
    pub ideals: &'a [Ideal],
    pub means: &'a [Mean],
    /// Makes a point of a component what may be shown: of its kind, suiting the rest, on whole codes.
    pub legal: &'a dyn Fn(usize, &mut Vec<f32>),
    /// The kinds that a point belongs to.
    pub home: &'a dyn Fn(&[f32]) -> Home<'a>,
    /// Whether what is chosen will be shown more than once, and so had better go with all landscapes.
    pub repeats: bool,
    /// What is decided of the four landscapes.
    pub settings: &'a Settings<'a>,
    /// Whether two points look clearly different.
    pub stands_out: &'a dyn Fn(Seen<'_>, Seen<'_>) -> bool,
}

impl<'a> Spread<'a> {
    /// The best guess: the favourite, which is the last of what was chosen, unless clearly less is missed in another of
    /// these or in the mean of a likely kind. Only what `is_like` the favourite takes its place: who chose a birch must not
    /// meet a palm instead.
    pub fn best(&self, chosen: &[Vec<f32>], is_like: &dyn Fn(&[f32]) -> bool) -> Vec<f32> {
        let greatest = self.means.iter().map(|mean| mean.share).fold(0.0, f32::max);
        let likely = self.means.iter().filter(|mean| mean.share >= MIN_SHARE.min(greatest));
        let means = likely.map(|mean| {
            let mut at = mean.at.clone();
            (self.legal)(mean.component, &mut at);
            at
        });
        let favourite = chosen.last();
        let all = chosen.iter().cloned().chain(means);
        let all = all.filter(|one| favourite.is_none() || is_like(one)).map(|one| (self.cost(&one), one));
        let best = all.reduce(|best, one| if one.0 < best.0 { one } else { best });
        match (best, favourite) {
            (Some((cost, best)), Some(favourite)) if cost <= CLEARLY * self.cost(favourite) => best,
            (_, Some(favourite)) => favourite.clone(),
            (Some((_, best)), None) => best,
            (None, None) => unreachable!("there are samples, and so a mean"),
        }
    }

    /// Others than `shown`, as many as it takes to make four, no two alike where the pool has so many, and, where it has
    /// these, each for a landscape with which it goes. Beside a best guess [`STRANGERS`] of them look different.
    pub fn others(&self, shown: &[Vec<f32>], dice: &mut Dice) -> Vec<Vec<f32>> {
        let units: Vec<f32> = self.ideals.iter().map(Ideal::unit).collect();
        let worth = |rows: &[&[f32]]| worth(rows, &units);
        let best = shown.first().map(|best| self.seen(best));
        let is_strange = |one: &Candidate| {
            best.is_some_and(|best| {
                (self.stands_out)(best, seen(&one.at, self.prior.component(one.component).home))
            })
        };
        let pool = self.pool(dice);
        let missed: Vec<Vec<f32>> = pool.iter().map(|one| self.missed(&one.at)).collect();
        let strange: Vec<bool> = pool.iter().map(is_strange).collect();
        let has_strangers = strange.contains(&true);
        let fits = |one: &Candidate| self.settings.places(self.prior.component(one.component).home);
        let places: Vec<Places> = pool.iter().map(fits).collect();
        let mut seats: Vec<Places> = Vec::new();
        let mut set: Vec<Candidate> = Vec::new();
        let mut rows: Vec<Vec<f32>> = shown.iter().map(|one| self.missed(one)).collect();
        let mut strangers = 0;
        while rows.len() < INDIVIDUALS {
            let with = |row: &Vec<f32>| {
                let with: Vec<&[f32]> = rows.iter().chain([row]).map(Vec::as_slice).collect();
                worth(&with)
            };
            let must = has_strangers && INDIVIDUALS - rows.len() <= STRANGERS.saturating_sub(strangers);
            let is_new = |one: &usize| !is_among(&pool[*one].at, shown, &set);
            let has_room = |one: &usize| places::has_room(&seats, places[*one], shown.len());
            let goes_anywhere = |one: &usize| self.repeats && places[*one] == [true; INDIVIDUALS];
            let rank = |one: &usize| (is_new(one), has_room(one), goes_anywhere(one));
            let all = (0..pool.len()).filter(|one| !must || strange[*one]);
            let best = all.max_by(|a, b| {
                rank(a).cmp(&rank(b)).then_with(|| with(&missed[*a]).total_cmp(&with(&missed[*b])))
            });
            let best = best.unwrap_or_default();
            strangers += usize::from(strange[best]);
            seats.push(places[best]);
            set.push(pool[best].clone());
            rows.push(missed[best].clone());
        }
        let mut most = worth(&slices(&rows));
        for _ in 0..CHANGES {
            let at = dice.below(set.len() as u32) as usize;
            let Some(other) = self.changed(&set[at], dice) else { continue };
            if is_among(&other.at, shown, &set) {
                continue;
            }
            let row = std::mem::replace(&mut rows[shown.len() + at], self.missed(&other.at));
            let now = worth(&slices(&rows));
            // A stranger stays one.
            if now > most && (!is_strange(&set[at]) || is_strange(&other)) {
                most = now;
                set[at] = other;
            } else {
                rows[shown.len() + at] = row;
            }
        }
        set.into_iter().map(|one| one.at).collect()
    }

    /// Of three others than `best` those that tell what showing something new costs, in nats, and at least so many. A stranger
    /// stays, if there is one, and stands in place of those that go until there are [`STRANGERS`]; then there is `best` again. Two
    /// of a category, each shown twice, make four landscapes of which each differs from each in two categories. What would leave
    /// a landscape with what does not go with it stays, too.
    pub fn sparing(&self, best: &[f32], others: Vec<Vec<f32>>, cost: f32, least_new: usize) -> Vec<Vec<f32>> {
        let units: Vec<f32> = self.ideals.iter().map(Ideal::unit).collect();
        let own = self.missed(best);
        let mut rows: Vec<Vec<f32>> = others.iter().map(|one| self.missed(one)).collect();
        let worth = |rows: &[Vec<f32>]| {
            let four: Vec<&[f32]> = std::iter::once(&own).chain(rows).map(Vec::as_slice).collect();
            worth(&four, &units)
        };
        let best_seen = self.seen(best);
        let strange: Vec<bool> =
            others.iter().map(|one| (self.stands_out)(best_seen, self.seen(one))).collect();
        // Which of the others stands in place of each, and the best where it is `None`.
        let standing = |new: &[usize]| -> Vec<Option<usize>> {
            // Where nothing is strange, the only new one is shown twice all the same.
            let stands_twice = |at: &&usize| strange[**at] || new.len() == 1;
            let again = new.iter().find(stands_twice).copied();
            let mut strangers = new.iter().filter(stands_twice).count();
            let mut stand_in = || {
                strangers += 1;
                again.filter(|_| strangers <= STRANGERS)
            };
            (0..others.len()).map(|at| if new.contains(&at) { Some(at) } else { stand_in() }).collect()
        };
        let (best_fits, fits) =
            (self.places(best), others.iter().map(|one| self.places(one)).collect::<Vec<_>>());
        let has_room = |new: &[usize]| {
            let seats = standing(new).into_iter().map(|one| one.map_or(best_fits, |one| fits[one]));
            places::find_room(&seats.collect::<Vec<_>>(), 1)
        };
        let mut new: Vec<usize> = (0..others.len()).collect();
        while new.len() > least_new {
            let all = worth(&rows);
            let without = |at: usize| {
                let mut rows = rows.clone();
                rows[at].clone_from(&own);
                worth(&rows)
            };
            let is_last_stranger =
                |at: usize| strange[at] && new.iter().filter(|one| strange[**one]).count() == 1;
            let leaves_room = |gone: usize| {
                let rest: Vec<usize> = new.iter().copied().filter(|at| *at != gone).collect();
                has_room(&rest) || !has_room(&new)
            };
            let may_go = new.iter().filter(|at| !is_last_stranger(**at) && leaves_room(**at));
            let costs = may_go.map(|at| (all - without(*at), *at));
            let least = costs.reduce(|least, one| if one.0 < least.0 { one } else { least });
            let Some((_, at)) = least.filter(|(lost, _)| *lost < cost) else { break };
            new.retain(|one| *one != at);
            rows[at].clone_from(&own);
        }
        standing(&new).into_iter().map(|one| one.map_or(best, |one| &others[one]).to_vec()).collect()
    }

    /// In which landscapes a point goes with the rest.
    pub fn places(&self, at: &[f32]) -> Places {
        self.settings.places((self.home)(at))
    }

    /// The kind that a point is like most; none of what is wild.
    pub fn kind(&self, at: &[f32]) -> Option<&'a str> {
        (self.home)(at).id()
    }

    fn seen<'b>(&'b self, at: &'b [f32]) -> Seen<'b> {
        seen(at, (self.home)(at))
    }

    /// What each sample misses in a point.
    fn missed(&self, point: &[f32]) -> Vec<f32> {
        self.ideals.iter().map(|ideal| ideal.missed(self.prior, point)).collect()
    }

    fn cost(&self, point: &[f32]) -> f32 {
        self.missed(point).iter().sum()
    }

    fn mean(&self, component: usize) -> Option<&[f32]> {
        self.means.iter().find(|mean| mean.component == component).map(|mean| mean.at.as_slice())
    }

    /// What samples want, and what lies between that and the mean of their kind; and members of any kind.
    fn pool(&self, dice: &mut Dice) -> Vec<Candidate> {
        let one = |number: usize| {
            if number >= POOL {
                let component = self.prior.any(dice);
                return Candidate { at: self.drawn(component, dice), component };
            }
            let ideal = &self.ideals[dice.below(self.ideals.len() as u32) as usize];
            let (mut at, component) = (ideal.at.clone(), ideal.component);
            if let Some(mean) = self.mean(component) {
                self.pull(&mut at, mean, PULLS[number % PULLS.len()]);
            }
            (self.legal)(component, &mut at);
            Candidate { at, component }
        };
        // Without kinds samples want anything anyway.
        let anything = if self.prior.is_one() { 0 } else { ANYTHING };
        (0..POOL + anything).map(one).collect()
    }

    /// A member of a component by chance.
    pub fn drawn(&self, component: usize, dice: &mut Dice) -> Vec<f32> {
        let mut at = (0..self.prior.genes()).map(|gene| self.prior.draw(component, gene, dice)).collect();
        (self.legal)(component, &mut at);
        at
    }

    fn pull(&self, at: &mut [f32], mean: &[f32], part: f32) {
        for (gene, (x, mean)) in at.iter_mut().zip(mean).enumerate() {
            if !self.prior.is_choice(gene) {
                *x = (mean + part * (*x - mean)).clamp(0.0, 1.0);
            }
        }
    }

    /// A candidate nearer to or farther from the mean of its kind, with a few genes of chance, or with some of a relative's.
    fn changed(&self, from: &Candidate, dice: &mut Dice) -> Option<Candidate> {
        let (mut at, component) = (from.at.clone(), from.component);
        match dice.below(3) {
            0 => {
                let part = 0.5 + 1.2 * dice.unit();
                self.pull(&mut at, self.mean(component)?, part);
            }
            1 => {
                for _ in 0..=dice.below(3) {
                    let gene = dice.below(self.prior.genes() as u32) as usize;
                    at[gene] = self.prior.draw(component, gene, dice);
                }
            }
            _ => {
                let other = &self.ideals[dice.below(self.ideals.len() as u32) as usize];
                if other.component != component {
                    return None;
                }
                for (x, other) in at.iter_mut().zip(&other.at) {
                    if dice.chance(0.25) {
                        *x = *other;
                    }
                }
            }
        }
        (self.legal)(component, &mut at);
        Some(Candidate { at, component })
    }
}

/// Of genes whose values are names, the one that matters most.
fn mean(prior: &Prior<'_>, members: &[&Ideal]) -> Vec<f32> {
    let units: Vec<f32> = members.iter().map(|ideal| 1.0 / ideal.weights.iter().sum::<f32>()).collect();
    let of = |gene: usize| {
        let weighted =
            || members.iter().zip(&units).map(|(one, unit)| (one.at[gene], unit * one.weights[gene]));
        if prior.is_choice(gene) {
            let votes = |at: f32| weighted().filter(|one| one.0 == at).map(|one| one.1).sum::<f32>();
            let best = weighted().map(|one| (votes(one.0), one.0));
            let best = best.reduce(|best, one| if one.0 > best.0 { one } else { best });
            return best.map_or(0.0, |one| one.1);
        }
        let add = |(sum, all), (at, weight)| (sum + weight * at, all + weight);
        let (sum, weight) = weighted().fold((0.0, 1e-12), add);
        sum / weight
    };
    (0..prior.genes()).map(of).collect()
}

fn seen<'a>(at: &'a [f32], home: Home<'a>) -> Seen<'a> {
    Seen { at, kind: home.id() }
}

/// Whether a point is one of those already.
fn is_among(at: &[f32], shown: &[Vec<f32>], set: &[Candidate]) -> bool {
    shown.iter().chain(set.iter().map(|one| &one.at)).any(|one| one == at)
}

fn slices(rows: &[Vec<f32>]) -> Vec<&[f32]> {
    rows.iter().map(Vec::as_slice).collect()
}

/// What is known of a choice before it is made: how much it would tell of which sample is right, in nats, less what would be
/// missed in what is chosen, as [`REGRET`] says. `missed` has a row for each point: what each sample misses in it.
/// `units` has for each sample what it misses where every gene differs by all of its range.
fn worth(missed: &[&[f32]], units: &[f32]) -> f32 {
    let mut least = vec![f32::INFINITY; units.len()];
    for row in missed {
        least.iter_mut().zip(*row).for_each(|(least, one)| *least = if one < least { *one } else { *least });
    }
    // Of each sample: what speaks for its choices, together, and what that misses beyond the least.
    let (mut sums, mut gaps) = (vec![0.0f32; units.len()], vec![0.0f32; units.len()]);
    let mut chances = vec![vec![0.0f32; units.len()]; missed.len()];
    for (row, chances) in missed.iter().zip(&mut chances) {
        let totals = sums.iter_mut().zip(&mut gaps);
        for (((one, least), chance), (sum, gap)) in row.iter().zip(&least).zip(chances).zip(totals) {
            let above = one - least;
            *chance = exp(-above);
            *sum += *chance;
            *gap += *chance * above;
        }
    }
    // The entropy of chances that fall as e to the power of the gap: sums are 4 at most, so many multiply to no infinity.
    let mut conditional: f32 = sums.chunks(32).map(|some| libm::logf(some.iter().product())).sum();
    let mut regret = 0.0;
    for (((sum, gap), least), unit) in sums.iter().zip(&gaps).zip(&least).zip(units) {
        let expected = gap / sum;
        conditional += expected;
        regret += (least + expected) / unit;
    }
    let samples = units.len().max(1) as f32;
    let mean = |chances: &Vec<f32>| {
        chances.iter().zip(&sums).map(|(chance, sum)| chance / sum).sum::<f32>() / samples
    };
    let told = chances.iter().map(|one| entropy(mean(one))).sum::<f32>() - conditional / samples;
    told - REGRET * regret / samples
}

/// One outcome's part of it.
fn entropy(chance: f32) -> f32 {
    if chance > 1e-7 { -chance * libm::logf(chance) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// What samples miss in the points of a set: each sample wants one of these, or none.
    fn rows() -> impl Strategy<Value = Vec<Vec<f32>>> {
        prop::collection::vec(prop::collection::vec(0.0..8.0f32, 12), INDIVIDUALS)
    }

    proptest! {
        #[test]
        fn of_choices_that_tell_as_much_the_nearer_is_worth_more(near in rows(), farther in 0.1..8.0f32) {
            let far: Vec<Vec<f32>> =
                near.iter().map(|row| row.iter().map(|missed| missed + farther).collect()).collect();
            let units = [20.0; 12];
            let lost = worth(&slices(&near), &units) - worth(&slices(&far), &units);
            // What everybody misses everywhere tells nothing.
            prop_assert!((lost - REGRET * farther / 20.0).abs() < 1e-3, "{}", lost);
        }

        #[test]
        fn nothing_is_told_by_four_that_are_alike_and_never_more_than_which_of_four(rows in rows()) {
            // Where range is without end nothing is missed.
            let units = [f32::INFINITY; 12];
            let told = worth(&slices(&rows), &units);
            prop_assert!((-1e-4..=libm::logf(INDIVIDUALS as f32) + 1e-4).contains(&told), "{}", told);
            let alike = worth(&[rows[0].as_slice(); INDIVIDUALS], &units);
            prop_assert!(alike.abs() < 1e-4, "{}", alike);
        }
    }
}
