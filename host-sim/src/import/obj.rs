//! Wavefront OBJ: `v`, `vn`, `vt` and `f`, with faces of any number of corners and negative indices; `usemtl` and `mtllib`
//! where the file is a scene of its own.

use std::collections::HashMap;
use std::path::Path;

use super::error::ImportError;
use super::mesh::RawMesh;
use super::ngon::Cutter;
use super::suggest::list;
use crate::desc::Vec3;

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

/// Reads the whole file as one mesh, groups and materials joined.
pub(super) fn read(path: &Path) -> Result<RawMesh, ImportError> {
    Ok(read_parts(path)?.raw)
}

/// Reads the file with what it says of materials.
pub(super) fn read_parts(path: &Path) -> Result<Parts, ImportError> {
    let text = std::fs::read(path).map_err(|error| ImportError::io(path, &error))?;
    parse(path, &String::from_utf8_lossy(&text))
}

/// A mesh, and what its triangles are of.
#[derive(Debug)]
pub(super) struct Parts {
    pub raw: RawMesh,
    /// One a triangle: 0 is what no `usemtl` stands before, the others count `names` from 1.
    pub part: Vec<usize>,
    pub names: Vec<String>,
    /// What follows each `mtllib`, with its line.
    pub libraries: Vec<(u32, String)>,
}

fn parse(path: &Path, text: &str) -> Result<Parts, ImportError> {
    let file = statements(path, text)?;
    if file.faces.is_empty() {
        return Err(ImportError::new(
            path,
            "has no faces; export the mesh with its faces",
        ));
    }
    // Faces may name what stands further down, so the last counts decide.
    let counts = file.counts();
    for face in &file.faces {
        let wrong = face.corners.iter().find_map(|corner| corner.check(counts).err());
        if let Some(message) = wrong {
            return Err(ImportError::at(path, face.line, message));
        }
    }
    file.mesh(path)
}

/// What the statements say, indices not looked at yet.
#[derive(Default)]
struct File {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    textures: Vec<[f64; 2]>,
    /// One a position, once one has been seen.
    colors: Vec<Vec3>,
    faces: Vec<Face>,
    materials: Vec<String>,
    libraries: Vec<(u32, String)>,
}

struct Face {
    line: u32,
    corners: Vec<Corner>,
    material: usize,
}

fn statements(path: &Path, text: &str) -> Result<File, ImportError> {
    let mut file = File::default();
    let mut material = 0;
    for (line, content) in &logical_lines(text) {
        let mut words = content.split_whitespace();
        let Some(statement) = words.next() else { continue };
        let refuse = |message: String| ImportError::at(path, *line, message);
        let wrong = |what: String| refuse(format!("{statement}: {what}"));
        match statement {
            "v" => {
                let numbers: Vec<&str> = words.collect();
                file.positions.push(numbers_of(&numbers).map_err(wrong)?);
                // As some exporters write them: x y z r g b.
                if let [_, _, _, color @ ..] = &numbers[..]
                    && color.len() == 3
                {
                    let color: Vec3 = numbers_of(color).map_err(wrong)?;
                    file.colors.resize(file.positions.len() - 1, [1.0; 3]);
                    file.colors.push(color.map(|c| c.clamp(0.0, 1.0)));
                }
            }
            "vn" => file.normals.push(numbers(words).map_err(wrong)?),
            "vt" => {
                let [u, v] = texture(words).map_err(wrong)?;
                // From the picture's last row up, as Mitsuba reads it.
                file.textures.push([u, 1.0 - v]);
            }
            "f" => file.faces.push(Face {
                line: *line,
                corners: corners(words, file.counts()).map_err(refuse)?,
                material,
            }),
            "usemtl" => {
                let name = content.trim_start()[statement.len()..].trim();
                let known = file.materials.iter().position(|known| known == name);
                material = 1 + known.unwrap_or(file.materials.len());
                if known.is_none() {
                    file.materials.push(name.to_string());
                }
            }
            "mtllib" => {
                let names = content.trim_start()[statement.len()..].trim();
                file.libraries.push((*line, names.to_string()));
            }
            _ if KNOWN.contains(&statement) => {}
            _ => {
                return Err(refuse(format!(
                    "\"{statement}\" is not an OBJ statement; use {}",
                    list(&SURFACE)
                )));
            }
        }
    }
    Ok(file)
}

impl File {
    fn counts(&self) -> Counts {
        Counts {
            v: self.positions.len() as i64,
            vt: self.textures.len() as i64,
            vn: self.normals.len() as i64,
        }
    }

    /// Corners that name the same become one vertex. Texture coordinates tell vertices apart (as in Mitsuba). Normals and
    /// they stay only if every corner has one: half a set would leave the rest undefined.
    fn mesh(mut self, path: &Path) -> Result<Parts, ImportError> {
        let corners = || self.faces.iter().flat_map(|face| &face.corners);
        let complete = corners().all(|corner| corner.vn.is_some());
        let placed = corners().all(|corner| corner.vt.is_some());
        let mut raw = RawMesh::default();
        if !complete && corners().any(|corner| corner.vn.is_some()) {
            let note = "some corners have no normal; all normals are computed instead";
            raw.notes.push(note.to_string());
        }
        if !self.colors.is_empty() {
            self.colors.resize(self.positions.len(), [1.0; 3]);
        }
        let mut known: HashMap<[Option<i64>; 3], u32> = HashMap::new();
        let mut cutter = Cutter::new();
        let mut face_indices = Vec::new();
        let mut part = Vec::new();
        for face in &self.faces {
            face_indices.clear();
            for corner in &face.corners {
                let normal = corner.vn.filter(|_| complete);
                let index = known
                    .entry([Some(corner.v), corner.vt, normal])
                    .or_insert_with(|| {
                        raw.positions.push(self.positions[corner.v as usize - 1]);
                        raw.normals.extend(normal.map(|vn| self.normals[vn as usize - 1]));
                        raw.colors.extend(self.colors.get(corner.v as usize - 1));
                        let uv = corner.vt.filter(|_| placed);
                        raw.uvs.extend(uv.map(|vt| self.textures[vt as usize - 1]));
                        (raw.positions.len() - 1) as u32
                    });
                face_indices.push(*index);
            }
            let added = cutter.add(&mut raw, &face_indices);
            added.map_err(|what| ImportError::at(path, face.line, format!("f: this face {what}")))?;
            part.resize(raw.triangles.len(), face.material);
        }
        raw.notes.extend(cutter.note());
        Ok(Parts {
            raw,
            part,
            names: self.materials,
            libraries: self.libraries,
        })
    }
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

/// The first `N` numbers, finite; what follows them (weights, colours) is skipped.
fn numbers<'a, const N: usize>(words: impl Iterator<Item = &'a str>) -> Result<[f64; N], String> {
    let mut found = [0.0_f64; N];
    let mut count = 0;
    for (number, word) in found.iter_mut().zip(words) {
        *number = word
            .parse()
            .map_err(|_| format!("\"{word}\" is not a number; correct it"))?;
        if !number.is_finite() {
            return Err(format!("{word} is not a finite number; correct it"));
        }
        count += 1;
    }
    match count {
        _ if count == N => Ok(found),
        _ => Err(format!("has {count} of {N} numbers; add the rest")),
    }
}

fn numbers_of<const N: usize>(words: &[&str]) -> Result<[f64; N], String> {
    numbers(words.iter().copied())
}

/// u, and v if it is given.
fn texture<'a>(words: impl Iterator<Item = &'a str>) -> Result<[f64; 2], String> {
    let words: Vec<&str> = words.collect();
    match words.len() {
        0 | 1 => numbers_of::<1>(&words).map(|[u]| [u, 0.0]),
        _ => numbers_of(&words),
    }
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
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<RawMesh, String> {
        let parts = parse(Path::new("m.obj"), text).map_err(|error| error.to_string())?;
        Ok(parts.raw)
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
