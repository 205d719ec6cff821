//! Frame times and counts, beside the pictures or, in a small window, over them: a graph of the last frames, where the
//! GPU's time goes pass by pass and view by view, what was drawn, and how many trees have each level of detail.

use egui::{Align2, Color32, FontId, Frame, Margin, Rect, RichText, Sense, Shape, Stroke};
use egui::{Ui, pos2, vec2};
use genescape_schema::Category;

use super::model::Stats;
use super::theme::Palette;
use super::widgets::{ends, section};

/// Width of the panel or card, in points.
const WIDTH: f32 = 284.0;
/// With less room than this the panel becomes a card over the pictures, in points.
const DOCKED_FROM: f32 = 860.0;
/// Frames of 60 Hz take so long, in milliseconds.
const SMOOTH_MS: f32 = 1000.0 / 60.0;

/// Median and 99th percentile of times in milliseconds; zeros if there are none. The percentile is the least time that
/// at least 99 % of the frames do not exceed.
pub fn median_and_p99(frames_ms: &[f32]) -> (f32, f32) {
    let mut sorted: Vec<f32> = frames_ms.iter().copied().filter(|ms| ms.is_finite()).collect();
    sorted.sort_by(f32::total_cmp);
    let rank = |part: f32| {
        let at = ((part * sorted.len() as f32).ceil() as usize).max(1) - 1;
        sorted.get(at.min(sorted.len().saturating_sub(1))).copied().unwrap_or(0.0)
    };
    (rank(0.5), rank(0.99))
}

/// Draws it as a panel at the left of `ui` if there is room; false if not, and nothing was drawn. `counted`: of what
/// there are several at each level.
pub fn show_docked(ui: &mut Ui, stats: &Stats, counted: &str) -> bool {
    if ui.available_width() < DOCKED_FROM {
        return false;
    }
    let frame = Frame::NONE.fill(Palette::of(ui.visuals()).panel).inner_margin(Margin::same(12));
    egui::Panel::left("stats")
        .exact_size(WIDTH)
        .resizable(false)
        .frame(frame)
        .show_separator_line(false)
        .show(ui, |ui| body(ui, stats, counted, ui.available_height()));
    true
}

/// Draws the card over the lower left of `area`.
pub fn show_card(ui: &mut Ui, stats: &Stats, counted: &str, area: Rect) {
    let width = WIDTH.min(area.width() - 24.0);
    egui::Area::new(egui::Id::unique("stats"))
        .fixed_pos(area.left_bottom() + vec2(12.0, -12.0))
        .pivot(Align2::LEFT_BOTTOM)
        .constrain_to(area)
        .interactable(false)
        .accessible_name("Frame times")
        .show(ui.ctx(), |ui| {
            // The card is dark in both themes, as everything that lies on pictures.
            ui.set_style(ui.ctx().style_of(egui::Theme::Dark));
            let frame = Frame::NONE
                .fill(Color32::from_rgba_unmultiplied(17, 19, 19, 232))
                .corner_radius(10)
                .inner_margin(Margin::same(12));
            frame.show(ui, |ui| {
                ui.set_width(width - 24.0);
                body(ui, stats, counted, area.height() - 60.0);
            });
        });
}

fn body(ui: &mut Ui, stats: &Stats, counted: &str, room: f32) {
    let palette = Palette::of(ui.visuals());
    ui.spacing_mut().item_spacing.y = 2.0;
    ui.spacing_mut().interact_size.y = 18.0;
    frames(ui, stats);
    line(ui, "CPU to record", &format!("{:.2} ms", stats.cpu_record_ms));
    line(ui, "Triangles", &thousands(stats.triangles.iter().sum()));
    let (draws, max) = (stats.draws.iter().sum::<u32>(), stats.draws.iter().max().unwrap_or(&0));
    line(ui, "Draws", &format!("{draws} (at most {max} a view)"));
    if room > 330.0 {
        gpu(ui, stats);
    }
    if room > 420.0 {
        levels(ui, &stats.trees_per_level, counted);
    }
    if !stats.adapter.is_empty() {
        let text = RichText::new(&stats.adapter).small().color(palette.weak);
        ui.add(egui::Label::new(text).truncate());
    }
}

fn line(ui: &mut Ui, name: &str, value: &str) {
    let name = RichText::new(name).color(Palette::of(ui.visuals()).weak);
    ui.horizontal(|ui| ends(ui, |ui| ui.label(name), |ui| _ = ui.label(value)));
}

fn frames(ui: &mut Ui, stats: &Stats) {
    let weak = Palette::of(ui.visuals()).weak;
    let (median, p99) = median_and_p99(&stats.frames_ms);
    ui.horizontal(|ui| {
        let fps = if median > 0.0 { 1000.0 / median } else { 0.0 };
        ui.label(RichText::new(format!("{fps:.0}")).size(24.0));
        let text = RichText::new(format!("median {median:.1} · p99 {p99:.1} ms")).color(weak);
        ends(ui, |ui| ui.label(RichText::new("fps").color(weak)), |ui| _ = ui.label(text));
    });
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 54.0), Sense::hover());
    graph(ui, rect, &stats.frames_ms, p99);
}

/// One bar a frame; the line is 60 Hz.
fn graph(ui: &Ui, rect: Rect, frames_ms: &[f32], p99: f32) {
    let palette = Palette::of(ui.visuals());
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    painter.rect_filled(rect, 4, palette.sunken);
    let top = (p99 * 1.25).max(1.3 * SMOOTH_MS);
    let height = |ms: f32| rect.height() * (ms / top).clamp(0.0, 1.0);
    let shown = &frames_ms[frames_ms.len().saturating_sub(rect.width() as usize)..];
    let step = rect.width() / shown.len().max(60) as f32;
    for (at, &ms) in shown.iter().rev().enumerate() {
        let corner = rect.right_bottom() - vec2(at as f32 * step, 0.0);
        let color = match ms / SMOOTH_MS {
            2.0.. => palette.danger,
            1.05.. => palette.warning,
            _ => palette.accent,
        };
        let bar = Rect::from_min_max(corner - vec2(step, height(ms)), corner);
        painter.rect_filled(bar, 0, color);
    }
    let y = rect.bottom() - height(SMOOTH_MS);
    let dash = Stroke::new(1.0, palette.weak);
    painter.extend(Shape::dashed_line(&[pos2(rect.left(), y), pos2(rect.right(), y)], dash, 3.0, 3.0));
    let font = FontId::proportional(10.0);
    painter.text(pos2(rect.left() + 4.0, y), Align2::LEFT_BOTTOM, "60 Hz", font, palette.weak);
}

/// A row for each pass: its name, the four views' shares as a stacked bar, and their sum.
fn gpu(ui: &mut Ui, stats: &Stats) {
    let palette = Palette::of(ui.visuals());
    let total: f32 = stats.gpu.iter().flat_map(|pass| pass.ms).sum();
    section(ui, "GPU");
    if stats.gpu.is_empty() {
        ui.label(RichText::new("This adapter tells no times.").color(palette.weak));
        return;
    }
    line(ui, "All passes, all views", &format!("{total:.2} ms"));
    for pass in &stats.gpu {
        let sum: f32 = pass.ms.iter().sum();
        let (_, rect) = ui.allocate_space(vec2(ui.available_width(), 17.0));
        let font = FontId::proportional(12.5);
        let painter = ui.painter();
        let mut x = rect.left() + 96.0;
        let room = (rect.width() - 96.0 - 58.0).max(10.0);
        for (view, &ms) in pass.ms.iter().enumerate() {
            let width = room * (ms / total.max(1e-6)).clamp(0.0, 1.0);
            let bar = Rect::from_min_size(pos2(x, rect.top() + 4.0), vec2(width, 9.0));
            let color = palette.category(Category::Sky).gamma_multiply(1.0 - 0.17 * view as f32);
            painter.rect_filled(bar, 0, color);
            x += width;
        }
        painter.text(rect.left_center(), Align2::LEFT_CENTER, &pass.name, font.clone(), palette.text);
        let value = format!("{sum:.2} ms");
        painter.text(rect.right_center(), Align2::RIGHT_CENTER, value, font, palette.text);
    }
}

/// A bar for each level of detail, finest at the left, with the number of trees or copies, as `counted` says, above.
fn levels(ui: &mut Ui, trees_per_level: &[u32], counted: &str) {
    let palette = Palette::of(ui.visuals());
    let all: u32 = trees_per_level.iter().sum();
    if trees_per_level.is_empty() {
        return;
    }
    section(ui, &format!("{} BY LEVEL, FINEST FIRST", counted.to_uppercase()));
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 46.0), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, format!("{all} {counted}")));
    let max = trees_per_level.iter().max().copied().unwrap_or(1).max(1) as f32;
    let step = rect.width() / trees_per_level.len() as f32;
    for (level, &trees) in trees_per_level.iter().enumerate() {
        let height = (rect.height() - 14.0) * trees as f32 / max;
        let left = rect.left() + level as f32 * step;
        let top = pos2(left + 1.0, rect.bottom() - height);
        let bar = Rect::from_min_max(top, pos2(left + step - 1.0, rect.bottom()));
        ui.painter().rect_filled(bar, 2, palette.category(Category::Tree));
        let place = pos2(bar.center().x, bar.top() - 1.0);
        let font = FontId::proportional(10.0);
        if step > 22.0 && trees > 0 {
            ui.painter().text(place, Align2::CENTER_BOTTOM, short(u64::from(trees)), font, palette.weak);
        }
    }
    let title = if counted == "trees" { "Trees drawn" } else { "Copies drawn" };
    line(ui, title, &thousands(u64::from(all)));
}

/// Between groups of three digits: a space that does not break.
const SPACE: char = '\u{a0}';

/// 1234567 → "1 234 567".
pub fn thousands(number: u64) -> String {
    let mut text = number.to_string();
    for at in (1..text.len()).rev().filter(|at| (text.len() - at).is_multiple_of(3)).collect::<Vec<_>>() {
        text.insert(at, SPACE);
    }
    text
}

/// 12345 → "12k".
fn short(number: u64) -> String {
    match number {
        0..1000 => number.to_string(),
        1000..10_000 => format!("{:.1}k", number as f64 / 1e3),
        10_000..1_000_000 => format!("{}k", number / 1000),
        _ => format!("{:.1}M", number as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn half_of_the_frames_are_within_the_median_and_99_percent_within_p99(
            frames in proptest::collection::vec(0.1f32..100.0, 1..300)
        ) {
            let (median, p99) = median_and_p99(&frames);
            let within = |limit: f32| frames.iter().filter(|&&ms| ms <= limit).count() as f32;
            let below = |limit: f32| frames.iter().filter(|&&ms| ms < limit).count() as f32;
            let count = frames.len() as f32;
            prop_assert!(within(median) >= 0.5 * count && below(median) <= 0.5 * count);
            prop_assert!(within(p99) >= 0.989 * count && below(p99) <= 0.991 * count);
        }

        #[test]
        fn thousands_only_adds_spaces(number in any::<u64>()) {
            let text = thousands(number);
            prop_assert_eq!(text.replace(SPACE, ""), number.to_string());
            let whole = text.split(SPACE).skip(1).all(|group| group.len() == 3);
            prop_assert!(whole, "{}", text);
            let digits = number.to_string().len();
            prop_assert_eq!(text.split(SPACE).count(), digits.div_ceil(3));
        }
    }

    #[test]
    fn no_frames_are_no_fault() {
        assert_eq!(median_and_p99(&[]), (0.0, 0.0));
        assert_eq!(median_and_p99(&[f32::NAN]), (0.0, 0.0));
    }
}
