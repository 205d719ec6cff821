//! Shows four baked landscapes at once, walked through together and voted on.
//!
//! Data goes one way: files → [`load`] → [`scene`] (plain values) → [`upload`] (buffers and textures) → [`passes`]
//! (pictures, in a [`view`] each), with the person's wishes coming in as events.

pub mod app;
pub mod baker;
pub mod bench;
pub mod camera;
pub mod cli;
pub mod event;
pub mod frame;
#[cfg(feature = "gamepad")]
pub mod gamepad;
pub mod gpu;
pub mod history;
pub mod input;
pub mod load;
pub mod lod;
pub mod lod_mode;

pub mod passes;
pub mod picture_file;
pub mod save;
pub mod scene;
pub mod screenshot;
pub mod settings;
pub mod shaders;
pub mod ui;
pub mod upload;
pub mod view;
pub mod walk;
pub mod world_files;
pub mod world_watch;
