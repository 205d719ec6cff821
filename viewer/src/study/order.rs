//! Orders of conditions in which each comes as often in each place, and as often after each other one (Williams 1949), so that
//! neither practice nor what came before favours any.

/// The orders for `count` conditions, numbered from 0: as many as there are conditions, or twice as many of an odd number.
pub fn williams(count: usize) -> Vec<Vec<usize>> {
    // 0, 1, n − 1, 2, n − 2 …: each step between neighbours comes once.
    let zigzag = |at: usize| if at % 2 == 1 { at.div_ceil(2) } else { (count - at / 2) % count };
    let shifted = |by: usize| (0..count).map(|at| (zigzag(at) + by) % count).collect::<Vec<_>>();
    let mut orders: Vec<Vec<usize>> = (0..count).map(shifted).collect();
    if count % 2 == 1 && count > 1 {
        let mirrored = orders.iter().map(|order| order.iter().rev().copied().collect());
        orders.extend(mirrored.collect::<Vec<_>>());
    }
    orders
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_comes_as_often_in_each_place_and_after_each_other() {
        for count in 1..=9 {
            let orders = williams(count);
            let (mut places, mut after) = (vec![vec![0; count]; count], vec![vec![0; count]; count]);
            for order in &orders {
                assert_eq!(order.len(), count);
                order.iter().enumerate().for_each(|(place, one)| places[place][*one] += 1);
                order.windows(2).for_each(|pair| after[pair[0]][pair[1]] += 1);
            }
            let times = orders.len() / count;
            assert!(places.iter().flatten().all(|number| *number == times), "{count}: {places:?}");
            for (first, row) in after.iter().enumerate() {
                for (second, number) in row.iter().enumerate() {
                    assert_eq!(*number, if first == second { 0 } else { times }, "{count}: {first} {second}");
                }
            }
        }
    }
}
