use crate::{Baked, knot, obj};

/// Points, and triangles of them.
pub(crate) type Mesh = (Vec<[f64; 3]>, Vec<[usize; 3]>);

/// A mesh within the twelve triangles of a cube, one mesh of both: what `emulator rays` sends rays to.
///
/// The cube has two and a half times the mesh's longest side, and the mesh in its middle.
#[derive(Clone, Debug)]
pub struct Room(Baked);

impl Room {
    /// About a torus knot of 20,000 triangles.
    pub fn of_knot() -> Result<Room, String> {
        Room::about(knot::tube(500, 20))
    }

    /// About the mesh of a Wavefront OBJ text.
    pub fn of_obj(text: &str) -> Result<Room, String> {
        Room::about(obj::read(text)?)
    }

    fn about((mut points, mut faces): Mesh) -> Result<Room, String> {
        let sides = [0, 1, 2].map(|axis| {
            points.iter().fold((f64::MAX, f64::MIN), |(low, high), point| {
                (point[axis].min(low), point[axis].max(high))
            })
        });
        let longest = sides.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
        let first = points.len();
        points.extend((0..8).map(|corner| {
            [0, 1, 2].map(|axis| {
                let (low, high) = sides[axis];
                let side = if corner >> axis & 1 == 0 { -1.25 } else { 1.25 };
                (low + high) / 2.0 + side * longest
            })
        }));
        for axis in 0..3 {
            let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            for from in [0, 1 << axis] {
                faces.push([from, from + u, from + u + v].map(|corner| first + corner));
                faces.push([from, from + u + v, from + v].map(|corner| first + corner));
            }
        }
        Baked::new(&points, &faces).map(Room)
    }

    pub fn triangles(&self) -> usize {
        self.0.triangles.len()
    }

    /// Bytes of flash that nodes and triangles take: as they are indexed, and packed.
    pub fn bytes(&self) -> [usize; 2] {
        let Baked {
            vertices,
            triangles,
            nodes,
            packed,
        } = &self.0;
        let plain = size_of_val(&**vertices) + size_of_val(&**triangles) + size_of_val(&**nodes);
        let mesh = packed.mesh();
        [plain, mesh.triangles.bytes() + size_of_val(mesh.nodes)]
    }

    /// As `firmware/qemu` has it in flash: how many nodes, triangles and vertices, then those, then, from a multiple of
    /// four bytes on, the same packed in a blob.
    pub fn image(&self) -> Result<Vec<u8>, String> {
        let Baked {
            vertices,
            triangles,
            nodes,
            ..
        } = &self.0;
        let mut image = Vec::new();
        for count in [nodes.len(), triangles.len(), vertices.len()] {
            image.extend((count as u32).to_le_bytes());
        }
        image.extend(nodes.iter().flat_map(|node| node.to_le_bytes()));
        let halves = triangles.iter().chain(vertices).flatten();
        image.extend(halves.flat_map(|half| half.to_le_bytes()));
        image.resize(image.len().next_multiple_of(4), 0);
        image.extend(self.0.blob()?);
        Ok(image)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twelve walls that face each other in pairs, the mesh two fifths of them.
    #[test]
    fn the_mesh_stands_in_the_middle() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let room = Room::of_obj(text).unwrap();
        assert_eq!(room.triangles(), 13);
        let of_walls = &room.0.vertices[3..];
        let middle = [0, 1, 2].map(|axis| {
            let side = of_walls.iter().map(|vertex| u32::from(vertex[axis]));
            assert_eq!(side.clone().max().unwrap() - side.clone().min().unwrap(), 55_700);
            side.sum::<u32>() / 8
        });
        assert_eq!(middle, [32_768, 27_914, 32_768]);
        let [corner, along, _] = [0, 1, 2].map(|vertex| room.0.vertices[vertex].map(i32::from));
        assert_eq!(along[0] - corner[0], 22_280);
        let image = room.image().unwrap();
        let nodes = room.0.nodes.len() * 40;
        assert_eq!(image[..4], (room.0.nodes.len() as u32).to_le_bytes());
        assert!(
            microlux::scene::Baked::open(
                microlux_bake::Aligned::new(
                    &image[(12 + nodes + 13 * 6 + 11 * 6_usize).next_multiple_of(4)..]
                )
                .bytes()
            )
            .is_ok()
        );
    }
}
