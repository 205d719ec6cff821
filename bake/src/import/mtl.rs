//! .mtl → materials, as far as they are used: colour, opacity, colour texture. Our own reader: that of `tobj` panics over
//! `Kd 1`, which is legal, and gives the whole file up over one number that it cannot read.

use std::collections::HashMap;

use tobj::Material;

/// The materials of a file, and the index of each by name. What is no number, or unknown, is passed over.
pub fn read(text: &str) -> (Vec<Material>, HashMap<String, usize>) {
    let mut materials: Vec<Material> = Vec::new();
    for line in text.lines() {
        let line = line.trim();
        let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if key == "newmtl" {
            materials.push(Material { name: rest.to_owned(), ..Material::default() });
        }
        let Some(material) = materials.last_mut() else { continue };
        match key {
            "Kd" => material.diffuse = color(rest).or(material.diffuse),
            "d" => material.dissolve = fraction(rest).or(material.dissolve),
            "Tr" => material.dissolve = fraction(rest).map(|clear| 1.0 - clear).or(material.dissolve),
            "map_Kd" if !rest.is_empty() => material.diffuse_texture = Some(rest.to_owned()),
            _ => {}
        }
    }
    let names =
        materials.iter().enumerate().map(|(index, material)| (material.name.clone(), index)).collect();
    (materials, names)
}

/// Red, green and blue; of a single number all three.
fn color(text: &str) -> Option<[f32; 3]> {
    let values: Option<Vec<f32>> = text.split_whitespace().map(fraction).collect();
    match values?[..] {
        [grey] => Some([grey; 3]),
        [r, g, b, ..] => Some([r, g, b]),
        _ => None,
    }
}

/// A number as glTF allows it.
fn fraction(text: &str) -> Option<f32> {
    text.parse().ok().filter(|value: &f32| value.is_finite()).map(|value| value.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_or_passed_over() {
        let text = "Kd 9 9 9\nnewmtl a\n Kd 0.5\nd nan\nnewmtl b c\nKd 1 0\nKd 2 0.25 x\nKd 2 0.25 -1\nTr 0.75\n\
            map_Kd\nmap_Kd  a file.png \nnewmtl\nKd";
        let (materials, names) = read(text);
        let told = materials.iter().map(|m| (&*m.name, m.diffuse, m.dissolve, m.diffuse_texture.as_deref()));
        assert_eq!(
            told.collect::<Vec<_>>(),
            [
                ("a", Some([0.5; 3]), None, None),
                ("b c", Some([1.0, 0.25, 0.0]), Some(0.25), Some("a file.png")),
                ("", None, None, None),
            ]
        );
        assert_eq!((names["a"], names["b c"]), (0, 1));
    }
}
