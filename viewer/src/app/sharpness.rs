//! At which part of full resolution each picture of one frame is drawn. Parts count sideways and upwards.

/// For all pictures of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sharpness {
    /// All at this part.
    Part(f32),
    /// What has to be drawn anew, at this part.
    New(f32),
    /// The same, and one picture that is as it should be but not yet sharp becomes so: one a frame, so that none takes long.
    Sharpen(f32),
    /// All at full resolution.
    Full,
}

/// A picture before the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Before {
    pub part: f32,
    /// It shows what it should.
    pub is_right: bool,
    /// It shows some landscape, and another is about to replace it.
    pub is_outdated: bool,
}

impl Sharpness {
    /// The part at which one picture is shown; `None` if it stays as it is, whatever it shows. `sharpened`: another became
    /// sharp in this frame.
    pub fn of(self, before: Before, sharpened: &mut bool) -> Option<f32> {
        match self {
            Self::Part(part) => Some(part),
            Self::Full => Some(1.0),
            Self::New(_) | Self::Sharpen(_) if before.is_outdated => None,
            Self::New(part) | Self::Sharpen(part) if !before.is_right => Some(part),
            Self::Sharpen(_) if before.part < 1.0 && !std::mem::replace(sharpened, true) => Some(1.0),
            Self::New(_) | Self::Sharpen(_) => Some(before.part),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHARP: Before = Before { part: 1.0, is_right: true, is_outdated: false };
    const COARSE: Before = Before { part: 0.5, ..SHARP };
    const WRONG: Before = Before { is_right: false, ..SHARP };
    const OUTDATED: Before = Before { is_outdated: true, ..WRONG };

    fn parts(sharpness: Sharpness, before: [Before; 4]) -> [Option<f32>; 4] {
        let mut sharpened = false;
        before.map(|one| sharpness.of(one, &mut sharpened))
    }

    #[test]
    fn a_moving_camera_and_a_screenshot_spare_no_picture() {
        let all = [SHARP, COARSE, WRONG, OUTDATED];
        assert_eq!(parts(Sharpness::Part(0.4), all), [Some(0.4); 4]);
        assert_eq!(parts(Sharpness::Full, all), [Some(1.0); 4]);
    }

    #[test]
    fn what_is_there_stays_and_what_is_new_is_coarse_at_first() {
        let all = [SHARP, COARSE, WRONG, OUTDATED];
        assert_eq!(parts(Sharpness::New(0.4), all), [Some(1.0), Some(0.5), Some(0.4), None]);
    }

    #[test]
    fn one_picture_a_frame_becomes_sharp() {
        let all = [WRONG, COARSE, COARSE, OUTDATED];
        assert_eq!(parts(Sharpness::Sharpen(0.4), all), [Some(0.4), Some(1.0), Some(0.5), None]);
    }
}
