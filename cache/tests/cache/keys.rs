//! Keys: any change of any field changes the key, and nothing else does.

use genescape_cache::{ActionKey, Digest};
use proptest::prelude::*;

#[derive(Clone, Debug, PartialEq)]
struct Fields {
    stage: String,
    version: u32,
    parameters: Vec<u8>,
    inputs: Vec<(String, u64)>,
}

fn fields() -> impl Strategy<Value = Fields> {
    // Short and from a small alphabet, so that lists with equal concatenations are common.
    let text = || "[ab\0]{0,3}";
    let inputs = prop::collection::vec((text(), 0_u64..3), 0..3);
    (text(), 0_u32..3, prop::collection::vec(0_u8..3, 0..4), inputs)
        .prop_map(|(stage, version, parameters, inputs)| Fields { stage, version, parameters, inputs })
}

fn key(fields: &Fields) -> ActionKey {
    let mut builder = ActionKey::builder(fields.stage.as_str(), fields.version)
        .parameters(&fields.parameters)
        .expect("bytes have canonical bytes");
    for (name, digest) in &fields.inputs {
        builder = builder.input(name.as_str(), Digest::of(&digest.to_le_bytes()));
    }
    builder.build()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn keys_are_equal_exactly_if_all_fields_are(a in fields(), b in fields()) {
        prop_assert_eq!(key(&a).digest() == key(&b).digest(), a == b);
    }

    #[test]
    fn every_single_change_changes_the_key(a in fields(), which in 0_usize..6) {
        let mut b = a.clone();
        match which {
            0 => b.stage.push('x'),
            1 => b.version += 1,
            2 => b.parameters.push(0),
            3 => b.inputs.push((String::new(), 0)),
            4 => b.inputs.iter_mut().for_each(|(name, _)| name.push('x')),
            _ => b.inputs.iter_mut().for_each(|(_, digest)| *digest += 1),
        }
        prop_assert_eq!(key(&a).digest() == key(&b).digest(), a == b);
    }

    #[test]
    fn a_boundary_between_fields_cannot_move(text in "[ab]{2,6}", at in 1_usize..5) {
        let (left, right) = text.split_at(at.min(text.len()));
        let moved = ActionKey::builder(left, 0).input(right, Digest::of(b"")).build();
        let whole = ActionKey::builder(text.as_str(), 0).input("", Digest::of(b"")).build();
        prop_assert_eq!(moved.digest() == whole.digest(), right.is_empty());
    }

    #[test]
    fn a_digest_survives_its_text(bytes in any::<[u8; 32]>()) {
        let digest = Digest::from_bytes(bytes);
        prop_assert_eq!(digest.to_string().parse::<Digest>(), Ok(digest));
    }
}

#[test]
fn names_for_people_do_not_change_the_key() {
    let plain = ActionKey::builder("tree", 1).parameters(&7.29_f32).expect("canonical").build();
    let named =
        ActionKey::builder("tree", 1).parameters(&7.29_f32).expect("canonical").named("height_m", 7.29);
    assert_eq!(plain.digest(), named.build().digest());
}

#[test]
fn a_digest_has_one_name() {
    let text = Digest::of(b"x").to_string();
    assert!(text.to_uppercase().parse::<Digest>().is_err());
    assert!(text[1..].parse::<Digest>().is_err());
    assert!(format!("{text}0").parse::<Digest>().is_err());
}

#[test]
fn fields_are_framed_by_their_length() {
    // Without frames, both would be the bytes x 0 0 0 0 0.
    let stage = ActionKey::builder("x\0", 0).build();
    let parameter = ActionKey::builder("x", 0).parameters(&0_u8).expect("canonical").build();
    assert_ne!(stage.digest(), parameter.digest());
}
