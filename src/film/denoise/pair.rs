/// Two workers: a chip's two cores, or what stands for them.
pub trait Pair {
    /// Does both, at once or one after the other in any order, and returns when both are done.
    fn both(&self, one: impl FnOnce() + Send, other: impl FnOnce() + Send);
}

/// One worker, who does one thing after the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Pair for Alone {
    fn both(&self, one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
        one();
        other();
    }
}
