//! Reads landscapes and brings them to the device on a thread of its own, so that the pictures go on meanwhile.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryIter, channel};
use std::thread;

use crate::baker;
use crate::gpu::Gpu;
use crate::passes::Passes;
use crate::scene_loader::{Loaded, SceneLoader};

/// A landscape to read.
pub struct Request {
    /// Which of the four views it is for.
    pub view: usize,
    pub generation: u32,
    /// Its `scene.gltf`.
    pub path: PathBuf,
    /// What draws its shadows.
    pub passes: Arc<Passes>,
}

/// A landscape that was read, or why not.
pub struct Reply {
    pub view: usize,
    pub generation: u32,
    /// An error is text for people.
    pub result: Result<Loaded, String>,
}

/// The thread; ends when dropped.
pub struct Loader {
    requests: Sender<Request>,
    replies: Receiver<Reply>,
}

impl Loader {
    /// Starts it. `wake` is called when there is something new in [`Loader::replies`].
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn start(gpu: &Gpu, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let (requests, asked) = channel::<Request>();
        let (answer, replies) = channel();
        let gpu = gpu.clone();
        thread::Builder::new().name("loader".into()).spawn(move || {
            baker::lower_priority();
            let loader = SceneLoader::new(&gpu);
            while let Ok(Request { view, generation, path, passes }) = asked.recv() {
                let result = loader.load(&path, &passes).map_err(|error| error.to_string());
                if answer.send(Reply { view, generation, result }).is_err() {
                    return;
                }
                wake();
            }
        })?;
        Ok(Self { requests, replies })
    }

    /// Asks for a landscape.
    pub fn ask(&self, request: Request) {
        // The thread ends before this only by a panic, and then the views keep what they have.
        let _ = self.requests.send(request);
    }

    /// What was read since the last call. Never waits.
    pub fn replies(&self) -> TryIter<'_, Reply> {
        self.replies.try_iter()
    }
}
