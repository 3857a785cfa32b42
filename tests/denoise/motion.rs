use microlux::camera::Camera;
use microlux::film::denoise::Reproject;
use microlux::film::feature::{DEPTH_NOTHING, depth_distance};
use microlux::geom::Point;
use microlux::num::Turn;
use microlux::render::Motion;

const SIZE: [u16; 2] = [80, 60];

fn camera(origin: [i32; 3], target: [i32; 3]) -> Camera {
    let tan = Camera::tan_half(Turn::from_bits(1 << 29));
    Camera::look_at(Point(origin), Point(target), [0, 1, 0], tan).unwrap()
}

/// The pixel's ray and the other camera's film, in f64 from the frames alone.
fn exact(before: &Camera, now: &Camera, x: u16, y: u16, distance: f64) -> [f64; 2] {
    let frame = |c: &Camera| c.frame().map(|d| d.0.map(|v| f64::from(v) / 65536.0));
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
    let tan = f64::from(now.half_width().to_bits()) / f64::from(1 << 20);
    let [width, height] = SIZE.map(f64::from);
    let [right, up, forward] = frame(now);
    let sx = (2.0 * (f64::from(x) + 0.5) - width) / width * tan;
    let sy = (height - 2.0 * (f64::from(y) + 0.5)) / width * tan;
    let dir = [0, 1, 2].map(|i| forward[i] + sx * right[i] + sy * up[i]);
    let length = dot(dir, dir).sqrt();
    let from = |c: &Camera| c.origin().0.map(f64::from);
    let offset = [0, 1, 2].map(|i| from(now)[i] + dir[i] * distance / length - from(before)[i]);
    let [right, up, forward] = frame(before);
    let depth = dot(offset, forward);
    let plane = [dot(offset, right) / depth, -dot(offset, up) / depth];
    [
        (plane[0] / tan * width + width) / 2.0,
        (plane[1] / tan * width + height) / 2.0,
    ]
}

#[test]
fn places_are_where_they_were() {
    let before = camera([0, 1 << 20, 3 << 20], [0, 1 << 19, 0]);
    let now = camera(
        [70_000, (1 << 20) + 30_000, (3 << 20) - 90_000],
        [20_000, 1 << 19, 0],
    );
    let motion = Motion::between(before, now, SIZE[0], SIZE[1]);
    let mut seen = 0;
    for y in (0..SIZE[1]).step_by(3) {
        for x in (0..SIZE[0]).step_by(3) {
            for depth in [100, 150, 165, 200] {
                let exact = exact(&before, &now, x, y, f64::from(depth_distance(depth)));
                let Some(found) = motion.before(x, y, depth) else {
                    assert!(exact[0] < 0.5 || exact[1] < 0.5 || exact[0] > 79.5 || exact[1] > 59.5);
                    continue;
                };
                seen += 1;
                for (found, exact) in found.place.into_iter().zip(exact) {
                    assert!(
                        (f64::from(found) / 16.0 - exact).abs() < 0.04,
                        "{x} {y} {found} {exact}"
                    );
                }
            }
        }
    }
    assert!(seen > 1500, "{seen}");
}

#[test]
fn a_camera_at_rest_sees_each_place_where_it_was_and_a_hair_of_motion_is_none() {
    let eye = camera([5, 1 << 20, 3 << 20], [0, 1 << 19, 77]);
    let moved = camera([6, 1 << 20, 3 << 20], [1, 1 << 19, 77]);
    for motion in [
        Motion::between(eye, eye, SIZE[0], SIZE[1]),
        Motion::between(eye, moved, SIZE[0], SIZE[1]),
    ] {
        for (x, y) in (0..SIZE[0]).flat_map(|x| (0..SIZE[1]).map(move |y| (x, y))) {
            for depth in [120, 160, DEPTH_NOTHING] {
                let found = motion.before(x, y, depth);
                let Some(found) = found else {
                    assert!(
                        x == 0 || y == 0 || x == SIZE[0] - 1 || y == SIZE[1] - 1,
                        "{x} {y}"
                    );
                    continue;
                };
                assert_eq!(found.place, [x, y].map(|c| 16 * i32::from(c) + 8));
                assert!(found.depth.abs_diff(depth) <= 1);
            }
        }
    }
}

#[test]
fn what_is_infinitely_far_away_moves_by_turns_alone() {
    let before = camera([0, 1 << 20, 3 << 20], [0, 1 << 19, 0]);
    let frame = before.frame();
    let tan = before.half_width();
    let moved = Camera::from_frame(Point([1 << 20, 0, 0]), frame, tan);
    let motion = Motion::between(before, moved, SIZE[0], SIZE[1]);
    let found = motion.before(40, 30, DEPTH_NOTHING).unwrap();
    assert_eq!(found.place, [40 * 16 + 8, 30 * 16 + 8]);
    assert_eq!(found.depth, DEPTH_NOTHING);
}
