//! What a walker remembers who stands in a pocket between trunks: on which side it goes around.
//!
//! Sliding alone ends where two trunks stand closer together than the body is wide, and among the trunks of four forests
//! such pockets are met every few hundred metres. So the walker puts a hand on the wall: from the pocket on it passes
//! every trunk on the same side, also backwards, until it is past the pocket. If that takes too long it turns round and
//! tries the other side, twice as far each time (as one searches a line both ways without knowing where: Baeza-Yates,
//! Culberson & Rawlins 1993), and at last stands still. Who turns or stops forgets all of it.

use glam::Vec2;

use super::trunks::Trunk;

/// A wish that turned by more than this is another wish: cos 15°.
const SAME_WISH_COS: f32 = 0.966;
/// A walker that came this much farther than the pocket is out of it.
const PAST_M: f32 = 0.5;
/// The first side gets this way; each further try gets twice as much as the one before.
const FIRST_WAY_M: f32 = 4.0;
/// Less than this is standing still: a wall's corner and rounding.
const STILL_M: f32 = 1e-5;
/// Who has searched this far stands still.
const MOST_WAY_M: f32 = 64.0;

/// On which side a trunk is passed, seen from someone who faces it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The walker goes right.
    Right,
    /// The walker goes left.
    Left,
}

/// The way around a pocket, if one is being walked. None by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Detour {
    around: Option<Around>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Around {
    side: Side,
    /// Where the pocket is.
    from_m: Vec2,
    /// The trunk that the hand is on.
    wall: Option<Trunk>,
    /// The wish that led into it, unit length.
    toward: Vec2,
    /// Walked on this side.
    way_m: f32,
    /// May be walked on this side.
    most_m: f32,
}

impl Detour {
    /// Forgets a detour that another wish began, `toward` being the direction of this one.
    pub fn wish(&mut self, toward: Vec2) {
        self.around = self.around.filter(|around| around.toward.dot(toward) >= SAME_WISH_COS);
    }

    /// The side that is being passed on.
    pub fn side(&self) -> Option<Side> {
        self.around.map(|around| around.side)
    }

    /// The trunk that the hand is on.
    pub fn wall(&self) -> Option<Trunk> {
        self.around.and_then(|around| around.wall)
    }

    /// Puts the hand on a trunk, if a pocket is being left.
    pub fn hold(&mut self, wall: Trunk) {
        if let Some(around) = &mut self.around {
            around.wall = Some(wall);
        }
    }

    /// True if both sides were searched as far as anybody would.
    pub fn given_up(&self) -> bool {
        self.around.is_some_and(|around| around.most_m > MOST_WAY_M)
    }

    /// Begins in a pocket at `from_m`, unless one is being walked around already.
    pub fn begin(&mut self, side: Side, from_m: Vec2, toward: Vec2) {
        let begun = Around { side, from_m, wall: None, toward, way_m: 0.0, most_m: FIRST_WAY_M };
        self.around.get_or_insert(begun);
    }

    /// Counts what was walked; ends behind the pocket, turns round where a side takes too long or leads nowhere.
    pub fn walked(&mut self, from_m: Vec2, to_m: Vec2) {
        let Some(around) = &mut self.around else { return };
        around.way_m += from_m.distance(to_m);
        if (to_m - around.from_m).dot(around.toward) > PAST_M {
            self.around = None;
        } else if around.way_m > around.most_m || from_m.distance_squared(to_m) < STILL_M * STILL_M {
            around.side = around.side.other();
            around.wall = None;
            (around.way_m, around.most_m) = (0.0, 2.0 * around.most_m);
        }
    }
}

impl Side {
    /// The other one.
    pub fn other(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }
}
