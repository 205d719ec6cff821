//! Everything that a result may depend on → its action key.
//!
//! The key is a BLAKE3 hash in a domain of its own over fields that are each framed by their length, so that no two
//! different lists of fields give the same bytes. The fields are kept beside the hash: they say later what changed.

use serde::{Deserialize, Serialize};

use crate::Digest;

/// The domain of the hash; its number changes when the meaning of cached results does.
const DOMAIN: &str = "genescape 2026 cache: action key 1";

/// All that an action's result may depend on, and `named` for people.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyFields {
    pub stage: String,
    /// Version of the stage's code: raised whenever its output changes.
    pub version: u32,
    /// The parameters that the stage reads, all of them and no others, in canonical bytes. Postcard gives such, but not
    /// for a hash map or set, whose order varies.
    pub parameters: Vec<u8>,
    /// The same parameters as names and values, so that a change can be told as "height_m: 7.29 → 8.14". Not part of
    /// the hash: `parameters` says it all.
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
