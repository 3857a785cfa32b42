//! One file's tokens: the paths it has into the crate, without those that only tests see.

use std::collections::BTreeMap;

use anyhow::{Result, anyhow};
use proc_macro2::{Delimiter, Group, Ident, LexError, TokenStream, TokenTree};

/// What a [`Used::path`] begins with when it names the crate's root as a whole (`use crate::*`).
pub const ROOT: &str = "*";

/// A path from the crate's root, where it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Used {
    pub line: usize,
    /// At least one segment; those inside braces are left out once the first is known.
    pub path: Vec<String>,
}

/// What a file says that the layers care about.
#[derive(Debug, Default)]
pub struct Scan {
    pub uses: Vec<Used>,
    /// `#[cfg(test)] mod tests;`, from the crate's root: their files are exempt.
    pub test_modules: Vec<Vec<String>>,
    /// `#[macro_export] macro_rules! name`: callable as `crate::name!`.
    pub exported_macros: Vec<String>,
}

/// Reads a file that holds the module `module`.
pub fn scan(source: &str, module: &[String]) -> Result<Scan> {
    let mut walker = Walker {
        module: module.to_vec(),
        scan: Scan::default(),
    };
    walker.walk(&lex(source)?);
    Ok(walker.scan)
}

/// The names that `pub use ROOM::...` lines of `lib.rs` put at the crate's root, each with its room.
pub fn reexports(source: &str) -> Result<BTreeMap<String, String>> {
    let tokens = lex(source)?;
    let mut names = BTreeMap::new();
    for (at, _) in tokens
        .iter()
        .enumerate()
        .filter(|(_, token)| is_ident(token, "use"))
    {
        let end = tokens[at..]
            .iter()
            .position(|token| is_punct(token, ';'))
            .map_or(tokens.len(), |n| at + n);
        let mut path = &tokens[at + 1..end];
        while path
            .first()
            .is_some_and(|token| is_ident(token, "self") || is_ident(token, "crate") || is_punct(token, ':'))
        {
            path = &path[1..];
        }
        if let Some(TokenTree::Ident(room)) = path.first() {
            leaves(&path[1..], &room.to_string(), &room.to_string(), &mut names);
        }
    }
    Ok(names)
}

/// Adds the names at the leaves of a use tree whose path so far ends in `last`.
fn leaves(tokens: &[TokenTree], room: &str, last: &str, names: &mut BTreeMap<String, String>) {
    let mut last = last.to_string();
    for token in tokens {
        match token {
            TokenTree::Ident(ident) if ident == "as" => {}
            TokenTree::Ident(ident) => last = ident.to_string(),
            TokenTree::Group(group) => {
                let inner: Vec<_> = group.stream().into_iter().collect();
                for branch in inner.split(|token| is_punct(token, ',')) {
                    leaves(branch, room, &last, names);
                }
                return;
            }
            _ => {}
        }
    }
    names.insert(last, room.to_string());
}

struct Walker {
    /// The module that the tokens stand in.
    module: Vec<String>,
    scan: Scan,
}

impl Walker {
    fn walk(&mut self, tokens: &[TokenTree]) {
        let mut at = 0;
        let mut exported = false;
        while at < tokens.len() {
            let rest = &tokens[at..];
            at += match rest {
                [hash, bang, TokenTree::Group(attribute), ..]
                    if is_punct(hash, '#') && is_punct(bang, '!') =>
                {
                    if is_test_only(attribute.stream()) {
                        return;
                    }
                    3
                }
                [hash, TokenTree::Group(attribute), ..] if is_punct(hash, '#') => {
                    if is_test_only(attribute.stream()) {
                        self.skip_item(&rest[2..]) + 2
                    } else {
                        let attribute: Vec<_> = attribute.stream().into_iter().collect();
                        exported |= attribute
                            .first()
                            .is_some_and(|token| is_ident(token, "macro_export"));
                        self.walk(&attribute);
                        2
                    }
                }
                [key, bang, TokenTree::Ident(name), ..]
                    if is_ident(key, "macro_rules") && is_punct(bang, '!') =>
                {
                    if std::mem::take(&mut exported) {
                        self.scan.exported_macros.push(name.to_string());
                    }
                    3
                }
                [key, TokenTree::Ident(name), TokenTree::Group(body), ..] if is_ident(key, "mod") => {
                    self.module.push(name.to_string());
                    self.walk(&body.stream().into_iter().collect::<Vec<_>>());
                    self.module.pop();
                    3
                }
                // `use crate as root;`
                [key, as_key, ..] if is_ident(key, "crate") && is_ident(as_key, "as") => {
                    self.scan.uses.push(Used {
                        line: line(key),
                        path: vec![ROOT.to_string()],
                    });
                    2
                }
                // `pub(in crate::geom)` names a module that this one stands in.
                [key, TokenTree::Group(scope), ..] if is_ident(key, "pub") && starts_with_in(scope) => 2,
                [TokenTree::Ident(start), ..] if follows_path_sep(&rest[1..]) => {
                    let base = match start.to_string().as_str() {
                        "crate" => Some(Vec::new()),
                        "self" => Some(self.module.clone()),
                        "super" => Some(parent(&self.module)),
                        _ => None,
                    };
                    match base {
                        Some(base) => 1 + self.path(base, &rest[1..]),
                        None => 1,
                    }
                }
                [TokenTree::Group(group), ..] => {
                    self.walk(&group.stream().into_iter().collect::<Vec<_>>());
                    1
                }
                _ => 1,
            };
        }
    }

    /// Reads on from `base`, at the `::` that follows it; returns the number of tokens that are done with.
    fn path(&mut self, mut base: Vec<String>, tokens: &[TokenTree]) -> usize {
        let mut at = 0;
        while follows_path_sep(&tokens[at..]) {
            let next = tokens.get(at + 2);
            match next {
                Some(TokenTree::Ident(ident)) if ident == "super" => base = parent(&base),
                Some(TokenTree::Ident(ident)) => return at + 2 + self.record(base, &tokens[at + 2..], ident),
                Some(TokenTree::Group(group)) if base.is_empty() && group.delimiter() == Delimiter::Brace => {
                    let branches: Vec<_> = group.stream().into_iter().collect();
                    for branch in branches.split(|token| is_punct(token, ',')) {
                        match branch {
                            [TokenTree::Ident(ident), ..] => {
                                self.record(Vec::new(), branch, ident);
                            }
                            [star, ..] => self.record_root(star),
                            [] => {}
                        }
                    }
                    return at + 3;
                }
                Some(star) if base.is_empty() => {
                    self.record_root(star);
                    return at + 3;
                }
                // Inside the module's own room: nothing below can lead out again.
                _ => return at + 2,
            }
            at += 3;
        }
        at
    }

    /// Notes the path that goes on from `base` at `first`; returns the number of tokens that belong to it.
    fn record(&mut self, base: Vec<String>, tokens: &[TokenTree], first: &Ident) -> usize {
        if first == "self" {
            if base.is_empty() {
                self.record_root(&tokens[0]);
            }
            return 1;
        }
        let mut path = base;
        let mut at = 0;
        while let Some(TokenTree::Ident(ident)) = tokens.get(at) {
            path.push(ident.to_string());
            at += 1;
            if !(follows_path_sep(&tokens[at..]) && matches!(tokens.get(at + 2), Some(TokenTree::Ident(_)))) {
                break;
            }
            at += 2;
        }
        self.scan.uses.push(Used {
            line: first.span().start().line,
            path,
        });
        at
    }

    fn record_root(&mut self, token: &TokenTree) {
        self.scan.uses.push(Used {
            line: line(token),
            path: vec![ROOT.to_string()],
        });
    }

    /// The length of the item, statement, field or arm at the start, which only tests see.
    fn skip_item(&mut self, tokens: &[TokenTree]) -> usize {
        let mut at = 0;
        while let [hash, TokenTree::Group(_), ..] = &tokens[at..] {
            if !is_punct(hash, '#') {
                break;
            }
            at += 2;
        }
        if let Some(name) = outline_module(&tokens[at..]) {
            let mut module = self.module.clone();
            module.push(name);
            self.scan.test_modules.push(module);
        }
        // What holds a value ends at its semicolon, what has a body at its brace, a field or an arm at its comma.
        let word = |token: Option<&TokenTree>| match token {
            Some(TokenTree::Ident(ident)) => ident.to_string(),
            _ => String::new(),
        };
        let mut head = at;
        if word(tokens.get(head)) == "pub" {
            head += 1 + usize::from(matches!(tokens.get(head + 1), Some(TokenTree::Group(_))));
        }
        let is_field = tokens.get(head + 1).is_some_and(|token| is_punct(token, ':'))
            && !follows_path_sep(&tokens[head + 1..]);
        let (brace_ends, comma_ends) = match word(tokens.get(head)).as_str() {
            "const" if word(tokens.get(head + 1)) == "fn" || word(tokens.get(head + 1)) == "unsafe" => {
                (true, false)
            }
            "use" | "const" | "static" | "type" | "let" => (false, false),
            "fn" | "mod" | "impl" | "trait" | "struct" | "enum" | "union" | "unsafe" | "extern" | "async"
            | "macro_rules" => (true, false),
            _ if is_field => (false, true),
            _ => (true, true),
        };
        for (done, token) in tokens[at..].iter().enumerate() {
            let ends = match token {
                TokenTree::Group(group) => brace_ends && group.delimiter() == Delimiter::Brace,
                token => is_punct(token, ';') || comma_ends && is_punct(token, ','),
            };
            if ends {
                return at + done + 1;
            }
        }
        tokens.len()
    }
}

/// The name in `[pub] mod name;`.
fn outline_module(tokens: &[TokenTree]) -> Option<String> {
    let end = tokens.iter().position(|token| is_punct(token, ';'))?;
    match &tokens[end.checked_sub(2)?..end] {
        [key, TokenTree::Ident(name)] if is_ident(key, "mod") && end <= 4 => Some(name.to_string()),
        _ => None,
    }
}

/// Whether an attribute leaves its item to tests: `test`, or `cfg(...)` of a condition that implies `test`.
fn is_test_only(attribute: TokenStream) -> bool {
    let tokens: Vec<_> = attribute.into_iter().collect();
    match tokens.as_slice() {
        [test] => is_ident(test, "test"),
        [cfg, TokenTree::Group(condition)] if is_ident(cfg, "cfg") => implies_test(condition.stream()),
        _ => false,
    }
}

/// Whether a cfg condition holds in tests only.
fn implies_test(condition: TokenStream) -> bool {
    let tokens: Vec<_> = condition.into_iter().collect();
    let branches = |group: &Group| -> Vec<TokenStream> {
        let inner: Vec<_> = group.stream().into_iter().collect();
        let branches = inner.split(|token| is_punct(token, ','));
        branches
            .filter(|branch| !branch.is_empty())
            .map(|branch| branch.iter().cloned().collect())
            .collect()
    };
    match tokens.as_slice() {
        [test] => is_ident(test, "test"),
        [all, TokenTree::Group(group)] if is_ident(all, "all") => {
            branches(group).into_iter().any(implies_test)
        }
        [any, TokenTree::Group(group)] if is_ident(any, "any") => {
            let branches = branches(group);
            !branches.is_empty() && branches.into_iter().all(implies_test)
        }
        _ => false,
    }
}

fn starts_with_in(scope: &Group) -> bool {
    scope
        .stream()
        .into_iter()
        .next()
        .is_some_and(|token| is_ident(&token, "in"))
}

fn lex(source: &str) -> Result<Vec<TokenTree>> {
    let stream: TokenStream = source
        .parse()
        .map_err(|error: LexError| anyhow!("line {}: {error}", error.span().start().line))?;
    Ok(stream.into_iter().collect())
}

fn is_ident(token: &TokenTree, word: &str) -> bool {
    matches!(token, TokenTree::Ident(ident) if ident == word)
}

fn is_punct(token: &TokenTree, mark: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == mark)
}

fn follows_path_sep(tokens: &[TokenTree]) -> bool {
    matches!(tokens, [first, second, ..] if is_punct(first, ':') && is_punct(second, ':'))
}

fn line(token: &TokenTree) -> usize {
    token.span().start().line
}

fn parent(module: &[String]) -> Vec<String> {
    module[..module.len().saturating_sub(1)].to_vec()
}
