//! What one gene may be, in codes, so that equal steps of a logarithmic gene are equal ratios.

/// The codes that a kind allows a gene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Allowed {
    /// `(min, typical, max)`, or one number: most members are near the typical one, none is outside.
    Near { min: u32, typical: u32, max: u32 },
    /// `(min, max)`: all alike.
    Anywhere { min: u32, max: u32 },
    /// `[a, b]`, rising: all alike, and nothing between them. So are genes of scale choice, and no others.
    OneOf(Vec<u32>),
}

impl Allowed {
    /// The first and the last code.
    pub fn ends(&self) -> (u32, u32) {
        match self {
            Self::Near { min, max, .. } | Self::Anywhere { min, max } => (*min, *max),
            Self::OneOf(codes) => (codes[0], codes[codes.len() - 1]),
        }
    }

    /// The code that members are nearest to.
    pub fn typical(&self) -> u32 {
        match self {
            Self::Near { typical, .. } => *typical,
            Self::Anywhere { min, max } => min.midpoint(*max),
            Self::OneOf(codes) => codes[0],
        }
    }

    pub fn contains(&self, code: u32) -> bool {
        self.nearest(code) == code
    }

    /// Whether there is but one code.
    pub fn is_fixed(&self) -> bool {
        let (min, max) = self.ends();
        min == max
    }

    /// The allowed code that is nearest; of two the lower one.
    pub fn nearest(&self, code: u32) -> u32 {
        match self {
            Self::OneOf(codes) => *codes.iter().min_by_key(|one| one.abs_diff(code)).unwrap_or(&code),
            _ => {
                let (min, max) = self.ends();
                code.clamp(min, max)
            }
        }
    }

    /// How far a code is from the nearest allowed one, in units of how far members stray: 0 inside, and 1 at most, for what
    /// is wholly different cannot be more so. `last` is the gene's last code.
    pub fn excess(&self, code: u32, last: u32) -> f32 {
        let gap = self.nearest(code).abs_diff(code);
        match self {
            Self::OneOf(_) => f32::from(u8::from(gap > 0)),
            _ => (gap as f32 / self.stray(last)).min(1.0),
        }
    }

    /// How far a code is from the typical one, in the same units.
    pub fn deviation(&self, code: u32, last: u32) -> f32 {
        match self {
            Self::OneOf(_) => self.excess(code, last),
            _ => self.typical().abs_diff(code) as f32 / self.stray(last),
        }
    }

    /// Half the width, but for a gene that hardly strays a sixteenth of all its codes.
    fn stray(&self, last: u32) -> f32 {
        let (min, max) = self.ends();
        (0.5 * (max - min) as f32).max(last as f32 / 16.0)
    }

    /// Those of the codes that are from `low` to `high`, if any.
    pub fn cut(&self, low: u32, high: u32) -> Option<Self> {
        let (min, max) = self.ends();
        let (min, max) = (min.max(low), max.min(high));
        match self {
            Self::OneOf(codes) => {
                let left: Vec<u32> =
                    codes.iter().copied().filter(|code| (low..=high).contains(code)).collect();
                (!left.is_empty()).then_some(Self::OneOf(left))
            }
            _ if min > max => None,
            Self::Near { typical, .. } => Some(Self::Near { min, typical: (*typical).clamp(min, max), max }),
            Self::Anywhere { .. } => Some(Self::Anywhere { min, max }),
        }
    }

    /// What either allows, and what lies between. The typical one is this one's.
    pub fn hull(&self, other: &Self) -> Self {
        if let (Self::OneOf(a), Self::OneOf(b)) = (self, other) {
            let mut both = [&a[..], b].concat();
            both.sort_unstable();
            both.dedup();
            return Self::OneOf(both);
        }
        let ((a_min, a_max), (b_min, b_max)) = (self.ends(), other.ends());
        Self::Near { min: a_min.min(b_min), typical: self.typical(), max: a_max.max(b_max) }
    }

    /// What a kind allows that lies between these, at a part 0 … ½ of the way. A choice is the nearer one's.
    pub fn blend(&self, other: &Self, part: f32) -> Self {
        let mix = |a: u32, b: u32| (a as f32 + (b as f32 - a as f32) * part).round() as u32;
        let ((a_min, a_max), (b_min, b_max)) = (self.ends(), other.ends());
        let (min, max) = (mix(a_min, b_min), mix(a_max, b_max));
        match (self, other) {
            (Self::OneOf(_), _) => self.clone(),
            (Self::Anywhere { .. }, Self::Anywhere { .. }) => Self::Anywhere { min, max },
            _ => Self::Near { min, typical: mix(self.typical(), other.typical()).clamp(min, max), max },
        }
    }
}
