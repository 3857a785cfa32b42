//! The list that every target runs and prints, one line each: `name crc32=89abcdef`.

use microlux::num::Crc;
use microlux::scene::builtin::Builtin::{Cornell, Implicits, Map, Materials, Sky, Spheres, Torus};

#[cfg(feature = "roomy")]
use crate::{
    denoise::{
        self,
        Way::{Atrous, Neural},
    },
    network,
};
use crate::{
    edges, flags,
    golden::{
        Case,
        Integrator::{self, Direct, Path},
        Pattern::{self, Blue, Cmj, Independent, Sobol, Stratified},
    },
    meshes, normalize,
    random::Xorshift,
    rays::{
        Bundle,
        Kind::{self, Primary},
        Motif,
    },
    raystones, rectangles, region, upsampled,
};

/// A piece of work with one fingerprint, the same on every target.
#[derive(Clone, Copy)]
pub struct Job {
    pub name: &'static str,
    pub work: Work,
    pub reach: Reach,
}

/// Which machines a job is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// All.
    All,
    /// All with room for it, in RAM and flash: with the feature `roomy`.
    Roomy,
    /// Of those, all whose emulator is quick: not the RP2040's.
    Quick,
}

/// Whether a machine has room, and whether its emulator is quick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Means {
    pub roomy: bool,
    pub quick: bool,
}

impl Means {
    /// Of the machine of that name.
    pub fn of(machine: &str) -> Means {
        Means {
            roomy: machine != "microbit",
            quick: machine != "rp2040",
        }
    }

    pub fn reach(self, job: &Job) -> bool {
        match job.reach {
            Reach::All => true,
            Reach::Roomy => self.roomy,
            Reach::Quick => self.roomy && self.quick,
        }
    }
}

/// What a job does.
#[derive(Clone, Copy)]
pub enum Work {
    /// Tests the machine itself: its arithmetic, its memory.
    Machine(fn() -> u32),
    /// Renders a picture of the record.
    Picture(Case),
    /// Traces rays or paths, each by itself.
    Rays(Bundle),
    /// Renders and denoises frames of the record.
    #[cfg(feature = "roomy")]
    Denoised(denoise::Case),
}

impl Job {
    pub(crate) const fn machine(name: &'static str, test: fn() -> u32) -> Job {
        Job {
            name,
            work: Work::Machine(test),
            reach: Reach::All,
        }
    }

    /// The fingerprint. Region `id` is what is worth counting: the whole job, or each of its rays.
    pub fn run(&self, id: u32) -> u32 {
        match self.work {
            Work::Machine(test) => region::count(id, test),
            Work::Picture(case) => region::count(id, || case.run().crc),
            Work::Rays(bundle) => bundle.run(id).crc,
            #[cfg(feature = "roomy")]
            Work::Denoised(case) => case.run(id),
        }
    }
}

/// Jobs about the arithmetic and the memory of the machine, and a picture that the example makes without the core's scene.
const OWN: [Job; 8] = [
    Job::machine("edges", edges::run),
    Job::machine("fill", fill),
    Job::machine("raystones", raystones::run),
    Job::machine("meshes", meshes::run),
    Job::machine("normalize", normalize::run),
    Job::machine("rectangles", rectangles::run),
    Job::machine("upsampled", upsampled::twice),
    Job::machine("upsampled-3x", upsampled::thrice),
];

/// Both seeds of each row.
macro_rules! pictures {
    ($($name:literal $scene:ident $integrator:ident $sampler:ident;)*) => {
        /// Every row of the record.
        const PICTURES: &[Job] = &[$(
            picture(concat!($name, "-1"), $scene, $integrator, $sampler, 1, Reach::All),
            picture(concat!($name, "-3735928559"), $scene, $integrator, $sampler, 0xdead_beef, Reach::All),
        )*];
    };
}

const fn picture(
    name: &'static str,
    scene: microlux::scene::builtin::Builtin,
    integrator: Integrator,
    sampler: Pattern,
    seed: u32,
    reach: Reach,
) -> Job {
    Job {
        name,
        work: Work::Picture(Case {
            scene,
            integrator,
            sampler,
            seed,
        }),
        reach,
    }
}

pictures! {
    "cornell-direct-independent" Cornell Direct Independent;
    "cornell-direct-stratified" Cornell Direct Stratified;
    "cornell-direct-sobol" Cornell Direct Sobol;
    "cornell-path-independent" Cornell Path Independent;
    "cornell-path-stratified" Cornell Path Stratified;
    "cornell-path-sobol" Cornell Path Sobol;
    "spheres-direct-independent" Spheres Direct Independent;
    "spheres-direct-stratified" Spheres Direct Stratified;
    "spheres-direct-sobol" Spheres Direct Sobol;
    "spheres-path-independent" Spheres Path Independent;
    "spheres-path-stratified" Spheres Path Stratified;
    "spheres-path-sobol" Spheres Path Sobol;
    "torus-direct-independent" Torus Direct Independent;
    "torus-direct-stratified" Torus Direct Stratified;
    "torus-direct-sobol" Torus Direct Sobol;
    "torus-path-independent" Torus Path Independent;
    "torus-path-stratified" Torus Path Stratified;
    "torus-path-sobol" Torus Path Sobol;
    "materials-path-independent" Materials Path Independent;
    "materials-path-sobol" Materials Path Sobol;
    "sky-path-independent" Sky Path Independent;
    "sky-path-sobol" Sky Path Sobol;
    "map-path-independent" Map Path Independent;
    "map-path-sobol" Map Path Sobol;
    "cornell-path-cmj" Cornell Path Cmj;
    "cornell-path-blue" Cornell Path Blue;
    "spheres-path-cmj" Spheres Path Cmj;
    "spheres-path-blue" Spheres Path Blue;
    "implicits-path-independent" Implicits Path Independent;
    "implicits-path-sobol" Implicits Path Sobol;
}

const fn rays(name: &'static str, motif: Motif, kind: Kind) -> Job {
    Job {
        name,
        work: Work::Rays(Bundle { motif, kind }),
        reach: Reach::All,
    }
}

/// Camera rays and paths in three scenes, one of them with a mesh.
const RAYS: [Job; 6] = [
    rays("cornell-primary", Motif::Builtin(Cornell), Primary),
    rays("cornell-paths", Motif::Builtin(Cornell), Kind::Path),
    rays("spheres-primary", Motif::Builtin(Spheres), Primary),
    rays("spheres-paths", Motif::Builtin(Spheres), Kind::Path),
    rays("torus-primary", Motif::Builtin(Torus), Primary),
    rays("torus-paths", Motif::Builtin(Torus), Kind::Path),
];

/// The same of the mesh in flash, which takes 33 KB.
#[cfg(feature = "roomy")]
const MESH: &[Job] = &[
    Job {
        reach: Reach::Roomy,
        ..rays("mesh-primary", Motif::Mesh, Primary)
    },
    Job {
        reach: Reach::Roomy,
        ..rays("mesh-paths", Motif::Mesh, Kind::Path)
    },
];

/// The first seed of each row, and who renders it.
#[cfg(feature = "roomy")]
macro_rules! transport {
    ($($name:literal $scene:ident $integrator:ident $sampler:ident $reach:ident;)*) => {
        /// Every row of the record of the other integrators.
        const TRANSPORT: &[Job] = &[$(
            picture($name, $scene, Integrator::$integrator, $sampler, 1, Reach::$reach),
        )*];
    };
}

#[cfg(feature = "roomy")]
transport! {
    "cornell-bdpt-independent" Cornell Bdpt Independent Roomy;
    "cornell-bdpt-stratified" Cornell Bdpt Stratified Quick;
    "cornell-bdpt-sobol" Cornell Bdpt Sobol Quick;
    "cornell-frame-independent" Cornell Frame Independent Roomy;
    "cornell-frame-stratified" Cornell Frame Stratified Quick;
    "cornell-frame-sobol" Cornell Frame Sobol Quick;
    "cornell-light-independent" Cornell Light Independent Roomy;
    "cornell-light-stratified" Cornell Light Stratified Quick;
    "cornell-light-sobol" Cornell Light Sobol Quick;
    "cornell-ao-independent" Cornell Ao Independent Roomy;
    "cornell-ao-stratified" Cornell Ao Stratified Quick;
    "cornell-ao-sobol" Cornell Ao Sobol Quick;
    "spheres-bdpt-independent" Spheres Bdpt Independent Roomy;
    "spheres-bdpt-stratified" Spheres Bdpt Stratified Quick;
    "spheres-bdpt-sobol" Spheres Bdpt Sobol Quick;
    "spheres-frame-independent" Spheres Frame Independent Quick;
    "spheres-frame-stratified" Spheres Frame Stratified Quick;
    "spheres-frame-sobol" Spheres Frame Sobol Quick;
    "spheres-light-independent" Spheres Light Independent Quick;
    "spheres-light-stratified" Spheres Light Stratified Quick;
    "spheres-light-sobol" Spheres Light Sobol Quick;
    "spheres-ao-independent" Spheres Ao Independent Roomy;
    "spheres-ao-stratified" Spheres Ao Stratified Quick;
    "spheres-ao-sobol" Spheres Ao Sobol Quick;
    "torus-bdpt-independent" Torus Bdpt Independent Roomy;
    "torus-bdpt-stratified" Torus Bdpt Stratified Quick;
    "torus-bdpt-sobol" Torus Bdpt Sobol Quick;
    "torus-frame-independent" Torus Frame Independent Quick;
    "torus-frame-stratified" Torus Frame Stratified Quick;
    "torus-frame-sobol" Torus Frame Sobol Quick;
    "torus-light-independent" Torus Light Independent Quick;
    "torus-light-stratified" Torus Light Stratified Quick;
    "torus-light-sobol" Torus Light Sobol Quick;
    "torus-ao-independent" Torus Ao Independent Roomy;
    "torus-ao-stratified" Torus Ao Stratified Quick;
    "torus-ao-sobol" Torus Ao Sobol Quick;
    "materials-bdpt-independent" Materials Bdpt Independent Quick;
    "materials-bdpt-sobol" Materials Bdpt Sobol Quick;
    "materials-frame-independent" Materials Frame Independent Quick;
    "materials-frame-sobol" Materials Frame Sobol Quick;
    "materials-light-independent" Materials Light Independent Quick;
    "materials-light-sobol" Materials Light Sobol Quick;
    "materials-ao-independent" Materials Ao Independent Quick;
    "materials-ao-sobol" Materials Ao Sobol Quick;
    "sky-bdpt-sobol" Sky Bdpt Sobol Quick;
    "sky-light-sobol" Sky Light Sobol Quick;
    "sky-ao-sobol" Sky Ao Sobol Quick;
    "map-bdpt-sobol" Map Bdpt Sobol Quick;
    "map-light-sobol" Map Light Sobol Quick;
    "cornell-bdpt-cmj" Cornell Bdpt Cmj Quick;
    "cornell-bdpt-blue" Cornell Bdpt Blue Quick;
    "cornell-frame-cmj" Cornell Frame Cmj Quick;
    "cornell-frame-blue" Cornell Frame Blue Quick;
    "cornell-light-cmj" Cornell Light Cmj Quick;
    "cornell-light-blue" Cornell Light Blue Quick;
    "cornell-ao-cmj" Cornell Ao Cmj Quick;
    "cornell-ao-blue" Cornell Ao Blue Quick;
    "implicits-bdpt-sobol" Implicits Bdpt Sobol Quick;
    "implicits-ao-sobol" Implicits Ao Sobol Quick;
}

#[cfg(feature = "roomy")]
const fn denoised(
    name: &'static str,
    scene: microlux::scene::builtin::Builtin,
    way: denoise::Way,
    spp: u32,
    reach: Reach,
) -> Job {
    Job {
        name,
        work: Work::Denoised(denoise::Case {
            scene,
            way,
            spp,
            is_steadied: false,
        }),
        reach,
    }
}

#[cfg(feature = "roomy")]
const fn steadied(name: &'static str, scene: microlux::scene::builtin::Builtin, reach: Reach) -> Job {
    Job {
        name,
        work: Work::Denoised(denoise::Case {
            scene,
            way: Atrous,
            spp: 1,
            is_steadied: true,
        }),
        reach,
    }
}

/// Every row of the record of denoised pictures.
#[cfg(feature = "roomy")]
const DENOISED: &[Job] = &[
    denoised("cornell-atrous-1", Cornell, Atrous, 1, Reach::Roomy),
    denoised("cornell-atrous-4", Cornell, Atrous, 4, Reach::Quick),
    denoised("cornell-neural-1", Cornell, Neural, 1, Reach::Roomy),
    denoised("cornell-neural-4", Cornell, Neural, 4, Reach::Quick),
    steadied("cornell-taa-1", Cornell, Reach::Roomy),
    denoised("spheres-atrous-1", Spheres, Atrous, 1, Reach::Roomy),
    denoised("spheres-atrous-4", Spheres, Atrous, 4, Reach::Quick),
    denoised("spheres-neural-1", Spheres, Neural, 1, Reach::Quick),
    denoised("spheres-neural-4", Spheres, Neural, 4, Reach::Quick),
    steadied("spheres-taa-1", Spheres, Reach::Quick),
    denoised("torus-atrous-1", Torus, Atrous, 1, Reach::Quick),
    denoised("torus-atrous-4", Torus, Atrous, 4, Reach::Quick),
    denoised("torus-neural-1", Torus, Neural, 1, Reach::Quick),
    denoised("torus-neural-4", Torus, Neural, 4, Reach::Quick),
    steadied("torus-taa-1", Torus, Reach::Quick),
    denoised("materials-atrous-1", Materials, Atrous, 1, Reach::Quick),
    denoised("materials-atrous-4", Materials, Atrous, 4, Reach::Quick),
    denoised("materials-neural-1", Materials, Neural, 1, Reach::Quick),
    denoised("materials-neural-4", Materials, Neural, 4, Reach::Quick),
    steadied("materials-taa-1", Materials, Reach::Quick),
    denoised("sky-atrous-1", Sky, Atrous, 1, Reach::Quick),
    denoised("sky-atrous-4", Sky, Atrous, 4, Reach::Quick),
    denoised("sky-neural-1", Sky, Neural, 1, Reach::Quick),
    denoised("sky-neural-4", Sky, Neural, 4, Reach::Quick),
    steadied("sky-taa-1", Sky, Reach::Quick),
];

/// Of no record.
#[cfg(feature = "roomy")]
const OTHERS: &[Job] = &[
    Job {
        reach: Reach::Roomy,
        ..Job::machine("network", network::run)
    },
    picture(
        "cornell-bdpt-8x8",
        Cornell,
        Integrator::Deep,
        Independent,
        1,
        Reach::Roomy,
    ),
];

#[cfg(not(feature = "roomy"))]
const MESH: &[Job] = &[];
#[cfg(not(feature = "roomy"))]
const TRANSPORT: &[Job] = &[];
#[cfg(not(feature = "roomy"))]
const OTHERS: &[Job] = &[];
#[cfg(not(feature = "roomy"))]
const DENOISED: &[Job] = &[];

/// Every job, in the order in which they run. A job's place in it is also its [`region`]; those for [`Reach::All`] come
/// first, so that it is the same where there are no others.
pub fn all() -> impl Iterator<Item = &'static Job> {
    let everywhere = OWN.iter().chain(flags::JOBS).chain(PICTURES).chain(&RAYS);
    everywhere
        .chain(MESH)
        .chain(TRANSPORT)
        .chain(OTHERS)
        .chain(DENOISED)
}

/// The jobs of one machine, with their regions.
pub fn of(machine: &str) -> impl Iterator<Item = (u32, &'static Job)> {
    let means = Means::of(machine);
    (0..).zip(all()).filter(move |(_, job)| means.reach(job))
}

/// 4 KiB of random bytes, written and read back in three widths.
#[inline(never)]
fn fill() -> u32 {
    let mut words = [0; 1024];
    let mut random = Xorshift::new(0x1234_5678);
    words.fill_with(|| random.u32());
    for i in 0..words.len() {
        let other = words[words[i] as usize % words.len()];
        words[i] = words[i].wrapping_mul(other | 1).rotate_left(other >> 27);
    }
    let mut crc = Crc::new();
    for pair in words.chunks_exact(2) {
        let halves = [pair[0] as u16, (pair[1] >> 16) as u16];
        crc.word(pair[0]);
        crc.bytes(&halves[0].to_be_bytes());
        crc.bytes(&halves[1].to_le_bytes());
        crc.bytes(&[pair[1] as u8]);
    }
    crc.value()
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::{format, string::String, vec::Vec};

    /// Rows of a record as they are named and printed.
    fn rows(record: &str) -> Vec<String> {
        let rows = record.lines().filter(|line| !line.starts_with('#'));
        rows.map(|row| row.split_whitespace().collect::<Vec<_>>().join("-"))
            .collect()
    }

    fn printed(jobs: &[Job]) -> Vec<String> {
        let line = |job: &Job| format!("{}-{:08x}", job.name, job.run(0));
        jobs.iter().map(line).collect()
    }

    /// This computer's pictures are the records', row by row and in their order.
    #[test]
    fn pictures_are_the_record() {
        let record = include_str!("../../../tests/golden.txt");
        assert_eq!(printed(PICTURES), rows(record));
        let record = include_str!("../../../tests/golden_transport.txt");
        assert_eq!(printed(TRANSPORT), rows(record));
    }

    /// Where there is no room, the list is this computer's up to where room is needed.
    #[test]
    fn jobs_for_all_come_first() {
        let rest = all().skip_while(|job| job.reach == Reach::All);
        assert!(rest.into_iter().all(|job| job.reach != Reach::All));
        assert_eq!(of("mps2-an385").count(), all().count());
        assert!(of("microbit").count() < of("rp2040").count());
        assert!(of("rp2040").count() < all().count());
    }

    #[test]
    fn every_job_has_a_region() {
        assert!(all().count() < region::EMPTY as usize);
    }
}
