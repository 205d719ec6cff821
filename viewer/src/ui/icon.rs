//! The interface's pictograms as vectors in a unit square (x right, y down): sharp at every scale, one weight of line,
//! no font needed.

use egui::epaint::PathShape;
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, lerp, pos2};
use genescape_schema::Category;

/// A pictogram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// A conifer.
    Tree,
    /// Two peaks.
    Terrain,
    /// A sun.
    Sky,
    /// An arrow that turns back.
    Undo,
    /// An arrow that turns on.
    Redo,
    /// An arrow ahead.
    Next,
    /// Four panes.
    Grid,
    /// One pane.
    Single,
    /// A pane in two halves.
    Compare,
    /// Three sliders.
    Genome,
    /// A graph of bars.
    Stats,
    /// Two switches.
    Settings,
    /// A question mark in a ring.
    Help,
    /// A closed lock.
    Locked,
    /// An open lock.
    Unlocked,
    /// A camera.
    Camera,
    /// Arrows into corners.
    Maximise,
    /// A cross.
    Close,
    /// An arrow in a circle.
    Reset,
    /// A triangle with an exclamation mark.
    Warning,
    /// Two sheets.
    Copy,
}

impl From<Category> for Icon {
    fn from(category: Category) -> Self {
        [Self::Tree, Self::Terrain, Self::Sky][category as usize]
    }
}

/// A part of a pictogram.
enum Part {
    /// A filled convex polygon.
    Fill(&'static [(f32, f32)]),
    /// A line through points.
    Line(&'static [(f32, f32)]),
    /// A filled circle.
    Dot((f32, f32), f32),
    /// A ring of twice the usual weight.
    Bold((f32, f32), f32),
    /// Part of a circle, from and to in degrees, clockwise from the right.
    Arc((f32, f32), f32, f32, f32),
}

use Part::{Arc, Bold, Dot, Fill, Line};

/// Segments of a full circle.
const SEGMENTS: f32 = 28.0;

impl Icon {
    /// Draws it, as large as fits into the rectangle.
    pub fn paint(self, painter: &Painter, rect: Rect, color: Color32) {
        let side = rect.width().min(rect.height());
        let square = Rect::from_center_size(rect.center(), egui::Vec2::splat(side));
        let stroke = Stroke::new((side * 0.095).max(1.2), color);
        let at =
            |&(x, y): &(f32, f32)| -> Pos2 { pos2(lerp(square.x_range(), x), lerp(square.y_range(), y)) };
        for part in self.parts() {
            painter.add(match part {
                Fill(points) => {
                    PathShape::convex_polygon(points.iter().map(at).collect(), color, Stroke::NONE).into()
                }
                Line(points) => Shape::line(points.iter().map(at).collect(), stroke),
                Dot(center, radius) => Shape::circle_filled(at(center), radius * side, color),
                Bold(center, radius) => {
                    Shape::circle_stroke(at(center), radius * side, Stroke::new(0.17 * side, color))
                }
                Arc(center, radius, from, to) => {
                    Shape::line(arc(at(center), radius * side, *from, *to), stroke)
                }
            });
        }
    }

    fn parts(self) -> &'static [Part] {
        match self {
            Self::Tree => &[
                Fill(&[(0.5, 0.02), (0.76, 0.4), (0.24, 0.4)]),
                Fill(&[(0.5, 0.22), (0.88, 0.78), (0.12, 0.78)]),
                Fill(&[(0.43, 0.78), (0.57, 0.78), (0.57, 0.97), (0.43, 0.97)]),
            ],
            Self::Terrain => &[
                Fill(&[(0.4, 0.16), (0.8, 0.86), (0.0, 0.86)]),
                Fill(&[(0.74, 0.42), (1.0, 0.86), (0.48, 0.86)]),
            ],
            Self::Sky => &[
                Dot((0.5, 0.5), 0.21),
                Line(&[(0.5, 0.04), (0.5, 0.17)]),
                Line(&[(0.5, 0.83), (0.5, 0.96)]),
                Line(&[(0.04, 0.5), (0.17, 0.5)]),
                Line(&[(0.83, 0.5), (0.96, 0.5)]),
                Line(&[(0.175, 0.175), (0.267, 0.267)]),
                Line(&[(0.733, 0.733), (0.825, 0.825)]),
                Line(&[(0.175, 0.825), (0.267, 0.733)]),
                Line(&[(0.733, 0.267), (0.825, 0.175)]),
            ],
            Self::Undo => &[
                Line(&[(0.36, 0.1), (0.13, 0.33), (0.36, 0.56)]),
                Line(&[(0.13, 0.33), (0.6, 0.33)]),
                Arc((0.6, 0.59), 0.26, -90.0, 90.0),
                Line(&[(0.6, 0.85), (0.3, 0.85)]),
            ],
            Self::Redo => &[
                Line(&[(0.64, 0.1), (0.87, 0.33), (0.64, 0.56)]),
                Line(&[(0.87, 0.33), (0.4, 0.33)]),
                Arc((0.4, 0.59), 0.26, -90.0, -270.0),
                Line(&[(0.4, 0.85), (0.7, 0.85)]),
            ],
            Self::Next => &[Line(&[(0.1, 0.5), (0.88, 0.5)]), Line(&[(0.58, 0.2), (0.88, 0.5), (0.58, 0.8)])],
            Self::Grid => &[
                Fill(&[(0.1, 0.1), (0.45, 0.1), (0.45, 0.45), (0.1, 0.45)]),
                Fill(&[(0.55, 0.1), (0.9, 0.1), (0.9, 0.45), (0.55, 0.45)]),
                Fill(&[(0.1, 0.55), (0.45, 0.55), (0.45, 0.9), (0.1, 0.9)]),
                Fill(&[(0.55, 0.55), (0.9, 0.55), (0.9, 0.9), (0.55, 0.9)]),
            ],
            Self::Single => &[Line(&[(0.1, 0.16), (0.9, 0.16), (0.9, 0.84), (0.1, 0.84), (0.1, 0.11)])],
            Self::Compare => &[
                Line(&[(0.1, 0.16), (0.9, 0.16), (0.9, 0.84), (0.1, 0.84), (0.1, 0.11)]),
                Fill(&[(0.5, 0.16), (0.9, 0.16), (0.9, 0.84), (0.5, 0.84)]),
            ],
            Self::Genome => &[
                Line(&[(0.08, 0.2), (0.92, 0.2)]),
                Line(&[(0.08, 0.5), (0.92, 0.5)]),
                Line(&[(0.08, 0.8), (0.92, 0.8)]),
                Dot((0.68, 0.2), 0.12),
                Dot((0.3, 0.5), 0.12),
                Dot((0.56, 0.8), 0.12),
            ],
            Self::Stats => &[
                Fill(&[(0.1, 0.55), (0.27, 0.55), (0.27, 0.9), (0.1, 0.9)]),
                Fill(&[(0.415, 0.12), (0.585, 0.12), (0.585, 0.9), (0.415, 0.9)]),
                Fill(&[(0.73, 0.36), (0.9, 0.36), (0.9, 0.9), (0.73, 0.9)]),
            ],
            Self::Settings => &[
                Bold((0.5, 0.5), 0.26),
                Fill(&[(0.4, 0.02), (0.6, 0.02), (0.63, 0.25), (0.37, 0.25)]),
                Fill(&[(0.37, 0.75), (0.63, 0.75), (0.6, 0.98), (0.4, 0.98)]),
                Fill(&[(0.034, 0.347), (0.134, 0.173), (0.349, 0.262), (0.219, 0.488)]),
                Fill(&[(0.651, 0.738), (0.781, 0.512), (0.966, 0.653), (0.866, 0.827)]),
                Fill(&[(0.134, 0.827), (0.034, 0.653), (0.219, 0.512), (0.349, 0.738)]),
                Fill(&[(0.781, 0.488), (0.651, 0.262), (0.866, 0.173), (0.966, 0.347)]),
            ],
            Self::Help => &[
                Arc((0.5, 0.5), 0.43, 0.0, 360.0),
                Arc((0.5, 0.38), 0.135, -180.0, 60.0),
                Line(&[(0.567, 0.497), (0.5, 0.56), (0.5, 0.62)]),
                Dot((0.5, 0.75), 0.06),
            ],
            Self::Locked => &[
                Fill(&[(0.2, 0.46), (0.8, 0.46), (0.8, 0.92), (0.2, 0.92)]),
                Arc((0.5, 0.36), 0.2, -180.0, 0.0),
                Line(&[(0.3, 0.36), (0.3, 0.48)]),
                Line(&[(0.7, 0.36), (0.7, 0.48)]),
            ],
            Self::Unlocked => &[
                Line(&[(0.2, 0.46), (0.8, 0.46), (0.8, 0.92), (0.2, 0.92), (0.2, 0.42)]),
                Arc((0.5, 0.28), 0.2, -180.0, -20.0),
                Line(&[(0.3, 0.28), (0.3, 0.48)]),
            ],
            Self::Camera => &[
                Line(&[
                    (0.06, 0.28),
                    (0.3, 0.28),
                    (0.38, 0.14),
                    (0.62, 0.14),
                    (0.7, 0.28),
                    (0.94, 0.28),
                    (0.94, 0.84),
                    (0.06, 0.84),
                    (0.06, 0.23),
                ]),
                Arc((0.5, 0.55), 0.16, 0.0, 360.0),
            ],
            Self::Maximise => &[
                Line(&[(0.58, 0.12), (0.88, 0.12), (0.88, 0.42)]),
                Line(&[(0.42, 0.88), (0.12, 0.88), (0.12, 0.58)]),
                Line(&[(0.88, 0.12), (0.58, 0.42)]),
                Line(&[(0.12, 0.88), (0.42, 0.58)]),
            ],
            Self::Close => &[Line(&[(0.2, 0.2), (0.8, 0.8)]), Line(&[(0.8, 0.2), (0.2, 0.8)])],
            Self::Reset => {
                &[Arc((0.5, 0.54), 0.34, -40.0, 240.0), Line(&[(0.28, 0.02), (0.33, 0.25), (0.1, 0.31)])]
            }
            Self::Warning => &[
                Line(&[(0.5, 0.1), (0.95, 0.88), (0.05, 0.88), (0.5, 0.1), (0.55, 0.19)]),
                Line(&[(0.5, 0.38), (0.5, 0.62)]),
                Dot((0.5, 0.75), 0.06),
            ],
            Self::Copy => &[
                Line(&[(0.1, 0.34), (0.66, 0.34), (0.66, 0.92), (0.1, 0.92), (0.1, 0.3)]),
                Line(&[(0.34, 0.2), (0.34, 0.08), (0.9, 0.08), (0.9, 0.66), (0.78, 0.66)]),
            ],
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
