//! Four balls over a chequered floor, with shadows, mirrors and glass: the benchmark *raystones* in integers.
//!
//! `cargo run --release --example raystones` shows it in the terminal; `-- raystones.ppm` also writes a file. `cargo xtask
//! raystones` counts what the same code takes on microcontrollers.

mod trace;

use std::error::Error;
use std::io::Write;

use trace::pixel;
use trace::scene::{HEIGHT, WIDTH};

fn main() -> Result<(), Box<dyn Error>> {
    let at = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    let picture: Vec<[u8; 3]> = at.map(|(x, y)| pixel(x, y)).collect();
    if let Some(path) = std::env::args_os().nth(1) {
        let mut file = std::fs::File::create(path)?;
        write!(file, "P6\n{WIDTH} {HEIGHT}\n255\n")?;
        file.write_all(picture.as_flattened())?;
    }
    for rows in picture.chunks_exact(2 * WIDTH as usize) {
        let (above, below) = rows.split_at(WIDTH as usize);
        for ([r, g, b], [s, h, c]) in above.iter().zip(below) {
            // A half block: the upper pixel in the foreground, the lower one behind it.
            print!("\x1b[38;2;{r};{g};{b}m\x1b[48;2;{s};{h};{c}m▀");
        }
        println!("\x1b[0m");
    }
    Ok(())
}
