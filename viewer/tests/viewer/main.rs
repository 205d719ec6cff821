//! What is drawn, on a device and in a window. All but the shaders' test need a Vulkan driver, and the window an X server
//! without a screen: `cargo xtask test` installs both where it may, and runs them.

mod cracks;
mod desktop;
mod display;
mod exports;
mod golden;
mod lod_twin;
mod made_up;
mod manual;
mod mistakes;
mod program;
mod shaders;
mod shadows;
mod window;
