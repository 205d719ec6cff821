//! What is drawn, on a device and in a window. All but the tests of shaders, files and mistakes need a Vulkan driver, and
//! the windows an X server without a screen: `cargo xtask test` installs both where it may, and runs them.

mod asset;
mod asset_drawn;
mod asset_hostile;
mod asset_materials;
mod cracks;
mod crowns;
mod desktop;
mod display;
mod exports;
mod files;
mod golden;
mod ground_kinds;
mod lab;
mod land_around;
mod lod_twin;
mod made_up;
mod manual;
mod meadow;
mod mistakes;
mod parted;
mod program;
mod rough;
mod shade;
mod shaders;
mod shadows;
mod sky;
mod still;
mod validation;
mod waits;
mod water;
mod window;
mod window_file;
