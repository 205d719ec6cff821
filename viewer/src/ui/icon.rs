//! The interface's pictograms as vectors: sharp at every scale, one weight of line, no font needed.

use egui::epaint::PathShape;
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Ui, lerp, pos2};
use genescape_schema::Category;

#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::VariantArray)]
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

    /// Its parts in a unit square, x right and y down: a filled convex polygon or a line through points; a dot or a ring
    /// of twice the usual weight by centre and radius; an arc by centre, radius and two angles in degrees, clockwise from
    /// the right.
    fn drawing(self) -> &'static str {
        match self {
            Self::Tree => {
                "fill .5 .02 .76 .4 .24 .4; fill .5 .22 .88 .78 .12 .78; \
                 fill .43 .78 .57 .78 .57 .97 .43 .97"
            }
            Self::Terrain => "fill .4 .16 .8 .86 0 .86; fill .74 .42 1 .86 .48 .86",
            Self::Sky => {
                "dot .5 .5 .21; line .5 .04 .5 .17; line .5 .83 .5 .96; line .04 .5 .17 .5; \
                 line .83 .5 .96 .5; line .175 .175 .267 .267; line .733 .733 .825 .825; \
                 line .175 .825 .267 .733; line .733 .267 .825 .175"
            }
            Self::Undo => {
                "line .36 .1 .13 .33 .36 .56; line .13 .33 .6 .33; arc .6 .59 .26 -90 90; \
                 line .6 .85 .3 .85"
            }
            Self::Redo => {
                "line .64 .1 .87 .33 .64 .56; line .87 .33 .4 .33; arc .4 .59 .26 -90 -270; \
                 line .4 .85 .7 .85"
            }
            Self::Next => "line .1 .5 .88 .5; line .58 .2 .88 .5 .58 .8",
            Self::Grid => {
                "fill .1 .1 .45 .1 .45 .45 .1 .45; fill .55 .1 .9 .1 .9 .45 .55 .45; \
                 fill .1 .55 .45 .55 .45 .9 .1 .9; fill .55 .55 .9 .55 .9 .9 .55 .9"
            }
            Self::Single => "line .1 .16 .9 .16 .9 .84 .1 .84 .1 .11",
            Self::Compare => "line .1 .16 .9 .16 .9 .84 .1 .84 .1 .11; fill .5 .16 .9 .16 .9 .84 .5 .84",
            Self::Genome => {
                "line .08 .2 .92 .2; line .08 .5 .92 .5; line .08 .8 .92 .8; dot .68 .2 .12; \
                 dot .3 .5 .12; dot .56 .8 .12"
            }
            Self::Stats => {
                "fill .1 .55 .27 .55 .27 .9 .1 .9; fill .415 .12 .585 .12 .585 .9 .415 .9; \
                 fill .73 .36 .9 .36 .9 .9 .73 .9"
            }
            Self::Settings => {
                "ring .5 .5 .26; fill .4 .02 .6 .02 .63 .25 .37 .25; fill .37 .75 .63 .75 .6 .98 .4 .98; \
                 fill .034 .347 .134 .173 .349 .262 .219 .488; \
                 fill .651 .738 .781 .512 .966 .653 .866 .827; \
                 fill .134 .827 .034 .653 .219 .512 .349 .738; \
                 fill .781 .488 .651 .262 .866 .173 .966 .347"
            }
            Self::Help => {
                "arc .5 .5 .43 0 360; arc .5 .38 .135 -180 60; line .567 .497 .5 .56 .5 .62; \
                 dot .5 .75 .06"
            }
            Self::Locked => {
                "fill .2 .46 .8 .46 .8 .92 .2 .92; arc .5 .36 .2 -180 0; line .3 .36 .3 .48; \
                 line .7 .36 .7 .48"
            }
            Self::Unlocked => {
                "line .2 .46 .8 .46 .8 .92 .2 .92 .2 .42; arc .5 .28 .2 -180 -20; line .3 .28 .3 .48"
            }
            Self::Camera => {
                "line .06 .28 .3 .28 .38 .14 .62 .14 .7 .28 .94 .28 .94 .84 .06 .84 .06 .23; \
                 arc .5 .55 .16 0 360"
            }
            Self::Maximise => {
                "line .58 .12 .88 .12 .88 .42; line .42 .88 .12 .88 .12 .58; line .88 .12 .58 .42; \
                 line .12 .88 .42 .58"
            }
            Self::Close => "line .2 .2 .8 .8; line .8 .2 .2 .8",
            Self::Reset => "arc .5 .54 .34 -40 240; line .28 .02 .33 .25 .1 .31",
            Self::Warning => "line .5 .1 .95 .88 .05 .88 .5 .1 .55 .19; line .5 .38 .5 .62; dot .5 .75 .06",
            Self::Copy => {
                "line .1 .34 .66 .34 .66 .92 .1 .92 .1 .3; line .34 .2 .34 .08 .9 .08 .9 .66 .78 .66"
            }
        }
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
