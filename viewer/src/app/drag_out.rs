//! Files dragged out of the window, to a file manager or another program. winit can only be dropped on, so under X11 this
//! is a source of its own in the XDND protocol (version 5), on a connection of its own; elsewhere there is none.
//!
//! A source is usually the one that grabs the pointer. Here the window has it, by the button that is held; so this side
//! asks the server where the pointer is and whether the button is still down.

#[cfg(all(unix, not(target_vendor = "apple")))]
mod xdnd;

use std::path::PathBuf;
use std::sync::mpsc::Sender;

use winit::window::Window;

/// The files that a drag is about, once they are written. Dropped without them, the drag ends without files.
pub struct Offer(Sender<Vec<PathBuf>>);

impl Offer {
    pub fn hand_over(self, files: Vec<PathBuf>) {
        // The drag may have ended over nothing.
        let _ = self.0.send(files);
    }
}

/// Begins a drag that follows the pointer until the button is let go; `None` where the desktop offers none.
#[cfg(all(unix, not(target_vendor = "apple")))]
pub fn begin(window: &Window) -> Option<Offer> {
    use winit::raw_window_handle::{HasWindowHandle, RawWindowHandle};
    let own = match window.window_handle().ok()?.as_raw() {
        RawWindowHandle::Xlib(handle) => handle.window as u32,
        RawWindowHandle::Xcb(handle) => handle.window.get(),
        // Wayland lets a program begin a drag only with the serial number of its press, which winit keeps to itself.
        _ => return None,
    };
    let (sender, files) = std::sync::mpsc::channel();
    std::thread::Builder::new().name("drag".into()).spawn(move || xdnd::drag(own, files)).ok()?;
    Some(Offer(sender))
}

#[cfg(not(all(unix, not(target_vendor = "apple"))))]
pub fn begin(_: &Window) -> Option<Offer> {
    None
}
