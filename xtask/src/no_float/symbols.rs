//! Which symbols of a linked program are soft-float routines.

use std::collections::BTreeSet;

use anyhow::{Context, Result, ensure};
use object::{Object, ObjectSymbol};

/// The names of all functions and data that the program defines, as `nm` lists them.
pub fn names(elf: &[u8]) -> Result<BTreeSet<String>> {
    let file = object::File::parse(elf).context("not an ELF program")?;
    let defined = file.symbols().filter(|symbol| symbol.is_definition());
    let names: BTreeSet<_> = defined
        .filter_map(|symbol| symbol.name().ok())
        .map(str::to_string)
        .collect();
    ensure!(
        !names.is_empty(),
        "the program has no symbol table: it was stripped"
    );
    Ok(names)
}

/// Tells names that do arithmetic in floats, or turn them into text and back, from all others.
pub struct SoftFloat {
    routines: BTreeSet<String>,
}

impl SoftFloat {
    pub fn new() -> SoftFloat {
        let mut routines = BTreeSet::new();
        aeabi(&mut routines);
        libgcc(&mut routines);
        libm(&mut routines);
        SoftFloat { routines }
    }

    pub fn is(&self, name: &str) -> bool {
        self.routines.contains(name) || is_rust_float(name)
    }
}

impl Default for SoftFloat {
    fn default() -> Self {
        Self::new()
    }
}

/// ARM's run-time ABI (IHI 0043), tables 2 to 7, and the GNU names of its half-float helpers.
fn aeabi(routines: &mut BTreeSet<String>) {
    for kind in ["f", "d"] {
        for operation in "add sub rsub mul div neg cmpeq cmplt cmple cmpge cmpgt cmpun".split(' ') {
            routines.insert(format!("__aeabi_{kind}{operation}"));
        }
        for comparison in ["cmpeq", "cmple", "rcmple"] {
            routines.insert(format!("__aeabi_c{kind}{comparison}"));
        }
        for integer in ["i", "ui", "l", "ul"] {
            routines.insert(format!("__aeabi_{integer}2{kind}"));
        }
        for integer in ["iz", "uiz", "lz", "ulz"] {
            routines.insert(format!("__aeabi_{kind}2{integer}"));
        }
    }
    for conversion in "d2f f2d h2f f2h d2h h2d h2f_alt f2h_alt d2h_alt".split(' ') {
        routines.insert(format!("__aeabi_{conversion}"));
    }
    for helper in [
        "h2f_ieee",
        "f2h_ieee",
        "d2h_ieee",
        "h2f_alternative",
        "f2h_alternative",
        "d2h_alternative",
    ] {
        routines.insert(format!("__gnu_{helper}"));
    }
}

/// The names of libgcc and compiler-rt, for half, single, double, extended and quadruple precision.
fn libgcc(routines: &mut BTreeSet<String>) {
    const FLOATS: [&str; 6] = ["hf", "bf", "sf", "df", "xf", "tf"];
    for float in FLOATS {
        for operation in ["add", "sub", "mul", "div", "pow"] {
            routines.insert(format!("__{operation}{float}3"));
        }
        for operation in "neg powi eq ne lt le gt ge cmp unord".split(' ') {
            routines.insert(format!("__{operation}{float}2"));
        }
        for other in FLOATS {
            routines.insert(format!("__extend{float}{other}2"));
            routines.insert(format!("__trunc{float}{other}2"));
        }
        for integer in ["si", "di", "ti"] {
            routines.insert(format!("__fix{float}{integer}"));
            routines.insert(format!("__fixuns{float}{integer}"));
            routines.insert(format!("__float{integer}{float}"));
            routines.insert(format!("__floatun{integer}{float}"));
        }
    }
    for complex in ["hc", "sc", "dc", "xc", "tc"] {
        routines.insert(format!("__mul{complex}3"));
        routines.insert(format!("__div{complex}3"));
    }
    let vfp: Vec<_> = routines
        .iter()
        .filter(|name| !name.starts_with("__aeabi"))
        .map(|name| format!("{name}vfp"))
        .collect();
    routines.extend(vfp);
}

/// C's mathematics, which `f32` and `f64` methods call where there is no instruction; `f` ends those of `f32`.
fn libm(routines: &mut BTreeSet<String>) {
    const FUNCTIONS: &str = "acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp10 exp2 \
        expm1 fabs fdim floor fma fmax fmaximum fmaximum_num fmin fminimum fminimum_num fmod frexp hypot ilogb j0 j1 jn \
        ldexp lgamma log log10 log1p log2 logb lrint lround modf nearbyint nextafter pow remainder remquo rint round \
        roundeven scalbn sin sincos sinh sqrt tan tanh tgamma trunc y0 y1 yn";
    for function in FUNCTIONS.split_whitespace() {
        for suffix in ["", "f", "f16", "f128", "l"] {
            routines.insert(format!("{function}{suffix}"));
        }
    }
}

/// Rust's own float code by its mangled path; both manglings write each segment after its length.
fn is_rust_float(name: &str) -> bool {
    let mangled = name.starts_with("_ZN") || name.starts_with("_R");
    let has = |segment: &str| name.contains(&format!("{}{segment}", segment.len()));
    // `int_traits` are the integers' part of `math`.
    let in_builtins = has("compiler_builtins") && (has("float") || has("math")) && !has("int_traits");
    let in_core = has("flt2dec") || has("dec2flt") || (has("fmt") && has("float"));
    mangled && (in_builtins || in_core || has("libm") || has("micromath"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_routines_of_each_family_are_known() {
        let soft_float = SoftFloat::new();
        for name in [
            "__aeabi_fadd",
            "__aeabi_dmul",
            "__aeabi_frsub",
            "__aeabi_cdrcmple",
            "__aeabi_fcmplt",
            "__aeabi_ul2d",
            "__aeabi_d2ulz",
            "__aeabi_f2h",
            "__addsf3",
            "__muldf3",
            "__divdf3vfp",
            "__unordsf2",
            "__extendsfdf2",
            "__truncdfhf2",
            "__fixunsdfdi",
            "__floatundisf",
            "__powisf2",
            "__muldc3",
            "sqrtf",
            "fmod",
            "truncf",
            "_ZN17compiler_builtins5float3add3add17h0123456789abcdefE",
            "_RNvNtNtCs1_4core3num7flt2dec6digits",
            "_ZN4core3fmt5float29float_to_decimal_common_exact17h0123456789abcdefE",
        ] {
            assert!(soft_float.is(name), "{name}");
        }
    }

    #[test]
    fn integers_are_not_floats() {
        let soft_float = SoftFloat::new();
        for name in [
            "__aeabi_uidiv",
            "__aeabi_ldivmod",
            "__aeabi_llsl",
            "__aeabi_lmul",
            "__aeabi_memcpy4",
            "__aeabi_uidivmod",
            "__muldi3",
            "__divsi3",
            "__udivmoddi4",
            "__ashldi3",
            "__clzsi2",
            "__negdi2",
            "__cmpdi2",
            "memcpy",
            "_ZN8microlux3num4root4sqrt17h0123456789abcdefE",
            "_ZN8microlux4film4tile5float17h0123456789abcdefE",
            "_ZN17compiler_builtins3int3mul17h0123456789abcdefE",
            "_RNvXNtNtNtNtCs3j_17compiler_builtins4math9libm_math7support10int_traitsjINtB2_8CastFrommE9cast_fromBa_",
            "_ZN4core3fmt9Formatter3pad17h0123456789abcdefE",
        ] {
            assert!(!soft_float.is(name), "{name}");
        }
    }

    /// A function that no optimisation can leave out: it is called through a pointer that nothing knows.
    #[inline(never)]
    fn a_name_to_be_found(x: u32) -> u32 {
        std::hint::black_box(x)
    }

    #[test]
    fn the_names_of_this_very_program_are_read() {
        assert_eq!(std::hint::black_box(a_name_to_be_found as fn(u32) -> u32)(7), 7);
        let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let names = names(&program).unwrap();
        assert!(names.contains("main"));
        assert!(names.iter().any(|name| name.contains("a_name_to_be_found")));
    }

    #[test]
    fn what_is_no_program_is_refused() {
        assert!(names(b"#!/bin/sh\n").is_err());
    }
}
