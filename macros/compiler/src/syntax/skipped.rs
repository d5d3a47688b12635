//! Option `skip_passes`: passes over the model that a user disables.

use super::ExprKind;
use super::arguments::Arguments;
use super::request::SkippedPasses;
use crate::diag::Diagnostics;

/// Name of the option that lists passes to skip.
const KEY: &str = "skip_passes";

/// Names of the passes that the option `skip_passes` accepts.
const PASSES: [&str; 4] = ["frames", "regroup", "parallel", "limbs"];

/// Takes the option `skip_passes` from the arguments of the attribute.
pub fn read_skipped_passes(arguments: &mut Arguments, cx: &mut Diagnostics) -> SkippedPasses {
    let mut skipped = SkippedPasses::default();
    let Some(e) = arguments.take_expression_of_key(KEY, cx) else { return skipped };
    let ExprKind::Array(items) = e.kind else {
        cx.report_error(e.place, format!("expected a list of passes for `{KEY}`"))
            .add_help(format!("write `{KEY} = [{}]`, or some of these", PASSES.join(", ")));
        return skipped;
    };
    for item in items {
        match item.as_name() {
            Some("frames") => skipped.frames = true,
            Some("regroup") => skipped.regroup = true,
            Some("parallel") => skipped.parallel = true,
            Some("limbs") => skipped.limbs = true,
            Some(word) => {
                _ = cx
                    .report_error(item.place.clone(), format!("unknown pass `{word}`"))
                    .suggest_name(word, PASSES)
            }
            None => _ = cx.report_error(item.place, "expected the name of a pass").suggest_name("", PASSES),
        }
    }
    skipped
}
