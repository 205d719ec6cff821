//! The flight recorder: what happens in the window → one JSON object a line, in the order in which it happened. It is for
//! bug reports, and it is the protocol by which viewer/tests/window.rs, or any program that drives the viewer, knows what
//! the viewer did: names and units here are a format. Each line has `t_s` (seconds since
//! the start), `frame` (frames shown) and `what`; a state is written when it changes, so the last line of each `what` says
//! how things are. Lengths in metres, angles in radians, places in the window in physical pixels.

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use egui::accesskit::{Node, Role, TreeUpdate};
use genescape_schema::{Category, INDIVIDUALS};
use serde_json::{Value, json};

use crate::ui::model::Model;
use crate::upload::{Exhibit, WeakExhibit};
use crate::walk::Pose;

/// Between two lines about what changes in every frame.
const PAUSE: Duration = Duration::from_millis(100);
/// Between two lines about how long frames take.
const FRAMES_EVERY: Duration = Duration::from_millis(250);

/// A log that is being written. Without a file it costs nothing.
pub struct Log {
    file: Option<File>,
    born: Instant,
    frame: u64,
    /// What was written last of each state, and when.
    states: BTreeMap<&'static str, (Value, Instant)>,
    landscapes: [Option<WeakExhibit>; INDIVIDUALS],
    frames: Frames,
    behind: bool,
}

/// Frames since the last line about them.
struct Frames {
    since: Instant,
    last: Instant,
    count: u32,
    worst_ms: f32,
}

/// How things stand after a frame.
pub struct Moment<'a> {
    /// What the user interface showed.
    pub model: &'a Model,
    /// The landscapes that are drawn.
    pub landscapes: [Option<&'a Exhibit>; INDIVIDUALS],
    /// Where the cameras are.
    pub pose: Pose,
    /// Width and height of the window.
    pub size_px: [u32; 2],
    /// What can be pressed, if egui was asked.
    pub widgets: Option<Value>,
}

impl Log {
    /// Into a new file; into none without a path.
    ///
    /// # Errors
    /// A file that cannot be made.
    pub fn create(path: Option<&Path>) -> Result<Self> {
        let create = |path: &Path| {
            File::create(path).with_context(|| format!("the log {} cannot be written", path.display()))
        };
        let now = Instant::now();
        Ok(Self {
            file: path.map(create).transpose()?,
            born: now,
            frame: 0,
            states: BTreeMap::new(),
            landscapes: Default::default(),
            frames: Frames { since: now, last: now, count: 0, worst_ms: 0.0 },
            behind: false,
        })
    }

    pub fn is_on(&self) -> bool {
        self.file.is_some()
    }

    /// Something that happens once.
    pub fn note(&mut self, what: &str, value: Value) {
        let Some(file) = &mut self.file else { return };
        let t_s = self.born.elapsed().as_secs_f64();
        let mut line = json!({ "t_s": (t_s * 1e3).round() / 1e3, "frame": self.frame, "what": what });
        if let (Some(line), Value::Object(value)) = (line.as_object_mut(), value) {
            line.extend(value);
        }
        // A full disk ends the log, not the viewer. In one piece, so that a reader meets whole lines.
        if file.write_all(format!("{line}\n").as_bytes()).is_err() {
            self.file = None;
        }
    }

    /// What the person asks for: an event or a command.
    pub fn event(&mut self, event: &impl Debug) {
        if self.is_on() {
            self.note("wish", json!({ "wish": format!("{event:?}") }));
        }
    }

    /// A frame was shown: writes what is not as it was.
    pub fn frame(&mut self, moment: Moment<'_>) {
        self.frame += 1;
        if !self.is_on() {
            return;
        }
        let Moment { model, landscapes, pose, size_px, widgets } = moment;
        for (view, landscape) in landscapes.into_iter().enumerate() {
            self.landscape(view, landscape, model.generation);
        }
        self.state("generations", json!({ "shown": model.generation, "all": model.generations }));
        self.state("ballots", ballots(model));
        self.state(
            "bake",
            model.baking.as_ref().map_or(json!({ "generation": null }), |baking| json!(baking)),
        );
        self.state("errors", json!({ "count": model.errors.len(), "errors": model.errors }));
        self.state("screen", screen(model, size_px));
        self.behind = false;
        self.seldom("pose", || json!(pose));
        self.seldom("widgets", || widgets.unwrap_or_default());
        self.time_frame();
    }

    /// Whether it is time to look at what can be pressed.
    pub fn wants_widgets(&self) -> bool {
        self.is_on() && self.rested("widgets")
    }

    /// A change is not yet written, because it came too soon after another.
    pub fn is_behind(&self) -> bool {
        self.behind
    }

    /// Whether nothing else will be seen before something happens, and whether that becomes finer until then.
    pub fn rest(&mut self, resting: bool, refining: bool) {
        self.state("rest", json!({ "resting": resting, "refining": refining }));
    }

    fn landscape(&mut self, view: usize, exhibit: Option<&Exhibit>, generation: u32) {
        let is_same = match (&self.landscapes[view], exhibit) {
            (Some(known), Some(exhibit)) => known.is(exhibit),
            (known, exhibit) => known.is_none() && exhibit.is_none(),
        };
        if is_same {
            return;
        }
        let trees = exhibit.and_then(Exhibit::landscape).and_then(|scene| scene.trees.as_ref());
        let trees = trees.map_or(0, |trees| trees.count);
        let name = exhibit.map(Exhibit::name);
        self.landscapes[view] = exhibit.map(Exhibit::downgrade);
        self.note(
            "landscape",
            json!({ "view": view, "generation": generation, "name": name, "trees": trees }),
        );
    }

    fn time_frame(&mut self) {
        let (now, frames) = (Instant::now(), &mut self.frames);
        frames.count += 1;
        frames.worst_ms = frames.worst_ms.max((now - frames.last).as_secs_f32() * 1e3);
        frames.last = now;
        let span = now - frames.since;
        if span < FRAMES_EVERY {
            return;
        }
        let value = json!({ "fps": frames.count as f32 / span.as_secs_f32(), "worst_ms": frames.worst_ms });
        (frames.since, frames.count, frames.worst_ms) = (now, 0, 0.0);
        self.note("frames", value);
    }

    /// Written if it changed.
    fn state(&mut self, what: &'static str, value: Value) {
        if self.states.get(what).is_none_or(|(known, _)| *known != value) {
            self.note(what, value.clone());
            self.states.insert(what, (value, Instant::now()));
        }
    }

    /// Written if it changed, and not in every frame. A change is written later, but never lost.
    fn seldom(&mut self, what: &'static str, value: impl FnOnce() -> Value) {
        if self.rested(what) {
            self.state(what, value());
        } else {
            self.behind = true;
        }
    }

    fn rested(&self, what: &str) -> bool {
        self.states.get(what).is_none_or(|(_, at)| at.elapsed() >= PAUSE)
    }
}

fn ballots(model: &Model) -> Value {
    let entry = |category: Category| {
        let ballot = model.ballots.get(category).cast();
        (category.name(), ballot.map(|best| best.map_or(json!("none"), |best| json!(best))))
    };
    json!(BTreeMap::from(Category::ALL.map(entry)))
}

fn screen(model: &Model, size_px: [u32; 2]) -> Value {
    json!({
        "situation": <&str>::from(&model.situation),
        "arrangement": format!("{:?}", model.arrangement),
        "chosen": model.chosen,
        "captured": model.captured,
        "panels": format!("{:?}", model.panels),
        "size_px": size_px,
        "names": model.views.each_ref().map(|view| view.name.clone()),
    })
}

/// What can be pressed or dragged, as screen readers know it: its words, and its middle in pixels.
pub fn widgets(update: &TreeUpdate, pixels_per_point: f32) -> Value {
    use Role::*;
    let usable = [Button, Slider, SpinButton, CheckBox, RadioButton, TextInput];
    let pixels = |points: f64| (points * f64::from(pixels_per_point)).round();
    let widget = |node: &Node| {
        let (words, place) = (node.label().or_else(|| node.value())?, node.bounds()?);
        Some(json!({
            "label": words,
            "role": format!("{:?}", node.role()),
            "at_px": [pixels(0.5 * (place.x0 + place.x1)), pixels(0.5 * (place.y0 + place.y1))],
            "size_px": [pixels(place.width()), pixels(place.height())],
        }))
    };
    let nodes = update.nodes.iter().map(|(_, node)| node).filter(|node| usable.contains(&node.role()));
    json!({ "widgets": nodes.filter_map(widget).collect::<Vec<_>>() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &Path) -> Vec<Value> {
        let text = std::fs::read_to_string(path).expect("written");
        text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
    }

    #[test]
    fn a_state_is_written_when_it_changes_and_only_then() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("log");
        let mut log = Log::create(Some(&path)).expect("a file");
        for value in [1, 1, 2, 2, 1] {
            log.state("bake", json!({ "generation": value }));
            log.state("errors", json!({ "count": 0 }));
        }
        log.event(&crate::ballots::Ballot::NoFavourite);
        let told: Vec<_> = lines(&path).iter().map(|line| line["what"].clone()).collect();
        assert_eq!(told, ["bake", "errors", "bake", "bake", "wish"]);
        assert_eq!(lines(&path)[2]["generation"], 2);
        assert_eq!(lines(&path)[4]["wish"], "NoFavourite");
    }

    #[test]
    fn what_changes_in_every_frame_is_written_at_intervals() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("log");
        let mut log = Log::create(Some(&path)).expect("a file");
        for x in 0..50 {
            log.seldom("pose", || json!({ "x_m": x }));
            log.states.get_mut("pose").expect("written").1 -= PAUSE / 10;
        }
        let told = lines(&path);
        assert!((5..=50 / 4).contains(&told.len()), "{} lines", told.len());
    }

    #[test]
    fn without_a_path_nothing_is_written_and_a_wrong_one_is_named() {
        let mut log = Log::create(None).expect("no file");
        log.note("start", json!({}));
        assert!(!log.is_on() && !log.wants_widgets());
        let error = Log::create(Some(Path::new("/nowhere/at/all"))).err().expect("no folder");
        assert!(error.to_string().contains("/nowhere/at/all"));
    }
}
