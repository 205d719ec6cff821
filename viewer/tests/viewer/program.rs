//! A viewer that runs, and what its log says of it. Nothing here waits for a time: only for something to be so, with a
//! limit that only a broken program meets.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use x11rb::protocol::xproto::Window;

use crate::display::Display;

/// The longest that anything may take: the machine may be slow and busy.
const LIMIT: Duration = Duration::from_secs(120);
/// Keys, clicks and files are noticed in that time.
const ARRIVES_WITHIN: Duration = Duration::from_millis(500);
/// Between two looks.
const LOOK_EVERY: Duration = Duration::from_millis(10);

/// A viewer; it ends with this value.
pub struct Viewer {
    process: Child,
    log: File,
    unread: String,
    /// The last line of each kind.
    pub now: BTreeMap<String, Value>,
    /// The last line about each landscape.
    pub landscapes: [Value; 4],
    /// All lines, for what has been.
    pub lines: Vec<Value>,
    /// Its window.
    pub window: Window,
    /// What it prints.
    printed: PathBuf,
}

impl Viewer {
    /// Starts one with these arguments; its log and what it prints go into `folder`.
    pub fn start(display: &Display, folder: &Path, arguments: &[&str]) -> Self {
        let path = folder.join("log.jsonl");
        let _ = std::fs::remove_file(&path);
        let printed = File::create(folder.join("stderr")).expect("our folder");
        let mut process = Command::new(env!("CARGO_BIN_EXE_viewer"))
            .arg("--log")
            .arg(&path)
            .args(arguments)
            .current_dir(folder)
            .env("DISPLAY", &display.name)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .stdin(Stdio::null())
            .stderr(printed)
            .spawn()
            .expect("the viewer is built");
        let start = Instant::now();
        let (log, window) = loop {
            let status = process.try_wait().expect("our child");
            let printed = || std::fs::read_to_string(folder.join("stderr")).unwrap_or_default();
            assert!(status.is_none(), "the viewer ended with {status:?}: {}", printed());
            if let (Ok(log), Some(window)) = (File::open(&path), display.window()) {
                break (log, window);
            }
            assert!(start.elapsed() < LIMIT, "no window opens: {}", printed());
            std::thread::sleep(LOOK_EVERY);
        };
        let mut viewer = Self {
            process,
            log,
            unread: String::new(),
            now: BTreeMap::new(),
            landscapes: Default::default(),
            lines: Vec::new(),
            window,
            printed: folder.join("stderr"),
        };
        // A window that was never shown cannot have the keyboard.
        viewer.until("the first frame", |viewer| viewer.now.contains_key("screen"));
        display.focus(viewer.window);
        viewer
    }

    /// Reads what is new in the log; returns how many lines there were before.
    pub fn read(&mut self) -> usize {
        let before = self.lines.len();
        let _ = self.log.read_to_string(&mut self.unread);
        while let Some(end) = self.unread.find('\n') {
            let line: String = self.unread.drain(..=end).collect();
            let line: Value = serde_json::from_str(&line).expect("a JSON object a line");
            let what = line["what"].as_str().expect("each line says what it is").to_owned();
            if let ("landscape", Some(view)) = (what.as_str(), line["view"].as_u64()) {
                self.landscapes[view as usize] = line.clone();
            }
            self.now.insert(what, line.clone());
            self.lines.push(line);
        }
        before
    }

    /// Waits until something is so.
    pub fn until(&mut self, what: &str, so: impl Fn(&Self) -> bool) {
        let start = Instant::now();
        loop {
            self.read();
            if so(self) {
                return;
            }
            let status = self.process.try_wait().expect("our child");
            let printed = || std::fs::read_to_string(&self.printed).unwrap_or_default();
            assert!(status.is_none(), "the viewer ended with {status:?} before {what}: {}", printed());
            assert!(start.elapsed() < LIMIT, "still not: {what}; but {}", self.story());
            std::thread::sleep(LOOK_EVERY);
        }
    }

    /// The last lines, but for long ones.
    fn story(&self) -> String {
        let told = self.lines.iter().filter(|line| {
            !["widgets", "pose", "frames", "bake"].contains(&line["what"].as_str().unwrap_or(""))
        });
        let told: Vec<String> = told.map(Value::to_string).collect();
        told[told.len().saturating_sub(25)..].join("\n")
    }

    /// Waits for that many more frames, or until none are drawn any more: what was asked for before is on the screen then.
    pub fn frames(&mut self, count: u64) {
        self.read();
        let (last, start) = (self.frame(), Instant::now());
        // What was asked for may not have arrived yet.
        let waited = || start.elapsed() > ARRIVES_WITHIN;
        self.until("more frames", |viewer| viewer.frame() >= last + count || viewer.rests() && waited());
    }

    /// Whether nothing else will be seen before something happens.
    pub fn rests(&self) -> bool {
        *self.get("rest", "resting") == true
    }

    /// Whether nothing will be drawn before something happens.
    pub fn is_still(&self) -> bool {
        self.rests() && *self.get("rest", "refining") == false
    }

    /// How many frames were shown.
    pub fn frame(&self) -> u64 {
        self.lines.last().and_then(|line| line["frame"].as_u64()).unwrap_or(0)
    }

    /// Resident memory.
    pub fn memory_mib(&self) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.process.id()));
        let status = status.expect("it runs, on a Linux");
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("a process has memory");
        let kib: f64 = line.trim().trim_end_matches(" kB").parse().expect("a number");
        kib / 1024.0
    }

    /// Time that its threads have had of the processor.
    pub fn processor_s(&self) -> f64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.process.id()));
        let stat = stat.expect("it runs, on a Linux");
        let (_, fields) = stat.rsplit_once(')').expect("after the name");
        let ticks = fields.split_whitespace().skip(11).take(2).map(|ticks| ticks.parse::<f64>());
        // User and system; Linux tells programs hundredths, whatever it counts itself.
        ticks.map(|ticks| ticks.expect("a number")).sum::<f64>() / 100.0
    }

    /// A value of the last line of a kind.
    pub fn get(&self, what: &str, key: &str) -> &Value {
        self.now.get(what).map_or(&Value::Null, |line| &line[key])
    }

    /// All four views show landscapes of that generation, and nothing is being baked.
    pub fn shows(&self, generation: u32) -> bool {
        self.get("generations", "shown") == generation
            && self.landscapes.iter().all(|landscape| landscape["generation"] == generation)
            && self.get("bake", "generation").is_null()
    }

    /// Where something that can be pressed has its middle.
    pub fn place_of(&mut self, label: &str) -> [i16; 2] {
        let find = |viewer: &Self| {
            let listed = viewer.get("widgets", "widgets").as_array()?;
            let widget = listed.iter().find(|widget| widget["label"] == label)?;
            let number = |at: usize| widget["at_px"][at].as_f64().map(|value| value as i16);
            Some([number(0)?, number(1)?])
        };
        // What was seen in an earlier frame may have moved.
        self.frames(2);
        self.until(&format!("there is “{label}”"), |viewer| find(viewer).is_some());
        find(self).expect("it was just there")
    }

    /// Points at something and presses it.
    pub fn click(&mut self, display: &Display, label: &str) {
        let mut place = self.place_of(label);
        loop {
            display.point(place);
            self.frames(2);
            // It moves where what stands before it has changed since the last frame.
            let found = self.place_of(label);
            let moved = std::mem::replace(&mut place, found) != found;
            if !moved {
                break;
            }
        }
        display.button(1, true);
        display.button(1, false);
    }

    /// Points at a place and presses a button of the mouse: at once, for what takes egui longer than 0.8 s is no click.
    pub fn press(&mut self, display: &Display, place: [i16; 2], button: u8) {
        display.point(place);
        self.frames(2);
        display.button(button, true);
        display.button(button, false);
    }

    /// Closes the window; how the program ended.
    pub fn quit(mut self, display: &Display) -> ExitStatus {
        display.close(self.window);
        let start = Instant::now();
        loop {
            if let Some(status) = self.process.try_wait().expect("our child") {
                self.read();
                assert!(self.now.contains_key("end"), "the log has no end: {}", self.story());
                return status;
            }
            assert!(start.elapsed() < LIMIT, "it does not close: {}", self.story());
            std::thread::sleep(LOOK_EVERY);
        }
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
