//! The border: what is wrong is refused with the offender's name, and what passes can be rendered, whatever it is.

#[path = "../scenes/mod.rs"]
mod scenes;

mod hostile;
mod refused;
