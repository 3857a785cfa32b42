//! Ctrl-C.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::Failure;

/// A flag that Ctrl-C sets, for the render to stop at its next tile. A second Ctrl-C ends the program at once.
pub fn on_ctrl_c() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let shared = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if shared.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    })
    .map_err(|error| Failure::Wrong(format!("Ctrl-C cannot be caught ({error}); try again")))?;
    Ok(flag)
}
