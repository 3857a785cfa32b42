//! The order itself, as ARCHITECTURE.md draws it.

/// A room uses what stands before it.
const CHAIN: [&str; 13] = [
    "num",
    "color",
    "geom",
    "sampler",
    "shape",
    "bvh",
    "material",
    "light",
    "camera",
    "scene",
    "integrator",
    "render",
    "setup",
];

/// Beside the chain: uses [`FILM_USES`], and only [`FILM_USER`] uses it.
const FILM: &str = "film";
const FILM_USES: [&str; 3] = ["num", "color", "geom"];
const FILM_USER: &str = "render";

pub fn knows(room: &str) -> bool {
    room == FILM || place(room).is_some()
}

/// Whether the order lets `from` use `to`. Rooms without a place may use, and be used by, anything: they are told on.
pub fn may_use(from: &str, to: &str) -> bool {
    match (from, to) {
        _ if from == to => true,
        (FILM, _) => FILM_USES.contains(&to),
        (_, FILM) => from == FILM_USER,
        _ => match (place(from), place(to)) {
            (Some(from), Some(to)) => to < from,
            _ => true,
        },
    }
}

/// Why `from` may not use `to`.
pub fn reason(from: &str, to: &str) -> String {
    match (from, to) {
        (FILM, _) => format!("film uses {} only", FILM_USES.join(", ")),
        (_, FILM) => format!("film is for {FILM_USER} only"),
        _ => format!("it stands to the right of {from}"),
    }
}

fn place(room: &str) -> Option<usize> {
    CHAIN.iter().position(|known| *known == room)
}
