use super::node::{Child, Node};
use super::{Item, MAX_DEPTH, MESH_PAD};
use crate::shape::{Bounds, MeshError, PackedMesh, Triangles};
use heapless::Vec;

/// What is wrong with a tree from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckError {
    /// The mesh itself.
    Mesh(MeshError),
    /// A tree refers to this node, which is not there.
    NoNode { node: u32 },
    /// This node lies deeper than [`MAX_DEPTH`].
    TooDeep { node: u32 },
    /// A slot of this node means nothing, or the node has no child at all.
    Malformed { node: u32 },
    /// This leaf's primitives are not the next in order (each must be reached once, depth first, leaves before nodes).
    Order { node: u32, expected: u32, found: u32 },
    /// No leaf holds this primitive.
    Unreached { primitive: u32 },
    /// This primitive, padded, sticks out of a box above it.
    Outside { primitive: u32 },
}

impl core::fmt::Display for CheckError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Mesh(error) => write!(f, "{error}"),
            Self::NoNode { node } => write!(f, "there is no node {node}"),
            Self::TooDeep { node } => write!(f, "node {node} lies deeper than {MAX_DEPTH} levels"),
            Self::Malformed { node } => write!(f, "node {node} is malformed"),
            Self::Order {
                node,
                expected,
                found,
            } => {
                write!(
                    f,
                    "node {node}: its leaf begins at primitive {found} instead of {expected}"
                )
            }
            Self::Unreached { primitive } => write!(f, "no leaf holds primitive {primitive}"),
            Self::Outside { primitive } => write!(f, "primitive {primitive} sticks out of a box above it"),
        }
    }
}

/// Check a mesh and its tree; answers the depth.
pub fn check_mesh(mesh: &Triangles, nodes: &[Node]) -> Result<usize, CheckError> {
    match mesh {
        Triangles::Plain(mesh) => {
            mesh.check().map_err(CheckError::Mesh)?;
            let bounds = |i| mesh.corners(i).map(|c| Bounds::of(&c).pad(MESH_PAD));
            check_tree(mesh.triangles.len(), bounds, nodes)
        }
        Triangles::Packed(mesh) => check_packed(mesh, nodes),
    }
}

/// Each leaf of the stream is the next that the tree reaches, says as much as its node of how many triangles it has,
/// and lies within all boxes above it.
fn check_packed(mesh: &PackedMesh, nodes: &[Node]) -> Result<usize, CheckError> {
    let mut leaves = mesh.each_leaf();
    let leaf = |node: u32, base: u32, meta: u8, within: Bounds| {
        let found = base << 4 | (meta & 15) as u32;
        let next = leaves.next();
        let expected = next.map_or((mesh.leaves.len() as u32) << 4, |leaf| leaf.first());
        let order = CheckError::Order {
            node,
            expected,
            found,
        };
        let next = next.filter(|leaf| leaf.first() == found).ok_or(order)?;
        if next.count != (meta >> 4) as u32 {
            return Err(CheckError::Malformed { node });
        }
        mesh.check_leaf(next).map_err(CheckError::Mesh)?;
        for primitive in found..found + next.count {
            let bounds = mesh.corners(primitive).map(|c| Bounds::of(&c).pad(MESH_PAD));
            if !bounds.is_some_and(|b| within.contains(b)) {
                return Err(CheckError::Outside { primitive });
            }
        }
        Ok(())
    };
    let depth = check_nodes(mesh.leaves.is_empty(), nodes, leaf)?;
    if leaves.at == mesh.leaves.len() && leaves.next().is_none() {
        Ok(depth)
    } else {
        Err(CheckError::Unreached {
            primitive: (leaves.at as u32) << 4,
        })
    }
}

/// Check a tree over items with boxes; answers the depth.
pub fn check_items<T: Item>(items: &[T], pad: u16, nodes: &[Node]) -> Result<usize, CheckError> {
    check_tree(
        items.len(),
        |i| items.get(i as usize).map(|item| item.bounds().pad(pad)),
        nodes,
    )
}

struct Job {
    node: u16,
    level: u8,
    /// What all boxes above the node have in common.
    within: Bounds,
}

/// Indices in range, depth, each primitive once and within all boxes above it.
///
/// It ends: a subtree without a leaf is as deep as is allowed at once, and a leaf that comes again is out of order.
pub(crate) fn check_tree(
    count: usize,
    bounds: impl Fn(u32) -> Option<Bounds>,
    nodes: &[Node],
) -> Result<usize, CheckError> {
    let mut next = 0u32;
    let leaf = |node: u32, base: u32, meta: u8, within: Bounds| {
        let (found, count) = (base + (meta & 15) as u32, (meta >> 4) as u32);
        if found != next {
            return Err(CheckError::Order {
                node,
                expected: next,
                found,
            });
        }
        for primitive in found..found + count {
            let inside = bounds(primitive).is_some_and(|b| within.contains(b));
            if !inside {
                return Err(CheckError::Outside { primitive });
            }
        }
        next += count;
        Ok(())
    };
    let depth = check_nodes(count == 0, nodes, leaf)?;
    if next as usize == count {
        Ok(depth)
    } else {
        Err(CheckError::Unreached { primitive: next })
    }
}

/// Nodes alone: indices, depth, slots; leaves are looked at in the order that the builder makes.
///
/// `leaf` is told its node's index and primitive base, its meta, and what all boxes above it have in common. (Not by a
/// pointer, whose calls no bound of the stack could follow.)
fn check_nodes(
    is_empty: bool,
    nodes: &[Node],
    mut leaf: impl FnMut(u32, u32, u8, Bounds) -> Result<(), CheckError>,
) -> Result<usize, CheckError> {
    let mut depth = 0;
    let whole = Bounds {
        low: [0; 3],
        high: [u16::MAX; 3],
    };
    let mut jobs: Vec<Job, { 3 * MAX_DEPTH + 1 }> = Vec::new();
    // A tree over nothing has no nodes: a traversal would begin at the first.
    if !is_empty || !nodes.is_empty() {
        jobs.extend([Job {
            node: 0,
            level: 1,
            within: whole,
        }]);
    }
    while let Some(job) = jobs.pop() {
        let index = job.node as u32;
        let node = nodes.get(job.node as usize).filter(|_| job.node < u16::MAX);
        let node = node.ok_or(CheckError::NoNode { node: index })?;
        if job.level as usize > MAX_DEPTH {
            return Err(CheckError::TooDeep { node: index });
        }
        depth = depth.max(job.level as usize);
        if node.exponent > 9 || node.meta == [0; 4] {
            return Err(CheckError::Malformed { node: index });
        }
        for slot in 0..4 {
            let (meta, within) = (node.meta[slot], common(job.within, node.bounds(slot)));
            match node.child(meta) {
                Child::None if meta != 0 => return Err(CheckError::Malformed { node: index }),
                Child::Node(_) if meta & 0x7c != 0 => {
                    return Err(CheckError::Malformed { node: index });
                }
                Child::Leaf(..) => leaf(index, node.primitives(), meta, within)?,
                _ => {}
            }
        }
        for slot in (0..4).rev() {
            if let Child::Node(child) = node.child(node.meta[slot]) {
                let within = common(job.within, node.bounds(slot));
                let job = Job {
                    node: child,
                    level: job.level + 1,
                    within,
                };
                jobs.push(job).map_err(|_| CheckError::TooDeep { node: index })?;
            }
        }
    }
    Ok(depth)
}

/// The box that both contain.
fn common(a: Bounds, b: Bounds) -> Bounds {
    Bounds {
        low: [0, 1, 2].map(|i| a.low[i].max(b.low[i])),
        high: [0, 1, 2].map(|i| a.high[i].min(b.high[i])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{build_items, max_nodes};

    /// Forty boxes in a row and their tree.
    fn row() -> (std::vec::Vec<Bounds>, std::vec::Vec<Node>) {
        let mut items: std::vec::Vec<Bounds> = (1..=40)
            .map(|i| Bounds {
                low: [1000 * i, 500, 500],
                high: [1000 * i + 900, 700, 700],
            })
            .collect();
        let mut nodes = std::vec![Node::EMPTY; max_nodes(items.len())];
        let used = build_items(&mut items, 16, &mut nodes).unwrap();
        nodes.truncate(used);
        (items, nodes)
    }

    #[test]
    fn each_fault_is_named() {
        let (mut items, nodes) = row();
        assert_eq!(check_items(&items, 16, &nodes), Ok(2));
        let faulty = |change: &dyn Fn(&mut std::vec::Vec<Node>)| {
            let mut nodes = nodes.clone();
            change(&mut nodes);
            check_items(&items, 16, &nodes).unwrap_err()
        };
        let last = nodes.len() as u32 - 1;
        assert_eq!(
            faulty(&|n| n.truncate(last as usize)),
            CheckError::NoNode { node: last }
        );
        assert_eq!(faulty(&|n| n[0].nodes = 0), CheckError::TooDeep { node: 0 });
        assert_eq!(faulty(&|n| n[1].exponent = 10), CheckError::Malformed { node: 1 });
        assert_eq!(faulty(&|n| n[1] = Node::EMPTY), CheckError::Malformed { node: 1 });
        assert_eq!(faulty(&|n| n[1].meta[0] = 3), CheckError::Malformed { node: 1 });
        assert_eq!(
            faulty(&|n| n[2] = n[1]),
            CheckError::Order {
                node: 2,
                expected: 10,
                found: 0
            }
        );
        assert_eq!(
            faulty(&|n| n[0].meta[3] = 0),
            CheckError::Unreached { primitive: 30 }
        );
        assert!(matches!(
            faulty(&|n| n[1].planes[1][0][0] += 255),
            CheckError::Outside { .. }
        ));
        assert!(check_items::<Bounds>(&[], 16, &nodes).is_err());
        assert_eq!(check_items::<Bounds>(&[], 16, &[]), Ok(0));
        items[7].high[2] = 800;
        assert_eq!(
            check_items(&items, 16, &nodes),
            Err(CheckError::Outside { primitive: 7 })
        );
    }
}
