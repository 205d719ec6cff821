//! One gene: how its code (0 … 2^bits − 1) becomes a physical value in its unit, and back.

use std::fmt;

/// Which part of the landscape a gene shapes. Categories are voted on and bred separately (thesis, section 3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Category {
    /// The trees: form, leaves, where they stand.
    Tree,
    /// The land.
    Terrain,
    /// Sun, air and clouds.
    Sky,
}

impl Category {
    /// All three, in the order of files.
    pub const ALL: [Self; 3] = [Self::Tree, Self::Terrain, Self::Sky];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        ["tree", "terrain", "sky"][self as usize]
    }

    /// The category of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|category| category.name() == name)
    }
}

impl fmt::Display for Category {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// How a gene's codes are spread over its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// By equal differences.
    Linear,
    /// By equal ratios.
    Logarithmic,
    /// One code for each whole number.
    Integer,
    /// One code for each whole number, which is a name: what lies between two of them is no mean of both.
    Choice,
}

impl Scale {
    /// All four.
    pub const ALL: [Self; 4] = [Self::Linear, Self::Logarithmic, Self::Integer, Self::Choice];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        ["linear", "logarithmic", "integer", "choice"][self as usize]
    }

    /// Whether values are whole numbers.
    pub fn is_whole(self) -> bool {
        matches!(self, Self::Integer | Self::Choice)
    }

    /// The scale of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scale| scale.name() == name)
    }
}

/// A gene as `space.ron` declares it.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name, with the unit as suffix.
    pub name: String,
    /// The chromosome that it belongs to.
    pub category: Category,
    /// What it belongs together with: a child of two parents takes each group of genes whole from one of them. May be empty.
    pub group: String,
    /// 1 to 16; there are 2^bits codes.
    pub bits: u32,
    /// Values of the first and of the last code.
    pub range: (f64, f64),
    /// How the codes lie between them.
    pub scale: Scale,
    /// What to write after a value; may be empty.
    pub unit: String,
    /// One line on what it does.
    pub help: String,
    /// The code that is used where a file lacks the gene; `None` if no file may.
    pub default: Option<u32>,
    /// Landscapes are made without it: a world's own space declares a gene that the program does not know.
    pub is_unread: bool,
    /// Where its bits begin in the chromosome.
    pub(crate) offset: u32,
}

/// How far, in steps from code to code, a written value may lie from the value that is used before it is worth a
/// word: also what the shortest text may deviate.
const TOLERANCE_STEPS: f64 = 0.1;

impl Parameter {
    /// Whether it says which individual of its kind this is: no trait that a kind could have.
    pub fn is_seed(&self) -> bool {
        self.name.strip_suffix("_seed") == Some(self.category.name())
    }

    /// The greatest code.
    pub fn last_code(&self) -> u32 {
        (1 << self.bits) - 1
    }

    /// Where a code lies between the first, 0, and the last, 1.
    pub fn part(&self, code: u32) -> f32 {
        code as f32 / self.last_code() as f32
    }

    /// The code nearest to a part; parts out of 0 … 1 give the end.
    pub fn code_at(&self, part: f32) -> u32 {
        ((part * self.last_code() as f32).round() as u32).min(self.last_code())
    }

    /// The physical value of a code, in `unit`: a function of the code alone, the same bits on every machine.
    /// Codes beyond the last are the last.
    pub fn value(&self, code: u32) -> f64 {
        let ((low, high), last) = (self.range, self.last_code());
        let part = f64::from(code) / f64::from(last);
        match (code, self.scale) {
            (0, _) => low,
            (code, _) if code >= last => high,
            (_, Scale::Linear) => low + (high - low) * part,
            (_, Scale::Logarithmic) => low * libm::pow(high / low, part),
            (code, Scale::Integer | Scale::Choice) => low + f64::from(code),
        }
    }

    /// The code whose value is nearest; nearest in ratio on a logarithmic scale. Values out of range give the end.
    pub fn snap(&self, value: f64) -> u32 {
        // A cast saturates, and takes NaN to 0.
        (self.position(value).round() as u32).min(self.last_code())
    }

    /// Whether a value lies in the range.
    pub fn contains(&self, value: f64) -> bool {
        value >= self.range.0 && value <= self.range.1
    }

    /// Whether `value` is written closely enough that it is no surprise when `code` is used for it.
    pub fn is_written_as(&self, value: f64, code: u32) -> bool {
        self.contains(value) && (self.position(value) - f64::from(code)).abs() <= TOLERANCE_STEPS
    }

    /// The shortest decimal that stands for a code: it snaps back to it and lies within a tenth of a step of it.
    pub fn text(&self, code: u32) -> String {
        let value = self.value(code);
        let short = |digits: i32| {
            let tens = (0..digits.abs()).fold(1.0, |tens, _| tens * 10.0);
            let text = match digits {
                ..0 => format!("{}", (value / tens).round() * tens),
                _ => format!("{value:.*}", digits as usize),
            };
            let written: f64 = text.parse().ok()?;
            let zero = written == 0.0;
            self.is_written_as(written, code).then(|| if zero { "0".to_owned() } else { text })
        };
        (-6..=12).find_map(short).unwrap_or_else(|| value.to_string())
    }

    /// The value of a code with its unit, for people: `7.3 m`.
    pub fn value_text(&self, code: u32) -> String {
        format!("{} {}", self.text(code), self.unit).trim_end().to_owned()
    }

    /// The range with its unit, for people: `3 … 30 m`.
    pub fn range_text(&self) -> String {
        format!("{} … {} {}", self.range.0, self.range.1, self.unit).trim_end().to_owned()
    }

    /// A value in codes, not rounded.
    fn position(&self, value: f64) -> f64 {
        let ((low, high), last) = (self.range, f64::from(self.last_code()));
        match self.scale {
            Scale::Linear => (value - low) / (high - low) * last,
            Scale::Logarithmic => libm::log(value / low) / libm::log(high / low) * last,
            Scale::Integer | Scale::Choice => value - low,
        }
    }
}
