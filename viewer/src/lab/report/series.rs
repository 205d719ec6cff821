//! Measured frames of one experiment, by scheme.

use anyhow::Result;

use crate::lab::experiment::{
    CONTINUOUS, DISCRETE, Experiment, LISTS, MORPH, NONE, ROAM, ROUGHNESS, SIMPLE, STRIPS,
};
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
        NONE | LISTS => 0,
        ROAM | DISCRETE => 1,
        MORPH | CONTINUOUS | STRIPS => 2,
        SIMPLE | ROUGHNESS => 3,
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
        let turn = self.frames.iter().map(|frame| frame.frame / 2 + 1).max().unwrap_or_default();
        let is_back = self.frames.iter().any(|frame| frame.frame > turn && value(frame).is_some());
        let lines = self.schemes().map(line).filter(|line| !line.points.is_empty()).collect();
        Plot {
            name: format!("{figure}-{}", self.experiment.name),
            title: self.experiment.scene.title().to_owned(),
            x_label: (if is_back { "Frame, there and back" } else { "Frame, there" }).into(),
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
            ..self.plot(figure, "L2 from one frame to the next", Scale::Linear, |_| None)
        }
    }

    /// Means and deviations of everything, a column for each scheme.
    pub fn table(&self) -> Table {
        let head = self.schemes().map(str::to_owned);
        table(
            self.experiment.scene.title(),
            head,
            self.schemes().map(|scheme| self.figures(scheme)).collect(),
        )
    }

    /// Mean and deviation of each of [`FIGURES`], then the mean popping and the worst.
    pub fn figures(&self, scheme: &str) -> Vec<String> {
        let told = |(_, value): &Figure| {
            let all = self.of(scheme, value);
            if all.is_empty() { "–".to_owned() } else { with_deviation(mean(&all), deviation(&all)) }
        };
        let (popping, worst) = self.popping(scheme);
        let is_known = self.pops.iter().any(|pop| pop.scheme == scheme);
        let popped = [popping, worst].map(|value| if is_known { rounded(value) } else { "–".to_owned() });
        FIGURES.iter().map(told).chain(popped).collect()
    }
}

/// A number of a frame with a name.
pub type Figure = (&'static str, fn(&Frame) -> Option<f64>);

/// What tables tell of frames.
pub const FIGURES: [Figure; 9] = [
    ("Frame, ms", |frame| Some(frame.frame_ms)),
    ("Device, ms", |frame| frame.gpu_ms),
    ("Processors, ms", |frame| Some(frame.processor_ms)),
    ("CPU only, ms", |frame| Some(frame.recording_ms)),
    ("Triangles chosen", |frame| Some(frame.triangles())),
    ("Triangles drawn", |frame| frame.drawn_triangles.map(|number| number as f64)),
    ("Vertices", |frame| frame.vertices.map(|number| number as f64)),
    ("L2", |frame| frame.l2),
    ("FLIP", |frame| frame.flip),
];

/// Columns of [`Series::figures`] with names over them.
pub fn table(of: &str, names: impl Iterator<Item = String>, columns: Vec<Vec<String>>) -> Table {
    let rows = FIGURES.iter().map(|(name, _)| *name).chain(["Popping, L2", "Popping, L2, worst frame"]);
    let row = |(at, name): (usize, &str)| {
        let cells = columns.iter().map(|column| column[at].clone());
        std::iter::once(name.to_owned()).chain(cells).collect()
    };
    Table {
        caption: format!("{of}: mean ± deviation over all frames"),
        head: std::iter::once(String::new()).chain(names).collect(),
        rows: rows.enumerate().map(row).collect(),
    }
}

/// What a frame costs: where the processor draws, the time of all processors, which other programs do not lengthen; else the
/// time until the picture is done.
pub fn cost(software: bool) -> Figure {
    match software {
        true => ("Milliseconds of processors a frame", |frame| Some(frame.processor_ms)),
        false => ("Milliseconds a frame", |frame| Some(frame.frame_ms)),
    }
}
