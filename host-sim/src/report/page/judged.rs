//! Values with what they are against their bars.

use super::text;
use crate::report::{Estimate, Mark};

/// A value with what it is against its bar.
pub struct Judged {
    pub mark: Mark,
    pub text: String,
    /// Drawn beside it; SVG.
    pub whisker: String,
    /// Said when the pointer rests on it.
    pub hint: String,
}

impl Judged {
    pub fn plain(mark: Mark, text: String) -> Judged {
        Judged {
            mark,
            text,
            whisker: String::new(),
            hint: String::new(),
        }
    }

    pub fn none(hint: &str) -> Judged {
        Judged {
            hint: hint.to_string(),
            ..Judged::plain(Mark::Unjudged, "–".to_string())
        }
    }

    pub fn bias(mark: Mark, bias: Option<Estimate>, hint: &str) -> Judged {
        match bias {
            None => Judged::none("nothing to compare with"),
            Some(estimate) => Judged {
                mark,
                text: text::with_error(estimate),
                whisker: text::whisker(estimate),
                hint: if hint.is_empty() {
                    format!("{} standard errors from none", text::plain(estimate.z().abs()))
                } else {
                    hint.to_string()
                },
            },
        }
    }
}
