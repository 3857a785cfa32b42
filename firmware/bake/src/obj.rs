use crate::Baked;
use crate::room::Mesh;

/// The triangles of a Wavefront OBJ text: `v` and `f` lines, polygons as fans; everything else is passed over.
pub fn obj(text: &str) -> Result<Baked, String> {
    let (points, faces) = read(text)?;
    Baked::new(&points, &faces)
}

pub(crate) fn read(text: &str) -> Result<Mesh, String> {
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let wrong = || format!("line {number}: {line:?}");
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut next = || {
                    words
                        .next()
                        .and_then(|word| word.parse::<f64>().ok())
                        .ok_or_else(wrong)
                };
                points.push([next()?, next()?, next()?]);
            }
            Some("f") => {
                let corner = |word: &str| {
                    let index = word.split('/').next()?.parse::<i64>().ok()?;
                    let from = if index < 0 { points.len() as i64 } else { -1 };
                    usize::try_from(from + index).ok()
                };
                let corners = words.map(corner).collect::<Option<Vec<_>>>().ok_or_else(wrong)?;
                for pair in corners.get(1..).unwrap_or(&[]).windows(2) {
                    faces.push([corners[0], pair[0], pair[1]]);
                }
            }
            _ => {}
        }
    }
    Ok((points, faces))
}

#[cfg(test)]
mod tests {
    use super::obj;

    #[test]
    fn reads_fans_and_both_ways_of_counting() {
        let text = "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1/1/1 2//1 3 4\nf -4 -3 -2\n";
        let baked = obj(text).unwrap();
        let mut triangles = baked.triangles;
        triangles.sort();
        assert_eq!(triangles, [[0, 1, 2], [0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn tells_the_line_that_is_wrong() {
        assert!(obj("v 0 0 0\nv 0 x 0\n").unwrap_err().contains("line 2"));
    }
}
