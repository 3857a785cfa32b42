//! The list that every target runs and prints, one line each: `name crc32=89abcdef`.

use microlux::scene::builtin::Builtin::{Cornell, Map, Materials, Sky, Spheres, Torus};

use crate::{
    crc::Crc,
    edges, flags,
    golden::{
        Case,
        Integrator::{self, Direct, Path},
        Pattern::{self, Blue, Cmj, Independent, Sobol, Stratified},
    },
    random::Xorshift,
    rays::{
        Bundle,
        Kind::{self, Primary},
        Motif,
    },
    region,
};

/// A piece of work with one fingerprint, the same on every target.
#[derive(Clone, Copy)]
pub struct Job {
    pub name: &'static str,
    pub work: Work,
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
}

impl Job {
    pub(crate) const fn machine(name: &'static str, test: fn() -> u32) -> Job {
        Job {
            name,
            work: Work::Machine(test),
        }
    }

    /// The fingerprint. Region `id` is what is worth counting: the whole job, or each of its rays.
    pub fn run(&self, id: u32) -> u32 {
        match self.work {
            Work::Machine(test) => region::count(id, test),
            Work::Picture(case) => region::count(id, || case.run().crc),
            Work::Rays(bundle) => bundle.run(id).crc,
        }
    }
}

/// Jobs about the arithmetic and the memory of the machine.
const OWN: [Job; 2] = [Job::machine("edges", edges::run), Job::machine("fill", fill)];

/// Both seeds of each row.
macro_rules! pictures {
    ($($name:literal $scene:ident $integrator:ident $sampler:ident;)*) => {
        /// Every row of the record.
        const PICTURES: &[Job] = &[$(
            picture(concat!($name, "-1"), $scene, $integrator, $sampler, 1),
            picture(concat!($name, "-3735928559"), $scene, $integrator, $sampler, 0xdead_beef),
        )*];
    };
}

const fn picture(
    name: &'static str,
    scene: microlux::scene::builtin::Builtin,
    integrator: Integrator,
    sampler: Pattern,
    seed: u32,
) -> Job {
    Job {
        name,
        work: Work::Picture(Case {
            scene,
            integrator,
            sampler,
            seed,
        }),
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
}

const fn rays(name: &'static str, motif: Motif, kind: Kind) -> Job {
    Job {
        name,
        work: Work::Rays(Bundle { motif, kind }),
    }
}

/// Camera rays and paths in four scenes, two of them with meshes.
const RAYS: [Job; 8] = [
    rays("cornell-primary", Motif::Builtin(Cornell), Primary),
    rays("cornell-paths", Motif::Builtin(Cornell), Kind::Path),
    rays("spheres-primary", Motif::Builtin(Spheres), Primary),
    rays("spheres-paths", Motif::Builtin(Spheres), Kind::Path),
    rays("torus-primary", Motif::Builtin(Torus), Primary),
    rays("torus-paths", Motif::Builtin(Torus), Kind::Path),
    rays("mesh-primary", Motif::Mesh, Primary),
    rays("mesh-paths", Motif::Mesh, Kind::Path),
];

/// Every job, in the order in which they run. A job's place in it is also its [`region`].
pub fn all() -> impl Iterator<Item = &'static Job> {
    OWN.iter().chain(flags::JOBS).chain(PICTURES).chain(&RAYS)
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
    use std::{format, string::String};

    /// This computer's pictures are the record's, row by row and in its order.
    #[test]
    fn pictures_are_the_record() {
        let record = include_str!("../../../tests/golden.txt");
        let rows = record.lines().filter(|line| !line.starts_with('#'));
        let rows: std::vec::Vec<String> = rows
            .map(|row| row.split_whitespace().collect::<std::vec::Vec<_>>().join("-"))
            .collect();
        let ours: std::vec::Vec<String> = PICTURES
            .iter()
            .map(|job| format!("{}-{:08x}", job.name, job.run(0)))
            .collect();
        assert_eq!(ours, rows);
    }

    #[test]
    fn every_job_has_a_region() {
        assert!(all().count() < region::EMPTY as usize);
    }
}
