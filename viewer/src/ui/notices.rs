//! What the program tells, for some seconds: cards in the lower left corner of the pictures, above the vote buttons. Each
//! is as high as its text needs, and a click takes it away or, if it has one, asks for its event.

use std::sync::Arc;
use std::time::Duration;

use egui::{
    Area, Color32, CursorIcon, Galley, Id, Order, Rect, Role, Sense, Stroke, StrokeKind, Ui, Vec2,
    WidgetInfo, pos2, vec2,
};

use super::theme::{self, Palette};
use super::widgets::ask;
use crate::event::Event;

/// Notices that are shown at a time.
const MAX: usize = 3;
/// Space between the lowest and the lower left corner of the pictures: there are vote buttons.
const MARGIN: Vec2 = vec2(14.0, 56.0);
/// Between two.
const GAP: f32 = 8.0;
const PADDING: Vec2 = vec2(12.0, 8.0);
/// Text is no wider than that, in points.
const WIDTH: f32 = 460.0;
/// How long a notice stays after the pointer has left it, in seconds.
const LINGER_S: f64 = 2.0;
/// Characters that people read in a second.
const READ_PER_S: f64 = 20.0;

/// How a notice looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// For information.
    Info,
    /// Something was done.
    Success,
    /// Something deserves attention.
    Warning,
    /// Something failed; stays longer.
    Error,
}

impl Tone {
    /// How long it stays, in seconds, besides the time that reading takes.
    fn seconds(self) -> f64 {
        match self {
            Self::Info | Self::Success => 3.0,
            Self::Warning => 6.0,
            Self::Error => 10.0,
        }
    }
}

struct Notice {
    number: u64,
    tone: Tone,
    text: String,
    /// What a click asks for.
    event: Option<Event>,
    /// When it goes, by egui's clock; `None` until it was shown.
    ends_s: Option<f64>,
}

/// Those that are shown, oldest first.
#[derive(Default)]
pub struct Notices {
    list: Vec<Notice>,
    /// How many there ever were.
    count: u64,
}

impl Notices {
    pub fn add(&mut self, tone: Tone, text: String, event: Option<Event>) {
        self.count += 1;
        // What is said again is said once, from now on.
        self.list.retain(|notice| notice.text != text);
        self.list.push(Notice { number: self.count, tone, text, event, ends_s: None });
        if self.list.len() > MAX {
            self.list.remove(0);
        }
    }

    /// Draws them over the pictures in `area`.
    pub fn show(&mut self, ui: &Ui, area: Rect) {
        let now_s = ui.input(|input| input.time);
        for notice in &mut self.list {
            let stays_s = notice.tone.seconds() + notice.text.chars().count() as f64 / READ_PER_S;
            notice.ends_s.get_or_insert(now_s + stays_s);
        }
        self.list.retain(|notice| notice.ends_s.is_none_or(|ends_s| ends_s > now_s));
        // Up to the vote buttons of the upper pictures; the newest is shown whatever its height.
        let (mut bottom, highest) = (area.bottom() - MARGIN.y, area.center().y);
        let mut shown = self.list.len();
        while let Some(at) = shown.checked_sub(1) {
            let (rect, galley) = self.list[at].place(ui, area, bottom);
            if rect.top() < highest && shown < self.list.len() {
                break;
            }
            self.list[at].show(ui, rect, galley, now_s);
            (bottom, shown) = (rect.top() - GAP, at);
        }
        self.list.drain(..shown);
        let next_s = self.list.iter().filter_map(|notice| notice.ends_s).fold(f64::INFINITY, f64::min);
        if next_s.is_finite() {
            ui.ctx().request_repaint_after(Duration::from_secs_f64((next_s - now_s).max(0.0)));
        }
    }
}

impl Notice {
    /// Where it is, if that is its lower edge, and its text.
    fn place(&self, ui: &Ui, area: Rect, bottom: f32) -> (Rect, Arc<Galley>) {
        let width = WIDTH.min(area.width() - 2.0 * (MARGIN.x + PADDING.x));
        let font = egui::TextStyle::Body.resolve(ui.style());
        let galley = ui.painter().layout(self.text.clone(), font, Palette::of(ui.visuals()).text, width);
        let size = galley.size() + 2.0 * PADDING;
        (Rect::from_min_size(pos2(area.left() + MARGIN.x, bottom - size.y), size), galley)
    }

    fn show(&mut self, ui: &Ui, rect: Rect, galley: Arc<Galley>, now_s: f64) {
        let layer = Area::new(Id::unique(("notice", self.number))).order(Order::Foreground);
        let response = layer.fixed_pos(rect.min).show(ui.ctx(), |ui| {
            let palette = Palette::of(ui.visuals());
            let response = ui.allocate_rect(rect, Sense::click());
            let lit = response.hovered();
            let line = Stroke::new(1.0, if lit { self.color(palette) } else { palette.line });
            ui.painter().add(theme::card_shadow().as_shape(rect, theme::RADIUS));
            ui.painter().rect(rect, theme::RADIUS, palette.raised, line, StrokeKind::Inside);
            let strip = Rect::from_min_size(rect.min, vec2(4.0, rect.height())).shrink2(vec2(0.0, 6.0));
            ui.painter().rect_filled(strip.translate(vec2(3.0, 0.0)), 2, self.color(palette));
            ui.painter().galley(rect.min + PADDING, galley, palette.text);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &self.text));
            response
        });
        let response = response.inner.on_hover_cursor(CursorIcon::PointingHand);
        if response.clicked() {
            self.event.take().into_iter().for_each(|event| ask(ui.ctx(), event));
            self.ends_s = Some(now_s);
            ui.ctx().request_repaint();
        } else if response.hovered() {
            self.ends_s = self.ends_s.map(|ends_s| ends_s.max(now_s + LINGER_S));
        }
    }

    fn color(&self, palette: &Palette) -> Color32 {
        match self.tone {
            Tone::Info => palette.weak,
            Tone::Success => palette.accent,
            Tone::Warning => palette.warning,
            Tone::Error => palette.danger,
        }
    }
}
