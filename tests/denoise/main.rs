//! What a denoiser is told, and what it makes of it.

mod features;
