use super::canonical;
use crate::color::Radiance;
use crate::geom::{Dir, Point};
use crate::light::{Light, MapParts, Sky};
use crate::num::Turn;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// Three mantissas and their exponent, [`Radiance::to_parts`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct Glow {
    mantissa: [u16; 3],
    exponent: i16,
}

impl Glow {
    pub fn of(light: Radiance) -> Glow {
        let (mantissa, exponent) = light.to_parts();
        Glow { mantissa, exponent }
    }

    pub fn radiance(&self) -> Radiance {
        let mantissa = self.mantissa.map(u32::from);
        Radiance::from_bits(mantissa, i32::from(self.exponent) - 15)
    }
}

/// A light, 24 bytes.
///
/// | byte | what |
/// |---|---|
/// | 0 | kind: 0 point, 1 directional, 2 area, 3 the same from all around |
/// | 1 | 0 |
/// | 2, 3 | the shape that it is |
/// | 4 ..= 15 | where it stands, 3×i32 units, or the way it travels, in 2^-16 |
/// | 16 ..= 23 | its light: three mantissas in 2^-15, u16, and their exponent, i16 |
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct LightRecord {
    kind: u8,
    zero: u8,
    shape: u16,
    place: [i32; 3],
    glow: Glow,
}

impl LightRecord {
    pub fn of(light: &Light) -> LightRecord {
        let (kind, shape, place, glow) = match *light {
            Light::Point { position, intensity } => (0, 0, position.0, intensity),
            Light::Directional {
                direction,
                irradiance,
            } => (1, 0, direction.0, irradiance),
            Light::Area { shape, radiance } => (2, shape, [0; 3], radiance),
            Light::Environment { radiance } => (3, 0, [0; 3], radiance),
        };
        LightRecord {
            kind,
            zero: 0,
            shape,
            place,
            glow: Glow::of(glow),
        }
    }

    /// The light, or what of the record makes no sense.
    pub fn light(&self) -> Result<Light, &'static str> {
        let (place, glow) = (self.place, self.glow.radiance());
        let light = match self.kind {
            0 => Light::Point {
                position: Point(place),
                intensity: glow,
            },
            1 => Light::Directional {
                direction: Dir(place),
                irradiance: glow,
            },
            2 => Light::Area {
                shape: self.shape,
                radiance: glow,
            },
            3 => Light::Environment { radiance: glow },
            _ => return Err("kind"),
        };
        canonical(self, &LightRecord::of(&light), light)
    }
}

/// A sky, 60 bytes: up; the colours of zenith, horizon and ground; the way to the sun, its radiance (black: there is none)
/// and its angular diameter in 2^-32 of a turn.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct SkyRecord {
    up: [i32; 3],
    colors: [Glow; 3],
    sun: [i32; 3],
    glow: Glow,
    diameter: u32,
}

impl SkyRecord {
    pub fn of(sky: &Sky) -> SkyRecord {
        let sun = sky.sun();
        SkyRecord {
            up: sky.up().0,
            colors: sky.colors().map(Glow::of),
            sun: sun.map_or([0; 3], |sun| sun.direction.0),
            glow: Glow::of(sun.map_or(Radiance::BLACK, |sun| sun.radiance)),
            diameter: sun.map_or(0, |sun| sun.diameter.to_bits()),
        }
    }

    /// The sky, or what of the record makes no sense.
    pub fn sky(&self) -> Result<Sky, &'static str> {
        let [zenith, horizon, ground] = self.colors.map(|glow| glow.radiance());
        let sky = Sky::new(Dir(self.up), zenith, horizon, ground).with_sun(
            Dir(self.sun),
            Turn::from_bits(self.diameter),
            self.glow.radiance(),
        );
        canonical(self, &SkyRecord::of(&sky), sky)
    }
}

/// A map of the environment without its numbers, 48 bytes.
///
/// | byte | what |
/// |---|---|
/// | 0 ..= 3 | width and height, u16 |
/// | 4, 5 | exponent of all texels, i16 |
/// | 6, 7 | steps in a band |
/// | 8, 9 | bounds between bands |
/// | 10, 11 | 0 |
/// | 12 ..= 47 | its axes x, y, z in the scene, in 2^-16 |
///
/// Then its texels, u32; the bounds between bands, u16; those between the steps of each band, u16.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, FromBytes, IntoBytes, Immutable, KnownLayout)]
pub struct MapRecord {
    pub width: u16,
    pub height: u16,
    pub exponent: i16,
    pub steps_in_band: u16,
    pub bands: u16,
    zero: u16,
    pub axes: [[i32; 3]; 3],
}

impl MapRecord {
    pub fn of(map: &MapParts) -> MapRecord {
        MapRecord {
            width: map.width,
            height: map.height,
            exponent: map.exponent,
            steps_in_band: map.steps_in_band,
            bands: (map.bands.len() as u16),
            zero: 0,
            axes: map.axes.map(|axis| axis.0),
        }
    }
}

const _: () = assert!(size_of::<LightRecord>() == 24 && size_of::<SkyRecord>() == 60);
const _: () = assert!(size_of::<MapRecord>() == 48);
