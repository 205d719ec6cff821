//! The area for pictures → the rectangle of each view, on whole physical pixels. All views of an arrangement have the
//! same size to the pixel, so that one camera gives bit-identical projections.

use egui::{Rect, pos2, vec2};
use genescape_schema::INDIVIDUALS;

use crate::event::Arrangement;

/// Space between pictures, in physical pixels at a scale of 1.
const GAP_PT: f32 = 4.0;

/// Where one view's picture is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Which landscape: less than [`INDIVIDUALS`].
    pub view: usize,
    /// In points; whole physical pixels.
    pub rect: Rect,
    /// Width and height of its render target in physical pixels; at least 1.
    pub size_px: [u32; 2],
}

/// The views that are on the screen. Those of [`Arrangement::Compare`] have the same rectangle: left, then right.
pub fn slots(area: Rect, arrangement: Arrangement, pixels_per_point: f32) -> Vec<Slot> {
    let scale = pixels_per_point;
    let low = (area.min.to_vec2() * scale).ceil();
    let size = ((area.max.to_vec2() * scale).floor() - low).max(vec2(1.0, 1.0));
    let slot = |view: usize, x: f32, y: f32, w: f32, h: f32| Slot {
        view: view.min(INDIVIDUALS - 1),
        rect: Rect::from_min_size(pos2(x / scale, y / scale), vec2(w / scale, h / scale)),
        size_px: [w as u32, h as u32],
    };
    match arrangement {
        Arrangement::One(view) => vec![slot(view, low.x, low.y, size.x, size.y)],
        Arrangement::Compare { left, right } => {
            [left, right].map(|view| slot(view, low.x, low.y, size.x, size.y)).into()
        }
        Arrangement::Grid => {
            let gap = (GAP_PT * scale).round();
            let half = ((size - vec2(gap, gap)) * 0.5).floor().max(vec2(1.0, 1.0));
            let corner = |view: usize| {
                (low.x + (view % 2) as f32 * (half.x + gap), low.y + (view / 2) as f32 * (half.y + gap))
            };
            (0..INDIVIDUALS)
                .map(|view| {
                    let (x, y) = corner(view);
                    slot(view, x, y, half.x, half.y)
                })
                .collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn arrangement() -> impl Strategy<Value = Arrangement> {
        prop_oneof![
            Just(Arrangement::Grid),
            (0..4usize).prop_map(Arrangement::One),
            (0..4usize, 0..4usize).prop_map(|(left, right)| Arrangement::Compare { left, right }),
        ]
    }

    proptest! {
        #[test]
        fn views_are_equal_whole_pixels_and_lie_apart_inside_the_area(
            arrangement in arrangement(), x in 0f32..50., y in 0f32..90., w in 120f32..2500., h in 90f32..1400.,
            scale in prop_oneof![Just(1.0f32), Just(1.25), Just(1.5), Just(2.0), 0.5f32..3.0],
        ) {
            let area = Rect::from_min_size(pos2(x, y), vec2(w, h));
            let slots = slots(area, arrangement, scale);
            for slot in &slots {
                prop_assert!(area.expand(0.01).contains_rect(slot.rect), "{:?} in {area:?}", slot.rect);
                prop_assert_eq!(slot.size_px, slots[0].size_px);
                let px = slot.rect.min.to_vec2() * scale;
                prop_assert!((px - px.round()).length() < 2e-2, "{px:?}");
                prop_assert!((slot.rect.width() * scale - slot.size_px[0] as f32).abs() < 2e-2);
            }
            let together: f32 = slots.iter().map(|slot| slot.rect.area()).sum();
            if arrangement == Arrangement::Grid {
                prop_assert_eq!(slots.len(), 4);
                prop_assert!(together > area.area() - (w + h) * 12.0 / scale.min(1.0), "little is wasted");
                for (at, a) in slots.iter().enumerate() {
                    prop_assert!(slots[at + 1..].iter().all(|b| !a.rect.shrink(0.01).intersects(b.rect)));
                }
            }
        }
    }
}
