//! For cores of RV32IM, which have registers for all of a ray.
//!
//! Neither the walk nor the triangles keep anything on the stack but what their callers want back.

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
