//! What measurements were made on.

use serde::{Deserialize, Serialize};

use crate::gpu::Gpu;

/// Machine and device.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// "llvmpipe (LLVM 15.0.6, 256 bits)".
    pub device: String,
    /// "llvmpipe Mesa 22.3.6".
    pub driver: String,
    /// Whether the processor draws.
    pub software: bool,
    /// "linux x86_64".
    pub system: String,
    pub cores: usize,
    /// See [`load_average`]; when the machine was looked at.
    #[serde(rename = "load_average_at_start")]
    pub load_average: Option<f64>,
}

impl Machine {
    /// This one.
    pub fn of(gpu: &Gpu) -> Self {
        Self {
            device: gpu.name.clone(),
            driver: gpu.driver.clone(),
            software: gpu.software,
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            cores: std::thread::available_parallelism().map_or(0, usize::from),
            load_average: load_average(),
        }
    }

    /// A line for people.
    pub fn told(&self) -> String {
        let kind = if self.software { "in software" } else { "a graphics card" };
        let load = self.load_average.map_or_else(String::new, |load| format!(", load average {load}"));
        let Self { device, system, cores, .. } = self;
        format!("{device} ({kind}), {system}, {cores} cores{load}")
    }
}

/// Programs that wanted to run in the last minute, on average, where the system tells.
pub fn load_average() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split(' ').next()?.parse().ok()
}
