use crate::geom::Octahedral;

/// What a mesh's vertices say beside where they are.
#[derive(Clone, Copy, Debug)]
pub struct Attributes<'a> {
    /// For smooth shading, one a vertex; none for flat faces.
    pub normals: &'a [Octahedral],
}

impl Attributes<'_> {
    /// Flat faces.
    pub const NONE: Attributes<'static> = Attributes { normals: &[] };

    /// Whether each list has one for each vertex, or none.
    pub(crate) fn fit(&self, vertices: usize) -> bool {
        [self.normals.len()]
            .into_iter()
            .all(|length| length == 0 || length == vertices)
    }
}

/// Which of them a packed mesh has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layers(u8);

impl Layers {
    /// Two bytes a vertex: [`Octahedral`].
    pub const NORMALS: Layers = Layers(1);

    const ALL: u8 = Layers::NORMALS.0;

    /// `None` for bits that mean nothing.
    pub const fn from_bits(bits: u8) -> Option<Layers> {
        if bits & !Layers::ALL == 0 {
            Some(Layers(bits))
        } else {
            None
        }
    }

    pub const fn bits(self) -> u8 {
        self.0
    }

    pub const fn with(self, other: Layers) -> Layers {
        Layers(self.0 | other.0)
    }

    #[inline]
    pub const fn has(self, other: Layers) -> bool {
        self.0 & other.0 != 0
    }

    /// Bytes of a vertex's.
    #[inline]
    pub const fn stride(self) -> usize {
        if self.has(Layers::NORMALS) { 2 } else { 0 }
    }
}
