//! When the next frame comes, how sharp its pictures are, and whether clouds drift: as much as the device can do while the
//! camera moves, nothing while nothing changes, and as little as will do while the processor that draws also bakes.
//! Arithmetic on times that are handed in; knows neither window nor device.

use std::time::{Duration, Instant};

use super::sharpness::Sharpness;
use crate::options::Options;

/// A walk's frame may take that long: 15 frames a second are what the thesis asks of four views (section 7).
const MOVING_FRAME: Duration = Duration::from_micros(66_667);
/// No frame comes sooner after another: more than screens show only heats.
const MIN_FRAME: Duration = Duration::from_micros(6_900);
/// Sides of the pictures while the camera moves, as parts of full resolution.
pub const PARTS: [f32; 4] = [1.0, 0.75, 0.5, 0.375];
/// Where the processor draws, full resolution is out of reach; the first steps shall not show it.
const FIRST_PART_IN_SOFTWARE: usize = 2;
/// After the camera came to rest, pictures become sharp: not between two steps.
const SHARP_AFTER: Duration = Duration::from_millis(200);
/// The same while the processor has better things to do, and since the last picture was drawn.
const SHARP_BESIDE_WORK_AFTER: Duration = Duration::from_secs(2);
/// Between two frames that nobody asked for, while the processor has better things to do.
const BESIDE_WORK: Duration = Duration::from_millis(250);
/// Clouds and waves rest when nobody has touched anything for so long.
const IDLE_AFTER: Duration = Duration::from_secs(10);
/// Frames at a new resolution before it is judged: the first still show what came before.
const WARM_UP: usize = 3;
/// Frames that are judged together.
const JUDGED: usize = 5;
/// A finer resolution must promise to stay below this part of [`MOVING_FRAME`], or two would alternate.
const MARGIN: f32 = 0.85;

/// What came of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shown {
    /// Pictures were drawn, not only the user interface.
    pub drawn: bool,
    /// Some picture is not at full resolution.
    pub blurred: bool,
    /// Some picture may become finer.
    pub rough: bool,
    /// When the user interface wants the next frame; `None` if it can wait for an event.
    pub again: Option<Duration>,
}

/// When the next frame is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    At(Instant),
    /// Then, but all that it shows will be finer.
    Finer(Instant),
    /// Not before something happens.
    OnEvent,
}

/// Follows the frames of a window.
#[derive(Clone, Debug)]
pub struct Pace {
    /// Which of [`PARTS`].
    part: usize,
    /// How long moving frames took since `part` was chosen.
    moving_frames: Vec<Duration>,
    /// When this frame began.
    now: Instant,
    moving: bool,
    /// When the camera moved last.
    moved: Instant,
    /// When pictures were drawn last.
    drawn: Instant,
    /// When the last frame ended.
    ended: Instant,
    /// The processor draws and has other work besides.
    shared: bool,
    /// When the person did something last.
    touched: Instant,
    /// For how long clouds have drifted and waves have run.
    drifted: Duration,
    drifting: bool,
    /// The last frame asked for one at once.
    running: bool,
}

impl Pace {
    pub fn new(now: Instant) -> Self {
        Self {
            part: 0,
            moving_frames: Vec::new(),
            now,
            moving: false,
            moved: now,
            drawn: now,
            ended: now,
            shared: false,
            touched: now,
            drifted: Duration::ZERO,
            drifting: false,
            running: false,
        }
    }

    /// The processor draws.
    pub fn expect_software(&mut self) {
        self.part = FIRST_PART_IN_SOFTWARE;
    }

    /// The person did something.
    pub fn touch(&mut self, now: Instant) {
        self.touched = now;
    }

    /// Begins a frame; the time since the last one, none after a rest.
    pub fn begin(&mut self, now: Instant) -> Duration {
        let passed = now.saturating_duration_since(std::mem::replace(&mut self.now, now));
        if !self.running {
            return Duration::ZERO;
        }
        if self.moving {
            self.judge(passed);
        }
        if self.drifting {
            self.drifted += passed;
        }
        passed
    }

    /// When this frame began.
    pub fn frame_began(&self) -> Instant {
        self.now
    }

    /// Whether the processor draws and has other work besides: pictures rest then unless the camera moves.
    pub fn share(&mut self, shared: bool) {
        self.shared = shared;
    }

    /// Whether it is so.
    pub fn is_shared(&self) -> bool {
        self.shared
    }

    /// When a frame may come that shows nothing urgent.
    pub fn soon(&self) -> Instant {
        self.ended + if self.shared { BESIDE_WORK } else { Duration::ZERO }
    }

    /// Whether the camera moves in this frame.
    pub fn camera(&mut self, moving: bool, options: &Options) {
        self.moving = moving;
        if moving {
            self.moved = self.now;
            self.touched = self.now;
        }
        let affordable = self.part == 0 && self.now.saturating_duration_since(self.touched) < IDLE_AFTER;
        self.drifting = options.drift_clouds && (moving || affordable);
    }

    /// For how long clouds have drifted.
    pub fn drifted_s(&self) -> f32 {
        self.drifted.as_secs_f32()
    }

    /// How this frame's pictures are drawn.
    pub fn sharpness(&self, options: &Options) -> Sharpness {
        let part = options.moving_resolution.unwrap_or(PARTS[self.part]).clamp(0.1, 1.0);
        match (self.until_sharp(self.now), self.shared && !self.moving) {
            (Duration::ZERO, _) => Sharpness::Sharpen(part),
            (_, true) => Sharpness::New(part),
            (_, false) => Sharpness::Part(part),
        }
    }

    /// Whether pictures become finer in this frame: while nothing moves, and nobody waits for the processor.
    pub fn refines(&self) -> bool {
        !self.shared && !self.drifting && self.until_sharp(self.now) == Duration::ZERO
    }

    /// Ends a frame: when the next is due.
    pub fn end(&mut self, now: Instant, shown: Shown) -> Next {
        if shown.drawn {
            self.drawn = now;
        }
        self.ended = now;
        let wait_for_sharpness = shown.blurred.then(|| self.until_sharp(now));
        self.running = self.moving || self.drifting;
        let at_once = self.running.then_some(Duration::ZERO);
        let took = now.saturating_duration_since(self.now);
        let rest = match (self.shared, self.moving) {
            (false, _) => Duration::ZERO,
            // Half of the time is left for the rest.
            (true, true) => took.min(Duration::from_secs(1)),
            (true, false) => BESIDE_WORK,
        };
        let wait = [at_once, wait_for_sharpness, shown.again].into_iter().flatten().min();
        // "Never" is a duration to egui.
        let after = |wait: Duration| now.checked_add(wait.max(MIN_FRAME.saturating_sub(took)));
        let next = wait.and_then(|wait| after(wait.max(rest)));
        let refines = shown.rough && !self.shared && !self.running;
        match (next, refines.then(|| self.until_sharp(now)).and_then(after)) {
            (next, Some(finer)) if next.is_none_or(|next| finer < next) => Next::Finer(finer),
            (Some(next), _) => Next::At(next),
            (None, _) => Next::OnEvent,
        }
    }

    /// How long pictures that are not sharp stay so, as seen at `now`.
    fn until_sharp(&self, now: Instant) -> Duration {
        let after =
            |rest: Duration, since: Instant| rest.saturating_sub(now.saturating_duration_since(since));
        match (self.moving, self.shared) {
            (true, _) => SHARP_AFTER,
            (false, false) => after(SHARP_AFTER, self.moved),
            (false, true) => after(SHARP_BESIDE_WORK_AFTER, self.moved.max(self.drawn)),
        }
    }

    /// Takes a moving frame's duration into account and chooses among [`PARTS`].
    fn judge(&mut self, frame: Duration) {
        self.moving_frames.push(frame);
        if self.moving_frames.len() < WARM_UP + JUDGED {
            return;
        }
        let mut judged = self.moving_frames.split_off(WARM_UP);
        judged.sort();
        let median = judged[JUDGED / 2].as_secs_f32();
        // As if all of a frame's cost came from its pixels: too dear towards finer, too cheap towards coarser, which
        // the next judgement mends.
        let area = |part: f32| part * part;
        let cost = |part: f32| median * area(part) / area(PARTS[self.part]);
        let target = MOVING_FRAME.as_secs_f32();
        let fits =
            |part: usize| cost(PARTS[part]) <= if part < self.part { MARGIN * target } else { 1.15 * target };
        let best = (0..PARTS.len()).find(|part| fits(*part)).unwrap_or(PARTS.len() - 1);
        if best != self.part {
            self.part = best;
            self.moving_frames.clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    /// A window whose frames take `base_ms` and `pixels_ms` more at full resolution.
    struct Device {
        pace: Pace,
        now: Instant,
        base_ms: f32,
        pixels_ms: f32,
        options: Options,
    }

    impl Device {
        fn new(base_ms: f32, pixels_ms: f32) -> Self {
            let now = Instant::now();
            Self { pace: Pace::new(now), now, base_ms, pixels_ms, options: Options::default() }
        }

        /// A frame; blurred pictures become sharp in one.
        fn frame(&mut self, moving: bool) -> (Sharpness, Next) {
            self.pace.begin(self.now);
            self.pace.camera(moving, &self.options);
            let sharpness = self.pace.sharpness(&self.options);
            let part = match sharpness {
                Sharpness::Part(part) | Sharpness::New(part) => part,
                Sharpness::Sharpen(_) | Sharpness::Full => 1.0,
            };
            self.now += MS.mul_f32(self.base_ms + self.pixels_ms * part * part);
            let shown = Shown { drawn: true, blurred: part < 1.0, ..Shown::default() };
            (sharpness, self.pace.end(self.now, shown))
        }

        /// Frames for as long as they follow upon each other; how many.
        fn run(&mut self, mut moving: usize, limit: usize) -> usize {
            for count in 0..limit {
                moving = moving.saturating_sub(1);
                match self.frame(moving > 0).1 {
                    Next::At(at) | Next::Finer(at) => self.now = self.now.max(at),
                    Next::OnEvent => return count + 1,
                }
            }
            limit
        }
    }

    #[test]
    fn resolution_follows_the_frame_time_and_settles() {
        for (pixels_ms, expected) in [(5.0, 1.0), (60.0, 1.0), (90.0, 0.75), (200.0, 0.5), (900.0, 0.375)] {
            let mut device = Device::new(4.0, pixels_ms);
            device.run(200, 199);
            for _ in 0..50 {
                assert_eq!(device.frame(true).0, Sharpness::Part(expected), "{pixels_ms} ms");
            }
        }
    }

    #[test]
    fn a_device_that_becomes_faster_becomes_sharper() {
        let mut device = Device::new(4.0, 500.0);
        device.pace.expect_software();
        device.run(100, 99);
        device.pixels_ms = 10.0;
        device.run(100, 99);
        assert_eq!(device.frame(true).0, Sharpness::Part(1.0));
    }

    #[test]
    fn a_slow_device_sharpens_its_pictures_after_a_walk_and_rests() {
        let mut device = Device::new(10.0, 400.0);
        device.pace.expect_software();
        device.run(40, 39);
        assert!(matches!(device.frame(true).0, Sharpness::Part(part) if part < 1.0));
        let frames = device.run(0, 1000);
        assert!(frames <= 4, "{frames} frames after a walk");
        assert!(matches!(device.frame(false), (Sharpness::Sharpen(_), Next::OnEvent)));
    }

    #[test]
    fn a_fast_device_lets_clouds_drift_until_nobody_has_touched_it_for_a_while() {
        let mut device = Device::new(2.0, 3.0);
        let start = device.now;
        device.run(2, 1_000_000);
        let ran = device.now - start;
        assert!((IDLE_AFTER..IDLE_AFTER + 100 * MS).contains(&ran), "{ran:?}");
        let drifted = device.pace.drifted_s();
        device.now += Duration::from_secs(100);
        device.frame(false);
        assert_eq!(device.pace.drifted_s(), drifted, "a rest is no jump of the clouds");
    }

    #[test]
    fn pictures_become_finer_at_rest_alone() {
        let mut device = Device::new(10.0, 20.0);
        device.options.drift_clouds = false;
        let mut finer = |moving: bool, shared: bool, after: Duration| {
            device.now += after;
            device.pace.begin(device.now);
            device.pace.share(shared);
            device.pace.camera(moving, &device.options);
            let refines = device.pace.refines();
            let shown = Shown { drawn: true, rough: true, ..Shown::default() };
            (refines, device.pace.end(device.now, shown))
        };
        assert!(matches!(finer(true, false, MS), (false, Next::At(_))), "moving");
        let (refines, next) = finer(false, false, MS);
        assert!(!refines && matches!(next, Next::Finer(_)), "not between two steps: {next:?}");
        assert_eq!(
            finer(false, true, SHARP_AFTER),
            (false, Next::OnEvent),
            "the processor is needed elsewhere"
        );
        let (refines, next) = finer(false, false, SHARP_AFTER);
        assert!(refines && matches!(next, Next::Finer(_)), "one after the other: {next:?}");
        device.options.drift_clouds = true;
        device.pace.touch(device.now);
        device.pace.camera(false, &device.options);
        assert!(!device.pace.refines(), "what drifts is never the same");
    }

    #[test]
    fn the_first_step_after_a_rest_is_none() {
        let mut device = Device::new(2.0, 3.0);
        device.options.drift_clouds = false;
        device.run(0, 100);
        device.now += Duration::from_secs(5);
        assert_eq!(device.pace.begin(device.now), Duration::ZERO);
    }

    #[test]
    fn where_the_processor_also_bakes_half_of_the_time_is_left() {
        let mut device = Device::new(0.0, 0.0);
        device.pace.begin(device.now);
        device.pace.share(true);
        device.pace.camera(true, &device.options);
        let end = device.now + 80 * MS;
        let shown = Shown { drawn: true, blurred: true, again: Some(Duration::ZERO), ..Shown::default() };
        assert_eq!(device.pace.end(end, shown), Next::At(end + 80 * MS));
    }

    #[test]
    fn where_the_processor_also_bakes_pictures_become_sharp_when_none_has_come_for_a_while() {
        let mut device = Device::new(20.0, 400.0);
        device.pace.expect_software();
        device.options.drift_clouds = false;
        device.pace.share(true);
        let part = PARTS[FIRST_PART_IN_SOFTWARE];
        for _ in 0..5 {
            // One landscape after the other arrives.
            let (sharpness, next) = device.frame(false);
            assert_eq!(sharpness, Sharpness::New(part));
            assert_eq!(next, Next::At(device.now + SHARP_BESIDE_WORK_AFTER));
            assert_eq!(device.pace.soon(), device.now + BESIDE_WORK);
            device.now += SHARP_BESIDE_WORK_AFTER / 2;
        }
        device.now += SHARP_BESIDE_WORK_AFTER;
        assert_eq!(device.frame(false).0, Sharpness::Sharpen(part));
        device.pace.share(false);
        assert_eq!(device.frame(false).0, Sharpness::Sharpen(part), "with the work done at once");
    }
}
