//! The source's side of XDND 5 (freedesktop.org), for files that are copied: tells whatever window is under the pointer
//! that files are held over it, and hands them over when they are dropped there.

use std::cell::OnceCell;
use std::path::PathBuf;
use std::sync::mpsc::Receiver;
use std::thread;
use std::time::{Duration, Instant};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_encode};
use x11rb::atom_manager;
use x11rb::connection::Connection;
use x11rb::errors::ReplyOrIdError;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ClientMessageEvent, ConnectionExt as _, CreateWindowAux, EventMask, KeyButMask, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, SelectionRequestEvent, Timestamp, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

/// The version of the protocol that we speak.
const VERSION: u32 = 5;
/// Between two looks at the pointer.
const LOOK_EVERY: Duration = Duration::from_millis(15);
/// The longest that a window may take to say whether it wants what is dropped on it.
const ANSWERS_WITHIN: Duration = Duration::from_secs(2);
/// The longest that a window may take to fetch the files, which may still have to be written.
const FETCHES_WITHIN: Duration = Duration::from_secs(120);
/// What stands in a URI as it is.
const PATH: &AsciiSet = &NON_ALPHANUMERIC.remove(b'/').remove(b'-').remove(b'_').remove(b'.').remove(b'~');

atom_manager! {
    Atoms: AtomsCookie {
        XdndAware, XdndSelection, XdndEnter, XdndPosition, XdndStatus, XdndLeave, XdndDrop, XdndFinished,
        XdndActionCopy, TARGETS, UriList: b"text/uri-list",
    }
}

/// Follows the pointer until the button is let go, over whatever window that is but `own`; then hands over the files.
/// Without a server that goes on answering, nothing is dropped.
pub fn drag(own: Window, files: Receiver<Vec<PathBuf>>) {
    let _ = Source::open(own, files).and_then(|source| {
        source.run()?;
        // A connection that is closed while answers lie unread takes with it what was not yet read over there.
        Ok(source.connection.sync()?)
    });
}

struct Source {
    connection: RustConnection,
    atoms: Atoms,
    root: Window,
    /// The application's window, on which nothing can be dropped.
    own: Window,
    /// Whom the others answer; never shown.
    window: Window,
    /// When the drag began, by the server's clock.
    began: Timestamp,
    files: Receiver<Vec<PathBuf>>,
    /// What came from there, as URIs; empty if nothing will come.
    list: OnceCell<String>,
}

/// The window that is under the pointer and takes drops.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Target {
    window: Window,
    version: u32,
}

/// What is known of the target.
#[derive(Clone, Copy, Default)]
struct Answer {
    /// It was told of a place, and has not answered yet.
    awaited: bool,
    /// It takes what is dropped there.
    accepts: bool,
}

type Fallible<T> = Result<T, ReplyOrIdError>;

impl Source {
    fn open(own: Window, files: Receiver<Vec<PathBuf>>) -> Fallible<Self> {
        let (connection, screen) =
            x11rb::connect(None).map_err(|_| x11rb::errors::ConnectionError::UnknownError)?;
        let atoms = Atoms::new(&connection)?.reply()?;
        let root = connection.setup().roots[screen].root;
        let window = connection.generate_id()?;
        let listening = CreateWindowAux::new().event_mask(EventMask::PROPERTY_CHANGE);
        let only_input = WindowClass::INPUT_ONLY;
        connection.create_window(0, window, root, -1, -1, 1, 1, 0, only_input, 0, &listening)?;
        let (began, list) = (x11rb::CURRENT_TIME, OnceCell::new());
        let mut source = Self { connection, atoms, root, own, window, began, files, list };
        source.began = source.time()?;
        source.connection.set_selection_owner(window, atoms.XdndSelection, source.began)?;
        Ok(source)
    }

    /// The server's clock: it tells the time of changes.
    fn time(&self) -> Fallible<Timestamp> {
        let none: [u8; 0] = [];
        self.connection.change_property8(
            PropMode::APPEND,
            self.window,
            AtomEnum::WM_NAME,
            AtomEnum::STRING,
            &none,
        )?;
        self.connection.flush()?;
        loop {
            if let Event::PropertyNotify(event) = self.connection.wait_for_event()? {
                return Ok(event.time);
            }
        }
    }

    fn run(&self) -> Fallible<()> {
        let (mut target, mut answer, mut told) = (None, Answer::default(), None);
        loop {
            let pointer = self.connection.query_pointer(self.root)?.reply()?;
            let place = (pointer.root_x, pointer.root_y);
            if !pointer.mask.contains(KeyButMask::BUTTON1) {
                break;
            }
            let found = self.target_at(place)?;
            if found != target {
                self.leave(target)?;
                self.enter(found)?;
                (target, answer, told) = (found, Answer::default(), None);
            }
            if let Some(target) = target
                && told != Some(place)
                && !answer.awaited
            {
                self.position(target, place)?;
                (told, answer.awaited) = (Some(place), true);
            }
            self.hear(target, &mut answer)?;
            thread::sleep(LOOK_EVERY);
        }
        self.drop_on(target, answer)
    }

    /// The button was let go over `target`.
    fn drop_on(&self, target: Option<Target>, mut answer: Answer) -> Fallible<()> {
        let Some(to) = target else { return Ok(()) };
        let end = Instant::now() + ANSWERS_WITHIN;
        while answer.awaited && Instant::now() < end {
            self.hear(target, &mut answer)?;
            thread::sleep(LOOK_EVERY);
        }
        if !answer.accepts {
            return self.leave(target);
        }
        self.send(to, self.atoms.XdndDrop, [0, self.began, 0, 0])?;
        let end = Instant::now() + FETCHES_WITHIN;
        while !self.hear(target, &mut answer)? && Instant::now() < end {
            thread::sleep(LOOK_EVERY);
        }
        Ok(())
    }

    /// The uppermost window that takes drops, under a place on the screen.
    fn target_at(&self, (x, y): (i16, i16)) -> Fallible<Option<Target>> {
        let mut window = self.root;
        loop {
            // A window may go at any time.
            let inside = self.connection.translate_coordinates(self.root, window, x, y)?.reply();
            window = inside.map_or(x11rb::NONE, |inside| inside.child);
            if window == x11rb::NONE || window == self.own {
                return Ok(None);
            }
            let aware = self.atoms.XdndAware;
            let property = self.connection.get_property(false, window, aware, AtomEnum::ATOM, 0, 1)?;
            let Ok(property) = property.reply() else { return Ok(None) };
            if let Some(version) = property.value32().and_then(|mut values| values.next()) {
                return Ok(Some(Target { window, version: version.min(VERSION) }));
            }
        }
    }

    fn enter(&self, target: Option<Target>) -> Fallible<()> {
        let Some(target) = target else { return Ok(()) };
        self.send(target, self.atoms.XdndEnter, [target.version << 24, self.atoms.UriList, 0, 0])
    }

    fn position(&self, target: Target, (x, y): (i16, i16)) -> Fallible<()> {
        let place = (u32::from(x as u16) << 16) | u32::from(y as u16);
        self.send(target, self.atoms.XdndPosition, [0, place, self.began, self.atoms.XdndActionCopy])
    }

    fn leave(&self, target: Option<Target>) -> Fallible<()> {
        let Some(target) = target else { return Ok(()) };
        self.send(target, self.atoms.XdndLeave, [0; 4])
    }

    fn send(&self, target: Target, kind: Atom, [a, b, c, d]: [u32; 4]) -> Fallible<()> {
        let message = ClientMessageEvent::new(32, target.window, kind, [self.window, a, b, c, d]);
        self.connection.send_event(false, target.window, EventMask::NO_EVENT, message)?;
        self.connection.flush()?;
        Ok(())
    }

    /// Takes in what came from the target; `true` when it has fetched what it wanted.
    fn hear(&self, target: Option<Target>, answer: &mut Answer) -> Fallible<bool> {
        while let Some(event) = self.connection.poll_for_event()? {
            match event {
                Event::ClientMessage(message) => {
                    let data = message.data.as_data32();
                    if target.is_none_or(|target| target.window != data[0]) {
                        continue;
                    }
                    if message.type_ == self.atoms.XdndStatus {
                        *answer = Answer { awaited: false, accepts: data[1] & 1 == 1 };
                    } else if message.type_ == self.atoms.XdndFinished {
                        return Ok(true);
                    }
                }
                Event::SelectionRequest(request) => self.answer(&request)?,
                _ => {}
            }
        }
        Ok(false)
    }

    /// The files, when they are written.
    fn list(&self) -> &str {
        let written = || self.files.recv_timeout(FETCHES_WITHIN).unwrap_or_default();
        self.list.get_or_init(|| uri_list(&written()))
    }

    /// Gives a window the list of files, or refuses what else it asks for.
    fn answer(&self, request: &SelectionRequestEvent) -> Fallible<()> {
        let (to, as_what) = (request.requestor, request.property);
        let property = if request.target == self.atoms.TARGETS {
            let targets = [self.atoms.TARGETS, self.atoms.UriList];
            self.connection.change_property32(PropMode::REPLACE, to, as_what, AtomEnum::ATOM, &targets)?;
            as_what
        } else if request.target == self.atoms.UriList && !self.list().is_empty() {
            let (kind, list) = (self.atoms.UriList, self.list().as_bytes());
            self.connection.change_property8(PropMode::REPLACE, to, as_what, kind, list)?;
            as_what
        } else {
            x11rb::NONE
        };
        let notice = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: request.time,
            requestor: to,
            selection: request.selection,
            target: request.target,
            property,
        };
        self.connection.send_event(false, to, EventMask::NO_EVENT, notice)?;
        self.connection.flush()?;
        Ok(())
    }
}

/// Files as `text/uri-list` (RFC 2483).
fn uri_list(files: &[PathBuf]) -> String {
    let uri =
        |path: &PathBuf| format!("file://{}\r\n", percent_encode(path.as_os_str().as_encoded_bytes(), PATH));
    files.iter().map(uri).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_written_as_uris() {
        let list = uri_list(&["/a b/ö#1.glb".into(), "/c.glb".into()]);
        assert_eq!(list, "file:///a%20b/%C3%B6%231.glb\r\nfile:///c.glb\r\n");
    }
}
