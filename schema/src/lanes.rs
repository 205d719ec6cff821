//! Which generation was bred from which → lanes side by side, as version control draws branches: a generation stays in
//! the lane of its parent if it is the first child, and begins a lane of its own if it is a later one.

use std::collections::BTreeMap;

/// A line from one generation to another, or through the rows between.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Line {
    /// From top to bottom, past this generation.
    Past(usize),
    /// From above down to this generation, in its own lane.
    In,
    /// From this generation down, in its own lane.
    Out,
    /// From this generation down into another lane.
    Branch(usize),
}

/// What is drawn beside one generation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// The generation's own lane, from 0.
    pub lane: usize,
    pub lines: Vec<Line>,
}

/// A row for each of some generations: its number and that of its parent, if it has one. In rising order; parents
/// come before their children, others count as none.
pub fn rows(generations: &[(u32, Option<u32>)]) -> Vec<Row> {
    let row_of: BTreeMap<u32, usize> =
        generations.iter().zip(0..).map(|((number, _), row)| (*number, row)).collect();
    let parent = |row: usize| {
        let parent = generations[row].1.and_then(|parent| row_of.get(&parent).copied());
        parent.filter(|parent| *parent < row)
    };
    let mut rows: Vec<Row> = Vec::new();
    // The last row that each lane is taken up to; of each row the children that it has had so far.
    let mut taken: Vec<usize> = Vec::new();
    let mut children = vec![0usize; generations.len()];
    let ends = chain_ends(generations.len(), &parent);
    for row in 0..generations.len() {
        let above = parent(row);
        let is_first = above.is_some_and(|above| children[above] == 0);
        let lane = match above {
            Some(above) if is_first => rows[above].lane,
            _ => {
                let begin = above.unwrap_or(row);
                let free = taken.iter().position(|last| *last < begin).unwrap_or(taken.len());
                taken.resize(taken.len().max(free + 1), 0);
                taken[free] = ends[row];
                free
            }
        };
        rows.push(Row { lane, lines: Vec::new() });
        let Some(above) = above else { continue };
        children[above] += 1;
        rows[above].lines.push(if is_first { Line::Out } else { Line::Branch(lane) });
        rows[above + 1..row].iter_mut().for_each(|between| between.lines.push(Line::Past(lane)));
        rows[row].lines.push(Line::In);
    }
    rows
}

/// Of each row the last one that is reached over first children.
fn chain_ends(rows: usize, parent: &dyn Fn(usize) -> Option<usize>) -> Vec<usize> {
    let mut first = vec![None; rows];
    for row in 0..rows {
        if let Some(parent) = parent(row) {
            first[parent].get_or_insert(row);
        }
    }
    let mut ends: Vec<usize> = (0..rows).collect();
    for row in (0..rows).rev() {
        ends[row] = first[row].map_or(row, |child| ends[child]);
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_later_child_begins_a_branch_beside_the_first() {
        let rows = rows(&[(0, None), (1, Some(0)), (2, Some(1)), (3, Some(0)), (4, Some(2)), (5, None)]);
        let lanes: Vec<usize> = rows.iter().map(|row| row.lane).collect();
        assert_eq!(lanes, [0, 0, 0, 1, 0, 0]);
        assert_eq!(rows[0].lines, [Line::Out, Line::Branch(1)]);
        assert_eq!(rows[3].lines, [Line::In, Line::Past(0)]);
    }

    proptest! {
        #[test]
        fn no_two_lines_lie_over_each_other(parents in prop::collection::vec(prop::option::of(0usize..40), 1..40)) {
            let generations: Vec<(u32, Option<u32>)> =
                parents.iter().zip(0u32..).map(|(parent, row)| (row, parent.map(|p| p as u32))).collect();
            let rows = rows(&generations);
            prop_assert_eq!(rows.len(), generations.len());
            for row in &rows {
                let below = row.lines.iter().filter_map(|line| match line {
                    Line::Past(lane) | Line::Branch(lane) => Some(*lane),
                    Line::Out => Some(row.lane),
                    Line::In => None,
                });
                let mut below: Vec<usize> = below.collect();
                let all = below.len();
                below.sort_unstable();
                below.dedup();
                prop_assert_eq!(below.len(), all, "{:?}", row);
                prop_assert!(!row.lines.contains(&Line::Past(row.lane)), "{:?}", row);
            }
            let with_parent = generations.iter().filter(|(row, parent)| parent.is_some_and(|p| p < *row)).count();
            prop_assert_eq!(rows.iter().filter(|row| row.lines.contains(&Line::In)).count(), with_parent);
        }
    }
}
