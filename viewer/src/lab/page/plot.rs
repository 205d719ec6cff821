//! Lines over an axis → SVG, which is coloured by style sheets: light or dark.

use std::fmt::{self, Write};

use genescape_schema::html::Escaped;

use super::ticks;

/// How a plot looks by itself.
pub const STYLE: &str = include_str!("plot.css");

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 300.0;
/// Room around the lines: left, right, top, bottom.
const LEFT: f64 = 62.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 54.0;
const BOTTOM: f64 = 42.0;
/// Width of a letter in the legend.
const LETTER: f64 = 6.9;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Of its file beside a Markdown page, without an ending.
    pub name: String,
    pub title: String,
    pub x_label: String,
    /// With its unit.
    pub y_label: String,
    pub scale: Scale,
    pub lines: Vec<Line>,
    pub marks: Vec<Mark>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// From zero.
    #[default]
    Linear,
    /// Of what is above zero; the rest is left out.
    Logarithmic,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    pub name: String,
    /// Of its colour and dashes: the same scheme looks alike in all plots.
    pub style: usize,
    pub points: Vec<(f64, f64)>,
}

/// A height with a name: what the thesis tells, or a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    pub name: String,
    pub y: f64,
}

impl Plot {
    /// An SVG element without a style of its own.
    pub fn svg(&self) -> String {
        let mut out = String::new();
        // A String takes whatever is written.
        let _ = self.write(&mut out, "");
        out
    }

    /// A file.
    pub fn svg_file(&self) -> String {
        let mut out = String::new();
        let _ = self.write(&mut out, &format!("<style>{STYLE}</style>"));
        out
    }

    fn write(&self, out: &mut String, style: &str) -> fmt::Result {
        let frame = Frame::of(self);
        write!(
            out,
            "<svg class=\"plot\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" \
             aria-label=\"{}\">{style}<text class=\"title\" x=\"{LEFT}\" y=\"16\">{}</text>",
            Escaped(&self.title),
            Escaped(&self.title)
        )?;
        self.write_legend(out)?;
        frame.write_axes(out, self)?;
        for mark in self.marks.iter().filter(|mark| frame.shows(mark.y)) {
            let (y, right, end) = (frame.y(mark.y), WIDTH - RIGHT, WIDTH - RIGHT - 4.0);
            write!(out, "<path class=\"mark\" d=\"M{LEFT} {y:.1}H{right}\"/>")?;
            write!(
                out,
                "<text class=\"mark\" x=\"{end}\" y=\"{:.1}\">{}</text>",
                y - 4.0,
                Escaped(&mark.name)
            )?;
        }
        for line in &self.lines {
            write!(out, "<path class=\"line s{}\" d=\"", line.style)?;
            let mut command = 'M';
            for (x, y) in line.points.iter().filter(|(_, y)| frame.shows(*y)) {
                write!(out, "{command}{:.1} {:.1}", frame.x(*x), frame.y(*y))?;
                command = 'L';
            }
            out.push_str("\"/>");
        }
        out.push_str("</svg>");
        Ok(())
    }

    fn write_legend(&self, out: &mut String) -> fmt::Result {
        let mut x = LEFT;
        for line in &self.lines {
            let name = Escaped(&line.name);
            write!(out, "<path class=\"line s{}\" d=\"M{x:.0} 34h22\"/>", line.style)?;
            write!(out, "<text class=\"legend\" x=\"{:.0}\" y=\"38\">{name}</text>", x + 28.0)?;
            x += 28.0 + 14.0 + LETTER * line.name.chars().count() as f64;
        }
        Ok(())
    }
}

/// What the axes reach.
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
    scale: Scale,
}

impl Frame {
    fn of(plot: &Plot) -> Self {
        let is_shown = |y: f64| y.is_finite() && (plot.scale == Scale::Linear || y > 0.0);
        let points = || plot.lines.iter().flat_map(|line| &line.points).filter(|(_, y)| is_shown(*y));
        let reach = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([f64::MAX, f64::MIN], |[low, high], value| [low.min(value), high.max(value)])
        };
        let x = reach(&mut points().map(|point| point.0));
        let marks = plot.marks.iter().map(|mark| mark.y).filter(|y| is_shown(*y));
        let [low, high] = reach(&mut points().map(|point| point.1).chain(marks));
        let y = match plot.scale {
            // Nothing to show.
            Scale::Logarithmic if low > high => [1.0, 10.0],
            Scale::Linear if low > high => [0.0, 1.0],
            Scale::Linear => [low.min(0.0), if high > 0.0 { high * 1.05 } else { 1.0 }],
            Scale::Logarithmic => [low / 1.2, high * 1.2],
        };
        let x = if x[0] < x[1] { x } else { [x[0].min(0.0), x[0].clamp(0.0, 1e300) + 1.0] };
        Self { x, y, scale: plot.scale }
    }

    fn shows(&self, y: f64) -> bool {
        y.is_finite() && (self.scale == Scale::Linear || y > 0.0)
    }

    fn x(&self, x: f64) -> f64 {
        LEFT + (x - self.x[0]) / (self.x[1] - self.x[0]) * (WIDTH - LEFT - RIGHT)
    }

    fn y(&self, y: f64) -> f64 {
        let [low, high] = self.y;
        let part = match self.scale {
            Scale::Linear => (y - low) / (high - low),
            Scale::Logarithmic => libm::log(y / low) / libm::log(high / low),
        };
        HEIGHT - BOTTOM - part * (HEIGHT - TOP - BOTTOM)
    }

    fn write_axes(&self, out: &mut String, plot: &Plot) -> fmt::Result {
        let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
        let (ticks, digits) = match self.scale {
            Scale::Linear => ticks::linear(self.y[0], self.y[1], 5.0),
            Scale::Logarithmic => (ticks::logarithmic(self.y[0], self.y[1]), 0),
        };
        for tick in ticks {
            let y = self.y(tick);
            let text = match self.scale {
                Scale::Linear if tick.abs() < 1e4 => format!("{tick:.digits$}"),
                _ => short(tick),
            };
            write!(out, "<path class=\"grid\" d=\"M{LEFT} {y:.1}H{right}\"/>")?;
            write!(out, "<text class=\"y\" x=\"{}\" y=\"{:.1}\">{text}</text>", LEFT - 7.0, y + 4.0)?;
        }
        let (ticks, digits) = ticks::linear(self.x[0], self.x[1], 7.0);
        for tick in ticks {
            let x = self.x(tick);
            write!(out, "<path class=\"grid\" d=\"M{x:.1} {bottom}v5\"/>")?;
            write!(out, "<text class=\"x\" x=\"{x:.1}\" y=\"{}\">{tick:.digits$}</text>", bottom + 18.0)?;
        }
        let (middle, half_way) = ((LEFT + right) / 2.0, (TOP + bottom) / 2.0);
        write!(
            out,
            "<path class=\"axis\" d=\"M{LEFT} {TOP}V{bottom}H{right}\"/>\
             <text class=\"x label\" x=\"{middle}\" y=\"{}\">{}</text>\
             <text class=\"label\" transform=\"translate(14 {half_way}) rotate(-90)\">{}</text>",
            HEIGHT - 6.0,
            Escaped(&plot.x_label),
            Escaped(&plot.y_label)
        )
    }
}

/// Few letters for a round number: 20 k, 5 M.
fn short(number: f64) -> String {
    match number.abs() {
        1e6.. => format!("{} M", number / 1e6),
        1e3.. => format!("{} k", number / 1e3),
        // What is left of a power of ten in binary.
        _ => format!("{}", (number * 1e9).round() / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn whatever_is_plotted_stays_inside_and_has_a_legend(
            ys in prop::collection::vec(prop_oneof![-1e9f64..1e9, Just(0.0), Just(f64::NAN), 1e-9f64..1.0], 0..20),
            is_log in any::<bool>(),
        ) {
            let points = (0..).zip(&ys).map(|(x, y)| (f64::from(x), *y)).collect();
            let scale = if is_log { Scale::Logarithmic } else { Scale::Linear };
            let lines = vec![Line { name: "a<b".into(), style: 1, points }];
            let svg = Plot { scale, lines, ..Plot::default() }.svg();
            prop_assert!(svg.contains("a&lt;b") && !svg.contains("NaN") && !svg.contains("inf"), "{}", svg);
            let path = svg.rsplit("<path class=\"line s1\" d=\"").next().and_then(|end| end.split('"').next());
            let numbers = path.unwrap_or("").split(|c: char| "ML ".contains(c)).filter_map(|n| n.parse::<f64>().ok());
            let places: Vec<f64> = numbers.collect();
            for place in places.chunks_exact(2) {
                prop_assert!((LEFT - 0.1..=WIDTH - RIGHT + 0.1).contains(&place[0]), "{:?}", place);
                prop_assert!((TOP - 0.1..=HEIGHT - BOTTOM + 0.1).contains(&place[1]), "{:?}", place);
            }
        }
    }
}
