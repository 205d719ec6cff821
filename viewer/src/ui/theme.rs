//! Colours, sizes and fonts of the whole interface, for light and for dark: the landscapes are what one looks at, so
//! the chrome is grey, slim and quiet, and colour means a category (trees green, terrain ochre, sky blue).
//! What lies on pictures has a dark scrim behind it in both themes.

use std::collections::BTreeMap;

use egui::style::{HandleShape, ScrollStyle, Selection, WidgetVisuals, Widgets};
use egui::{
    Color32, Context, CornerRadius, FontFamily, FontId, Frame, Margin, Shadow, Stroke, Style, TextStyle,
};
use egui::{Visuals, vec2};
use genescape_schema::Category;

use crate::settings;

/// A colour as in CSS.
const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// Ground behind text and buttons on a picture: white text on it is readable even over snow.
pub const SCRIM: Color32 = Color32::from_black_alpha(168);
/// The same under the pointer.
pub const SCRIM_HOVERED: Color32 = Color32::from_black_alpha(215);
/// Text on a scrim.
pub const ON_SCRIM: Color32 = rgb(0xfafaf8);
/// Text on a scrim that matters less.
pub const ON_SCRIM_WEAK: Color32 = rgb(0xd6d8d6);
/// Text on a category's bright colour.
pub const ON_BRIGHT: Color32 = rgb(0x101612);
/// Corners of pictures and cards, in points.
pub const RADIUS: u8 = 7;

/// In which a panel opens, or a switch moves.
const ANIMATION_S: f32 = 0.12;
/// A frame that takes longer is no part of a movement.
const SLOW_S: f32 = 0.1;

/// A category's colour on pictures, bright in both themes.
pub fn bright(category: Category) -> Color32 {
    [rgb(0x86cf7e), rgb(0xebb666), rgb(0x85c1f4)][category as usize]
}

/// What a category is called on buttons.
pub fn title(category: Category) -> &'static str {
    ["Trees", "Terrain", "Sky"][category as usize]
}

/// The colours of one theme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Palette {
    /// Behind the pictures.
    pub ground: Color32,
    /// Panels and bars.
    pub panel: Color32,
    /// Cards, menus and tooltips, which lie above panels.
    pub raised: Color32,
    /// Fields and rails, which lie below them.
    pub sunken: Color32,
    /// Hair lines.
    pub line: Color32,
    /// Text.
    pub text: Color32,
    /// Text that matters less.
    pub weak: Color32,
    /// Buttons at rest.
    pub button: Color32,
    /// Buttons under the pointer.
    pub hovered: Color32,
    /// What is chosen, and the one thing to press next.
    pub accent: Color32,
    /// Text on the accent.
    pub on_accent: Color32,
    /// Faults.
    pub danger: Color32,
    /// What needs attention.
    pub warning: Color32,
    /// Categories on panels, as in [`Category::ALL`].
    pub categories: [Color32; 3],
}

/// Light text on dark ground.
pub const DARK: Palette = Palette {
    ground: rgb(0x0c0d0e),
    panel: rgb(0x191b1c),
    raised: rgb(0x232627),
    sunken: rgb(0x111213),
    line: rgb(0x343839),
    text: rgb(0xe2e5e2),
    weak: rgb(0x99a09d),
    button: rgb(0x2c3031),
    hovered: rgb(0x3c4142),
    accent: rgb(0x8fcbac),
    on_accent: rgb(0x0e1a14),
    danger: rgb(0xf08a7c),
    warning: rgb(0xe9be70),
    categories: [rgb(0x86cf7e), rgb(0xe2ad5c), rgb(0x7eb9ec)],
};

/// Dark text on light ground.
pub const LIGHT: Palette = Palette {
    ground: rgb(0xdee0dc),
    panel: rgb(0xf6f6f3),
    raised: rgb(0xfffffd),
    sunken: rgb(0xe8e9e5),
    line: rgb(0xd3d5d0),
    text: rgb(0x212623),
    weak: rgb(0x5c635f),
    button: rgb(0xe5e7e3),
    hovered: rgb(0xd6dad5),
    accent: rgb(0x20694a),
    on_accent: rgb(0xfafffc),
    danger: rgb(0xa82d20),
    warning: rgb(0x855608),
    categories: [rgb(0x28702c), rgb(0x8c560e), rgb(0x1c629e)],
};

impl Palette {
    /// The palette of a style that [`install`] made.
    pub fn of(visuals: &Visuals) -> &'static Self {
        if visuals.dark_mode { &DARK } else { &LIGHT }
    }

    /// A category's colour on panels.
    pub fn category(&self, category: Category) -> Color32 {
        self.categories[category as usize]
    }
}

/// What the window has to be filled with before anything is painted. Not painted itself: most of it is hidden by pictures,
/// and where the processor draws it would take as long as they do.
pub fn ground(ctx: &Context) -> Color32 {
    Palette::of(&ctx.global_style().visuals).ground
}

/// Gives both styles to a context; once, before the first frame.
pub fn install(ctx: &Context) {
    ctx.set_style_of(egui::Theme::Dark, style(&DARK, Visuals::dark()));
    ctx.set_style_of(egui::Theme::Light, style(&LIGHT, Visuals::light()));
}

/// Follows the person's choice of theme and scale; every frame.
pub fn follow(ctx: &Context, comfort: &settings::Comfort) {
    let preference = match comfort.theme {
        settings::Theme::System => egui::ThemePreference::System,
        settings::Theme::Light => egui::ThemePreference::Light,
        settings::Theme::Dark => egui::ThemePreference::Dark,
    };
    ctx.set_theme(preference);
    ctx.set_zoom_factor(comfort.ui_scale.clamp(0.5, 2.5));
}

/// Nothing fades or slides while frames take long: in steps of a second it would only be late.
pub fn keep_pace(ctx: &Context) {
    let is_slow = ctx.input(|input| input.unstable_dt) > SLOW_S;
    let wanted = if is_slow { 0.0 } else { ANIMATION_S };
    if ctx.global_style().animation_time != wanted {
        ctx.all_styles_mut(|style| style.animation_time = wanted);
    }
}

fn style(palette: &Palette, base: Visuals) -> Style {
    let mut style = Style { visuals: visuals(palette, base), text_styles: text_styles(), ..Style::default() };
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(8.0, 6.0);
    spacing.button_padding = vec2(10.0, 5.0);
    spacing.interact_size = vec2(32.0, 26.0);
    spacing.slider_rail_height = 4.0;
    spacing.window_margin = Margin::same(14);
    spacing.menu_margin = Margin::same(6);
    spacing.tooltip_width = 320.0;
    spacing.scroll = ScrollStyle { bar_width: 7.0, ..ScrollStyle::thin() };
    style.interaction.selectable_labels = false;
    style.interaction.tooltip_delay = 0.35;
    style.animation_time = ANIMATION_S;
    style
}

fn text_styles() -> BTreeMap<TextStyle, FontId> {
    let font = |size| FontId::new(size, FontFamily::Proportional);
    [
        (TextStyle::Small, font(12.0)),
        (TextStyle::Body, font(14.0)),
        (TextStyle::Button, font(14.0)),
        (TextStyle::Heading, font(18.0)),
        (TextStyle::Monospace, FontId::new(12.5, FontFamily::Monospace)),
    ]
    .into()
}

fn visuals(palette: &Palette, base: Visuals) -> Visuals {
    let shadow = |blur| Shadow { offset: [0, 4], blur, spread: 0, color: Color32::from_black_alpha(70) };
    Visuals {
        widgets: widgets(palette),
        selection: Selection {
            bg_fill: palette.accent.gamma_multiply(0.45),
            stroke: Stroke::new(1.0, palette.text),
        },
        weak_text_color: Some(palette.weak),
        extreme_bg_color: palette.sunken,
        text_edit_bg_color: Some(palette.sunken),
        window_fill: palette.raised,
        window_stroke: Stroke::new(1.0, palette.line),
        window_corner_radius: CornerRadius::same(10),
        menu_corner_radius: CornerRadius::same(RADIUS),
        window_shadow: shadow(24),
        popup_shadow: shadow(14),
        panel_fill: palette.panel,
        slider_trailing_fill: true,
        handle_shape: HandleShape::Circle,
        indent_has_left_vline: false,
        disabled_alpha: 0.45,
        interact_cursor: Some(egui::CursorIcon::PointingHand),
        ..base
    }
}

fn widgets(palette: &Palette) -> Widgets {
    let state = |fill, strong: Color32, line: Color32, expansion| WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: Stroke::new(1.0, line),
        fg_stroke: Stroke::new(1.0, strong),
        corner_radius: CornerRadius::same(RADIUS),
        expansion,
    };
    let none = Color32::TRANSPARENT;
    Widgets {
        noninteractive: state(palette.panel, palette.text, palette.line, 0.0),
        inactive: state(palette.button, palette.text, none, 0.0),
        hovered: state(palette.hovered, palette.text, none, 0.0),
        active: state(palette.hovered, palette.text, palette.accent, 0.0),
        open: state(palette.hovered, palette.text, none, 0.0),
    }
}

/// A card that lies on pictures or on other panels.
pub fn card(palette: &Palette) -> Frame {
    Frame::NONE.fill(palette.raised).corner_radius(10).shadow(card_shadow())
}

/// Shadow that sets a card off from a picture.
pub fn card_shadow() -> Shadow {
    Shadow { offset: [0, 3], blur: 14, spread: 0, color: Color32::from_black_alpha(90) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of WCAG 2.
    fn luminance(color: Color32) -> f32 {
        let linear = |byte: u8| {
            let part = f32::from(byte) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { libm::powf((part + 0.055) / 1.055, 2.4) }
        };
        0.2126 * linear(color.r()) + 0.7152 * linear(color.g()) + 0.0722 * linear(color.b())
    }

    fn contrast(a: Color32, b: Color32) -> f32 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_is_readable_on_every_ground_of_both_themes() {
        for palette in [DARK, LIGHT] {
            let grounds = [palette.panel, palette.raised, palette.sunken, palette.button, palette.hovered];
            for ground in grounds {
                assert!(contrast(palette.text, ground) > 7.0, "text on {ground:?}");
            }
            for ground in &grounds[..3] {
                let colors = [palette.weak, palette.danger, palette.warning, palette.accent];
                for color in colors.into_iter().chain(palette.categories) {
                    assert!(contrast(color, *ground) >= 4.5, "{color:?} on {ground:?}");
                }
            }
            assert!(contrast(palette.on_accent, palette.accent) >= 4.5);
        }
    }

    #[test]
    fn text_is_readable_on_any_picture() {
        for picture in [Color32::WHITE, Color32::BLACK, Color32::from_rgb(255, 235, 150)] {
            for scrim in [SCRIM, SCRIM_HOVERED] {
                let ground = picture.blend(scrim);
                assert!(contrast(ON_SCRIM, ground) >= 4.5 && contrast(ON_SCRIM_WEAK, ground) >= 4.5);
            }
        }
        for category in Category::ALL {
            assert!(contrast(ON_BRIGHT, bright(category)) >= 7.0);
        }
    }
}
