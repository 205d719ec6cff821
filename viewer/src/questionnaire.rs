//! What a person is asked after a walk: the thesis's questions on rendering (appendix B), and which of the four is best. Answers
//! say nothing of who gave them, or when.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use strum::{EnumMessage, VariantArray};

use crate::lod_mode::{TerrainLodMode, TreeLodMode};
use crate::options::Options;

/// Ratings are from 1 to this.
pub const MAX_RATING: u8 = 5;
/// Letters of a text that are kept.
pub const MAX_TEXT: usize = 2000;
/// A file of answers has fewer bytes.
pub const MAX_BYTES: u64 = 1 << 16;

/// What is rated. Its documentation is what is asked.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    strum::EnumMessage,
    strum::IntoStaticStr,
    strum::VariantArray,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Question {
    /// How smooth was walking through the scenes?
    Jerkiness,
    /// Sudden changes in the ground?
    GroundSudden,
    /// Smooth changes in the ground?
    GroundSmooth,
    /// Sudden changes in the sky?
    SkySudden,
    /// Smooth changes in the sky?
    SkySmooth,
    /// Sudden changes in the trees?
    TreesSudden,
    /// Smooth changes in the trees?
    TreesSmooth,
    /// How real did the scenes look?
    Realism,
    /// Was the program fast enough?
    Speed,
}

impl Question {
    /// What a person is asked.
    pub fn text(self) -> &'static str {
        self.get_documentation().unwrap_or_default()
    }

    /// What 1 means, and what [`MAX_RATING`].
    pub fn ends(self) -> [&'static str; 2] {
        match self {
            Self::Jerkiness => ["very smooth", "very jerky"],
            Self::Realism => ["not at all", "like a photograph"],
            Self::Speed => ["much too slow", "always"],
            _ => ["none at all", "extremely noticeable"],
        }
    }

    /// Its name in files.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// What a landscape can be best in.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    strum::IntoStaticStr,
    strum::VariantArray,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Aspect {
    Trees,
    Terrain,
    Sky,
    Overall,
}

impl Aspect {
    /// Its name in files and to people.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// Answers so far; what was left open is absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Answers {
    /// 1 to [`MAX_RATING`].
    pub ratings: BTreeMap<Question, u8>,
    /// Which landscape, 1 to 4, is best.
    pub best: BTreeMap<Aspect, u8>,
    /// Whether the bark of trees was seen to shift.
    pub bark_shifts: Option<bool>,
    /// What else was wrong with how scenes were shown.
    pub problems: String,
}

/// A file: answers, and what they were given on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Answers", default, deny_unknown_fields)]
pub struct AnswerSheet {
    /// The landscapes' generation.
    pub generation: u32,
    pub tree_lod: TreeLodMode,
    pub terrain_lod: TerrainLodMode,
    /// Pixels.
    pub tree_error_px: f32,
    pub terrain_error_px: f32,
    pub answers: Answers,
}

impl AnswerSheet {
    /// Answers to a walk through a generation with these options.
    pub fn new(generation: u32, options: &Options, answers: Answers) -> Self {
        Self {
            generation,
            tree_lod: options.tree_lod,
            terrain_lod: options.terrain_lod,
            tree_error_px: options.tree_error_px,
            terrain_error_px: options.terrain_error_px,
            answers,
        }
    }

    /// As a file's text.
    ///
    /// # Errors
    /// None: all of it can be written.
    pub fn to_ron(&self) -> Result<String, ron::Error> {
        let pretty = ron::ser::PrettyConfig::default().struct_names(true);
        Ok(ron::ser::to_string_pretty(self, pretty)? + "\n")
    }

    /// Reads a file's text.
    ///
    /// # Errors
    /// What is wrong, where, and what would be right.
    pub fn parse(text: &str) -> Result<Self, String> {
        let sheet: Self = ron::from_str(text).map_err(|error| error.to_string())?;
        let is_rating = |rating: &&u8| !(1..=MAX_RATING).contains(*rating);
        if let Some(rating) = sheet.answers.ratings.values().find(is_rating) {
            return Err(format!("ratings go from 1 to {MAX_RATING}, not {rating}"));
        }
        if let Some(best) = sheet.answers.best.values().find(|best| !(1..=4).contains(*best)) {
            return Err(format!("there are landscapes 1 to 4, not {best}"));
        }
        Ok(sheet)
    }
}

impl Answers {
    /// Whether nothing was answered.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// What is still open, in words; `None` if all that can be rated was.
    pub fn still_open(&self) -> Option<String> {
        let open = Question::VARIANTS.iter().filter(|question| !self.ratings.contains_key(question)).count();
        (open > 0).then(|| format!("{open} of {} questions are open", Question::VARIANTS.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn answers() -> impl Strategy<Value = Answers> {
        let rating = (prop::sample::select(Question::VARIANTS), 1..=MAX_RATING);
        let best = (prop::sample::select(Aspect::VARIANTS), 1..=4_u8);
        let lists = (
            prop::collection::btree_map(rating.0, rating.1, 0..9),
            prop::collection::btree_map(best.0, best.1, 0..4),
        );
        (lists, any::<Option<bool>>(), any::<String>()).prop_map(
            |((ratings, best), bark_shifts, problems)| Answers { ratings, best, bark_shifts, problems },
        )
    }

    proptest! {
        #[test]
        fn what_was_answered_is_read_again(answers in answers(), generation in any::<u32>()) {
            let sheet = AnswerSheet::new(generation, &Options::default(), answers);
            prop_assert_eq!(AnswerSheet::parse(&sheet.to_ron().expect("text")), Ok(sheet));
        }
    }

    #[test]
    fn what_cannot_be_is_told() {
        let told = |text: &str| AnswerSheet::parse(text).expect_err(text);
        assert!(told("Answers(answers: (ratings: {realism: 6}))").contains("1 to 5, not 6"));
        assert!(told("Answers(answers: (best: {sky: 0}))").contains("1 to 4, not 0"));
        assert!(told("Answers(answer: ())").contains("answer"));
        for question in Question::VARIANTS {
            assert!(question.text().ends_with('?') && !question.ends()[0].is_empty(), "{question:?}");
        }
    }
}
