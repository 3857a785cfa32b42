//! Colours over a mesh.

use std::sync::Arc;

use super::vec::Rgb;

/// What a shape's material's own colour is multiplied by.
#[derive(Clone, Debug)]
pub enum Tint {
    /// The mesh's vertices' colours.
    Vertices,
    /// The texture's at the mesh's places in it.
    Texture(Arc<Texture>),
}

/// A picture that is repeated: (0, 0) is its first texel's corner, (1, 1) its last one's.
#[derive(Clone, Debug)]
pub struct Texture {
    pub width: usize,
    pub height: usize,
    /// Row after row.
    pub texels: Vec<Rgb>,
    /// Else bilinear between the texels' middles.
    pub nearest: bool,
}

impl Texture {
    pub fn at(&self, [u, v]: [f64; 2]) -> Rgb {
        let (x, y) = (u * self.width as f64, v * self.height as f64);
        let texel = |column: f64, row: f64| {
            let column = column.rem_euclid(self.width as f64) as usize % self.width;
            let row = row.rem_euclid(self.height as f64) as usize % self.height;
            self.texels[row * self.width + column]
        };
        if self.nearest {
            return texel(x.floor(), y.floor());
        }
        let (left, top) = ((x - 0.5).floor(), (y - 0.5).floor());
        let (right, down) = (x - 0.5 - left, y - 0.5 - top);
        let row = |row: f64| texel(left, row) * (1.0 - right) + texel(left + 1.0, row) * right;
        row(top) * (1.0 - down) + row(top + 1.0) * down
    }
}
