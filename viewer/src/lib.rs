//! Shows four baked landscapes at once, walked through together and voted on.
//!
//! Data goes one way: files → [`load`] → [`scene`] (plain values) → [`upload`] (buffers and textures) → [`passes`]
//! (pictures, in a [`view`] each), with the person's wishes coming in as events.

pub mod baker;
pub mod camera;
pub mod event;
pub mod frame;
#[cfg(feature = "gamepad")]
pub mod gamepad;
pub mod history;
pub mod input;
pub mod lod;
pub mod save;
pub mod scene;
pub mod settings;
pub mod ui;
pub mod walk;
pub mod world_files;
pub mod world_watch;
