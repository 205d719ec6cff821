//! What a running stage can reach: the results it reads, and where its own files go.

use std::collections::HashMap;
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use genescape_cache::{ActionKey, ActionRecord, BlobRef, Bytes, Cache, Digest, How, KeyFields, Output};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::{Finished, Input, Node, NodeId, Source, StageError, Value, encode};

/// A file for other programs, by its name in the cache.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct File(BlobRef);

impl File {
    pub fn blob(&self) -> &BlobRef {
        &self.0
    }
}

/// A value of type `T` by its name in the cache.
#[derive(Debug, Serialize, Deserialize)]
#[serde(transparent, bound = "")]
pub struct Stored<T> {
    blob: BlobRef,
    #[serde(skip)]
    value: PhantomData<fn() -> T>,
}

impl<T> Clone for Stored<T> {
    fn clone(&self) -> Self {
        Self { blob: self.blob.clone(), value: PhantomData }
    }
}

/// The result of one node.
#[derive(Debug)]
pub struct Done {
    pub key: ActionKey,
    /// Its blobs: first the output itself, then those that it names.
    pub record: ActionRecord,
    /// Built or reused.
    pub how: How,
    memory: Mutex<Memory>,
}

/// Results in memory, as long as some stage may read them: the output, and what it names.
#[derive(Debug, Default)]
struct Memory {
    output: Option<Value>,
    blobs: HashMap<Digest, Content>,
}

/// The content of a blob.
#[derive(Clone, Debug)]
enum Content {
    Bytes(Bytes),
    Value(Value),
}

impl Done {
    /// The blob that holds the output.
    pub fn output_blob(&self) -> &BlobRef {
        &self.record.outputs[0].1
    }

    /// The output, which must be a `T`.
    ///
    /// # Errors
    /// [`StageError::InputLost`] if it is damaged.
    pub(crate) fn reread<T: DeserializeOwned>(&self, cache: &Cache) -> Result<T, StageError> {
        let bytes = cache.get_blob(self.output_blob())?.ok_or(StageError::InputLost)?;
        postcard::from_bytes(&bytes).map_err(|_| self.forget(cache))
    }

    /// Frees what is in memory: no other stage reads it.
    pub(crate) fn release(&self) {
        *self.memory() = Memory::default();
    }

    fn memory(&self) -> MutexGuard<'_, Memory> {
        self.memory.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The output. From the cache it is decoded once.
    fn output(&self, cache: &Cache, node: &Node) -> Result<Value, StageError> {
        if let Some(output) = &self.memory().output {
            return Ok(output.clone());
        }
        let bytes = cache.get_blob(self.output_blob())?.ok_or(StageError::InputLost)?;
        let decoded = node.stage.decode(&bytes).map_err(|_| self.forget(cache))?;
        Ok(self.memory().output.get_or_insert(decoded).clone())
    }

    /// For bytes that are intact but that this version of the program does not write: they will be made again.
    fn forget(&self, cache: &Cache) -> StageError {
        cache.forget(&self.key).map_or_else(StageError::Cache, |()| StageError::InputLost)
    }
}

/// Finished nodes as a stage, or its action key, sees them.
pub struct Context<'a> {
    cache: &'a Cache,
    nodes: &'a [Node],
    inputs: Finished,
    made: Mutex<Vec<(BlobRef, Bytes, Content)>>,
}

impl<'a> Context<'a> {
    pub(crate) fn new(cache: &'a Cache, nodes: &'a [Node], inputs: Finished) -> Self {
        Self { cache, nodes, inputs, made: Mutex::default() }
    }

    /// An input's value.
    ///
    /// # Errors
    /// [`StageError::InputLost`] if it is damaged.
    pub fn get<T: Send + Sync + 'static>(&self, input: &Input<T>) -> Result<Arc<T>, StageError> {
        let value = self.source(input.source)?.0;
        Ok(value.downcast().expect("an input has the type of its node's output"))
    }

    /// The values of several inputs, in their order.
    ///
    /// # Errors
    /// [`StageError::InputLost`] if one is damaged.
    pub fn get_all<T: Clone + Send + Sync + 'static>(
        &self,
        inputs: &[Input<T>],
    ) -> Result<Vec<T>, StageError> {
        inputs.iter().map(|input| Ok((*self.get(input)?).clone())).collect()
    }

    /// The bytes of a file that an input names.
    ///
    /// # Errors
    /// [`StageError::InputLost`] if it is damaged.
    pub fn bytes(&self, File(blob): &File) -> Result<Bytes, StageError> {
        match self.in_memory(blob.digest) {
            Some(Content::Bytes(bytes)) => Ok(bytes),
            _ => self.cache.get_blob(blob)?.ok_or(StageError::InputLost),
        }
    }

    /// A stored value that an input names. From the cache it is decoded once.
    ///
    /// # Errors
    /// [`StageError::InputLost`] if it is damaged.
    pub fn load<T>(&self, stored: &Stored<T>) -> Result<Arc<T>, StageError>
    where
        T: DeserializeOwned + Send + Sync + 'static,
    {
        let digest = stored.blob.digest;
        if let Some(Content::Value(value)) = self.in_memory(digest)
            && let Ok(value) = value.downcast()
        {
            return Ok(value);
        }
        let names_it = |(_, done): &&(NodeId, Arc<Done>)| {
            done.record.outputs.iter().any(|(_, blob)| blob.digest == digest)
        };
        let (_, owner) = self.inputs.iter().find(names_it).ok_or(StageError::InputLost)?;
        let bytes = self.cache.get_blob(&stored.blob)?.ok_or(StageError::InputLost)?;
        let value: Arc<T> = Arc::new(postcard::from_bytes(&bytes).map_err(|_| owner.forget(self.cache))?);
        owner.memory().blobs.insert(digest, Content::Value(value.clone()));
        Ok(value)
    }

    /// A new file. `ext` is its extension without a dot.
    pub fn file(&self, ext: &'static str, bytes: Vec<u8>) -> File {
        let bytes = Bytes::from(bytes);
        File(self.make(ext, bytes.clone(), Content::Bytes(bytes)))
    }

    /// A value in a blob of its own.
    pub fn store<T: Serialize + Send + Sync + 'static>(&self, value: T) -> Stored<T> {
        let bytes = encode(&value).into();
        Stored { blob: self.make("bin", bytes, Content::Value(Arc::new(value))), value: PhantomData }
    }

    fn make(&self, ext: &'static str, bytes: Bytes, content: Content) -> BlobRef {
        let blob = BlobRef::of(&bytes, ext).expect("a plain extension");
        self.made.lock().unwrap_or_else(PoisonError::into_inner).push((blob.clone(), bytes, content));
        blob
    }

    fn in_memory(&self, digest: Digest) -> Option<Content> {
        self.inputs.iter().find_map(|(_, done)| done.memory().blobs.get(&digest).cloned())
    }

    /// A value and the digest of its bytes; of a whole output the value only if it is asked for.
    fn source(&self, Source { node, part }: Source) -> Result<(Value, Digest), StageError> {
        let done = self.done(node);
        let output = done.output(self.cache, &self.nodes[node])?;
        Ok(match part {
            Some(part) => (self.nodes[node].parts[part].take)(&output),
            None => (output, done.output_blob().digest),
        })
    }

    fn done(&self, node: NodeId) -> &Done {
        let found = self.inputs.iter().find(|(id, _)| *id == node);
        &found.expect("a stage's inputs are finished before it").1
    }

    /// The action key of a node that reads these inputs.
    fn action_key(&self, node: &Node) -> Result<ActionKey, StageError> {
        let digest = |source: Source| -> Result<Digest, StageError> {
            match source.part {
                None => Ok(self.done(source.node).output_blob().digest),
                Some(_) => Ok(self.source(source)?.1),
            }
        };
        let inputs = node.inputs.iter().map(|(name, source)| Ok((name.clone(), digest(*source)?)));
        let inputs = inputs.collect::<Result<_, StageError>>()?;
        Ok(ActionKey::new(KeyFields { inputs, ..node.key.clone() }))
    }

    /// A node's result: from the cache, or by running its stage on `pool`. `started` is called before it runs.
    pub(crate) fn perform(
        &self,
        node: &Node,
        pool: &rayon::ThreadPool,
        started: impl FnOnce(),
    ) -> Result<Done, StageError> {
        let key = self.action_key(node)?;
        let mut memory = Memory::default();
        let build = || -> Result<Vec<Output>, StageError> {
            started();
            let outputs;
            (outputs, memory) = pool.install(|| self.run(node))?;
            Ok(outputs)
        };
        let outcome = self.cache.get_or_build(&key, build)?;
        Ok(Done { key, record: outcome.record, how: outcome.how, memory: Mutex::new(memory) })
    }

    /// Runs a node's stage: what is to be stored, the output first, and what may stay in memory.
    fn run(&self, node: &Node) -> Result<(Vec<Output>, Memory), StageError> {
        // A bug in one stage must not take the threads of the others with it.
        let result = catch_unwind(AssertUnwindSafe(|| node.stage.run(self)));
        let (output, bytes) = result.unwrap_or_else(|payload| {
            let text = payload.downcast_ref::<String>().cloned();
            let text = text.or_else(|| payload.downcast_ref::<&str>().map(|s| (*s).to_owned()));
            Err(StageError::Panicked(text.unwrap_or_else(|| "no message".into())))
        })?;
        let mut made = std::mem::take(&mut *self.made.lock().unwrap_or_else(PoisonError::into_inner));
        // Threads made them in any order.
        made.sort_by(|(a, ..), (b, ..)| a.cmp(b));
        made.dedup_by(|(a, ..), (b, ..)| a == b);
        let mut outputs = vec![Output::new("output", "bin", bytes)];
        let mut memory = Memory { output: Some(output), blobs: HashMap::new() };
        for (index, (blob, bytes, content)) in made.into_iter().enumerate() {
            let digest = Some(blob.digest);
            outputs.push(Output { name: index.to_string(), ext: blob.ext, bytes, digest });
            memory.blobs.insert(blob.digest, content);
        }
        Ok((outputs, memory))
    }
}
