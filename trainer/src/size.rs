//! Networks of several sizes; the core has one of them.

use microlux::film::denoise::network::{CHANNELS, LEVELS, Layer, layers};

/// Channels of activations at 1, 1/2, 1/4 and 1/8.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Size {
    /// 4, 8, 12, 12: the core's
    #[default]
    Xs,
    /// 8, 12, 16, 16
    S,
    /// 8, 16, 24, 24
    M,
    /// 16, 24, 32, 32
    L,
    /// 24, 40, 56, 64
    Xl,
}

impl Size {
    pub const ALL: [Size; 5] = [Size::Xs, Size::S, Size::M, Size::L, Size::Xl];

    pub fn name(self) -> &'static str {
        match self {
            Size::Xs => "xs",
            Size::S => "s",
            Size::M => "m",
            Size::L => "l",
            Size::Xl => "xl",
        }
    }

    pub fn channels(self) -> [usize; LEVELS] {
        match self {
            Size::Xs => CHANNELS,
            Size::S => [8, 12, 16, 16],
            Size::M => [8, 16, 24, 24],
            Size::L => [16, 24, 32, 32],
            Size::Xl => [24, 40, 56, 64],
        }
    }

    pub fn layers(self) -> [Layer; 15] {
        layers(self.channels())
    }

    /// Where layer `number` begins among weights and among biases.
    pub fn place(self, number: usize) -> (usize, usize) {
        let layers = self.layers();
        let before = &layers[..number];
        (
            before.iter().map(Layer::weights).sum(),
            before.iter().map(|l| l.outputs).sum(),
        )
    }

    /// Products of the network for a pixel of the picture, in the mean.
    pub fn products(self) -> f64 {
        // At which of the sizes each layer runs.
        const LEVEL: [i32; 15] = [0, 1, 2, 3, 3, 2, 2, 1, 1, 0, 0, 0, 1, 2, 3];
        let layers = self.layers().into_iter().zip(LEVEL);
        layers
            .map(|(l, level)| l.weights() as f64 * 0.25f64.powi(level))
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use microlux::film::denoise::network::{BIASES, LAYERS, WEIGHTS};

    #[test]
    fn the_cores_size_is_xs() {
        assert_eq!(Size::Xs.layers(), LAYERS);
        assert_eq!(Size::Xs.place(LAYERS.len()), (WEIGHTS, BIASES));
        assert_eq!(Size::Xs.products(), 901.0);
    }
}
