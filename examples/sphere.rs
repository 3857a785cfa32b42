//! A lit ball in the terminal: the smallest whole program. All memory is on the stack, all arithmetic is integers.
//!
//! `cargo run --release --example sphere`

use embedded_graphics::pixelcolor::Gray8;
use embedded_graphics::prelude::*;
use fixed::types::I12F20;
use microlux::bvh::Node;
use microlux::camera::Camera;
use microlux::color::{Radiance, albedo};
use microlux::film::Display;
use microlux::geom::{Dir, point};
use microlux::integrator::Path;
use microlux::light::Light;
use microlux::material::Material;
use microlux::num::Share;
use microlux::q;
use microlux::render::{Renderer, Settings};
use microlux::sampler::Sobol;
use microlux::scene::SceneBuilder;
use microlux::shape::{Plane, Sphere};

const WIDTH: usize = 72;
const HEIGHT: usize = 32;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    // Room for 2 shapes, 2 materials and 2 lights. Lengths are metres.
    let mut builder = SceneBuilder::<2, 2, 2>::new();
    let unit = builder.unit();
    let matt = |share| Material::lambert(albedo(share, share, share));
    let white = builder.material(matt(q!(0.8, Share)))?;
    let grey = builder.material(matt(q!(0.3, Share)))?;
    let ball = Sphere::new(point(q!(0), q!(1), q!(0)), unit.length(q!(1)));
    builder.shape(ball, white)?;
    builder.shape(Plane::new(point(q!(0), q!(0), q!(0)), Dir::Y), grey)?;
    builder.light(Light::Point {
        position: point(q!(-3), q!(4), q!(3)),
        intensity: Radiance::new(q!(70), q!(70), q!(70)),
    })?;
    builder.light(Light::Environment {
        radiance: Radiance::new(q!(0.1), q!(0.1), q!(0.1)),
    })?;
    // The border: everything is checked here, and nothing can fail after.
    let mut nodes = [Node::EMPTY; 1];
    let scene = builder.build(&mut nodes)?;

    let eye = point(q!(0), q!(1.6), q!(5));
    let camera = Camera::look_at(eye, ball.center, [0, 1, 0], q!(0.42, I12F20)).ok_or("no view")?;
    let settings = Settings {
        width: WIDTH as u16,
        height: 2 * HEIGHT as u16,
        spp: 32,
    };
    let mut renderer = Renderer::new(&scene, camera, Path::new(4), Sobol::new(1), settings);

    let mut terminal = Terminal::new();
    let mut strip = [Radiance::BLACK; WIDTH];
    while let Some(tile) = renderer.step(&mut strip) {
        tile.draw(&mut terminal, &Display::default())?;
    }
    terminal.print();
    Ok(())
}

/// A display made of characters, which are twice as high as wide: two rows of pixels share one.
struct Terminal {
    pixels: [[u8; WIDTH]; 2 * HEIGHT],
}

impl Terminal {
    fn new() -> Terminal {
        Terminal {
            pixels: [[0; WIDTH]; 2 * HEIGHT],
        }
    }

    fn print(&self) {
        for rows in self.pixels.chunks_exact(2) {
            let dots = rows[0].iter().zip(&rows[1]).map(|(&above, &below)| {
                const INK: &[u8; 10] = b" .:-=+*#%@";
                let light = (above as usize + below as usize) / 2;
                INK[light * INK.len() / 256] as char
            });
            println!("{}", dots.collect::<String>());
        }
    }
}

impl OriginDimensions for Terminal {
    fn size(&self) -> Size {
        Size::new(WIDTH as u32, 2 * HEIGHT as u32)
    }
}

impl DrawTarget for Terminal {
    type Color = Gray8;
    type Error = core::convert::Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Gray8>>>(&mut self, pixels: I) -> Result<(), Self::Error> {
        for Pixel(at, color) in pixels {
            let row = self.pixels.get_mut(at.y as usize);
            if let Some(pixel) = row.and_then(|row| row.get_mut(at.x as usize)) {
                *pixel = color.luma();
            }
        }
        Ok(())
    }
}
