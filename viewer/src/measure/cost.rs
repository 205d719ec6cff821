//! What work takes, on the clock and on processors.

use std::time::Instant;

use cpu_time::{ProcessTime, ThreadTime};

use crate::camera::Camera;
use crate::headless::Headless;
use crate::options::FrameInput;
use crate::view::View;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Milliseconds on the clock.
    pub wall_ms: f64,
    /// Milliseconds of processors, all threads of this process together.
    pub cpu_ms: f64,
}

impl Cost {
    pub const MAX: Self = Self { wall_ms: f64::MAX, cpu_ms: f64::MAX };

    /// The lesser of each: what other programs added is left out.
    pub fn least(self, other: Self) -> Self {
        Self { wall_ms: self.wall_ms.min(other.wall_ms), cpu_ms: self.cpu_ms.min(other.cpu_ms) }
    }

    /// What one picture of each view takes, waited for.
    pub fn of_frame(headless: &Headless, views: &mut [View], frame: &FrameInput, camera: &Camera) -> Self {
        let work = || {
            let (commands, _) = headless.record(views, frame, camera, camera);
            headless.gpu.queue.submit([commands]);
            headless.gpu.wait();
        };
        Self::of(work).0
    }

    /// What `work` takes.
    pub fn of<T>(work: impl FnOnce() -> T) -> (Self, T) {
        let (wall, cpu) = (Instant::now(), ProcessTime::try_now());
        let result = work();
        let cpu_ms = cpu.map_or(f64::NAN, |start| milliseconds(start.elapsed()));
        (Self { wall_ms: milliseconds(wall.elapsed()), cpu_ms }, result)
    }

    /// Milliseconds of a processor that `work` takes on this thread alone.
    pub fn of_thread<T>(work: impl FnOnce() -> T) -> (f64, T) {
        let start = ThreadTime::try_now();
        let result = work();
        (start.map_or(f64::NAN, |start| milliseconds(start.elapsed())), result)
    }
}

impl std::iter::Sum for Cost {
    fn sum<I: Iterator<Item = Self>>(costs: I) -> Self {
        costs.fold(Self::default(), |a, b| Self {
            wall_ms: a.wall_ms + b.wall_ms,
            cpu_ms: a.cpu_ms + b.cpu_ms,
        })
    }
}

fn milliseconds(time: std::time::Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
