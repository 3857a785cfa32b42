//! Draws the boards' two scenes as a Pico does, one core, one sample a pixel, and the first by longer paths: regions 0 to 2.
//! Prints `profile SCENE pixels=N rays=N crc32=89abcdef` for each.

#![no_std]
#![no_main]

#[path = "../console.rs"]
mod console;

use core::panic::PanicInfo;

#[cfg(target_arch = "arm")]
use cortex_m_rt::entry;
use firmware_common::{
    mesh, region,
    stage::{COUNTED, Cornell, Pedestal, Stage},
    tile::{PASSES, PIXELS, Painter, SQUARE},
};
use microlux::{integrator::Path, num::Crc, scene::Cell};
#[cfg(target_arch = "riscv32")]
use riscv_rt::entry;
use semihosting::process;

/// The only scene to draw, if the build names one.
const ONLY: &str = match option_env!("MICROLUX_ONLY") {
    Some(name) => name,
    None => "",
};

#[entry]
fn main() -> ! {
    region::count(region::EMPTY, || ());
    let draws: [fn(); 3] = [|| cornell(0, Path::direct()), knot, || cornell(2, Path::new(5))];
    for (name, draw) in COUNTED.iter().zip(draws) {
        if ONLY.is_empty() || ONLY == *name {
            draw();
        }
    }
    process::exit(0)
}

#[inline(never)]
fn cornell(id: u32, path: Path) {
    let Ok(mut cornell) = Cornell::new() else { refuse() };
    let Ok((mut scene, camera)) = cornell.scene() else {
        refuse()
    };
    // For long paths what is where, and what may shade it, is told ahead, which counts.
    let mut cells = [Cell::UNKNOWN; 512];
    if path.max_depth > 2 {
        scene = region::count(id, || scene.foresee(&mut cells));
    }
    let stage = Stage {
        scene: &scene,
        camera,
    };
    draw(id, path, &stage);
}

#[inline(never)]
fn knot() {
    let Ok(baked) = mesh::baked() else { refuse() };
    let mut pedestal = Pedestal::new(baked);
    let Ok((scene, camera)) = pedestal.scene() else {
        refuse()
    };
    let stage = Stage {
        scene: &scene,
        camera,
    };
    draw(1, Path::direct(), &stage);
}

/// Tile by tile; what is counted is what becomes of one.
#[inline(never)]
fn draw(id: u32, path: Path, stage: &Stage) {
    let mut painter = Painter::of(path, stage, SQUARE, PASSES[1]);
    let mut pixels = [0; PIXELS];
    let mut crc = Crc::new();
    for index in 0..SQUARE.tiles() {
        region::count(id, || painter.render(index, &mut pixels));
        for pixel in pixels {
            crc.bytes(&pixel.to_le_bytes());
        }
    }
    console::print(&["profile ", COUNTED[id as usize], " pixels="]);
    console::decimal(SQUARE.width() * SQUARE.height());
    console::print(&[" rays="]);
    console::decimal(painter.rays());
    console::print(&[" crc32="]);
    console::hexadecimal(crc.value());
    console::print(&["\n"]);
}

fn refuse() -> ! {
    console::print(&[env!("MACHINE"), ": the scene is refused\n"]);
    process::exit(1)
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    console::print(&[env!("MACHINE"), ": panic\n"]);
    process::exit(1)
}
