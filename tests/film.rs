//! The film against f64: tone curves, dither, and what a draw target sees of a tile.

use embedded_graphics::mock_display::MockDisplay;
use embedded_graphics::pixelcolor::{BinaryColor, Gray4, Gray8, Rgb565, Rgb666, Rgb888};
use embedded_graphics::prelude::*;
use embedded_graphics::primitives::Rectangle;
use microlux::color::Radiance;
use microlux::film::{Display, DisplayColor, Dither, Stops, Tile, Tone, ToneMap};

/// IEC 61966-2-1.
fn srgb(x: f64) -> f64 {
    if x <= 0.0031308 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    }
}

fn srgb_decoded(v: f64) -> f64 {
    if v <= 0.04045 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}

/// Hable 2010, as published.
fn hable(x: f64) -> f64 {
    let f =
        |x: f64| (x * (0.15 * x + 0.1 * 0.5) + 0.2 * 0.02) / (x * (0.15 * x + 0.5) + 0.2 * 0.3) - 0.02 / 0.3;
    f(2.0 * x) / f(11.2)
}

fn signal(map: ToneMap, x: f64) -> f64 {
    let toned = match map {
        ToneMap::Clamp => x,
        ToneMap::Filmic => hable(x),
    };
    srgb(toned.min(1.0))
}

fn grey(mantissa: u32, exponent: i32) -> Radiance {
    Radiance::from_bits([mantissa; 3], exponent - 15)
}

/// Max, RMS and signed mean error of a tone map over all mantissas of 20 octaves, at an exposure.
fn tone_error(map: ToneMap, exposure: i16) -> [f64; 3] {
    let tone = map.at(Stops::from_bits(exposure));
    let gain = (f64::from(exposure) / 256.0).exp2();
    let (mut max, mut squares, mut sum, mut count) = (0f64, 0.0, 0.0, 0.0);
    for exponent in -16..4 {
        for mantissa in 1 << 15..1 << 16 {
            let x = f64::from(mantissa) / 32768.0 * f64::from(exponent).exp2() * gain;
            let is = f64::from(tone.rgb(grey(mantissa, exponent))[1]) / 65535.0;
            let error = is - signal(map, x);
            max = max.max(error.abs());
            squares += error * error;
            sum += error;
            count += 1.0;
        }
    }
    [max, (squares / count).sqrt(), sum / count]
}

/// Whether what was measured is what the doc says: no worse, and not less than half of it.
fn assert_as_said(what: &str, measured: f64, said: f64) {
    let share = measured / said;
    assert!(
        (0.5..=1.0).contains(&share),
        "{what}: {measured:.3e}, where the doc says {said:.3e}"
    );
}

#[test]
fn tone_maps_follow_their_formulas() {
    for (map, said) in [
        (ToneMap::Clamp, [9.3e-5, 1.6e-5, -7e-6]),
        (ToneMap::Filmic, [1.2e-4, 2.4e-5, -1.25e-5]),
    ] {
        for exposure in [0, 77, -300, 1000] {
            let [max, rms, mean] = tone_error(map, exposure);
            println!("{map:?} at {exposure}/256 stops: max {max:.2e}, RMS {rms:.2e}, mean {mean:.2e}");
            assert_as_said("max", max, said[0]);
            assert_as_said("RMS", rms, said[1]);
            assert_as_said("mean", mean, said[2]);
        }
    }
}

#[test]
fn tone_maps_are_monotone_over_every_mantissa() {
    for map in [ToneMap::Clamp, ToneMap::Filmic] {
        for exposure in [0, -77, 128] {
            let tone = map.at(Stops::from_bits(exposure));
            let mut last = 0;
            for exponent in -20..5 {
                for mantissa in 1 << 15..1 << 16 {
                    let now = tone.rgb(grey(mantissa, exponent))[0];
                    assert!(now >= last, "{map:?} falls at {mantissa}/2^15 · 2^{exponent}");
                    last = now;
                }
            }
            assert_eq!(last, 65535);
        }
    }
}

#[test]
fn exposure_is_a_power_of_two_at_each_step() {
    // Below 2^-9 the curve is straight, and the signal tells the gain.
    for bits in -0x8000..=0x7fff_i32 {
        let exponent = -11 - (bits >> 8);
        let is = f64::from(
            ToneMap::Clamp
                .at(Stops::from_bits(bits as i16))
                .rgb(grey(0xffff, exponent))[2],
        );
        let gain = (f64::from(bits) / 256.0).exp2();
        let exact = 12.92 * 65535.0 * gain * 65535.0 / 32768.0 * f64::from(exponent).exp2();
        // Rounding, and that of the knot: 1654 for 1653.7. A step of the exposure is 2.2 here at least.
        assert!((is - exact).abs() < 0.9, "{bits}: {is} for {exact}");
    }
}

#[test]
fn every_srgb_code_comes_back() {
    let display = Display::default();
    let tone = display.tone();
    for code in 0..=255u8 {
        let light = srgb_decoded(f64::from(code) / 255.0);
        let bits = (light * 2f64.powi(31)).round() as u32;
        let color: Rgb888 = display.color(&tone, Radiance::from_bits([bits; 3], -31), 0, 0);
        assert_eq!(color, Rgb888::new(code, code, code));
    }
}

/// Mean over a mask of a level shown with dither, as a share of the top level.
fn mean(dither: Dither, shown: impl Fn(u16) -> f64) -> f64 {
    (0..64 * 64)
        .map(|i| shown(dither.threshold(i % 64, i / 64)))
        .sum::<f64>()
        / 4096.0
}

#[test]
fn dither_gives_the_level_in_the_mean() {
    for (dither, share) in [(Dither::Ordered, 64.0), (Dither::BlueNoise, 256.0)] {
        let (mut worst, mut sum) = ([0f64; 4], [0.0; 4]);
        for v in (0..=65535u16).step_by(13) {
            let exact = f64::from(v) / 65535.0;
            let shown = |steps: f64, level: &dyn Fn(u16) -> u8| {
                (mean(dither, |t| f64::from(level(t))) - exact * steps) * share
            };
            let errors = [
                shown(31.0, &|t| Rgb565::quantize([v; 3], t).r()),
                shown(63.0, &|t| Rgb666::quantize([v; 3], t).g()),
                shown(255.0, &|t| Gray8::quantize([v; 3], t).luma()),
                shown(15.0, &|t| Gray4::quantize([v; 3], t).luma()),
            ];
            for i in 0..4 {
                worst[i] = worst[i].max(errors[i].abs());
                sum[i] += errors[i];
            }
        }
        println!(
            "{dither:?}: worst {worst:?}, mean {:?} of a threshold's share",
            sum.map(|s| s / 5042.0)
        );
        // Half a share is what a level between two thresholds may miss; in the mean over levels nothing remains.
        assert!(worst.iter().all(|w| (0.45..0.51).contains(w)));
        assert!(sum.iter().all(|s| (s / 5042.0).abs() < 0.01));
    }
}

#[test]
fn dots_give_the_light_in_the_mean() {
    let (mut worst, mut sum) = (0f64, 0.0);
    for v in (0..=65535u16).step_by(51) {
        let exact = srgb_decoded(f64::from(v) / 65535.0);
        let error = mean(Dither::BlueNoise, |t| {
            f64::from(u8::from(BinaryColor::quantize([v; 3], t).is_on()))
        }) - exact;
        worst = worst.max(error.abs());
        sum += error;
    }
    println!("dots: max {worst:.2e}, mean {:.2e}", sum / 1286.0);
    // The cubic's 0.0017, and half a share of 256.
    assert_as_said("max", worst, 0.0017 + 1.0 / 512.0);
    assert_as_said("mean", sum / 1286.0, -0.0004);
}

/// Counts what is asked of it; a target of its own size that refuses from the nth call on.
struct Counting {
    size: Size,
    areas: Vec<Rectangle>,
    colors: Vec<Rgb565>,
    refuses_at: usize,
}

impl Counting {
    fn new(refuses_at: usize) -> Counting {
        Counting {
            size: Size::new(64, 48),
            areas: vec![],
            colors: vec![],
            refuses_at,
        }
    }
}

impl OriginDimensions for Counting {
    fn size(&self) -> Size {
        self.size
    }
}

#[derive(Debug, PartialEq)]
struct BusFault(usize);

impl DrawTarget for Counting {
    type Color = Rgb565;
    type Error = BusFault;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb565>>>(&mut self, _: I) -> Result<(), BusFault> {
        panic!("pixel by pixel");
    }

    fn fill_contiguous<I: IntoIterator<Item = Rgb565>>(
        &mut self,
        area: &Rectangle,
        colors: I,
    ) -> Result<(), BusFault> {
        if self.areas.len() == self.refuses_at {
            return Err(BusFault(self.refuses_at));
        }
        self.areas.push(*area);
        self.colors.extend(colors);
        Ok(())
    }

    fn fill_solid(&mut self, _: &Rectangle, _: Rgb565) -> Result<(), BusFault> {
        panic!("a rectangle of one colour");
    }

    fn clear(&mut self, _: Rgb565) -> Result<(), BusFault> {
        panic!("cleared");
    }
}

/// A picture of slopes, 64×48.
fn picture() -> Vec<Radiance> {
    (0..64 * 48)
        .map(|i| Radiance::from_bits([i % 64 * 1024, i / 64 * 1365, 20_000 + i], -16))
        .collect()
}

/// One tile of the picture.
fn cut(picture: &[Radiance], area: Rectangle) -> Vec<Radiance> {
    area.points()
        .map(|p| picture[(p.y * 64 + p.x) as usize])
        .collect()
}

const DITHERED: Display = Display {
    exposure: Stops::ZERO,
    tone_map: ToneMap::Filmic,
    dither: Dither::BlueNoise,
};

#[test]
fn a_tile_is_one_fill_contiguous() {
    let pixels = picture();
    let mut target = Counting::new(99);
    for (n, y) in [0, 16, 32].into_iter().enumerate() {
        let area = Rectangle::new(Point::new(0, y), Size::new(64, 16));
        let strip = cut(&pixels, area);
        Tile { area, pixels: &strip }
            .draw(&mut target, &DITHERED)
            .unwrap();
        assert_eq!((target.areas.len(), target.areas[n]), (n + 1, area));
    }
    assert_eq!(target.colors.len(), 64 * 48);
}

#[test]
fn the_targets_error_comes_back() {
    let pixels = picture();
    let tile = Tile {
        area: Rectangle::new(Point::zero(), Size::new(64, 48)),
        pixels: &pixels,
    };
    let mut target = Counting::new(1);
    assert_eq!(tile.draw(&mut target, &DITHERED), Ok(()));
    assert_eq!(tile.draw(&mut target, &DITHERED), Err(BusFault(1)));
}

#[test]
fn tiles_cannot_change_the_picture() {
    let pixels = picture();
    let whole = Tile {
        area: Rectangle::new(Point::zero(), Size::new(64, 48)),
        pixels: &pixels,
    };
    for dither in [Dither::None, Dither::Ordered, Dither::BlueNoise] {
        let display = Display { dither, ..DITHERED };
        let mut expected = MockDisplay::<Rgb565>::new();
        whole.draw(&mut expected, &display).unwrap();
        for size in [Size::new(64, 1), Size::new(7, 5), Size::new(16, 16)] {
            let mut target = MockDisplay::new();
            for y in (0..48).step_by(size.height as usize) {
                for x in (0..64).step_by(size.width as usize) {
                    let area = Rectangle::new(Point::new(x, y), size).intersection(&whole.area);
                    let part = cut(&pixels, area);
                    Tile { area, pixels: &part }.draw(&mut target, &display).unwrap();
                }
            }
            target.assert_eq(&expected);
        }
    }
}

#[test]
fn a_tile_beyond_the_edge_is_clipped() {
    let pixels = picture();
    let area = Rectangle::new(Point::new(-20, 30), Size::new(64, 48));
    let tile = Tile {
        area,
        pixels: &pixels,
    };
    let mut target = MockDisplay::<Gray8>::new();
    let mut clipped = target.clipped(&Rectangle::new(Point::zero(), Size::new(40, 50)));
    tile.draw(&mut clipped, &DITHERED).unwrap();
    let all: Vec<Gray8> = tile.colors(&DITHERED).collect();
    for p in Rectangle::new(Point::zero(), Size::new(64, 64)).points() {
        let inside = p.x < 40 && (30..50).contains(&p.y);
        let expected = inside.then(|| all[((p.y - 30) * 64 + p.x + 20) as usize]);
        assert_eq!(target.get_pixel(p), expected, "{p}");
    }
}

#[test]
fn a_tile_without_area_or_with_too_few_pixels_draws_what_there_is() {
    let pixels = picture();
    let mut target = MockDisplay::<Rgb565>::new();
    Tile {
        area: Rectangle::zero(),
        pixels: &pixels,
    }
    .draw(&mut target, &DITHERED)
    .unwrap();
    assert_eq!(target.affected_area(), Rectangle::zero());
    let area = Rectangle::new(Point::new(3, 2), Size::new(8, 8));
    Tile {
        area,
        pixels: &pixels[..12],
    }
    .draw(&mut target, &DITHERED)
    .unwrap();
    assert!(target.get_pixel(Point::new(6, 3)).is_some());
    assert_eq!(target.get_pixel(Point::new(7, 3)), None);
}

#[test]
fn gray_shows_the_luminance_of_light() {
    // Pure green of light 1 has luminance 0.7152, which encodes to 0.863: 220 of 255; its luma would be 182.
    let tone: Tone = ToneMap::Clamp.at(Stops::ZERO);
    let green = Radiance::from_bits([0, 1, 0], 0);
    let shown: Gray8 = Display::default().color(&tone, green, 0, 0);
    assert_eq!(shown.luma(), (srgb(0.7152) * 255.0).round() as u8);
}
