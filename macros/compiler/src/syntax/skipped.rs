//! Passes over the model that a user switches off.

use super::ExprKind;
use super::arguments::Arguments;
use crate::diag::Diagnostics;

/// The argument.
const KEY: &str = "skip_passes";

/// Its words.
const PASSES: [&str; 4] = ["frames", "regroup", "parallel", "limbs"];

/// The passes that are left out: `skip_passes = [word, …]`. No function depends on them, only what it costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Link frames stay where they are described.
    pub frames: bool,
    /// Mass properties stay with their links.
    pub regroup: bool,
    /// Links that turn about parallel axes are described in their own axes.
    pub parallel: bool,
    /// Neither alike limbs nor joints of one path are lanes.
    pub limbs: bool,
}

/// Takes the argument.
pub fn read(arguments: &mut Arguments, cx: &mut Diagnostics) -> Skipped {
    let mut skipped = Skipped::default();
    let Some(e) = arguments.take_expr(KEY, cx) else { return skipped };
    let ExprKind::Array(items) = e.kind else {
        cx.error(e.place, format!("expected a list of passes for `{KEY}`"))
            .help(format!("write `{KEY} = [{}]`, or some of these", PASSES.join(", ")));
        return skipped;
    };
    for item in items {
        match item.name() {
            Some("frames") => skipped.frames = true,
            Some("regroup") => skipped.regroup = true,
            Some("parallel") => skipped.parallel = true,
            Some("limbs") => skipped.limbs = true,
            Some(word) => {
                _ = cx.error(item.place.clone(), format!("unknown pass `{word}`")).suggest(word, PASSES)
            }
            None => _ = cx.error(item.place, "expected the name of a pass").suggest("", PASSES),
        }
    }
    skipped
}
