//! The report of an error → sentences, which are wrapped where there is little room, and excerpts of files, whose columns
//! stay one below the other.

/// A part of a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// What is wrong; a place begins with the file's name, without its folders.
    Sentence(String),
    /// Lines of a file with their numbers and marks, without the indent that all of them have.
    Excerpt(String),
}

/// All parts, in their order.
pub fn parts(report: &str) -> Vec<Part> {
    let lines: Vec<&str> = report.lines().filter(|line| !line.trim().is_empty()).collect();
    let groups = lines.chunk_by(|one, next| code(one).is_some() && code(next).is_some());
    let part = |group: &[&str]| match group.iter().map(|line| code(line)).collect::<Option<Vec<_>>>() {
        Some(excerpt) => Part::Excerpt(without_indent(&excerpt)),
        None => Part::Sentence(without_folders(group[0])),
    };
    groups.map(part).collect()
}

/// Number, rail and text of a line of an excerpt, as `genescape_schema::Report` and naga print them; `None` for others.
fn code(line: &str) -> Option<(&str, char, &str)> {
    let at = line.find(|c: char| !c.is_ascii_digit() && c != ' ')?;
    let (number, rest) = line.split_at(at);
    let rail = rest.chars().next().filter(|rail| "|│┌╭".contains(*rail))?;
    Some((number.trim(), rail, &rest[rail.len_utf8()..]))
}

fn without_indent(lines: &[(&str, char, &str)]) -> String {
    let indent = |text: &str| text.chars().take_while(|c| c.is_whitespace()).count();
    let texts = || lines.iter().filter(|(_, rail, text)| "|│".contains(*rail) && !text.trim().is_empty());
    let common = texts().map(|(.., text)| indent(text)).min().unwrap_or(0);
    let digits = lines.iter().map(|(number, ..)| number.len()).max().unwrap_or(0);
    let shown = lines.iter().map(|(number, rail, text)| {
        let cut = if "|│".contains(*rail) { common.min(indent(text)) } else { 0 };
        let text: String = text.chars().skip(cut).collect();
        let gap = if cut > 0 { " " } else { "" };
        format!("{number:>digits$} {rail}{gap}{text}").trim_end().to_owned()
    });
    shown.collect::<Vec<_>>().join("\n")
}

/// `world/population/g0001.ron:14:30: what` → `g0001.ron:14:30: what`.
fn without_folders(line: &str) -> String {
    let is_number = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
    let name = |place: &str| {
        let mut parts = place.rsplitn(3, ':');
        let is_place = parts.next().is_some_and(is_number) && parts.next().is_some_and(is_number);
        place.rfind(['/', '\\']).filter(|_| is_place).map(|at| place[at + 1..].to_owned())
    };
    let shortened = line.split_once(": ").and_then(|(place, what)| Some(format!("{}: {what}", name(place)?)));
    shortened.unwrap_or_else(|| line.trim_end().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use genescape_schema::{Population, Space};

    #[test]
    fn a_report_of_a_population_is_taken_apart() {
        let text = "Population(\n            generation: -1,\n\t    seeed: 1,\n)\n";
        let report =
            Population::load(&Space::builtin(), "/far/away/population/g0001.ron", text).expect_err("faulty");
        let parts = parts(&report.to_string());
        let sentences: Vec<_> = parts
            .iter()
            .filter_map(|part| if let Part::Sentence(text) = part { Some(text) } else { None })
            .collect();
        assert!(sentences[0].starts_with("g0001.ron:"), "{sentences:?}");
        assert!(sentences.last().is_some_and(|last| last.ends_with("errors")), "{sentences:?}");
        let excerpt = Part::Excerpt("2 | generation: -1,\n  |             ^^".to_owned());
        assert!(parts.contains(&excerpt), "{parts:#?}");
        let words: usize = sentences.iter().map(|text| text.split_whitespace().count()).sum();
        let before =
            report.diagnostics.iter().map(|one| one.message.split_whitespace().count() + 1).sum::<usize>();
        assert_eq!(words, before + 2, "no word of a message is lost");
    }

    #[test]
    fn a_shaders_report_keeps_its_rails_and_other_texts_stay_as_they_are() {
        let naga = "sky.wgsl is wrong:\nerror: expected `;`\n   ┌─ wgsl:232:5\n    │\n232 │     let a = 1\n    │     ^^^ here\n";
        let expected = [
            Part::Sentence("sky.wgsl is wrong:".to_owned()),
            Part::Sentence("error: expected `;`".to_owned()),
            Part::Excerpt("    ┌─ wgsl:232:5\n    │\n232 │ let a = 1\n    │ ^^^ here".to_owned()),
        ];
        assert_eq!(parts(naga), expected);
        let plain = "cannot read /a/b/scene.gltf: it is gone";
        assert_eq!(parts(plain), [Part::Sentence(plain.to_owned())]);
        assert_eq!(parts(""), []);
    }
}
