//! Reads landscapes and brings them to the device on threads of its own, so that the pictures go on meanwhile.
//!
//! Where the processor draws, a landscape's shadows take longer than all the rest: it is handed over with those around the
//! eye, and the others are drawn when they are asked for, after every landscape that is waited for.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryIter, TryRecvError, channel};

use glam::Vec2;

use crate::baker;
use crate::gpu::Gpu;
use crate::passes::Passes;
use crate::scene_loader::{Loaded, SceneLoader};
use crate::upload::SceneBuffers;
use crate::walk::Anchor;

/// A landscape to read.
pub struct Request {
    /// Which of the four views it is for.
    pub view: usize,
    pub generation: u32,
    /// Its `scene.gltf`.
    pub path: PathBuf,
    /// From where it will be seen: x and z of the walk in metres.
    pub eye_m: Vec2,
    /// Where the walk lies in it; `None` where it does from its start.
    pub anchor: Option<Anchor>,
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

/// The thread; ends when dropped, which waits for it.
pub struct Loader {
    tasks: Sender<Task>,
    replies: Receiver<Reply>,
    shadowed: Receiver<Arc<SceneBuffers>>,
}

enum Task {
    Load(Request),
    FinishShadows(Arc<SceneBuffers>, Arc<Passes>),
}

impl Loader {
    /// Starts it. `wake` is called when there is something new in [`Loader::replies`] or [`Loader::shadowed`].
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn start(gpu: &Gpu, wake: impl Fn() + Send + 'static) -> Result<Self, rayon::ThreadPoolBuildError> {
        let (tasks, asked) = channel();
        let (answer, replies) = channel();
        let (finished, shadowed) = channel();
        let (gpu, wake, unfinished) = (gpu.clone(), Box::new(wake), VecDeque::new());
        baker::readers()?.spawn(move || {
            let loader = SceneLoader::new(&gpu);
            Worker { loader, gpu, asked, answer, finished, wake, unfinished }.run();
        });
        Ok(Self { tasks, replies, shadowed })
    }

    /// Asks for a landscape.
    pub fn ask(&self, request: Request) {
        self.send(Task::Load(request));
    }

    /// Asks for the shadows that a landscape came without.
    pub fn finish_shadows(&self, buffers: Arc<SceneBuffers>, passes: Arc<Passes>) {
        self.send(Task::FinishShadows(buffers, passes));
    }

    fn send(&self, task: Task) {
        // The thread ends before this only by a panic, and then the views keep what they have.
        let _ = self.tasks.send(task);
    }

    /// What was read since the last call. Never waits.
    pub fn replies(&self) -> TryIter<'_, Reply> {
        self.replies.try_iter()
    }

    /// What has got the rest of its shadows since the last call. Never waits.
    pub fn shadowed(&self) -> TryIter<'_, Arc<SceneBuffers>> {
        self.shadowed.try_iter()
    }
}

impl Drop for Loader {
    /// The thread may be the last to hold the device. Letting go of that unloads the driver, and to do so while the process
    /// ends crashes in it.
    fn drop(&mut self) {
        self.tasks = channel().0;
        while self.replies.recv().is_ok() {}
    }
}

/// The thread's side.
struct Worker {
    // In this order: who sees `answer` closed knows that the device was let go of.
    loader: SceneLoader,
    gpu: Gpu,
    asked: Receiver<Task>,
    // Nobody listens any more only when the window is gone.
    answer: Sender<Reply>,
    finished: Sender<Arc<SceneBuffers>>,
    wake: Box<dyn Fn() + Send>,
    unfinished: VecDeque<(Arc<SceneBuffers>, Arc<Passes>)>,
}

impl Worker {
    fn run(mut self) {
        while let Ok(task) = self.asked.recv() {
            self.begin(task);
            while let Some((buffers, passes)) = self.unfinished.pop_front() {
                self.finish_shadows(&buffers, &passes);
                let _ = self.finished.send(buffers);
                (self.wake)();
            }
        }
    }

    fn begin(&mut self, task: Task) {
        match task {
            Task::Load(request) => self.load(request),
            Task::FinishShadows(buffers, passes) => self.unfinished.push_back((buffers, passes)),
        }
    }

    fn load(&self, Request { view, generation, path, eye_m, anchor, passes }: Request) {
        let result = match self.gpu.software {
            true => self.loader.load_with_near_shadows(&path, &passes, eye_m, anchor),
            false => self.loader.load(&path, &passes),
        };
        let result = result.map_err(|error| error.to_string());
        let _ = self.answer.send(Reply { view, generation, result });
        (self.wake)();
    }

    /// Whatever is asked for meanwhile comes first.
    fn finish_shadows(&mut self, buffers: &SceneBuffers, passes: &Passes) {
        let gpu = self.gpu.clone();
        let bake = passes.shadow.begin(&gpu, passes, buffers);
        let mut next = Some(0);
        while let Some(first) = next {
            loop {
                match self.asked.try_recv() {
                    Ok(task) => self.begin(task),
                    Err(TryRecvError::Empty) => break,
                    Err(TryRecvError::Disconnected) => return,
                }
            }
            next = bake.trees_from(first);
        }
    }
}
