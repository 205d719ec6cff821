//! Keys: any change of any field changes the key, and nothing else does.

use genescape_cache::{ActionKey, Digest, KeyFields};
use proptest::prelude::*;

use crate::key_with_input;

fn fields() -> impl Strategy<Value = KeyFields> {
    // Short and from a small alphabet, so that lists with equal concatenations are common.
    let text = || "[ab\0]{0,3}";
    let digest = (0_u64..3).prop_map(|n| Digest::of(&n.to_le_bytes()));
    let inputs = prop::collection::vec((text(), digest), 0..3);
    (text(), 0_u32..3, prop::collection::vec(0_u8..3, 0..4), inputs).prop_map(
        |(stage, version, parameters, inputs)| KeyFields {
            stage,
            version,
            parameters,
            inputs,
            named: vec![],
        },
    )
}

fn digest(fields: &KeyFields) -> Digest {
    ActionKey::new(fields.clone()).digest()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn keys_are_equal_exactly_if_all_fields_are(a in fields(), b in fields()) {
        prop_assert_eq!(digest(&a) == digest(&b), a == b);
    }

    #[test]
    fn every_single_change_changes_the_key(a in fields(), which in 0_usize..6) {
        let mut b = a.clone();
        match which {
            0 => b.stage.push('x'),
            1 => b.version += 1,
            2 => b.parameters.push(0),
            3 => b.inputs.push((String::new(), Digest::of(b""))),
            4 => b.inputs.iter_mut().for_each(|(name, _)| name.push('x')),
            _ => b.inputs.iter_mut().for_each(|(_, digest)| *digest = Digest::of(digest.as_bytes())),
        }
        prop_assert_eq!(digest(&a) == digest(&b), a == b);
    }

    #[test]
    fn a_boundary_between_fields_cannot_move(text in "[ab]{2,6}", at in 1_usize..5) {
        let (left, right) = text.split_at(at.min(text.len()));
        let (moved, whole) = (key_with_input(left, right, b""), key_with_input(&text, "", b""));
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
    let named = vec![("height_m".to_owned(), "7.29".to_owned())];
    assert_eq!(digest(&KeyFields { named, ..KeyFields::default() }), digest(&KeyFields::default()));
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
    let stage = KeyFields { stage: "x\0".to_owned(), ..KeyFields::default() };
    let parameter = KeyFields { stage: "x".to_owned(), parameters: vec![0], ..KeyFields::default() };
    assert_ne!(digest(&stage), digest(&parameter));
}
