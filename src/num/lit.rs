/// A decimal as a fixed-point constant, rounded to nearest at compile time; refused there if it does not fit.
///
/// ```
/// use microlux::{num::Share, q};
/// assert_eq!(q!(-1.5).to_bits(), -98304);       // Metres (I16F16) unless said
/// assert_eq!(q!(0.73, Share).to_bits(), 23921); // 0.73 · 2^15 = 23920.64
/// ```
///
/// ```compile_fail
/// let too_far = microlux::q!(40000);
/// ```
#[macro_export]
macro_rules! q {
    ($value:expr) => {
        $crate::q!($value, $crate::num::Metres)
    };
    ($value:expr, $role:ty) => {{
        const VALUE: $role = <$role>::lit(stringify!($value));
        VALUE
    }};
}
