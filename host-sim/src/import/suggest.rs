//! "Did you mean ...?": the nearest of the names that would have been right.

/// The advice for a name that is not among `known`: the nearest one, or the whole list when nothing is near.
pub(super) fn advice(name: &str, known: &[&str]) -> String {
    match nearest(name, known) {
        Some(near) => format!("did you mean \"{near}\"?"),
        None if known.is_empty() => "remove it".to_string(),
        None => format!("use {}", list(known)),
    }
}

/// `a, b or c`.
pub(super) fn list(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [only] => (*only).to_string(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

/// The known name within a third of the word's length (at least one, at most three edits), if any.
fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let limit = (name.chars().count() / 3).clamp(1, 3);
    let scored = known
        .iter()
        .map(|&candidate| (distance(name, candidate), candidate));
    scored
        .filter(|&(d, _)| d <= limit)
        .min_by_key(|&(d, _)| d)
        .map(|(_, candidate)| candidate)
}

/// Edits (insert, remove, replace, swap two neighbours) from `a` to `b`, letter case ignored.
///
/// Optimal string alignment; Damerau, "A technique for computer detection and correction of spelling errors", 1964.
fn distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.to_lowercase().chars().collect();
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut rows = vec![vec![0; b.len() + 1]; a.len() + 1];
    for (i, row) in rows.iter_mut().enumerate() {
        row[0] = i;
    }
    rows[0] = (0..=b.len()).collect();
    for i in 1..=a.len() {
        for j in 1..=b.len() {
            let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            rows[i][j] = best;
        }
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typos_find_their_word() {
        let known = ["reflectance", "radius", "center"];
        assert_eq!(nearest("reflectence", &known), Some("reflectance"));
        assert_eq!(nearest("radisu", &known), Some("radius"));
        assert_eq!(nearest("centre", &known), Some("center"));
        assert_eq!(nearest("temperature", &known), None);
    }

    #[test]
    fn distances() {
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(distance("Sphere", "sphere"), 0);
        assert_eq!(distance("shpere", "sphere"), 1);
        assert_eq!(distance("disk", "cube"), 4);
    }
}
