//! A landscape's genes as three packed bitfields, and their physical values for the stages of the bake.

use serde::de::value::{Error as ValueError, MapDeserializer};
use serde::de::{DeserializeOwned, Deserializer, IntoDeserializer, Visitor};
use serde::forward_to_deserialize_any;

use crate::parameter::{Category, Parameter};
use crate::space::Space;

/// The genes of one category: their codes side by side in the order of the space, least significant bit first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Chromosome {
    bytes: Vec<u8>,
}

impl Chromosome {
    /// All codes 0.
    pub fn zero(space: &Space, category: Category) -> Self {
        Self { bytes: vec![0; space.bits(category).div_ceil(8) as usize] }
    }

    /// The code of a gene, which must be of this chromosome's category and space.
    pub fn code(&self, parameter: &Parameter) -> u32 {
        (0..parameter.bits).fold(0, |code, bit| {
            let at = parameter.offset + bit;
            let byte = self.bytes.get(at as usize / 8).copied().unwrap_or(0);
            code | u32::from(byte >> (at % 8) & 1) << bit
        })
    }

    /// Changes the code of a gene; codes beyond the last become the last.
    pub fn set_code(&mut self, parameter: &Parameter, code: u32) {
        let code = code.min(parameter.last_code());
        for bit in 0..parameter.bits {
            let at = parameter.offset + bit;
            if let Some(byte) = self.bytes.get_mut(at as usize / 8) {
                *byte = *byte & !(1 << (at % 8)) | ((code >> bit & 1) as u8) << (at % 8);
            }
        }
    }
}

/// All genes of one landscape.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Genome {
    /// Tree, terrain and sky, as in [`Category::ALL`].
    pub chromosomes: [Chromosome; 3],
}

/// A struct asks for a gene that the space does not have, or for another type.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the parameter space does not give {what}: {reason}")]
pub struct GenomeError {
    /// The type that asked.
    pub what: &'static str,
    /// What is missing.
    pub reason: String,
}

impl Genome {
    /// All codes 0.
    pub fn zero(space: &Space) -> Self {
        Self { chromosomes: Category::ALL.map(|category| Chromosome::zero(space, category)) }
    }

    /// One category's genes.
    pub fn chromosome(&self, category: Category) -> &Chromosome {
        &self.chromosomes[category as usize]
    }

    /// One category's genes, to change.
    pub fn chromosome_mut(&mut self, category: Category) -> &mut Chromosome {
        &mut self.chromosomes[category as usize]
    }

    /// The code of a gene of this genome's space.
    pub fn code(&self, parameter: &Parameter) -> u32 {
        self.chromosome(parameter.category).code(parameter)
    }

    /// Changes the code of a gene of this genome's space.
    pub fn set_code(&mut self, parameter: &Parameter, code: u32) {
        self.chromosome_mut(parameter.category).set_code(parameter, code);
    }

    /// The physical value of a gene in its unit; `None` if there is none of that name.
    pub fn value(&self, space: &Space, name: &str) -> Option<f32> {
        space.find(name).map(|parameter| parameter.value(self.code(parameter)) as f32)
    }

    /// Fills a struct whose fields are named as genes with their physical values: `f32`, or an integer type for genes
    /// of integer scale. Genes that the struct lacks are passed over.
    ///
    /// # Errors
    /// A field that is no gene, by its name.
    pub fn read<T: DeserializeOwned>(&self, space: &Space) -> Result<T, GenomeError> {
        let genes = space.parameters().iter().map(|parameter| {
            let value = parameter.value(self.code(parameter));
            (parameter.name.as_str(), Gene { value, whole: parameter.scale.is_whole() })
        });
        let deserializer = MapDeserializer::<_, ValueError>::new(genes);
        T::deserialize(deserializer)
            .map_err(|error| GenomeError { what: std::any::type_name::<T>(), reason: error.to_string() })
    }
}

/// A gene's value as serde asks for it.
#[derive(Clone, Copy)]
struct Gene {
    value: f64,
    whole: bool,
}

impl IntoDeserializer<'_> for Gene {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for Gene {
    type Error = ValueError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ValueError> {
        match self.whole {
            true => visitor.visit_i64(self.value as i64),
            false => visitor.visit_f32(self.value as f32),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}
