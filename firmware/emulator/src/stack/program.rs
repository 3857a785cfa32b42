//! What an ELF file says about its functions.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    ops::Range,
    path::Path,
};

use anyhow::{Context, Result, bail, ensure};
use object::{
    Architecture, Object, ObjectSection, ObjectSymbol, RelocationFlags, Section, SectionFlags, SymbolKind,
    elf, read::File,
};

use super::code::{Decoder, Step};

/// A function of the program, with what its code does to the stack and to the flow of control.
#[derive(Clone, Debug)]
pub struct Function {
    /// As in the source, without the hash.
    pub name: String,
    /// Addresses, end excluded.
    pub range: Range<u64>,
    /// Bytes of stack, as the compiler says.
    pub frame: Option<u64>,
    pub steps: Vec<Step>,
}

/// A program's functions by address, and what else the graph needs.
#[derive(Debug)]
pub struct Program {
    pub functions: BTreeMap<u64, Function>,
    pub entry: u64,
    /// Handlers in a vector table, reset excluded.
    pub vectors: BTreeSet<u64>,
    /// Words anywhere else in the program that are addresses.
    pub pointers: BTreeSet<u64>,
    /// What the hardware pushes when an exception comes, with what it leaves free to align the stack.
    pub exception_frame: u64,
}

/// An ELF file and how its addresses are to be read.
struct Image<'a> {
    file: File<'a>,
    decoder: Decoder,
    is_arm: bool,
}

/// Reads the ELF file `program`.
pub fn read(program: &Path) -> Result<Program> {
    let bytes = fs::read(program)?;
    let file = File::parse(&*bytes)?;
    let is_arm = match file.architecture() {
        Architecture::Arm => true,
        Architecture::Riscv32 => false,
        other => bail!("{other:?} is no architecture of a board's"),
    };
    let image = Image {
        decoder: if is_arm {
            Decoder::thumb()?
        } else {
            Decoder::riscv()?
        },
        is_arm,
        file,
    };
    let mut program = Program {
        functions: image.functions()?,
        entry: image.plain(image.file.entry()),
        vectors: BTreeSet::new(),
        pointers: BTreeSet::new(),
        exception_frame: image.exception_frame(),
    };
    ensure!(
        !program.functions.is_empty(),
        "no function has a name: it was stripped"
    );
    for section in image.sections(elf::SHF_ALLOC) {
        let pointers = image.pointers(&section)?;
        if section.name() == Ok(".vector_table") {
            // The first two are the stack's top and the reset's.
            let handlers = pointers.range(section.address() + 8..);
            program.vectors.extend(handlers.map(|(_, pointer)| *pointer));
        } else {
            program.pointers.extend(pointers.into_values());
        }
    }
    Ok(program)
}

impl<'a> Image<'a> {
    /// The sections with contents that have the flag.
    fn sections(&self, flag: u32) -> impl Iterator<Item = Section<'a, '_>> {
        self.file.sections().filter(move |section| {
            let is_there = section.file_range().is_some();
            is_there
                && matches!(section.flags(), SectionFlags::Elf { sh_flags } if sh_flags & u64::from(flag) != 0)
        })
    }

    /// The address without the instruction set, which is bit 0 of a Thumb function's.
    fn plain(&self, address: u64) -> u64 {
        if self.is_arm { address & !1 } else { address }
    }

    fn functions(&self) -> Result<BTreeMap<u64, Function>> {
        let frames = self.frames()?;
        let mut functions = BTreeMap::new();
        for section in self.sections(elf::SHF_EXECINSTR) {
            let data = section.data()?;
            let whole = section.address()..section.address() + data.len() as u64;
            let starts = self.starts(&whole, section.name()?);
            let codes = self.codes(&whole);
            let nexts = starts.keys().copied().skip(1).chain([whole.end]);
            for ((&start, (name, size)), next) in starts.iter().zip(nexts) {
                // Assembly may not tell its size, and what lies behind a function may have no name.
                let end = if *size == 0 { next } else { next.min(start + size) };
                for (range, name) in [(start..end, name.clone()), (end..next, format!("behind {name}"))] {
                    let mut steps = Vec::new();
                    for code in &codes {
                        let part = code.start.max(range.start)..code.end.min(range.end);
                        if !part.is_empty() {
                            let bytes =
                                &data[(part.start - whole.start) as usize..(part.end - whole.start) as usize];
                            let decoded = self.decoder.steps(bytes, part.start);
                            steps.extend(decoded.with_context(|| format!("in {name}"))?);
                        }
                    }
                    let function = Function {
                        name,
                        frame: frames.get(&range.start).copied(),
                        range,
                        steps,
                    };
                    if !function.range.is_empty() {
                        functions.insert(function.range.start, function);
                    }
                }
            }
        }
        Ok(functions)
    }

    /// Name and size of each function in the section, by its address; one that is named after the section is all that
    /// has no name at its start.
    fn starts(&self, section: &Range<u64>, name: &str) -> BTreeMap<u64, (String, u64)> {
        let mut starts = BTreeMap::new();
        for symbol in self.file.symbols() {
            let start = self.plain(symbol.address());
            let name = symbol.name().unwrap_or_default();
            if symbol.kind() != SymbolKind::Text || !section.contains(&start) || name.starts_with('$') {
                continue;
            }
            let entry = starts.entry(start).or_insert_with(|| {
                let name = rustc_demangle::demangle(name);
                (format!("{name:#}"), 0)
            });
            entry.1 = symbol.size().max(entry.1);
        }
        starts
            .entry(section.start)
            .or_insert_with(|| (name.to_owned(), 0));
        starts
    }

    /// Where the section holds code and not data, by the mapping symbols.
    fn codes(&self, section: &Range<u64>) -> Vec<Range<u64>> {
        let mut marks = BTreeMap::from([(section.start, true)]);
        for symbol in self.file.symbols() {
            let name = symbol.name().unwrap_or_default();
            if name.starts_with('$') && section.contains(&symbol.address()) {
                marks.insert(symbol.address(), !name.starts_with("$d"));
            }
        }
        let ends = marks.keys().copied().skip(1).chain([section.end]);
        let parts = marks.iter().zip(ends);
        parts
            .filter(|((_, is_code), _)| **is_code)
            .map(|((start, _), end)| *start..end)
            .collect()
    }

    /// The words of a section that the linker made addresses, by their place.
    fn pointers(&self, section: &Section) -> Result<BTreeMap<u64, u64>> {
        let kind = if self.is_arm {
            elf::R_ARM_ABS32
        } else {
            elf::R_RISCV_32
        };
        let data = section.data()?;
        let mut pointers = BTreeMap::new();
        for (place, relocation) in section.relocations() {
            let is_word = relocation.flags() == RelocationFlags::Elf { r_type: kind };
            let offset = place.wrapping_sub(section.address()) as usize;
            let word = data.get(offset..).and_then(|rest| rest.first_chunk());
            if let Some(word) = word.filter(|_| is_word) {
                pointers.insert(place, self.plain(u32::from_le_bytes(*word).into()));
            }
        }
        Ok(pointers)
    }

    /// The compiler's word: each entry an address and a size in LEB128.
    fn frames(&self) -> Result<BTreeMap<u64, u64>> {
        let mut frames = BTreeMap::new();
        for section in self.file.sections().filter(|s| s.name() == Ok(".stack_sizes")) {
            let mut rest = section.data()?;
            while let Some((address, after)) = rest.split_first_chunk() {
                let (size, after) = leb128(after).context("a stack size is cut short")?;
                frames.insert(self.plain(u32::from_le_bytes(*address).into()), size);
                rest = after;
            }
        }
        ensure!(!frames.is_empty(), "it was built without -Zemit-stack-sizes");
        Ok(frames)
    }

    /// Eight registers; with an FPU its sixteen, the status and a word of padding; and 4 bytes to align.
    ///
    /// "Armv8-M Architecture Reference Manual", B3.18; a RISC-V pushes nothing by itself.
    fn exception_frame(&self) -> u64 {
        const HARD_FLOAT: u32 = 0x400;
        let has_fpu = matches!(
            self.file.flags(),
            object::FileFlags::Elf { e_flags, .. } if e_flags & HARD_FLOAT != 0
        );
        match (self.is_arm, has_fpu) {
            (false, _) => 0,
            (true, false) => 32 + 4,
            (true, true) => 32 + 72 + 4,
        }
    }
}

/// An unsigned number, seven bits a byte, the lowest first.
fn leb128(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let length = bytes.iter().position(|byte| byte & 0x80 == 0)? + 1;
    let (number, rest) = bytes.split_at(length);
    let number = number
        .iter()
        .rev()
        .fold(0, |number, byte| number << 7 | u64::from(byte & 0x7f));
    Some((number, rest))
}

#[cfg(test)]
mod tests {
    use super::leb128;

    #[test]
    fn numbers_of_any_length() {
        assert_eq!(leb128(&[5, 9]), Some((5, &[9][..])));
        assert_eq!(leb128(&[0xe5, 0x8e, 0x26]), Some((624_485, &[][..])));
        assert_eq!(leb128(&[0x80]), None);
    }
}
