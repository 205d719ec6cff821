//! The interface's pictograms as vectors: sharp at every scale, one weight of line, no font needed.

use egui::epaint::PathShape;
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Ui, lerp, pos2};
use genescape_schema::Category;

#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::IntoStaticStr, strum::VariantArray)]
#[strum(serialize_all = "snake_case")]
pub enum Icon {
    Tree,
    Terrain,
    Sky,
    Undo,
    Redo,
    Next,
    Grid,
    Single,
    Compare,
    Genome,
    Stats,
    Settings,
    Help,
    Locked,
    Unlocked,
    Camera,
    Maximise,
    Close,
    Reset,
    Warning,
    Copy,
    Export,
    Family,
    Star,
    More,
}

impl From<Category> for Icon {
    fn from(category: Category) -> Self {
        [Self::Tree, Self::Terrain, Self::Sky][category as usize]
    }
}

/// Segments of a full circle.
const SEGMENTS: f32 = 28.0;

impl Icon {
    /// Draws it, as large as fits into the rectangle.
    pub fn paint(self, painter: &Painter, rect: Rect, color: Color32) {
        let side = rect.width().min(rect.height());
        let square = Rect::from_center_size(rect.center(), egui::Vec2::splat(side));
        let stroke = Stroke::new((side * 0.095).max(1.2), color);
        let at = |x: f32, y: f32| pos2(lerp(square.x_range(), x), lerp(square.y_range(), y));
        for (verb, numbers) in self.parts() {
            let points = || numbers.chunks_exact(2).map(|point| at(point[0], point[1])).collect();
            painter.add(match (verb, &numbers[..]) {
                ("fill", _) => PathShape::convex_polygon(points(), color, Stroke::NONE).into(),
                ("line", _) => Shape::line(points(), stroke),
                ("dot", &[x, y, radius]) => Shape::circle_filled(at(x, y), radius * side, color),
                ("ring", &[x, y, radius]) => {
                    Shape::circle_stroke(at(x, y), radius * side, Stroke::new(0.17 * side, color))
                }
                ("arc", &[x, y, radius, from_deg, to_deg]) => {
                    Shape::line(arc(at(x, y), radius * side, from_deg, to_deg), stroke)
                }
                part => unreachable!("{part:?} is no part of a pictogram"),
            });
        }
    }

    /// The same around a point.
    pub fn paint_at(self, painter: &Painter, center: Pos2, side: f32, color: Color32) {
        self.paint(painter, Rect::from_center_size(center, egui::Vec2::splat(side)), color);
    }

    /// The same in the next place of a layout.
    pub fn show(self, ui: &mut Ui, width: f32, height: f32, color: Color32) {
        let (rect, _) = ui.allocate_exact_size(egui::vec2(width, height), egui::Sense::hover());
        self.paint(ui.painter(), rect, color);
    }

    fn parts(self) -> impl Iterator<Item = (&'static str, Vec<f32>)> {
        self.drawing().split("; ").map(|part| {
            let (verb, numbers) = part.split_once(' ').unwrap_or((part, ""));
            (verb, numbers.split(' ').filter_map(|number| number.parse().ok()).collect())
        })
    }

    /// Its line in `icons.txt`: parts in a unit square, x right and y down. A filled convex polygon or a line through
    /// points; a dot or a ring of twice the usual weight by centre and radius; an arc by centre, radius and two angles in
    /// degrees, clockwise from the right.
    fn drawing(self) -> &'static str {
        let mut lines = include_str!("icons.txt").lines().filter_map(|line| line.split_once(": "));
        lines.find(|(name, _)| *name == <&str>::from(self)).map_or("", |(_, drawing)| drawing)
    }
}

/// Points of part of a circle; angles in degrees, clockwise from the right.
pub fn arc(center: Pos2, radius: f32, from_deg: f32, to_deg: f32) -> Vec<Pos2> {
    let steps = (SEGMENTS * (to_deg - from_deg).abs() / 360.0).ceil().max(1.0) as usize;
    let point = |step: usize| {
        let angle_rad = (from_deg + (to_deg - from_deg) * step as f32 / steps as f32).to_radians();
        let (sin, cos) = libm::sincosf(angle_rad);
        center + egui::vec2(cos, sin) * radius
    };
    (0..=steps).map(point).collect()
}

#[cfg(test)]
mod tests {
    use strum::VariantArray;

    use super::*;

    #[test]
    fn every_part_of_every_pictogram_is_understood_and_lies_within_it() {
        for icon in Icon::VARIANTS {
            for (verb, numbers) in icon.parts() {
                let places = match (verb, numbers.len()) {
                    ("fill", 6 | 8) => &numbers[..],
                    ("line", 4..) if numbers.len() % 2 == 0 => &numbers[..],
                    ("dot" | "ring", 3) | ("arc", 5) => &numbers[..3],
                    _ => panic!("{icon:?}: {verb} {numbers:?}"),
                };
                assert!(places.iter().all(|place| (0.0..=1.0).contains(place)), "{icon:?}: {numbers:?}");
                let written =
                    icon.drawing().split([' ', ';']).filter(|word| word.parse::<f32>().is_ok()).count();
                assert_eq!(
                    written,
                    icon.parts().map(|(_, numbers)| numbers.len()).sum::<usize>(),
                    "{icon:?}"
                );
            }
        }
    }
}
