//! A surface in f64 to look at materials on, and all the materials there are.

use microlux::color::{Albedo, Radiance};
use microlux::geom::Dir;
use microlux::material::{BlinnPhong, BsdfSample, Conductor, Dielectric, Index, Local, Material};
use microlux::material::{OrenNayar, OrenNayarModel, RoughDielectric};
use microlux::num::{Metres, Share, Turn, Uniform, Wide};

pub type Vec3 = [f64; 3];

pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    let minor = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

fn unit(v: Vec3) -> Vec3 {
    let length = dot(v, v).sqrt();
    v.map(|c| c / length)
}

/// Three axes at right angles, the last of them given.
#[derive(Clone, Copy)]
pub struct Axes(pub [Vec3; 3]);

impl Axes {
    pub fn about(n: Vec3) -> Axes {
        let n = unit(n);
        let other = if n[0].abs() < 0.6 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 1.0, 0.0]
        };
        let s = unit(cross(other, n));
        Axes([s, cross(n, s), n])
    }

    pub fn to_world(self, v: Vec3) -> Vec3 {
        [0, 1, 2].map(|i| v[0] * self.0[0][i] + v[1] * self.0[1][i] + v[2] * self.0[2][i])
    }

    pub fn to_local(self, v: Vec3) -> Vec3 {
        self.0.map(|axis| dot(axis, v))
    }

    /// At an angle to the last axis and turned about it, radians.
    pub fn at(&self, theta: f64, phi: f64) -> Vec3 {
        let (sin, cos) = theta.sin_cos();
        self.to_world([sin * phi.cos(), sin * phi.sin(), cos])
    }
}

pub fn to_dir(v: Vec3) -> Dir {
    Dir(unit(v).map(|c| (c * 65536.0).round() as i32))
}

pub fn to_f64(d: Dir) -> Vec3 {
    d.0.map(|c| f64::from(c) / 65536.0)
}

pub fn wide(w: Wide) -> f64 {
    f64::from(w.mantissa()) * f64::from(i32::from(w.exponent()) - 15).exp2()
}

pub fn rgb(light: Radiance) -> Vec3 {
    let (mantissa, exponent) = light.to_parts();
    mantissa.map(|m| f64::from(m) * f64::from(i32::from(exponent) - 15).exp2())
}

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn uniform(&mut self) -> Uniform {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Uniform::from_bits((z ^ (z >> 31)) as u32)
    }

    pub fn next(&mut self) -> f64 {
        f64::from(self.uniform().to_bits()) / 2f64.powi(32)
    }

    pub fn sample(&mut self, material: &Material, local: &Local) -> Option<BsdfSample> {
        let u = [self.uniform(), self.uniform()];
        material.sample(local, u, self.uniform())
    }
}

/// A surface that is aligned with nothing, seen under an angle (degrees, above 90 from inside).
pub struct View {
    pub axes: Axes,
    pub wo: Vec3,
    pub local: Local,
}

pub fn view(degrees: f64) -> View {
    view_at(degrees, 0.7)
}

/// The same from another side, radians.
pub fn view_at(degrees: f64, phi: f64) -> View {
    let normal = to_dir([1.0, -2.0, 3.0]);
    let axes = Axes::about(to_f64(normal));
    let wo = to_dir(axes.at(degrees.to_radians(), phi));
    View {
        axes,
        wo: to_f64(wo),
        local: Local { normal, wo },
    }
}

pub struct Named {
    pub name: String,
    pub material: Material,
    /// Width of its lobe, about which bins are laid; 1 for none.
    pub width: f64,
    /// Refractive index inside over outside.
    pub eta: f64,
}

pub fn share(x: f64) -> Share {
    Share::from_num(x)
}

pub fn grey(x: f64) -> Albedo {
    Albedo([share(x); 3])
}

pub fn degrees(x: f64) -> Turn {
    Turn::from_num(x / 360.0)
}

pub fn oren_nayar(model: OrenNayarModel, albedo: Albedo, sigma: f64) -> Named {
    Named {
        name: format!("{model:?} Oren–Nayar, sigma {sigma}"),
        material: Material::OrenNayar(OrenNayar::new(model, albedo, degrees(sigma))),
        width: 1.0,
        eta: 1.0,
    }
}

pub const MODELS: [OrenNayarModel; 3] = [
    OrenNayarModel::Full,
    OrenNayarModel::Qualitative,
    OrenNayarModel::EnergyPreserving,
];

pub fn phong(diffuse: f64, specular: f64, exponent: f64, normalized: bool) -> Named {
    let phong = BlinnPhong::new(grey(diffuse), grey(specular), Metres::from_num(exponent));
    Named {
        name: format!("Blinn–Phong {diffuse} + {specular}, exponent {exponent}, normalised {normalized}"),
        material: Material::BlinnPhong(if normalized { phong } else { phong.unnormalized() }),
        width: (2.0 / (exponent + 2.0)).sqrt(),
        eta: 1.0,
    }
}

/// Of gold, about, for red, green and blue.
pub const GOLD: [[f64; 3]; 2] = [[0.143, 0.375, 1.442], [3.983, 2.386, 1.603]];

pub fn index(x: Vec3) -> [Index; 3] {
    x.map(Index::from_num)
}

pub fn metal(alpha: f64, gold: bool) -> Named {
    let metal = Conductor::new(Albedo::WHITE).rough(share(alpha));
    let coloured = metal.with_index(index(GOLD[0]), index(GOLD[1]));
    Named {
        name: format!("metal, gold {gold}, alpha {alpha}"),
        material: Material::Conductor(if gold { coloured } else { metal }),
        width: alpha,
        eta: 1.0,
    }
}

pub fn glass(alpha: f64, eta: f64) -> Named {
    let smooth = Dielectric::new(Metres::from_num(eta));
    Named {
        name: format!("rough glass, alpha {alpha}, eta {eta}"),
        material: Material::RoughDielectric(RoughDielectric::new(smooth, share(alpha))),
        width: alpha,
        eta,
    }
}

/// Each kind over its range of roughness, all white.
pub fn smooth_materials() -> Vec<Named> {
    let mut all = vec![Named {
        name: "Lambert".into(),
        material: Material::lambert(Albedo::WHITE),
        width: 1.0,
        eta: 1.0,
    }];
    for model in MODELS {
        all.extend([0.0, 20.0, 90.0].map(|sigma| oren_nayar(model, Albedo::WHITE, sigma)));
    }
    all.extend([0.0, 1.0, 12.5, 200.0, 2000.0].map(|n| phong(0.4, 0.5, n, true)));
    all.extend([1.0, 12.5].map(|n| phong(0.4, 0.5, n, false)));
    all.push(phong(0.0, 0.9, 20.0, true));
    all.push(phong(0.9, 0.0, 20.0, true));
    all.extend([0.02, 0.1, 0.3, 0.8, 1.0].map(|alpha| metal(alpha, false)));
    all.push(metal(0.2, true));
    for eta in [1.5, 2.4, 0.75] {
        all.extend([0.05, 0.2, 0.7].map(|alpha| glass(alpha, eta)));
    }
    all.push(glass(0.1, 1.1));
    all
}
