//! Figures → text for people, or a line of JSON.

use anyhow::Result;
use serde::Serialize;

use crate::gpu::Gpu;
use crate::measure::{Machine, load_average};
use crate::say;

/// The bound that a figure should keep.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Aim {
    AtMost(f64),
    AtLeast(f64),
}

impl Aim {
    fn met(self, value: f64) -> bool {
        match self {
            Self::AtMost(max) => value <= max,
            Self::AtLeast(min) => value >= min,
        }
    }
}

#[derive(Clone, Debug, Serialize)]
struct Figure {
    measure: String,
    what: String,
    value: f64,
    unit: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    aim: Option<Aim>,
    #[serde(skip_serializing_if = "Option::is_none")]
    met: Option<bool>,
}

/// All figures of a run; in text each is printed as soon as it is known.
#[derive(Debug, Default, Serialize)]
pub(super) struct Report {
    #[serde(flatten)]
    machine: Machine,
    load_average_at_end: Option<f64>,
    figures: Vec<Figure>,
    notes: Vec<String>,
    #[serde(skip)]
    json: bool,
    #[serde(skip)]
    measure: String,
}

impl Report {
    /// Names machine and device.
    pub fn begin(gpu: &Gpu, json: bool) -> Self {
        let report = Self { machine: Machine::of(gpu), json, ..Self::default() };
        report.print(&report.machine.told());
        report
    }

    /// Text as it comes; JSON is printed at the end.
    fn print(&self, line: &str) {
        if !self.json {
            say!("{line}");
        }
    }

    /// The figures that follow belong to this.
    pub fn section(&mut self, title: impl Into<String>) {
        self.measure = title.into();
        self.print(&format!("\n{}", self.measure));
    }

    /// A figure without a bound.
    pub fn figure(&mut self, what: impl Into<String>, value: f64, unit: &'static str) {
        self.add(what.into(), value, unit, None);
    }

    pub fn aimed(&mut self, what: impl Into<String>, value: f64, unit: &'static str, aim: Aim) {
        self.add(what.into(), value, unit, Some(aim));
    }

    pub fn note(&mut self, text: &str) {
        self.print(&format!("  {text}"));
        self.notes.push(text.to_owned());
    }

    fn add(&mut self, what: String, value: f64, unit: &'static str, aim: Option<Aim>) {
        let met = aim.map(|aim| aim.met(value));
        let verdict = if met == Some(true) { "met" } else { "MISSED" };
        let verdict = match aim {
            Some(Aim::AtMost(max)) => format!("   {verdict}: at most {max}"),
            Some(Aim::AtLeast(min)) => format!("   {verdict}: at least {min}"),
            None => String::new(),
        };
        self.print(&format!("  {what:<58} {:>10} {unit}{verdict}", rounded(value)));
        self.figures.push(Figure { measure: self.measure.clone(), what, value, unit, aim, met });
    }

    /// Prints the JSON, or how many aims were met.
    pub fn end(mut self) -> Result<()> {
        self.load_average_at_end = load_average();
        if self.json {
            say!("{}", serde_json::to_string(&self)?);
            return Ok(());
        }
        let aims = self.figures.iter().filter_map(|figure| figure.met);
        let (met, all) = (aims.clone().filter(|met| *met).count(), aims.count());
        say!("\n{met} of {all} aims met{}", busy(self.load_average_at_end));
        Ok(())
    }
}

/// Four significant digits, and all digits before the point.
fn rounded(value: f64) -> String {
    let digits = [1e3, 1e2, 1e1, 1.0].iter().position(|&least| value.abs() >= least).unwrap_or(4);
    format!("{value:.digits$}")
}

fn busy(load: Option<f64>) -> String {
    load.map_or_else(String::new, |load| format!(", load average {load}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_aim_is_met_up_to_its_bound() {
        assert!(Aim::AtMost(1.5).met(1.5) && !Aim::AtMost(1.5).met(1.51));
        assert!(Aim::AtLeast(6.0).met(6.0) && !Aim::AtLeast(6.0).met(5.9));
    }

    #[test]
    fn numbers_are_told_in_four_digits() {
        let told = [0.012345, 1.23456, 12.3456, 123.456, 12345.6].map(rounded);
        assert_eq!(told, ["0.0123", "1.235", "12.35", "123.5", "12346"]);
    }
}
