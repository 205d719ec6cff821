//! Stages, and the graph that says which stage reads which results of which other.
//!
//! A stage is a value: its fields are the parameters it reads and the results of earlier stages that it reads, as
//! [`Input`]s. So what is in a stage *is* its action key: the parameters by their bytes, the inputs by the digests of
//! what they refer to. A stage cannot read what is not in it, for only an `Input` leads to another stage's result.
//!
//! A result is one value of the stage's output type. Bytes that are files for other programs ([`File`]) and large
//! values that only some readers need ([`Stored`]) are blobs of their own; the value holds their names.

mod context;

use std::any::{Any, TypeId};
use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

use genescape_cache::{Digest, KeyFields};
use serde::de::DeserializeOwned;
use serde::{Serialize, Serializer};
use serde_json::Value as Json;

pub use context::{Context, Done, File, Stored};

use crate::gltf::ExportError;

/// A pure function from what is in it to its output. No I/O, no clock, no global state, no unseeded randomness.
pub trait Stage: Serialize + Send + Sync + 'static {
    /// Its name in messages, in the cache and in `bake explain`.
    const NAME: &'static str;
    /// To be raised whenever the same input gives another output: cached results of other versions are not used.
    const VERSION: u32;
    type Output: Serialize + DeserializeOwned + Send + Sync + 'static;

    /// Computes the output.
    ///
    /// # Errors
    /// A file that cannot be made, or an input that turns out damaged.
    fn run(&self, context: &Context<'_>) -> Result<Self::Output, StageError>;

    /// Distinguishes it from other nodes of the same stage: "tree 3".
    fn label(&self) -> String {
        Self::NAME.to_owned()
    }
}

/// Why a stage gave no result.
#[derive(Debug, thiserror::Error)]
pub enum StageError {
    /// A result that it reads was lost, damaged, or is not what this program writes; the cache has forgotten it, and
    /// another attempt makes it again.
    #[error(
        "what it reads from the cache was lost or damaged again and again; does another program write to baked/?"
    )]
    InputLost,
    #[error(transparent)]
    Gltf(#[from] ExportError),
    #[error(transparent)]
    Cache(#[from] genescape_cache::Error),
    /// A bug.
    #[error("the stage panicked: {0}; this is a bug in Genescape, please report it with the population file")]
    Panicked(String),
}

/// Index of a node in a graph.
pub type NodeId = usize;

/// The output of an earlier stage, or a part of it, as a field of a stage that reads it.
pub struct Input<T> {
    source: Source,
    value: PhantomData<fn() -> T>,
}

impl<T> Clone for Input<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Input<T> {}

impl<T> fmt::Debug for Input<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.source)
    }
}

impl<T> Input<T> {
    fn new(node: NodeId, part: Option<usize>) -> Self {
        Self { source: Source { node, part }, value: PhantomData }
    }

    /// The node that gives it.
    pub fn node(&self) -> NodeId {
        self.source.node
    }
}

/// Name of the only field of an input's JSON form.
const SOURCE: &str = "$source";

impl<T> Serialize for Input<T> {
    /// In JSON the place in the graph, for [`Node::new`] to find all inputs of a stage; among the bytes of its
    /// parameters nothing, since its digest is a field of the action key.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeMap;
        if !serializer.is_human_readable() {
            return serializer.serialize_unit();
        }
        let mut map = serializer.serialize_map(Some(1))?;
        map.serialize_entry(SOURCE, &(self.source.node, self.source.part))?;
        map.end()
    }
}

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// Always an earlier node.
    pub node: NodeId,
    /// Which of [`Node`]'s parts; `None` for all of its output.
    part: Option<usize>,
}

/// The nodes that a node reads, each with its result.
pub(crate) type Finished = Vec<(NodeId, Arc<Done>)>;

/// A stage's output or a part of it.
type Value = Arc<dyn Any + Send + Sync>;

/// A stage with its types erased.
trait AnyStage: Send + Sync {
    fn run(&self, context: &Context<'_>) -> Result<(Value, Vec<u8>), StageError>;
    fn decode(&self, bytes: &[u8]) -> postcard::Result<Value>;
}

impl<S: Stage> AnyStage for S {
    fn run(&self, context: &Context<'_>) -> Result<(Value, Vec<u8>), StageError> {
        let output = Stage::run(self, context)?;
        let bytes = encode(&output);
        Ok((Arc::new(output), bytes))
    }

    fn decode(&self, bytes: &[u8]) -> postcard::Result<Value> {
        Ok(Arc::new(postcard::from_bytes::<S::Output>(bytes)?))
    }
}

fn encode<T: Serialize>(value: &T) -> Vec<u8> {
    postcard::to_allocvec(value).expect("results are plain data of known length")
}

/// One stage of a graph.
pub struct Node {
    stage: Box<dyn AnyStage>,
    /// For people: "tree 3".
    pub label: String,
    /// The action key without the inputs' digests.
    key: KeyFields,
    /// What it reads, by field, in the order of the fields.
    pub inputs: Vec<(String, Source)>,
    /// The scenes that use it.
    pub scenes: Vec<usize>,
    parts: Vec<Part>,
}

/// From an output to a part of it and the digest of the part's bytes.
type TakePart = dyn Fn(&Value) -> (Value, Digest) + Send + Sync;

/// A part of a node's output that some stage reads instead of all of it.
struct Part {
    /// Type of the function that takes it out: equal functions, equal parts.
    identity: TypeId,
    take: Box<TakePart>,
}

impl Node {
    fn new<S: Stage>(stage: S) -> Self {
        let parameters = encode(&stage);
        let (mut named, mut inputs) = (Vec::new(), Vec::new());
        // A stage is plain data with string keys, which JSON can always hold.
        list_fields("", &serde_json::to_value(&stage).unwrap_or_default(), &mut named, &mut inputs);
        let key = KeyFields {
            stage: S::NAME.to_owned(),
            version: S::VERSION,
            parameters,
            named,
            inputs: Vec::new(),
        };
        let label = stage.label();
        Self { stage: Box::new(stage), label, key, inputs, scenes: Vec::new(), parts: Vec::new() }
    }

    /// Name and version of its stage.
    pub fn stage(&self) -> (&str, u32) {
        (&self.key.stage, self.key.version)
    }

    /// Whether both do the same work on the same inputs.
    fn is_same(&self, other: &Self) -> bool {
        self.key == other.key && self.inputs == other.inputs
    }
}

/// A stage's fields: parameters as names and values, inputs as names and where they come from. Nested fields go by the
/// innermost name, as genes do, and pairs of a name and a value count as fields.
fn list_fields(
    name: &str,
    value: &Json,
    parameters: &mut Vec<(String, String)>,
    inputs: &mut Vec<(String, Source)>,
) {
    match value {
        Json::Object(fields) => match fields.get(SOURCE) {
            Some(source) => {
                let (node, part) = serde_json::from_value(source.clone()).expect("written by Input");
                inputs.push((name.to_owned(), Source { node, part }));
            }
            None => fields.iter().for_each(|(name, value)| list_fields(name, value, parameters, inputs)),
        },
        Json::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                match item.as_array().map(Vec::as_slice) {
                    Some([Json::String(name), value]) => list_fields(name, value, parameters, inputs),
                    _ => list_fields(&format!("{name} {index}"), item, parameters, inputs),
                }
            }
        }
        other => parameters.push((name.to_owned(), other.to_string())),
    }
}

/// Stages in an order in which inputs come first. Nodes that do the same work on the same inputs are one node.
#[derive(Default)]
pub struct Graph {
    pub nodes: Vec<Node>,
}

impl Graph {
    /// Adds a stage for a scene, or finds it; its output.
    pub fn add<S: Stage>(&mut self, scene: usize, stage: S) -> Input<S::Output> {
        let node = Node::new(stage);
        let found = self.nodes.iter().position(|known| known.is_same(&node));
        let id = found.unwrap_or_else(|| {
            self.nodes.push(node);
            self.nodes.len() - 1
        });
        let scenes = &mut self.nodes[id].scenes;
        if !scenes.contains(&scene) {
            scenes.push(scene);
        }
        Input::new(id, None)
    }

    /// A part of an output, so that a stage which reads no more is not run again when the rest changes.
    pub fn part<O, T, F>(&mut self, output: Input<O>, take: F) -> Input<T>
    where
        O: Send + Sync + 'static,
        T: Serialize + Send + Sync + 'static,
        F: Fn(&O) -> T + Send + Sync + 'static,
    {
        debug_assert!(output.source.part.is_none(), "a part of an output, not of a part");
        let identity = TypeId::of::<F>();
        let parts = &mut self.nodes[output.node()].parts;
        let known = parts.iter().position(|part| part.identity == identity);
        let index = known.unwrap_or_else(|| {
            let take = move |whole: &Value| {
                let part = take(whole.downcast_ref().expect("an input has the type of its node's output"));
                let digest = Digest::of(&encode(&part));
                (Arc::new(part) as Value, digest)
            };
            parts.push(Part { identity, take: Box::new(take) });
            parts.len() - 1
        });
        Input::new(output.node(), Some(index))
    }
}
