//! Materials of Wavefront OBJ: a `.mtl` file, and each material by the nearest there is.
//!
//! Alias|Wavefront's "Object Files" of 1995 for the statements, with Clara.io's `Pr` and `Pm`. Numbers are linear, lights
//! of `Ke` are radiances. The illumination models say what a surface is made of: 3, 5 and 8 mirror, 6 and 7 refract, 4
//! and 9 are glass where something gets through.

use std::path::Path;

use super::error::ImportError;
use super::pbr::{MAX_EXPONENT, Mapped, Pbr};
use super::texture::{self, Mean};
use crate::desc::{BsdfDesc, TintDesc, Vec3};

/// What a material says; `None` where it does not.
#[derive(Clone, Debug, Default)]
pub(super) struct Mtl {
    pub name: String,
    diffuse: Option<Vec3>,
    specular: Option<Vec3>,
    emission: Option<Vec3>,
    filter: Option<Vec3>,
    exponent: Option<f64>,
    index: Option<f64>,
    /// 1 is opaque.
    dissolve: Option<f64>,
    roughness: Option<f64>,
    metallic: Option<f64>,
    illumination: Option<f64>,
    /// Statement and file.
    textures: Vec<(String, String)>,
    /// What its diffuse colour is multiplied by.
    pub tint: Option<TintDesc>,
    pub losses: Vec<String>,
}

/// Reads a file's materials.
pub(super) fn read(path: &Path) -> Result<Vec<Mtl>, ImportError> {
    let text = std::fs::read(path).map_err(|error| ImportError::io(path, &error))?;
    parse(path, &String::from_utf8_lossy(&text))
}

fn parse(path: &Path, text: &str) -> Result<Vec<Mtl>, ImportError> {
    let mut materials: Vec<Mtl> = Vec::new();
    for (line, content) in (1..).zip(text.lines()) {
        let content = content.split('#').next().unwrap_or("").trim();
        let (statement, rest) = content.split_once(char::is_whitespace).unwrap_or((content, ""));
        let rest = rest.trim();
        let refuse = |what: String| ImportError::at(path, line, format!("{statement}: {what}"));
        match (statement, materials.last_mut()) {
            ("", _) => {}
            ("newmtl", _) if rest.is_empty() => return Err(refuse("has no name; give it one".to_string())),
            ("newmtl", _) => materials.push(Mtl {
                name: rest.to_string(),
                ..Mtl::default()
            }),
            (_, Some(material)) => material.say(statement, rest).map_err(refuse)?,
            (_, None) => return Err(refuse("stands before the first newmtl; move it".to_string())),
        }
    }
    Ok(materials)
}

/// One to three numbers: one alone is grey.
fn colour(rest: &str) -> Result<Vec3, String> {
    let numbers: Vec<f64> = rest.split_whitespace().map(number).collect::<Result<_, _>>()?;
    match *numbers {
        [grey] => Ok([grey; 3]),
        [r, g, b, ..] => Ok([r, g, b]),
        _ => Err(format!("has {} of 3 numbers; add the rest", numbers.len())),
    }
}

fn number(word: &str) -> Result<f64, String> {
    let number = word.parse::<f64>().ok().filter(|x| x.is_finite());
    number.ok_or_else(|| format!("\"{word}\" is not a finite number; correct it"))
}

/// The file of a texture, behind its options.
fn file_name(rest: &str) -> String {
    let mut words: Vec<&str> = rest.split_whitespace().collect();
    while let [option, values @ ..] = &words[..]
        && option.starts_with('-')
    {
        let count = match *option {
            "-mm" => 2,
            // One to three.
            "-o" | "-s" | "-t" => values
                .iter()
                .take(3)
                .take_while(|v| v.parse::<f64>().is_ok())
                .count(),
            _ => 1,
        };
        words = values.iter().skip(count).copied().collect();
    }
    words.join(" ").replace('\\', "/")
}

fn mean(colour: Vec3) -> f64 {
    colour.iter().sum::<f64>() / 3.0
}

fn times(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

impl Mtl {
    fn say(&mut self, statement: &str, rest: &str) -> Result<(), String> {
        let one = || number(rest.split_whitespace().last().unwrap_or(""));
        match statement {
            "Kd" => self.diffuse = Some(self.share("Kd", colour(rest)?)),
            "Ks" => self.specular = Some(self.share("Ks", colour(rest)?)),
            "Tf" => self.filter = Some(self.share("Tf", colour(rest)?)),
            "Ke" => self.emission = Some(colour(rest)?.map(|x| x.max(0.0))),
            "Ns" => self.exponent = Some(one()?.max(0.0)),
            "Ni" => self.index = Some(one()?.max(0.0)),
            "Pr" => self.roughness = Some(self.share("Pr", [one()?; 3])[0]),
            "Pm" => self.metallic = Some(self.share("Pm", [one()?; 3])[0]),
            "d" => self.dissolve = Some(self.share("d", [one()?; 3])[0]),
            // Where both are given, d is what exporters agree on.
            "Tr" => {
                let opaque = 1.0 - self.share("Tr", [one()?; 3])[0];
                self.dissolve = self.dissolve.or(Some(opaque));
            }
            "illum" => self.illumination = Some(one()?),
            // Light from nowhere.
            "Ka" => {}
            _ if statement.starts_with("map_") => {
                self.textures.push((statement.to_string(), file_name(rest)));
            }
            _ => self.losses.push(format!("{statement} is left out")),
        }
        Ok(())
    }

    fn share(&mut self, statement: &str, given: Vec3) -> Vec3 {
        let held = given.map(|x| x.clamp(0.0, 1.0));
        if held != given {
            self.losses
                .push(format!("{statement} is beyond 0 to 1 and held there"));
        }
        held
    }

    /// Its textures by their means, but the diffuse one as it is if the mesh says where in it it is; `folder` is where they
    /// lie.
    pub fn read_textures(&mut self, folder: &Path, has_uvs: bool) {
        for (statement, file) in std::mem::take(&mut self.textures) {
            let told = match statement.as_str() {
                "map_Kd" if has_uvs && !self.is_glass() => {
                    let bytes = std::fs::read(folder.join(&file)).map_err(|_| "cannot be read".to_string());
                    match bytes.and_then(|bytes| texture::decode(&file, &bytes, false, false)) {
                        Ok(texture) => {
                            self.diffuse = self.diffuse.or(Some([1.0; 3]));
                            self.tint = Some(TintDesc::Texture {
                                texture,
                                to_uv: TintDesc::IN_PLACE,
                            });
                            continue;
                        }
                        Err(what) => format!("{statement} is left out: {file} {what}"),
                    }
                }
                "map_Kd" | "map_Ks" | "map_Ke" | "map_Pr" | "map_Pm" => {
                    let bytes = std::fs::read(folder.join(&file)).map_err(|_| "cannot be read".to_string());
                    match bytes.and_then(|bytes| texture::mean(&bytes)) {
                        Ok(mean) => {
                            self.apply(&statement, mean);
                            format!("{statement} becomes its mean")
                        }
                        Err(what) => format!("{statement} is left out: {file} {what}"),
                    }
                }
                _ => format!("{statement} is left out"),
            };
            self.losses.push(told);
        }
    }

    fn apply(&mut self, statement: &str, mean: Mean) {
        let tinted = |of: Option<Vec3>| Some(times(of.unwrap_or([1.0; 3]), mean.linear));
        let scaled = |of: Option<f64>| Some(of.unwrap_or(1.0) * mean.stored[0]);
        match statement {
            "map_Kd" => self.diffuse = tinted(self.diffuse),
            "map_Ks" => self.specular = tinted(self.specular),
            "map_Ke" => self.emission = tinted(self.emission),
            "map_Pr" => self.roughness = scaled(self.roughness),
            _ => self.metallic = scaled(self.metallic),
        }
    }

    /// Radiance, if there is any.
    pub fn emission(&self) -> Option<Vec3> {
        self.emission.filter(|radiance| *radiance != [0.0; 3])
    }

    fn is_model(&self, models: &[f64]) -> bool {
        self.illumination.is_some_and(|model| models.contains(&model))
    }

    /// Share of the light that gets through.
    fn transmission(&self) -> f64 {
        let through = 1.0 - self.dissolve.unwrap_or(1.0);
        let filtered = through == 0.0 && self.filter.is_some_and(|filter| filter != [0.0; 3]);
        match self.is_model(&[6.0, 7.0]) || (self.is_model(&[4.0, 9.0]) && filtered) {
            true => 1.0,
            false => through,
        }
    }

    /// Whether light goes through it.
    pub fn is_glass(&self) -> bool {
        self.transmission() >= 0.5 && self.metallic.unwrap_or(0.0) < 0.9
    }

    pub fn map(&self) -> Mapped {
        let physical = self.roughness.is_some() || self.metallic.is_some();
        // What says nothing of its colour is grey, like what has no material.
        let silent = self.specular.is_none() && self.emission().is_none() && !self.is_glass();
        let diffuse = self.diffuse.unwrap_or([if silent { 0.7 } else { 0.0 }; 3]);
        let pbr = Pbr {
            base: diffuse,
            metallic: self.metallic.unwrap_or(0.0),
            roughness: self.roughness.unwrap_or(1.0),
            transmission: self.transmission(),
            ior: self.index.unwrap_or(1.5),
        };
        let coloured = diffuse != [0.0; 3];
        let mut mapped = if physical {
            return pbr.map();
        } else if self.is_glass() {
            let clear = Pbr {
                base: self.filter.unwrap_or([1.0; 3]),
                roughness: 0.0,
                ..pbr
            };
            clear.map().losing(coloured, "Kd is left out: it is glass")
        } else {
            self.opaque(diffuse)
        };
        let through = pbr.transmission;
        let lost = through > 0.0 && !self.is_glass();
        mapped = mapped.losing(
            lost,
            &format!("transparency {through:.2} is left out: opaque below 0.5"),
        );
        mapped
    }

    /// "Object Files", illumination models 1 to 3: Kd ΣE N·L + Ks ΣE (N·H)^Ns, a mirror besides in the third.
    fn opaque(&self, diffuse: Vec3) -> Mapped {
        let specular = self.specular.unwrap_or([0.0; 3]);
        let shines = specular != [0.0; 3] && !self.is_model(&[0.0, 1.0]);
        if shines && self.is_model(&[3.0, 5.0, 8.0]) && mean(specular) >= mean(diffuse) {
            let mirror = Mapped {
                bsdf: BsdfDesc::Conductor {
                    specular_reflectance: specular,
                    eta_k: None,
                },
                words: "mirror".to_string(),
                losses: Vec::new(),
            };
            return mirror.losing(diffuse != [0.0; 3], "Kd is left out: it is a mirror");
        }
        match self.exponent.filter(|n| shines && *n > 0.0) {
            Some(exponent) => {
                let exponent = exponent.min(MAX_EXPONENT);
                Mapped {
                    bsdf: BsdfDesc::BlinnPhong {
                        diffuse_reflectance: diffuse,
                        specular_reflectance: specular,
                        exponent,
                        normalized: false,
                    },
                    words: format!("Blinn-Phong, exponent {exponent:.0}"),
                    losses: Vec::new(),
                }
                .losing(
                    self.is_model(&[3.0, 5.0, 8.0]),
                    "what it mirrors is left out: it is more matt than not",
                )
            }
            None => Mapped {
                bsdf: BsdfDesc::Diffuse { reflectance: diffuse },
                words: "Lambert".to_string(),
                losses: Vec::new(),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(text: &str) -> Mtl {
        parse(Path::new("m.mtl"), &format!("newmtl a b\n{text}"))
            .unwrap()
            .remove(0)
    }

    #[test]
    fn each_model_has_its_material() {
        let lambert = one("Kd 0.5 0.25 0.125 # red\nKs 1 1 1\nNs 10\nillum 1");
        assert_eq!(lambert.name, "a b");
        assert!(
            matches!(lambert.map().bsdf, BsdfDesc::Diffuse { reflectance } if reflectance == [0.5, 0.25, 0.125])
        );
        let gloss = one("Kd 0.5\nKs 0.25 0.25 0.25\nNs 96\nillum 2");
        assert!(matches!(
            gloss.map().bsdf,
            BsdfDesc::BlinnPhong {
                exponent: 96.0,
                normalized: false,
                diffuse_reflectance: [0.5, 0.5, 0.5],
                specular_reflectance: [0.25, 0.25, 0.25]
            }
        ));
        let mirror = one("Kd 0.1 0.1 0.1\nKs 0.9 0.8 0.7\nillum 3");
        assert!(matches!(
            mirror.map().bsdf,
            BsdfDesc::Conductor {
                specular_reflectance: [0.9, 0.8, 0.7],
                eta_k: None
            }
        ));
        assert_eq!(mirror.map().losses.len(), 1);
        let glass = one("Kd 0 0 0\nTf 0.5 1 0.5\nNi 1.33\nillum 7");
        assert!(glass.is_glass());
        assert!(matches!(
            glass.map().bsdf,
            BsdfDesc::Dielectric {
                int_ior: 1.33,
                specular_transmittance: [0.5, 1.0, 0.5],
                ..
            }
        ));
        let metal = one("Kd 0.9 0.6 0.2\nPm 1\nPr 0.5\nillum 3");
        assert!(matches!(
            metal.map().bsdf,
            BsdfDesc::RoughConductor { alpha: 0.25, .. }
        ));
        assert!(metal.map().losses.is_empty());
    }

    #[test]
    fn what_gets_through_is_glass_from_a_half_on() {
        let thin = |text: &str| one(text).map();
        assert!(matches!(
            thin("d 0.25").bsdf,
            BsdfDesc::Dielectric { int_ior: 1.5, .. }
        ));
        assert!(matches!(thin("Tr 0.75").bsdf, BsdfDesc::Dielectric { .. }));
        let veil = thin("Kd 1 1 1\nd 0.75");
        assert!(matches!(veil.bsdf, BsdfDesc::Diffuse { .. }));
        assert_eq!(veil.losses, ["transparency 0.25 is left out: opaque below 0.5"]);
        // An exporter that means the other by Tr.
        assert!(matches!(thin("d 1\nTr 1").bsdf, BsdfDesc::Diffuse { .. }));
        assert!(!one("illum 4").is_glass() && one("Tf 1 1 1\nillum 4").is_glass());
    }

    #[test]
    fn losses_and_lights_are_told() {
        let lamp = one("Kd 1.5 0 0\nKe 12 6 0\nmap_Kd -s 2 2 1 -bm 0.5 no such.png\nbump b.png\nnorm n.png");
        assert_eq!(lamp.emission(), Some([12.0, 6.0, 0.0]));
        let mut lamp = lamp;
        lamp.read_textures(Path::new("/nowhere"), false);
        assert_eq!(
            lamp.losses,
            [
                "Kd is beyond 0 to 1 and held there",
                "bump is left out",
                "norm is left out",
                "map_Kd is left out: no such.png cannot be read"
            ]
        );
        assert_eq!(one("Ke 0 0 0").emission(), None);
    }

    #[test]
    fn errors_name_their_line() {
        for (text, expected) in [
            ("Kd 1 1 1\n", "m.mtl:1: Kd: stands before the first newmtl"),
            ("newmtl\n", "m.mtl:1: newmtl: has no name"),
            (
                "newmtl a\n\nKd 1 x 1\n",
                "m.mtl:3: Kd: \"x\" is not a finite number",
            ),
            ("newmtl a\nKs 1 2\n", "m.mtl:2: Ks: has 2 of 3 numbers"),
            (
                "newmtl a\nNs nan\n",
                "m.mtl:2: Ns: \"nan\" is not a finite number",
            ),
        ] {
            let error = parse(Path::new("m.mtl"), text).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error:?} is not {expected:?}");
        }
    }
}
