//! Sections of a record, each with a title of its own, that several chores write.

use anyhow::{Context, Result, ensure};

use crate::shell;

/// Writes a section of a record; `order` is that of all sections that are written so.
pub(crate) fn put(record: &str, order: &[&str], title: &str, body: &str) -> Result<()> {
    let path = shell::root().join(record);
    let page = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    std::fs::write(&path, replaced(&page, order, title, body)?).with_context(|| path.display().to_string())
}

/// What stands under a title, up to the next one.
pub(crate) fn of<'a>(page: &'a str, title: &str) -> Option<&'a str> {
    let (_, rest) = page.split_once(&format!("{title}\n"))?;
    Some(rest.split("\n## ").next().unwrap_or(rest))
}

/// The page with the section replaced, or put before the first of those that come after it, or at the end.
fn replaced(page: &str, order: &[&str], title: &str, body: &str) -> Result<String> {
    let place = order.iter().position(|known| *known == title);
    let (before, after) = order.split_at(place.context("no section of the record")?);
    let begins = |title: &&str| page.find(&format!("\n{title}\n"));
    let (until, next) = match begins(&title) {
        Some(begin) => {
            let rest = &page[begin + 1..];
            (begin, begin + 1 + rest.find("\n## ").unwrap_or(rest.len()))
        }
        None => {
            let next = after[1..].iter().find_map(begins).unwrap_or(page.len());
            (next, next)
        }
    };
    ensure!(
        before.iter().filter_map(begins).all(|begin| begin < until),
        "the record's sections are not in their order"
    );
    let rest = page[next..].trim();
    let mut page = format!("{}\n\n{title}\n\n{}\n", page[..until].trim_end(), body.trim());
    if !rest.is_empty() {
        page += &format!("\n{rest}\n");
    }
    Ok(page)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_ends_at_the_next_title() {
        let page = "# Page\n\n## One\n\nsome\n\n## Two\n\nmore\n";
        assert_eq!(of(page, "## One").map(str::trim), Some("some"));
        assert_eq!(of(page, "## Two").map(str::trim), Some("more"));
        assert_eq!(of(page, "## Other"), None);
    }

    #[test]
    fn a_section_is_put_in_and_replaced() {
        const ORDER: [&str; 3] = ["## A", "## B", "## Tried"];
        let put = |page: &str, title: &str, body: &str| replaced(page, &ORDER, title, body);
        let page = "# Page\n\nsome\n\n## Tried\n\nmore\n";
        let once = put(page, "## A", "first\n").unwrap();
        assert_eq!(once, "# Page\n\nsome\n\n## A\n\nfirst\n\n## Tried\n\nmore\n");
        let twice = put(&once, "## B", "second").unwrap();
        assert_eq!(twice, once.replace("\n## Tried", "\n## B\n\nsecond\n\n## Tried"));
        assert_eq!(put(&twice, "## A", "first").unwrap(), twice);
        assert_eq!(
            put(&twice, "## B", "third").unwrap(),
            twice.replace("second", "third")
        );
        assert!(put(page, "## Other", "").is_err());
        assert!(put("\n## Tried\n\n## A\n", "## Tried", "").is_err());
    }

    #[test]
    fn what_others_wrote_stays_where_it_is() {
        let page = "# A\n\n## Cost\n\none\n\n## By hand\n\nb\n";
        let put = |page: &str| replaced(page, &["## Cost"], "## Cost", "two").unwrap();
        assert_eq!(put(page), page.replace("one", "two"));
        assert_eq!(put("# A\n\n## B\n\nb\n"), "# A\n\n## B\n\nb\n\n## Cost\n\ntwo\n");
    }
}
