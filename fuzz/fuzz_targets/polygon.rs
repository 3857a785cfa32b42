//! Polygons from anywhere: refused by name, or cut into triangles that turn counter-clockwise and are of its points' range.

#![no_main]

use arbitrary::Arbitrary;
use libfuzzer_sys::fuzz_target;
use microlux::shape::polygon::{Corner, Fill, Polygon, RANGE, Step, Workspace};

#[derive(Arbitrary, Debug)]
struct Input {
    points: Vec<[i32; 2]>,
    ends: Vec<u16>,
    non_zero: bool,
    /// By how much coordinates are cut, so that points meet.
    cut: u8,
}

fuzz_target!(|input: Input| {
    let cut = u32::from(input.cut % 32);
    let points: Vec<[i32; 2]> = input
        .points
        .iter()
        .take(48)
        .map(|p| p.map(|c| c >> cut))
        .collect();
    let ends = match input.ends.is_empty() {
        true => vec![points.len() as u16],
        false => input.ends,
    };
    let polygon = Polygon {
        points: &points,
        ends: &ends,
        fill: if input.non_zero {
            Fill::NonZero
        } else {
            Fill::EvenOdd
        },
    };
    let at = |corner: Corner| match corner {
        Corner::Vertex(index) => points[usize::from(index)],
        Corner::Crossing(point) => point,
    };
    let result = Workspace::<2048>::new().triangulate(&polygon, |step| {
        let Step::Triangle(corners) = step else { return };
        let [a, b, c] = corners.map(at);
        for [x, y] in [a, b, c] {
            assert!(x.abs() <= RANGE && y.abs() <= RANGE);
        }
        let [ax, ay, bx, by, cx, cy] = [a[0], a[1], b[0], b[1], c[0], c[1]].map(i64::from);
        let double_area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
        // Corners that are rounded may lie on the other side of a sliver, by half a step times its length.
        let rounded = corners.iter().any(|corner| matches!(corner, Corner::Crossing(_)));
        let length = [(bx - ax), (by - ay), (cx - ax), (cy - ay)].map(i64::abs);
        let slack = if rounded {
            2 + length.iter().sum::<i64>()
        } else {
            0
        };
        assert!(double_area >= -slack, "{a:?} {b:?} {c:?}");
    });
    if let Err(error) = result {
        assert!(!error.to_string().is_empty());
    }
});
