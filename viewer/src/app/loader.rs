//! Reads landscapes and brings them to the device on a thread of its own, so that the pictures go on meanwhile.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryIter, channel};
use std::thread;

use thread_priority::{ThreadPriority, set_current_thread_priority};

use crate::gpu::Gpu;
use crate::load::{self, Store};
use crate::passes::Passes;
use crate::upload::{SceneBuffers, Uploader};
use crate::walk::Land;

/// Below whoever draws, as in [`crate::baker`].
const PRIORITY: u8 = 25;

/// A landscape to read.
pub struct Request {
    /// Which of the four views it is for.
    pub view: usize,
    /// Its generation.
    pub generation: u32,
    /// Its `scene.gltf`.
    pub path: PathBuf,
    /// What draws its shadows.
    pub passes: Arc<Passes>,
}

/// A landscape that was read, or why not.
pub struct Reply {
    /// Which of the four views it is for.
    pub view: usize,
    /// Its generation.
    pub generation: u32,
    /// What was read; an error is text for people.
    pub result: Result<Ready, String>,
}

/// All that a view needs of a landscape.
pub struct Ready {
    /// What is drawn.
    pub buffers: Arc<SceneBuffers>,
    /// What a walker meets.
    pub land: Arc<Land>,
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
            if let Ok(priority) = PRIORITY.try_into() {
                // Without this right it is merely less polite.
                let _ = set_current_thread_priority(ThreadPriority::Crossplatform(priority));
            }
            let (store, uploader) = (Store::default(), Uploader::new(&gpu));
            while let Ok(request) = asked.recv() {
                let result = read(&gpu, &store, &uploader, &request);
                let reply = Reply { view: request.view, generation: request.generation, result };
                if answer.send(reply).is_err() {
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

fn read(gpu: &Gpu, store: &Store, uploader: &Uploader, request: &Request) -> Result<Ready, String> {
    let scene = load::load(&request.path, store).map_err(|error| error.to_string())?;
    let buffers = uploader.upload(&scene)?;
    let passes = &request.passes;
    passes.shadow.bake(gpu, &passes.layouts, &passes.cull, &buffers);
    // Shadows are done before the views see the landscape: a picture never waits for them.
    gpu.wait();
    Ok(Ready { buffers: Arc::new(buffers), land: Arc::new(Land::of(&scene)) })
}
