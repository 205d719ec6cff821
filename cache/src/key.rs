//! Everything that a result may depend on → its action key.
//!
//! The key is a BLAKE3 hash in a domain of its own over fields that are each framed by their length, so that no two
//! different lists of fields give the same bytes. The fields are kept beside the hash: they say later what changed.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::{Digest, Error, Result};

/// The domain of the hash; its number changes when the meaning of cached results does.
const DOMAIN: &str = "genescape 2026 cache: action key 1";

/// What an action key was made of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyFields {
    pub stage: String,
    /// Version of the stage's code: raised whenever its output changes.
    pub version: u32,
    /// The parameters that the stage reads, as postcard.
    pub parameters: Vec<u8>,
    /// The same parameters for people: name and value. Not part of the hash: `parameters` says it all.
    pub named: Vec<(String, String)>,
    /// Digests of what the stage reads, by name, in order.
    pub inputs: Vec<(String, Digest)>,
}

impl KeyFields {
    /// The hash over all fields but `named`, each preceded by its length, and at last over their number.
    fn digest(&self) -> Digest {
        let version = self.version.to_le_bytes();
        let inputs = self.inputs.iter().flat_map(|(name, digest)| [name.as_bytes(), digest.as_bytes()]);
        let fields = [self.stage.as_bytes(), &version, &self.parameters].into_iter().chain(inputs);
        let (mut hasher, mut count) = (blake3::Hasher::new_derive_key(DOMAIN), 0_u64);
        for field in fields {
            hasher.update(&(field.len() as u64).to_le_bytes());
            hasher.update(field);
            count += 1;
        }
        hasher.update(&count.to_le_bytes());
        Digest::from_bytes(*hasher.finalize().as_bytes())
    }
}

/// The name of an action, with the fields that it was made of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ActionKey {
    digest: Digest,
    fields: KeyFields,
}

impl ActionKey {
    /// Begins the key of an action of `stage`, whose code has `version`.
    pub fn builder(stage: impl Into<String>, version: u32) -> KeyBuilder {
        let (stage, parameters) = (stage.into(), Vec::new());
        KeyBuilder { fields: KeyFields { stage, version, parameters, named: Vec::new(), inputs: Vec::new() } }
    }

    /// The key of an action that depends on `fields`.
    pub fn new(fields: KeyFields) -> Self {
        Self { digest: fields.digest(), fields }
    }

    pub fn digest(&self) -> Digest {
        self.digest
    }

    pub fn fields(&self) -> &KeyFields {
        &self.fields
    }
}

/// Collects the fields of an [`ActionKey`].
#[derive(Clone, Debug)]
pub struct KeyBuilder {
    fields: KeyFields,
}

impl KeyBuilder {
    /// The parameters that the stage reads, all of them and no others; hashed as postcard. Not a hash map or set:
    /// their order is not canonical. Called again, adds to them.
    ///
    /// # Errors
    /// If they cannot be written as postcard (sequences of unknown length).
    pub fn parameters<P: Serialize + ?Sized>(mut self, parameters: &P) -> Result<Self> {
        let bytes = postcard::to_allocvec(parameters)
            .map_err(|source| Error::Parameters { stage: self.fields.stage.clone(), source })?;
        self.fields.parameters.extend_from_slice(&bytes);
        Ok(self)
    }

    /// A parameter's name and value as text, so that a change can be told as "height_m: 7.29 → 8.14".
    #[must_use]
    pub fn named(mut self, name: impl Into<String>, value: impl fmt::Display) -> Self {
        self.fields.named.push((name.into(), value.to_string()));
        self
    }

    /// Something that the stage reads, by the digest of its bytes.
    #[must_use]
    pub fn input(mut self, name: impl Into<String>, digest: Digest) -> Self {
        self.fields.inputs.push((name.into(), digest));
        self
    }

    pub fn build(self) -> ActionKey {
        ActionKey::new(self.fields)
    }
}
