//! For cores of RV32IM, which have registers for all of a ray.
//!
//! What a node's test wants stays in them over the walk; triangles take them over and hand them back. On the stack are what
//! callers want back and, while triangles are looked at, three words of the walk.

/// What the target has beside RV32I: the assembler is not told.
#[cfg(target_feature = "c")]
macro_rules! extensions {
    () => {
        ".option push; .option arch, +m, +c"
    };
}

#[cfg(not(target_feature = "c"))]
macro_rules! extensions {
    () => {
        ".option push; .option arch, +m"
    };
}

pub(crate) mod facets;
pub(crate) mod walk;
