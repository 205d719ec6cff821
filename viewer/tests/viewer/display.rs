//! An X server that shows nothing (Xvfb), with synthetic keyboard and mouse (the XTEST extension, as far as the program
//! can see they are real), and pictures of what would be on the screen. Places are pixels from the upper left corner.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    AtomEnum, BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ClientMessageEvent, ConfigureWindowAux,
    ConnectionExt as _, EventMask, ImageFormat, InputFocus, KEY_PRESS_EVENT, KEY_RELEASE_EVENT,
    MOTION_NOTIFY_EVENT, Window,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// Keys by their place on the keyboard: what the kernel calls them, plus the 8 that X adds.
pub mod keys {
    /// As they are written on an American keyboard.
    macro_rules! keys {
        ($($name:ident = $code:literal),* $(,)?) => {
            $(#[doc = stringify!($name)] pub const $name: u8 = $code + 8;)*
        };
    }
    keys! {
        ESCAPE = 1, E = 18, U = 22, Y = 21, ENTER = 28, CTRL = 29, A = 30, F = 33, G = 34, Z = 44, N = 49, DOT = 52, W = 17, S = 31, F5 = 63,
        F12 = 88,
        TAB = 15, PAGE_UP = 104, PAGE_DOWN = 109, I = 23, O = 24, P = 25, J = 36, K = 37, L = 38, SEMICOLON = 39, M = 50,
        COMMA = 51, SLASH = 53,
    }

    /// The key of a digit.
    pub fn digit(digit: char) -> u8 {
        let place = digit.to_digit(10).expect("a digit") as u8;
        8 + if place == 0 { 11 } else { place + 1 }
    }
}

/// A running X server and our hands on it; it ends with this value.
pub struct Display {
    server: Child,
    /// ":99"
    pub name: String,
    connection: RustConnection,
    root: Window,
    size: [u16; 2],
}

/// What is on the screen.
pub struct Picture {
    /// Width and height.
    pub size: [usize; 2],
    /// Red, green, blue; rows from above.
    pub pixels: Vec<[u8; 3]>,
}

impl Display {
    /// Starts a server on a free display.
    pub fn start(size: [u16; 2]) -> Self {
        let [width, height] = size;
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-nolisten", "tcp", "-screen", "0", &format!("{width}x{height}x24")])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb; on Debian and Ubuntu: apt-get install xvfb");
        // It writes its number when it is ready for us.
        let mut number = String::new();
        let output = server.stdout.take().expect("piped");
        BufReader::new(output).read_line(&mut number).expect("Xvfb says its number");
        let name = format!(":{}", number.trim());
        let (connection, screen) = x11rb::connect(Some(&name)).expect("Xvfb takes us in");
        let root = connection.setup().roots[screen].root;
        Self { server, name, connection, root, size }
    }

    /// The viewer's window, once it is there.
    pub fn window(&self) -> Option<Window> {
        let tree = self.connection.query_tree(self.root).ok()?.reply().ok()?;
        tree.children.into_iter().find(|window| {
            let name = self.connection.get_property(false, *window, AtomEnum::WM_NAME, AtomEnum::ANY, 0, 64);
            name.ok()
                .and_then(|name| name.reply().ok())
                .is_some_and(|name| name.value.ends_with(b"Genescape"))
        })
    }

    /// Gives a window the keyboard and puts it into the upper left corner: there is no window manager to do it.
    pub fn focus(&self, window: Window) {
        let corner = ConfigureWindowAux::new().x(0).y(0);
        self.connection.configure_window(window, &corner).expect("sent");
        self.connection.set_input_focus(InputFocus::PARENT, window, x11rb::CURRENT_TIME).expect("sent");
        self.sync();
    }

    /// Another size of the window's content.
    pub fn resize(&self, window: Window, [width, height]: [u32; 2]) {
        let size = ConfigureWindowAux::new().width(width).height(height);
        self.connection.configure_window(window, &size).expect("sent");
        self.sync();
    }

    /// Asks the window to close, as its cross in the corner does.
    pub fn close(&self, window: Window) {
        let atom = |name: &[u8]| {
            self.connection.intern_atom(false, name).expect("sent").reply().expect("an answer").atom
        };
        let data = [atom(b"WM_DELETE_WINDOW"), x11rb::CURRENT_TIME, 0, 0, 0];
        let message = ClientMessageEvent::new(32, window, atom(b"WM_PROTOCOLS"), data);
        self.connection.send_event(false, window, EventMask::NO_EVENT, message).expect("sent");
        self.sync();
    }

    /// Holds a key down or lets it go.
    pub fn key(&self, key: u8, down: bool) {
        self.fake(if down { KEY_PRESS_EVENT } else { KEY_RELEASE_EVENT }, key, [0, 0]);
    }

    /// Presses a key and lets it go.
    pub fn tap(&self, key: u8) {
        self.key(key, true);
        self.key(key, false);
    }

    /// Presses a key while Ctrl is held.
    pub fn tap_with_ctrl(&self, key: u8) {
        self.key(keys::CTRL, true);
        self.tap(key);
        self.key(keys::CTRL, false);
    }

    /// Moves the pointer there.
    pub fn point(&self, at: [i16; 2]) {
        self.fake(MOTION_NOTIFY_EVENT, 0, at);
    }

    /// Moves the mouse by that much, wherever the pointer is.
    pub fn nudge(&self, by: [i16; 2]) {
        self.fake(MOTION_NOTIFY_EVENT, 1, by);
    }

    /// Holds a button of the mouse down (1: left, 3: right) or lets it go.
    pub fn button(&self, button: u8, down: bool) {
        self.fake(if down { BUTTON_PRESS_EVENT } else { BUTTON_RELEASE_EVENT }, button, [0, 0]);
    }

    fn fake(&self, kind: u8, detail: u8, [x, y]: [i16; 2]) {
        let sent = self.connection.xtest_fake_input(kind, detail, x11rb::CURRENT_TIME, self.root, x, y, 0);
        sent.expect("sent").check().expect("XTEST is part of Xvfb");
    }

    fn sync(&self) {
        self.connection.get_input_focus().expect("sent").reply().expect("an answer");
    }

    /// What is on the screen now.
    pub fn picture(&self) -> Picture {
        let [width, height] = self.size;
        let image = self.connection.get_image(ImageFormat::Z_PIXMAP, self.root, 0, 0, width, height, !0);
        let image = image.expect("sent").reply().expect("a picture");
        let pixels = image.data.chunks_exact(4).map(|bgrx| [bgrx[2], bgrx[1], bgrx[0]]).collect();
        Picture { size: [width.into(), height.into()], pixels }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

impl Picture {
    /// Writes it for people to look at.
    pub fn save(&self, name: &str) {
        let path = pictures().join(name);
        let [width, height] = self.size.map(|side| side as u32);
        image::save_buffer(path, self.pixels.as_flattened(), width, height, image::ExtendedColorType::Rgb8)
            .expect("written");
    }

    /// Brightness, 0 to 255, in a rectangle: mean and standard deviation.
    pub fn brightness(&self, [x0, y0, x1, y1]: [usize; 4]) -> (f64, f64) {
        let values: Vec<f64> = (y0..y1)
            .flat_map(|y| &self.pixels[y * self.size[0] + x0..y * self.size[0] + x1])
            .map(|rgb| rgb.iter().map(|part| f64::from(*part)).sum::<f64>() / 3.0)
            .collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / count;
        (mean, variance.sqrt())
    }

    /// The share of pixels of a rectangle that differ by more than noise.
    pub fn difference(&self, other: &Self, [x0, y0, x1, y1]: [usize; 4]) -> f64 {
        let at = |x: usize, y: usize| y * self.size[0] + x;
        let differs = |index: usize| {
            let (a, b) = (self.pixels[index], other.pixels[index]);
            (0..3).any(|part| a[part].abs_diff(b[part]) > 12)
        };
        let all = (x1 - x0) * (y1 - y0);
        let count = (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))).filter(|(x, y)| differs(at(*x, *y)));
        count.count() as f64 / all as f64
    }
}

/// Where pictures of the window go, for people to look at.
fn pictures() -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/window-test");
    std::fs::create_dir_all(&folder).expect("the target folder is ours");
    folder
}
