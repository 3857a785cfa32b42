//! Wavefront OBJ: `v`, `vn`, `vt` and `f` (fans, negative indices). `tobj` builds the faces; the lines are checked here
//! first, since it does not say where an error stands.

use std::path::Path;

use super::error::ImportError;
use super::mesh::RawMesh;
use super::suggest::list;

/// Statements that say something about the surface; all others (groups, materials, smoothing, lines, ...) are skipped.
const SURFACE: [&str; 4] = ["v", "vt", "vn", "f"];
const KNOWN: [&str; 19] = [
    "v",
    "vt",
    "vn",
    "vp",
    "f",
    "g",
    "o",
    "s",
    "l",
    "p",
    "usemtl",
    "mtllib",
    "mg",
    "usemap",
    "maplib",
    "lod",
    "shadow_obj",
    "trace_obj",
    "bevel",
];

/// Reads the whole file as one mesh, groups joined.
pub(super) fn read(path: &Path) -> Result<RawMesh, ImportError> {
    let text = std::fs::read(path).map_err(|error| ImportError::io(path, &error))?;
    parse(path, &String::from_utf8_lossy(&text))
}

fn parse(path: &Path, text: &str) -> Result<RawMesh, ImportError> {
    let surface = check(path, text)?;
    let options = tobj::LoadOptions {
        single_index: true,
        triangulate: true,
        ..Default::default()
    };
    let no_materials = |_: &Path| Ok((Vec::new(), Default::default()));
    let (models, _) = tobj::load_obj_buf(&mut surface.text.as_bytes(), &options, no_materials)
        .map_err(|error| ImportError::new(path, format!("{error}; export the mesh again")))?;

    let mut raw = RawMesh {
        notes: surface.notes,
        ..RawMesh::default()
    };
    for model in models {
        let first = raw.positions.len() as u32;
        raw.positions.extend(threes(&model.mesh.positions));
        raw.normals.extend(threes(&model.mesh.normals));
        raw.triangles.extend(
            model
                .mesh
                .indices
                .chunks_exact(3)
                .map(|t| [t[0] + first, t[1] + first, t[2] + first]),
        );
    }
    Ok(raw)
}

fn threes(numbers: &[f64]) -> impl Iterator<Item = [f64; 3]> {
    numbers.chunks_exact(3).map(|n| [n[0], n[1], n[2]])
}

/// The lines that matter, known to be sound.
struct Surface {
    text: String,
    notes: Vec<String>,
}

/// Checks numbers and indices line by line, and keeps positions, normals and faces.
///
/// Normals stay only if every corner has one: half a set would leave the rest undefined.
fn check(path: &Path, text: &str) -> Result<Surface, ImportError> {
    let lines = logical_lines(text);
    let mut counts = Counts::default();
    let mut faces = Vec::new();
    for (line, content) in &lines {
        let mut words = content.split_whitespace();
        let Some(statement) = words.next() else { continue };
        let refuse = |message: String| ImportError::at(path, *line, message);
        match statement {
            "v" | "vn" => {
                finite(words, 3).map_err(|what| refuse(format!("{statement}: {what}")))?;
                *(if statement == "v" {
                    &mut counts.v
                } else {
                    &mut counts.vn
                }) += 1;
            }
            "vt" => {
                finite(words, 1).map_err(|what| refuse(format!("vt: {what}")))?;
                counts.vt += 1;
            }
            "f" => faces.push(
                corners(words, counts)
                    .map(|corners| (*line, corners))
                    .map_err(refuse)?,
            ),
            _ if KNOWN.contains(&statement) => {}
            _ => {
                return Err(refuse(format!(
                    "\"{statement}\" is not an OBJ statement; use {}",
                    list(&SURFACE)
                )));
            }
        }
    }
    if faces.is_empty() {
        return Err(ImportError::new(
            path,
            "has no faces; export the mesh with its faces",
        ));
    }
    // Faces may name what stands further down, so the last counts decide.
    for (line, corners) in &faces {
        for corner in corners {
            corner
                .check(counts)
                .map_err(|message| ImportError::at(path, *line, message))?;
        }
    }

    let with_normal = |corners: &[Corner]| corners.iter().filter(|c| c.vn.is_some()).count();
    let normals: usize = faces.iter().map(|(_, corners)| with_normal(corners)).sum();
    let complete = faces
        .iter()
        .all(|(_, corners)| with_normal(corners) == corners.len());
    let mut notes = Vec::new();
    if normals > 0 && !complete {
        notes.push("some corners have no normal; all normals are computed instead".to_string());
    }
    let mut kept = String::with_capacity(text.len());
    for (_, content) in lines
        .iter()
        .filter(|(_, c)| matches!(c.split_whitespace().next(), Some("v" | "vn")))
    {
        // Only the coordinates: tobj would take what follows for a weight or a colour.
        kept.extend(content.split_whitespace().take(4).flat_map(|word| [word, " "]));
        kept.push('\n');
    }
    // Texture coordinates tell vertices apart (as in Mitsuba), their values mean nothing here.
    for _ in 0..counts.vt {
        kept.push_str("vt 0 0\n");
    }
    for (_, corners) in &faces {
        kept.push('f');
        corners
            .iter()
            .for_each(|corner| corner.write(&mut kept, complete));
        kept.push('\n');
    }
    Ok(Surface { text: kept, notes })
}

/// Lines without comments, continued ones (`\` at the end) joined, each with the number of its first line.
fn logical_lines(text: &str) -> Vec<(u32, String)> {
    let mut lines: Vec<(u32, String)> = Vec::new();
    let mut continued = false;
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or("").trim_end();
        let (content, more) = match line.strip_suffix('\\') {
            Some(content) => (content, true),
            None => (line, false),
        };
        match lines.last_mut() {
            Some((_, open)) if continued => {
                open.push(' ');
                open.push_str(content);
            }
            _ => lines.push((number, content.to_string())),
        }
        continued = more;
    }
    lines
}

/// At least `needed` numbers, the first of them finite.
fn finite<'a>(words: impl Iterator<Item = &'a str>, needed: usize) -> Result<(), String> {
    let mut found = 0;
    for word in words.take(needed) {
        let number: f64 = word
            .parse()
            .map_err(|_| format!("\"{word}\" is not a number; correct it"))?;
        if !number.is_finite() {
            return Err(format!("{word} is not a finite number; correct it"));
        }
        found += 1;
    }
    if found < needed {
        return Err(format!("has {found} of {needed} numbers; add the rest"));
    }
    Ok(())
}

/// How many of each stand in the file so far.
#[derive(Clone, Copy, Default)]
struct Counts {
    v: i64,
    vt: i64,
    vn: i64,
}

/// One corner of a face; indices count from 1, relative ones resolved.
struct Corner {
    v: i64,
    vt: Option<i64>,
    vn: Option<i64>,
}

fn corners<'a>(words: impl Iterator<Item = &'a str>, so_far: Counts) -> Result<Vec<Corner>, String> {
    let corners = words
        .map(|word| Corner::parse(word, so_far))
        .collect::<Result<Vec<_>, _>>()?;
    match corners.len() {
        0..3 => Err(format!(
            "f: a face needs 3 corners, this one has {}; remove it",
            corners.len()
        )),
        _ => Ok(corners),
    }
}

impl Corner {
    fn parse(word: &str, so_far: Counts) -> Result<Self, String> {
        let wrong = || format!("f: \"{word}\" is not v, v/vt, v//vn or v/vt/vn; correct it");
        let mut parts = word.split('/');
        let mut next = |count: i64| match parts.next() {
            None | Some("") => Ok(None),
            Some(part) => match part.parse::<i64>().map_err(|_| wrong())? {
                0 => Err(format!("f: index 0 in \"{word}\"; OBJ counts from 1")),
                index if index < 0 => Ok(Some(count + 1 + index)),
                index => Ok(Some(index)),
            },
        };
        let corner = Self {
            v: next(so_far.v)?.ok_or_else(wrong)?,
            vt: next(so_far.vt)?,
            vn: next(so_far.vn)?,
        };
        if parts.next().is_some() {
            Err(wrong())
        } else {
            Ok(corner)
        }
    }

    fn check(&self, all: Counts) -> Result<(), String> {
        let kinds = [
            (Some(self.v), all.v, "vertex"),
            (self.vt, all.vt, "texture coordinate"),
            (self.vn, all.vn, "normal"),
        ];
        for (index, count, kind) in kinds {
            if index.is_some_and(|index| !(1..=count).contains(&index)) {
                let index = index.unwrap_or_default();
                return Err(format!(
                    "f: {kind} {index} does not exist, the file has {count}; correct the index"
                ));
            }
        }
        Ok(())
    }

    fn write(&self, text: &mut String, with_normal: bool) {
        let part = |index: Option<i64>| index.map(|i| i.to_string()).unwrap_or_default();
        let vn = if with_normal { self.vn } else { None };
        *text += &match (self.vt, vn) {
            (None, None) => format!(" {}", self.v),
            (vt, None) => format!(" {}/{}", self.v, part(vt)),
            (vt, vn) => format!(" {}/{}/{}", self.v, part(vt), part(vn)),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<RawMesh, String> {
        parse(Path::new("m.obj"), text).map_err(|error| error.to_string())
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn polygons_become_fans() {
        let raw = read_text(&format!("{SQUARE}v 0.5 2 0\nf 1 2 3 5 4\n")).unwrap();
        assert_eq!(raw.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(raw.positions[3], [0.5, 2.0, 0.0]);
    }

    #[test]
    fn negative_indices_count_back_from_their_own_line() {
        let raw = read_text("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\n").unwrap();
        assert_eq!(raw.positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    }

    #[test]
    fn groups_share_their_vertices_and_seams_do_not() {
        let raw = read_text(&format!("{SQUARE}g a\nf 1 2 3\ng b\nusemtl x\nf 1 3 4\n")).unwrap();
        assert_eq!(raw.positions.len(), 4);
        let raw = read_text(&format!("{SQUARE}vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 3/2 4/2\n")).unwrap();
        assert_eq!(raw.positions.len(), 6);
    }

    #[test]
    fn comments_continuations_colours_and_further_down() {
        let raw =
            read_text("f 1 2 \\\n 3 # late\nv 0 0 0 0.1 0.2 0.3\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\n").unwrap();
        assert_eq!(raw.triangles, [[0, 1, 2]]);
        assert_eq!(raw.positions[1], [1.0, 0.0, 0.0]);
    }

    #[test]
    fn half_a_set_of_normals_is_none() {
        let raw = read_text(&format!("{SQUARE}vn 0 0 1\nf 1//1 2//1 3//1\nf 1 3 4\n")).unwrap();
        assert!(raw.normals.is_empty());
        assert_eq!(raw.notes.len(), 1);
        let raw = read_text(&format!("{SQUARE}vn 0 0 1\nf 1//1 2//-1 3//1\n")).unwrap();
        assert_eq!((raw.normals.len(), raw.notes.len()), (3, 0));
    }

    #[test]
    fn errors_name_their_line() {
        for (text, expected) in [
            ("v 0 0\n", "m.obj:1: v: has 2 of 3 numbers"),
            ("\nv 0 0 nan\n", "m.obj:2: v: nan is not a finite number"),
            ("v 0 0 x\n", "m.obj:1: v: \"x\" is not a number"),
            ("v 0 0 0\nf 1 1\n", "m.obj:2: f: a face needs 3 corners"),
            (
                "v 0 0 0\n\n\nf 1 1 2\n",
                "m.obj:4: f: vertex 2 does not exist, the file has 1",
            ),
            ("v 0 0 0\nf 1 1 -2\n", "m.obj:2: f: vertex 0 does not exist"),
            ("v 0 0 0\nf 0 1 1\n", "m.obj:2: f: index 0 in"),
            ("v 0 0 0\nf 1//1 1 1\n", "m.obj:2: f: normal 1 does not exist"),
            ("v 0 0 0\nf 1/a 1 1\n", "m.obj:2: f: \"1/a\" is not"),
            (
                "v 0 0 0\nface 1 1 1\n",
                "m.obj:2: \"face\" is not an OBJ statement",
            ),
            ("v 0 0 0\n", "m.obj: has no faces"),
        ] {
            let error = read_text(text).unwrap_err();
            assert!(
                error.starts_with(expected),
                "{error:?} does not start with {expected:?}"
            );
        }
    }
}
