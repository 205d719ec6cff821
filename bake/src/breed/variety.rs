//! How different from the best guess a person wants the others → those others, nearer to it or farther away than the ones
//! that would tell most.

use genescape_schema::Variety;

use super::places::{Places, has_room};
use super::spread::Spread;
use crate::seed::Dice;

/// How far towards another one a close variation goes, at least.
const MIN_REACH: f32 = 0.12;
/// Draws until one differs from all that are shown.
const TRIES: u32 = 24;

/// What others are made from.
pub struct Varied<'a> {
    pub spread: &'a Spread<'a>,
}

impl Varied<'_> {
    /// The others of a generation that begins with `shown`: as they are where the variety is the usual one.
    pub fn others(
        &self,
        variety: Variety,
        shown: &[Vec<f32>],
        others: Vec<Vec<f32>>,
        dice: &mut Dice,
    ) -> Vec<Vec<f32>> {
        // 0 for close variations, 1 for the usual, 2 for anything.
        let part = variety.part() / Variety::USUAL.part();
        match shown.first() {
            Some(best) if part < 1.0 => self.closer(part, best, others, dice),
            _ if part > 1.0 => self.farther(part - 1.0, shown, others, dice),
            _ => others,
        }
    }

    /// Each on the way from the best guess to what it was. What is of another kind is left as it is, as often as `part`
    /// says, and else gives way to a relative of the best guess: nothing is between two kinds.
    fn closer(&self, part: f32, best: &[f32], others: Vec<Vec<f32>>, dice: &mut Dice) -> Vec<Vec<f32>> {
        let count = others.len();
        let mut strangers = (count as f32 * part) as usize;
        let own = self.spread.kind(best);
        let component = self.spread.prior.component_of(best, dice);
        let mut made: Vec<Vec<f32>> = Vec::new();
        for other in others {
            let is_kin = self.spread.kind(&other) == own;
            if !is_kin && strangers > 0 {
                strangers -= 1;
                made.push(other);
                continue;
            }
            let mut towards = if is_kin { other } else { self.spread.drawn(component, dice) };
            let mut reach = MIN_REACH + (1.0 - MIN_REACH) * part;
            for _ in 0..TRIES {
                let near = self.between(component, best, &towards, reach, dice);
                let is_new = near != best && !made.contains(&near);
                if is_new {
                    made.push(near);
                    break;
                }
                // Codes are coarse: a short step may lead nowhere.
                reach = (1.3 * reach).min(1.0);
                towards = self.spread.drawn(component, dice);
            }
        }
        // A kind may be so narrow that there is nothing else.
        made.resize(count, best.to_vec());
        made
    }

    /// Some of them, as many as `part` says, give way to anything of kinds that are not shown and go with the rest somewhere.
    fn farther(
        &self,
        part: f32,
        shown: &[Vec<f32>],
        mut others: Vec<Vec<f32>>,
        dice: &mut Dice,
    ) -> Vec<Vec<f32>> {
        let count = (others.len() as f32 * part).ceil() as usize;
        let kept = others.len().saturating_sub(count);
        others.truncate(kept);
        for _ in 0..count {
            let seen: Vec<Option<&str>> =
                shown.iter().chain(&others).map(|one| self.spread.kind(one)).collect();
            let places: Vec<Places> = others.iter().map(|one| self.spread.places(one)).collect();
            let mut one = Vec::new();
            for _ in 0..TRIES {
                let component = self.spread.prior.any(dice);
                one = self.spread.drawn(component, dice);
                let kind = self.spread.kind(&one);
                let is_new = kind.is_none() || !seen.contains(&kind);
                if is_new && has_room(&places, self.spread.places(&one), shown.len()) {
                    break;
                }
            }
            others.push(one);
        }
        others
    }

    /// So far on the way from one point to another; genes whose values are names are those of either.
    fn between(&self, component: usize, from: &[f32], to: &[f32], reach: f32, dice: &mut Dice) -> Vec<f32> {
        let mut at = from.to_vec();
        for (gene, (x, to)) in at.iter_mut().zip(to).enumerate() {
            match self.spread.prior.is_choice(gene) {
                true if dice.chance(reach * reach) => *x = *to,
                true => {}
                false => *x += reach * (to - *x),
            }
        }
        (self.spread.legal)(component, &mut at);
        at
    }
}
