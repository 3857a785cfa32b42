//! The arrows between the core's rooms: each module uses what stands to its left.
//!
//! Reads the sources as tokens, so that macros are seen too and comments are not. Paths count that begin with
//! `crate::` (also `$crate::`) or climb to the crate's root by `super::`; code under `#[cfg(test)]` is exempt.

mod order;
mod scan;
mod tree;

use std::path::Path;

use anyhow::{Context, Result, bail};

use order::may_use;
use tree::Tree;

/// Reads `root/src`: a summary if all arrows point left, else an error with a line for each that does not.
pub fn check(root: &Path) -> Result<String> {
    let tree = Tree::read(&root.join("src")).context("reading the core's sources")?;
    let findings = findings(&tree);
    if !findings.is_empty() {
        bail!(
            "{} against the order of the layers\n{}",
            findings.len(),
            findings.join("\n")
        );
    }
    let paths: usize = tree.files.iter().map(|file| file.uses.len()).sum();
    Ok(format!(
        "{paths} paths between modules in {} files, every arrow points left",
        tree.files.len()
    ))
}

/// One line for each path that leads right or nowhere, and each room that the order does not know.
fn findings(tree: &Tree) -> Vec<String> {
    let mut findings = Vec::new();
    for (room, file) in tree.rooms() {
        if !order::knows(room) {
            findings.push(format!(
                "{file}:1: `{room}` has no place in the order (xtask/src/layers/order.rs)"
            ));
        }
    }
    for file in tree.files.iter().filter(|file| !file.test_only) {
        // src/lib.rs stands above all rooms.
        let Some(from) = file.module.first() else { continue };
        for used in &file.uses {
            let path = format!("crate::{}", used.path.join("::"));
            let complaint = match tree.room_of(&used.path[0]) {
                Some(room) if may_use(from, room) => continue,
                Some(room) => format!("{from} may not use {room} ({})", order::reason(from, room)),
                None if used.path[0] == scan::ROOT => "name the room, not the crate's root".to_string(),
                None => "this is neither a room nor re-exported by src/lib.rs".to_string(),
            };
            findings.push(format!("{}:{}: `{path}`: {complaint}", file.path, used.line));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The findings in a crate made of these files.
    fn findings_in(files: &[(&str, &str)]) -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        for (path, text) in files {
            let path = folder.path().join("src").join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        findings(&Tree::read(&folder.path().join("src")).unwrap())
    }

    #[test]
    fn arrows_to_the_left_are_silent() {
        let files = [
            (
                "lib.rs",
                "pub mod num; pub mod bvh; pub mod render; pub mod film; pub use bvh::Node;",
            ),
            (
                "num/mod.rs",
                "pub struct Q; #[macro_export] macro_rules! q { () => { $crate::num::Q } }",
            ),
            ("bvh/mod.rs", "mod node; use crate::num::Q; pub use node::Node;"),
            (
                "bvh/node.rs",
                "use super::super::num::Q; use super::Tree; use crate::bvh::Leaf; const A: Q = crate::q!(); pub(in crate::bvh) struct B;",
            ),
            ("film.rs", "use crate::{color::Radiance, num};"),
            (
                "render.rs",
                "use crate::film::Tile; use crate::{bvh::{self, Node}, num::*}; type N = crate::Node;",
            ),
        ];
        assert_eq!(findings_in(&files), Vec::<String>::new());
    }

    #[test]
    fn an_arrow_to_the_right_is_told_with_its_line() {
        let files = [
            ("lib.rs", "mod geom;"),
            ("geom/ray.rs", "//! Rays.\n\nuse crate::material::Lambert;\n"),
        ];
        assert_eq!(
            findings_in(&files),
            [
                "src/geom/ray.rs:3: `crate::material::Lambert`: geom may not use material (it stands to the right of geom)"
            ]
        );
    }

    #[test]
    fn every_spelling_is_seen() {
        let right = [
            "use crate::{num, render::Renderer};",
            "use super::render::Renderer;",
            "use super::{num, render};",
            "fn f() { let _ = crate::render::go(); }",
            "mod inner { use super::super::render; }",
            "macro_rules! m { () => { $crate::render::go() } }",
            "fn f() -> Vec<crate::render::Tile> { Vec::new() }",
            "const A: &[u8] = &vec![super::render::Tile];",
            "#[derive(crate::render::Derive)] struct S;",
            "fn f() { self::super::render::go() }",
            "fn f() { for _ in crate::render::tiles() {} }",
            "pub struct P(pub (crate::render::Tile, u8));",
        ];
        for line in right {
            let found = findings_in(&[("lib.rs", ""), ("color.rs", line)]);
            assert_eq!(found.len(), 1, "{line}: {found:?}");
            assert!(found[0].contains("color may not use render"), "{line}: {found:?}");
        }
    }

    #[test]
    fn film_is_a_side_room() {
        let uses = |from: &str, to: &str| {
            findings_in(&[
                ("lib.rs", ""),
                (&format!("{from}.rs"), &format!("use crate::{to}::X;")),
            ])
        };
        assert!(uses("film", "color").is_empty());
        assert!(uses("render", "film").is_empty());
        assert!(uses("film", "geom").is_empty());
        assert!(uses("film", "sampler")[0].contains("film uses num, color, geom only"));
        assert!(uses("integrator", "film")[0].contains("film is for render only"));
    }

    #[test]
    fn tests_are_exempt() {
        let files = [
            ("lib.rs", "mod num; #[cfg(test)] mod fixtures;"),
            (
                "num/mod.rs",
                "#[cfg(test)] mod tests; #[cfg(all(test, feature = \"x\"))] mod more { use crate::render::X; }",
            ),
            ("num/tests.rs", "use crate::render::Renderer;"),
            ("num/tests/deep.rs", "use crate::render::Renderer;"),
            (
                "num/root.rs",
                "#[cfg(test)] use crate::{film, render}; #[test] fn f() { crate::render::go() }",
            ),
            ("fixtures.rs", "use crate::render::Renderer;"),
        ];
        assert_eq!(findings_in(&files), Vec::<String>::new());
    }

    #[test]
    fn what_follows_a_test_is_not_exempt() {
        for line in [
            "#[cfg(test)] use crate::{num, color}; use crate::render::X;",
            "#[cfg(test)] const A: [u8; { 1 }] = [0]; use crate::render::X;",
            "#[cfg(test)] mod tests; use crate::render::X;",
            "struct S { #[cfg(test)] a: u8, b: crate::render::X }",
            "#[cfg(not(test))] use crate::render::X;",
            "#[cfg(any(test, feature = \"x\"))] use crate::render::X;",
        ] {
            assert_eq!(
                findings_in(&[("lib.rs", ""), ("num.rs", line)]).len(),
                1,
                "{line}"
            );
        }
    }

    #[test]
    fn names_of_the_root_are_traced_to_their_room() {
        let files = [
            (
                "lib.rs",
                "pub use render::{Renderer, Settings as S}; pub use film::tile::*;",
            ),
            (
                "light.rs",
                "use crate::Renderer;\nuse crate::S;\nuse crate::Nothing;\nuse crate::*;\nuse crate::{self as k};\nuse super::*;",
            ),
            ("render.rs", "#[macro_export] macro_rules! strip { () => {} }"),
            ("shape.rs", "const A: () = crate::strip!();"),
        ];
        let found = findings_in(&files);
        assert!(
            found[0].contains("light.rs:1: `crate::Renderer`: light may not use render"),
            "{found:?}"
        );
        assert!(
            found[1].contains("light.rs:2: `crate::S`: light may not use render"),
            "{found:?}"
        );
        assert!(
            found[2].contains("light.rs:3: `crate::Nothing`: this is neither a room"),
            "{found:?}"
        );
        for (line, found) in (4..=6).zip(&found[3..]) {
            assert!(
                found.contains(&format!("light.rs:{line}: ")) && found.contains("name the room"),
                "{found}"
            );
        }
        assert!(
            found[6].contains("shape.rs:1: `crate::strip`: shape may not use render"),
            "{found:?}"
        );
        assert_eq!(found.len(), 7);
    }

    #[test]
    fn a_room_without_a_place_is_told() {
        let found = findings_in(&[("lib.rs", ""), ("helpers/mod.rs", "")]);
        assert_eq!(
            found,
            ["src/helpers/mod.rs:1: `helpers` has no place in the order (xtask/src/layers/order.rs)"]
        );
    }

    #[test]
    fn a_tree_without_a_root_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("src")).unwrap();
        assert!(check(folder.path()).is_err());
    }
}
