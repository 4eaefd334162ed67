//! "Did you mean": the closest of a few known words.

/// Longer words are not compared; nobody mistypes this much.
const LONGEST: usize = 40;

/// The known word closest to what was written, if it is close enough to be a slip.
pub(super) fn closest<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = written.chars().count();
    if length > LONGEST {
        return None;
    }
    let lower = written.to_lowercase();
    let most = (length / 3).max(1);
    known
        .into_iter()
        .map(|word| (distance(&lower, &word.to_lowercase()), word))
        // A word with no letter in common is no suggestion, however short both are.
        .filter(|(slips, word)| *slips <= most && *slips < word.chars().count())
        .min_by_key(|(slips, _)| *slips)
        .map(|(_, word)| word)
}

/// Edit distance with insertions, deletions, replacements and swaps of neighbors (optimal string alignment).
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut before = vec![0; b.len() + 1];
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let replaced = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = replaced.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut above, row);
    }
    above[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_by_hand() {
        for (a, b, slips) in [("", "abc", 3), ("abc", "acb", 1), ("kitten", "sitting", 3), ("same", "same", 0)] {
            assert_eq!(distance(a, b), slips, "{a} {b}");
        }
    }

    #[test]
    fn slips_are_recognized_and_strangers_are_not() {
        let known = ["inner_radius", "outer_radius", "length"];
        assert_eq!(closest("inner_radus", known), Some("inner_radius"));
        assert_eq!(closest("LENGHT", known), Some("length"));
        assert_eq!(closest("color", known), None);
        assert_eq!(closest("kpa", ["Pa", "kPa"]), Some("kPa"));
        assert_eq!(closest("x", ["m", "s"]), None);
    }
}
