//! How deep a program's stacks can get, whatever it computes.
//!
//! The compiler says what each function takes (`-Zemit-stack-sizes`), the linked machine code who calls whom; the longest
//! way down from where a core starts is the bound. Where the compiler says nothing, as of the assembly and the
//! precompiled routines, what the code itself takes off the stack pointer counts. A call by pointer may go to any
//! function whose address stands anywhere in the program. What has no bound, such as a recursion, is an error that names
//! it. Interrupts and faults come on top: see [`Bound::exception`].

mod code;
mod graph;
mod program;

use std::path::Path;

use anyhow::{Context, Result, ensure};

pub use graph::Bound;
use graph::Graph;

/// Where a stack begins to be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Root {
    /// The program's entry.
    Reset,
    /// What an RP2040's or RP2350's second core runs.
    Core1,
}

/// The deepest that the stack of `root` gets in the ELF file `program`.
pub fn bound(program: &Path, root: Root) -> Result<Bound> {
    let name = || program.display().to_string();
    let graph = Graph::new(program::read(program).with_context(name)?).with_context(name)?;
    graph.bound(root).with_context(name)
}

/// The deepest stack of a program, seen and possible.
#[derive(Clone, Debug)]
pub struct Depth {
    /// What for.
    pub name: String,
    /// Bytes at the deepest while it ran.
    pub measured: u64,
    pub bound: Bound,
    /// Bytes there are.
    pub room: u64,
}

impl Depth {
    /// Fails unless what was seen is within what is possible, and that within what there is.
    pub fn check(&self) -> Result<()> {
        let bytes = self.bound.bytes;
        ensure!(
            self.measured <= bytes,
            "{}: a stack of {} bytes was measured, but the bound says {bytes} at most",
            self.name,
            self.measured
        );
        ensure!(
            bytes + self.bound.exception <= self.room,
            "{}: the stack may grow to {bytes} bytes, an exception may take {} more, and there are {}:\n{}",
            self.name,
            self.bound.exception,
            self.room,
            self.bound.way()
        );
        Ok(())
    }
}

/// A job's line `memory NAME variables=BYTES stack=BYTES room=BYTES`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Memory {
    pub name: String,
    pub variables: u64,
    pub stack: u64,
    /// What there is for both.
    pub room: u64,
}

impl Memory {
    /// All such lines.
    pub fn read(printed: &str) -> Result<Vec<Memory>> {
        let lines = printed.lines().filter_map(|line| line.strip_prefix("memory "));
        lines
            .map(|line| Memory::parse(line).with_context(|| format!("not a memory line: {line:?}")))
            .collect()
    }

    fn parse(line: &str) -> Option<Memory> {
        let mut words = line.split(' ');
        let name = words.next()?.to_owned();
        let mut next = |key: &str| words.next()?.strip_prefix(key)?.parse().ok();
        Some(Memory {
            name,
            variables: next("variables=")?,
            stack: next("stack=")?,
            room: next("room=")?,
        })
    }
}

/// The deepest of all jobs that `program` has `printed` the memory of, checked.
pub fn jobs(name: &str, program: &Path, printed: &str) -> Result<Depth> {
    let memories = Memory::read(printed)?;
    let deepest = memories.iter().max_by_key(|memory| memory.stack);
    let deepest = deepest.with_context(|| format!("{name} prints no memory line"))?;
    let depth = Depth {
        name: name.to_owned(),
        measured: deepest.stack,
        bound: bound(program, Root::Reset)?,
        room: deepest.room - deepest.variables,
    };
    depth.check()?;
    Ok(depth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_memory_lines() {
        let printed = "memory a-1 variables=1 stack=2 room=3\na-1 crc32=00000000\nmemory b variables=128 stack=5688 room=16384\n";
        let lines = Memory::read(printed).unwrap();
        assert_eq!(lines[0].name, "a-1");
        let Memory {
            variables,
            stack,
            room,
            ..
        } = lines[1];
        assert_eq!((variables, stack, room), (128, 5688, 16384));
        assert!(Memory::read("memory b stack=1 variables=2 room=3\n").is_err());
    }

    fn depth(measured: u64, bytes: u64, room: u64) -> Depth {
        Depth {
            name: "a board".into(),
            measured,
            bound: Bound {
                bytes,
                exception: 36,
                way: vec![],
                by_pointer: vec![],
            },
            room,
        }
    }

    #[test]
    fn a_bound_below_the_measured_is_refused() {
        assert!(depth(100, 100, 136).check().is_ok());
        assert!(depth(101, 100, 136).check().is_err());
        assert!(depth(100, 100, 135).check().is_err());
    }
}
