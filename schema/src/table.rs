//! The parameter space as a table for people.

use std::fmt::Write;

use crate::parameter::{Category, Parameter};
use crate::space::Space;

const HEADINGS: [&str; 6] = ["name", "from", "to", "unit", "values", "scale"];

impl Space {
    /// Aligned columns for a terminal: name, range, unit, number of values, scale, help; a block for each category.
    pub fn to_table(&self) -> String {
        let rows: Vec<_> = self.parameters().iter().map(cells).collect();
        let width = |column: usize| {
            let widths = rows.iter().map(|row| row[column].chars().count());
            widths.max().unwrap_or(0).max(HEADINGS[column].len())
        };
        let widths: [usize; 6] = std::array::from_fn(width);
        let mut out = String::new();
        for category in Category::ALL {
            let (count, bits) = (self.category(category).count(), self.bits(category));
            let _ = writeln!(out, "{category}: {count} parameters, {bits} bits\n");
            line(&mut out, &widths, &HEADINGS.map(str::to_owned), "");
            for parameter in self.category(category) {
                line(&mut out, &widths, &cells(parameter), &parameter.help);
            }
            out.push('\n');
        }
        out
    }

    /// The same as Markdown.
    pub fn to_markdown(&self) -> String {
        let mut out = String::new();
        for category in Category::ALL {
            let _ = writeln!(out, "## {category}\n\n| {} | help |", HEADINGS.join(" | "));
            let _ = writeln!(out, "|---|---:|---:|---|---:|---|---|");
            for parameter in self.category(category) {
                let help = parameter.help.replace('|', "\\|");
                let cells = cells(parameter);
                let _ = writeln!(out, "| `{}` | {} | {help} |", cells[0], cells[1..].join(" | "));
            }
            out.push('\n');
        }
        out
    }
}

fn cells(parameter: &Parameter) -> [String; 6] {
    let Parameter { name, range: (low, high), unit, scale, .. } = parameter;
    let values = parameter.last_code() + 1;
    [name.clone(), low.to_string(), high.to_string(), unit.clone(), values.to_string(), scale.name().into()]
}

fn line(out: &mut String, widths: &[usize; 6], cells: &[String; 6], help: &str) {
    let [name, low, high, unit, values, scale] = cells;
    let [w0, w1, w2, w3, w4, w5] = *widths;
    let text =
        format!("  {name:w0$}  {low:>w1$}  {high:>w2$}  {unit:w3$}  {values:>w4$}  {scale:w5$}  {help}");
    let _ = writeln!(out, "{}", text.trim_end());
}
