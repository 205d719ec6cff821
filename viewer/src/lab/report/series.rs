//! Measured frames of one experiment, by scheme.

use anyhow::Result;

use crate::lab::experiment::{CONTINUOUS, DISCRETE, Experiment, MORPH, NONE, ROAM, SIMPLE};
use crate::lab::page::{Line, Plot, Scale, Table, rounded, with_deviation};
use crate::lab::popping::Pop;
use crate::lab::store::Store;
use crate::lab::walk::Frame;
use crate::lab::{popping_table, walk_table};
use crate::measure::{deviation, mean};

/// An experiment with what was measured of it.
pub struct Series {
    pub experiment: Experiment,
    pub frames: Vec<Frame>,
    pub pops: Vec<Pop>,
}

/// The mean of a number; 0 of none.
pub fn mean_of(values: impl Iterator<Item = f64>) -> f64 {
    mean(&values.collect::<Vec<_>>())
}

/// Looks of lines: a scheme has the same everywhere.
fn style(scheme: &str) -> usize {
    match scheme {
        NONE => 0,
        ROAM | DISCRETE => 1,
        MORPH | CONTINUOUS => 2,
        SIMPLE => 3,
        _ => 4,
    }
}

impl Series {
    /// Reads what there is.
    ///
    /// # Errors
    /// Tables that are damaged.
    pub fn read(store: &Store, experiment: Experiment) -> Result<Self> {
        let frames = store.rows(&walk_table(experiment.name))?;
        let pops = store.rows(&popping_table(experiment.name))?;
        Ok(Self { experiment, frames, pops })
    }

    fn schemes(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.experiment.schemes.iter().map(|scheme| scheme.name)
    }

    /// Numbers of all frames of a scheme that have one.
    pub fn of(&self, scheme: &str, value: impl Fn(&Frame) -> Option<f64>) -> Vec<f64> {
        self.frames.iter().filter(|frame| frame.scheme == scheme).filter_map(value).collect()
    }

    /// The mean over all frames of a scheme.
    pub fn mean(&self, scheme: &str, value: impl Fn(&Frame) -> Option<f64>) -> f64 {
        mean(&self.of(scheme, value))
    }

    /// L2 popping of all frames of a scheme: mean, and the greatest.
    pub fn popping(&self, scheme: &str) -> (f64, f64) {
        let all: Vec<f64> = self.pops.iter().filter(|pop| pop.scheme == scheme).map(|pop| pop.l2).collect();
        (mean(&all), all.iter().copied().fold(0.0, f64::max))
    }

    /// A plot of a number over frames; `skip` leaves the reference out.
    pub fn plot(
        &self,
        figure: &str,
        y_label: &str,
        scale: Scale,
        value: impl Fn(&Frame) -> Option<f64>,
    ) -> Plot {
        let line = |scheme: &'static str| {
            let frames = self.frames.iter().filter(|frame| frame.scheme == scheme);
            let points = frames.filter_map(|frame| Some((f64::from(frame.frame), value(frame)?))).collect();
            Line { name: scheme.to_owned(), style: style(scheme), points }
        };
        let lines = self.schemes().map(line).filter(|line| !line.points.is_empty()).collect();
        Plot {
            name: format!("{figure}-{}", self.experiment.name),
            title: self.experiment.scene.title().to_owned(),
            x_label: "Frame, there and back".into(),
            y_label: y_label.to_owned(),
            scale,
            lines,
            marks: Vec::new(),
        }
    }

    /// A plot of popping over frames.
    pub fn popping_plot(&self, figure: &str) -> Plot {
        let line = |scheme: &'static str| {
            let pops = self.pops.iter().filter(|pop| pop.scheme == scheme);
            let points = pops.map(|pop| (f64::from(pop.frame), pop.l2)).collect();
            Line { name: scheme.to_owned(), style: style(scheme), points }
        };
        Plot {
            lines: self.schemes().map(line).filter(|line| !line.points.is_empty()).collect(),
            x_label: "Frame, there".into(),
            ..self.plot(figure, "L2 from one frame to the next", Scale::Linear, |_| None)
        }
    }

    /// Means and deviations of everything.
    pub fn table(&self) -> Table {
        let cell = |scheme: &str, value: &dyn Fn(&Frame) -> Option<f64>| {
            let all = self.of(scheme, value);
            match all.is_empty() {
                true => "–".to_owned(),
                false => with_deviation(mean(&all), deviation(&all)),
            }
        };
        let row = |scheme: &'static str| {
            let (popping, worst) = self.popping(scheme);
            let popped = |value: f64| {
                if self.pops.is_empty() || scheme == NONE { "–".into() } else { rounded(value) }
            };
            vec![
                scheme.to_owned(),
                cell(scheme, &|frame| Some(frame.frame_ms)),
                cell(scheme, &|frame| frame.gpu_ms),
                cell(scheme, &|frame| Some(frame.processor_ms)),
                cell(scheme, &|frame| Some(frame.recording_ms)),
                cell(scheme, &|frame| Some(frame.triangles())),
                cell(scheme, &|frame| frame.drawn_triangles.map(|number| number as f64)),
                cell(scheme, &|frame| frame.vertices.map(|number| number as f64)),
                cell(scheme, &|frame| frame.l2),
                cell(scheme, &|frame| frame.flip),
                popped(popping),
                popped(worst),
            ]
        };
        let head = [
            "Scheme",
            "Frame, ms",
            "Device, ms",
            "Processors, ms",
            "CPU only, ms",
            "Triangles chosen",
            "Triangles drawn",
            "Vertices",
            "L2",
            "FLIP",
            "Popping, L2",
            "its worst frame",
        ];
        Table {
            caption: format!("{}: mean ± deviation over all frames", self.experiment.scene.title()),
            head: head.map(str::to_owned).into(),
            rows: self.schemes().map(row).collect(),
        }
    }
}
