use crate::geom::Octahedral;

/// What a mesh's vertices say beside where they are: each list has one for each vertex, or none.
#[derive(Clone, Copy, Debug)]
pub struct Attributes<'a> {
    /// For smooth shading; none for flat faces.
    pub normals: &'a [Octahedral],
    /// sRGB.
    pub colors: &'a [[u8; 3]],
    /// Places in a texture (u, v), in steps of 2^-12 of it.
    pub uvs: &'a [[i16; 2]],
}

impl Attributes<'_> {
    /// Flat faces of one colour.
    pub const NONE: Attributes<'static> = Attributes {
        normals: &[],
        colors: &[],
        uvs: &[],
    };

    /// Which of them there are.
    pub fn layers(&self) -> Layers {
        let layer = |has: bool, layer| if has { layer } else { Layers::default() };
        layer(!self.normals.is_empty(), Layers::NORMALS)
            .with(layer(!self.colors.is_empty(), Layers::COLORS))
            .with(layer(!self.uvs.is_empty(), Layers::UVS))
    }

    /// Bytes of flash.
    pub fn bytes(&self) -> usize {
        size_of_val(self.normals) + size_of_val(self.colors) + size_of_val(self.uvs)
    }

    /// Whether each list has one for each vertex, or none.
    pub(crate) fn fit(&self, vertices: usize) -> bool {
        [self.normals.len(), self.colors.len(), self.uvs.len()]
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
    /// Three bytes a vertex: sRGB.
    pub const COLORS: Layers = Layers(2);
    /// Four bytes a vertex: u and v, i16 in steps of 2^-12.
    pub const UVS: Layers = Layers(4);

    const ALL: u8 = Layers::NORMALS.0 | Layers::COLORS.0 | Layers::UVS.0;

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

    /// Bytes of all that a vertex says, normal, colour and place in this order.
    #[inline]
    pub const fn stride(self) -> usize {
        self.before(Layers(8))
    }

    /// Bytes of those that come before one.
    #[inline]
    pub(crate) const fn before(self, layer: Layers) -> usize {
        let below = Layers(self.0 & (layer.0 - 1));
        2 * below.has(Layers::NORMALS) as usize
            + 3 * below.has(Layers::COLORS) as usize
            + 4 * below.has(Layers::UVS) as usize
    }
}
