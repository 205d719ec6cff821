//! Values ↔ sealed files: a hash over the file's name and the rest of its bytes, then the value as postcard.

use std::io;
use std::time::SystemTime;

use serde::{Serialize, de::DeserializeOwned};

use crate::{Cache, Error, Fault, Result};

/// The domain of the hash.
const DOMAIN: &str = "genescape 2026 cache: seal 1";
const SEAL_BYTES: usize = 32;

impl Cache {
    /// Publishes a value under a name.
    pub(crate) fn put_sealed<T: Serialize>(&self, name: &str, value: &T) -> Result<()> {
        let mut bytes = postcard::to_extend(value, vec![0; SEAL_BYTES])
            .map_err(|error| Error::at("write", &self.store.path_of(name), io::Error::other(error)))?;
        let seal = seal(name, &bytes[SEAL_BYTES..]);
        bytes[..SEAL_BYTES].copy_from_slice(&seal);
        self.publish_file(name, &bytes, None)
    }

    /// A value and when it was last changed; `None` if there is no such file, or one that fails its seal, which is
    /// removed.
    pub(crate) fn get_sealed<T: DeserializeOwned>(&self, name: &str) -> Result<Option<(T, SystemTime)>> {
        self.unseal(name, |payload| postcard::from_bytes(payload).ok())
    }

    /// Removes the file if it fails its seal; `None` if it did or is not there.
    pub(crate) fn check_seal(&self, name: &str) -> Result<Option<()>> {
        Ok(self.unseal(name, |_| Some(()))?.map(|((), _)| ()))
    }

    fn unseal<T>(
        &self,
        name: &str,
        decode: impl FnOnce(&[u8]) -> Option<T>,
    ) -> Result<Option<(T, SystemTime)>> {
        let Some((bytes, modified)) = self.store.get(name)? else { return Ok(None) };
        let value = bytes
            .split_at_checked(SEAL_BYTES)
            .filter(|(found, payload)| *found == seal(name, payload))
            .and_then(|(_, payload)| decode(payload));
        if value.is_none() {
            // If it cannot be removed, it still fails its seal the next time.
            let _ = self.store.remove(name);
            self.notices().add(self.store.path_of(name), Fault::DamagedRecord);
        }
        Ok(value.map(|value| (value, modified)))
    }
}

fn seal(name: &str, payload: &[u8]) -> [u8; SEAL_BYTES] {
    let mut hasher = blake3::Hasher::new_derive_key(DOMAIN);
    hasher.update(&(name.len() as u64).to_le_bytes());
    hasher.update(name.as_bytes());
    hasher.update(payload);
    *hasher.finalize().as_bytes()
}
