//! Time → how far clouds have drifted.

use glam::Vec2;

const WIND_M_PER_S: Vec2 = Vec2::new(9.0, 4.0);
/// For so long a copy of the painted clouds drifts before it begins anew.
const CYCLE_S: f32 = 200.0;

/// Two copies of the painted clouds drift half a cycle apart, each faded in and out while it is far from where it was painted, so
/// that clouds drift for ever. Most of the time one of them is all that is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drift {
    /// x and z in metres of the copy that is seen more of.
    pub main_m: Vec2,
    /// The same of the other one.
    pub other_m: Vec2,
    /// How much is seen of the other one, 0 to ½.
    pub other_share: f32,
}

impl Drift {
    /// After so many seconds.
    pub fn after(time_s: f32) -> Self {
        let turns = f64::from(time_s) / f64::from(CYCLE_S);
        let copy = |from: f64| {
            let turn = ((turns + from).rem_euclid(1.0) - 0.5) as f32;
            let near = ((0.6 - 2.0 * turn.abs()) / 0.2).clamp(0.0, 1.0);
            (turn * CYCLE_S * WIND_M_PER_S, near * near * (3.0 - 2.0 * near))
        };
        let (first, second) = (copy(0.5), copy(0.0));
        let (main, other) = if first.1 >= second.1 { (first, second) } else { (second, first) };
        Self { main_m: main.0, other_m: other.0, other_share: other.1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clouds_drift_without_a_leap() {
        let times = (0..=8000).map(|step| step as f32 * 0.05);
        let all: Vec<Drift> = times.map(Drift::after).collect();
        let seen =
            |drift: &Drift| [(drift.main_m, 1.0 - drift.other_share), (drift.other_m, drift.other_share)];
        for pair in all.windows(2) {
            let next = seen(&pair[1]);
            // Where one begins anew it is not seen.
            for (place_m, share) in seen(&pair[0]).into_iter().filter(|(_, share)| *share > 0.01) {
                let goes_on = |(next_m, next_share): &(Vec2, f32)| {
                    (next_m - place_m).length() < 0.6 && (next_share - share).abs() < 0.01
                };
                assert!(next.iter().any(goes_on), "{:?} to {:?}", pair[0], pair[1]);
            }
        }
        let alone = all.iter().filter(|drift| drift.other_share == 0.0).count();
        assert!(alone > all.len() / 2 && all.iter().any(|drift| drift.other_share > 0.49));
        assert_eq!(Drift::after(0.0), Drift { other_m: -0.5 * CYCLE_S * WIND_M_PER_S, ..Drift::default() });
    }
}
