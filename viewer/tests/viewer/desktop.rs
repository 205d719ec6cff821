//! Another program on the desktop: a window on which files can be dropped (XDND 5), and that can paste.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use x11rb::atom_manager;
use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ClientMessageEvent, ConnectionExt as _, CreateWindowAux, EventMask, PropMode, Window,
    WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use crate::display::Display;

/// The longest that anything may take.
const LIMIT: Duration = Duration::from_secs(120);

atom_manager! {
    Atoms: AtomsCookie {
        XdndAware, XdndSelection, XdndEnter, XdndPosition, XdndStatus, XdndLeave, XdndDrop, XdndFinished,
        XdndActionCopy, CLIPBOARD, RECEIVED, UriList: b"text/uri-list",
    }
}

/// A program with one window.
pub struct Program {
    connection: RustConnection,
    atoms: Atoms,
    window: Window,
    /// Whether it takes what is dropped.
    accepts: bool,
    /// What it was told, in order.
    pub heard: Vec<&'static str>,
}

impl Program {
    /// Shows its window there: left, top, width, height.
    pub fn open(display: &Display, [x, y, width, height]: [i16; 4], accepts: bool) -> Self {
        let (connection, screen) = x11rb::connect(Some(&display.name)).expect("Xvfb takes us in");
        let atoms = Atoms::new(&connection).expect("sent").reply().expect("atoms");
        let root = connection.setup().roots[screen].root;
        let window = connection.generate_id().expect("a number");
        let (width, height) = (width as u16, height as u16);
        let kind = WindowClass::INPUT_OUTPUT;
        let look = CreateWindowAux::new().background_pixel(0x00ff_8800);
        connection.create_window(0, window, root, x, y, width, height, 0, kind, 0, &look).expect("sent");
        let version = [5];
        let replace = PropMode::REPLACE;
        connection
            .change_property32(replace, window, atoms.XdndAware, AtomEnum::ATOM, &version)
            .expect("sent");
        connection.map_window(window).expect("sent").check().expect("shown");
        Self { connection, atoms, window, accepts, heard: Vec::new() }
    }

    /// Waits for files to be dropped on the window.
    pub fn dropped(&mut self) -> Vec<PathBuf> {
        self.until("files are dropped", |program, event| match event {
            Event::ClientMessage(message) => {
                program.told(message);
                None
            }
            Event::SelectionNotify(notice) => {
                assert_ne!(notice.property, x11rb::NONE, "the files are refused");
                Some(program.received())
            }
            _ => None,
        })
    }

    /// Waits until it has heard that of a drag.
    pub fn hears(&mut self, what: &'static str) {
        self.until(what, |program, event| {
            if let Event::ClientMessage(message) = event {
                program.told(message);
            }
            program.heard.contains(&what).then_some(())
        });
    }

    /// The files on the clipboard.
    pub fn pasted(&mut self) -> Vec<PathBuf> {
        self.ask_for(self.atoms.CLIPBOARD, x11rb::CURRENT_TIME);
        self.until("files are pasted", |program, event| {
            matches!(event, Event::SelectionNotify(_)).then(|| program.received())
        })
    }

    fn until<T>(&mut self, what: &str, so: impl Fn(&mut Self, &Event) -> Option<T>) -> T {
        let start = Instant::now();
        loop {
            while let Some(event) = self.connection.poll_for_event().expect("connected") {
                if let Some(found) = so(self, &event) {
                    return found;
                }
            }
            assert!(start.elapsed() < LIMIT, "still not: {what}; heard {:?}", self.heard);
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// A message of the drag's source.
    fn told(&mut self, message: &ClientMessageEvent) {
        let data = message.data.as_data32();
        let source = data[0];
        let Atoms { XdndEnter, XdndPosition, XdndLeave, XdndDrop, .. } = self.atoms;
        let what = match message.type_ {
            kind if kind == XdndEnter => {
                assert_eq!((data[1] >> 24, data[2]), (5, self.atoms.UriList));
                "enter"
            }
            kind if kind == XdndPosition => {
                let accepts = u32::from(self.accepts);
                let copy = self.atoms.XdndActionCopy;
                self.answer(
                    source,
                    self.atoms.XdndStatus,
                    [accepts, 0, 0, if self.accepts { copy } else { 0 }],
                );
                "position"
            }
            kind if kind == XdndLeave => "leave",
            kind if kind == XdndDrop => {
                self.ask_for(self.atoms.XdndSelection, data[2]);
                self.answer(source, self.atoms.XdndFinished, [1, self.atoms.XdndActionCopy, 0, 0]);
                "drop"
            }
            _ => "something else",
        };
        if self.heard.last() != Some(&what) {
            self.heard.push(what);
        }
    }

    fn answer(&self, to: Window, kind: Atom, [a, b, c, d]: [u32; 4]) {
        let message = ClientMessageEvent::new(32, to, kind, [self.window, a, b, c, d]);
        self.connection.send_event(false, to, EventMask::NO_EVENT, message).expect("sent");
        self.connection.flush().expect("sent");
    }

    fn ask_for(&self, selection: Atom, time: u32) {
        let Atoms { UriList, RECEIVED, .. } = self.atoms;
        self.connection.convert_selection(self.window, selection, UriList, RECEIVED, time).expect("sent");
        self.connection.flush().expect("sent");
    }

    fn received(&self) -> Vec<PathBuf> {
        let property =
            self.connection.get_property(true, self.window, self.atoms.RECEIVED, AtomEnum::ANY, 0, 4096);
        let bytes = property.expect("sent").reply().expect("an answer").value;
        let text = String::from_utf8(bytes).expect("ASCII");
        let path = |line: &str| line.trim().strip_prefix("file://").expect("a file's URI").into();
        text.lines().map(path).collect()
    }
}
