use crate::camera::Camera;
use crate::color::{Radiance, albedo};
use crate::geom::{Dir, Point, point};
use crate::material::Material;
use crate::num::{Metres, Share, Turn, sin_cos};
use crate::q;
use crate::scene::{MaterialId, SceneBuilder, SceneError};
use crate::shape::Rectangle;

type Builder = SceneBuilder<16, 4, 1>;

/// A box with a lamp under its ceiling and two blocks in it, after Goral et al. 1984; sizes and colours are our own.
///
/// Sixteen rectangles, one of them the light; 2 m wide, seen from its open side.
pub fn cornell() -> Result<(Builder, Camera), SceneError> {
    let mut b = Builder::new();
    let mut diffuse = |r, g, b_: Share| b.material(Material::lambert(albedo(r, g, b_)));
    let white = diffuse(q!(0.74, Share), q!(0.73, Share), q!(0.70, Share))?;
    let red = diffuse(q!(0.60, Share), q!(0.07, Share), q!(0.06, Share))?;
    let green = diffuse(q!(0.13, Share), q!(0.44, Share), q!(0.12, Share))?;
    let black = b.material(Material::Black)?;

    let (x, y, z) = (Dir::X, Dir::Y, Dir::Z);
    let one = [length(q!(1)); 2];
    let wall = |center, [u, v, normal]: [Dir; 3], half| Rectangle {
        center,
        u,
        v,
        normal,
        half,
    };
    b.shape(wall(point(q!(0), q!(0), q!(0)), [z, x, y], one), white)?;
    b.shape(wall(point(q!(0), q!(2), q!(0)), [x, z, -y], one), white)?;
    b.shape(wall(point(q!(0), q!(1), q!(-1)), [x, y, z], one), white)?;
    b.shape(wall(point(q!(-1), q!(1), q!(0)), [y, z, x], one), red)?;
    b.shape(wall(point(q!(1), q!(1), q!(0)), [z, y, -x], one), green)?;

    let tall = [q!(0.29), q!(0.61), q!(0.29)].map(length);
    block(
        &mut b,
        white,
        point(q!(-0.36), q!(0.61), q!(-0.30)),
        tall,
        q!(0.0472, Turn),
    )?;
    let short = [q!(0.29), q!(0.28), q!(0.29)].map(length);
    block(
        &mut b,
        white,
        point(q!(0.35), q!(0.28), q!(0.33)),
        short,
        q!(0.9472, Turn),
    )?;

    let lamp = wall(
        point(q!(0), q!(1.985), q!(-0.05)),
        [x, z, -y],
        [q!(0.26), q!(0.21)].map(length),
    );
    b.emitter(lamp, black, Radiance::new(q!(16.5), q!(13.6), q!(8.6)))?;

    let camera = Camera::from_frame(
        point(q!(0), q!(1), q!(4.1)),
        [x, y, -z],
        Camera::tan_half(q!(0.1056, Turn)),
    );
    Ok((b, camera))
}

fn length(metres: Metres) -> i32 {
    crate::geom::Unit::DEFAULT.length(metres)
}

/// An upright box turned about y, without its bottom.
fn block(
    b: &mut Builder,
    material: MaterialId,
    center: Point,
    half: [i32; 3],
    turn: Turn,
) -> Result<(), SceneError> {
    let (sin, cos) = sin_cos(turn);
    let axes = [Dir([cos, 0, -sin]), Dir::Y, Dir([sin, 0, cos])];
    for (axis, out) in [(0, false), (0, true), (1, true), (2, false), (2, true)] {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        // u × v is the axis itself: the side is chosen by the sign of one edge.
        let side = |dir: Dir| if out { dir } else { -dir };
        let normal = side(axes[axis]);
        let face = Rectangle {
            center: center.along(normal, half[axis]),
            u: side(axes[u]),
            v: axes[v],
            normal,
            half: [half[u], half[v]],
        };
        b.shape(face, material)?;
    }
    Ok(())
}
